"""What a report is made of: sections of words, tables, pictures and heat maps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import TYPE_CHECKING, ClassVar

from matplotlib.figure import Figure

from .text import slug

if TYPE_CHECKING:
    import pandas as pd

MAX_LABELS = 10
"""Along one side of a panel of a heat map."""
MAX_ROWS = 12
"""Of a table that is not folded."""


@dataclass(frozen=True)
class Words:
    """A paragraph."""

    kind: ClassVar = "words"

    text: str


@dataclass(frozen=True)
class Table:
    """A table, shown with the columns as they are called and kept as CSV."""

    kind: ClassVar = "table"

    name: str
    title: str
    data: pd.DataFrame
    note: str = ""
    """What is counted and how."""
    better: Mapping[str, str] = field(default_factory=dict)
    """By column which way is better, ``more`` or ``less``: the best value is in bold."""
    within: str = ""
    """The column within whose values the best is sought; of the whole table by default."""

    @property
    def is_long(self) -> bool:
        """Whether the page folds it."""
        return len(self.data) > MAX_ROWS

    def best(self) -> set[tuple[int, int]]:
        """Row and column of the best values, where not all are equal."""
        found: set[tuple[int, int]] = set()
        columns = list(self.data.columns)
        groups = self.data[self.within] if self.within else [0] * len(self.data)
        rows_of: dict[object, list[int]] = {}
        for row, group in enumerate(groups):
            rows_of.setdefault(group, []).append(row)
        for name, way in self.better.items():
            if name not in columns or way not in ("more", "less"):
                continue
            column = columns.index(name)
            for rows in rows_of.values():
                values = self.data.iloc[rows, column].astype(float)
                if values.nunique() < 2:
                    continue
                top = values.max() if way == "more" else values.min()
                found |= {(row, column) for row, x in zip(rows, values, strict=True) if x == top}
        return found


@dataclass(frozen=True)
class Picture:
    """A picture drawn by matplotlib, kept as PNG, with its data as CSV."""

    kind: ClassVar = "picture"

    name: str
    title: str
    caption: str
    """What is seen."""
    alt: str
    figure: Figure
    data: pd.DataFrame


@dataclass(frozen=True)
class Cell:
    """A number of robots and of victims: its place, counted from the lower left, and its value."""

    x: int
    y: int
    state: str
    colour: str | None
    tip: str
    text: str = ""
    """The value, in maps of few cells."""
    ink: str = ""


@dataclass(frozen=True)
class Panel:
    """One contender on one map."""

    contender: str
    robots: Sequence[int]
    victims: Sequence[int]
    cells: Sequence[Cell]
    alt: str

    @property
    def x_labels(self) -> list[tuple[int, int]]:
        """Positions along the victims with the labels there, few enough to be read."""
        return _labels(self.victims)

    @property
    def has_values(self) -> bool:
        """Whether the cells tell their values."""
        return any(cell.text for cell in self.cells)

    @property
    def letters(self) -> int:
        """Of the longest value that a cell tells."""
        return max((len(cell.text) for cell in self.cells), default=0)

    @property
    def y_labels(self) -> list[tuple[int, int]]:
        """The same along the robots."""
        return _labels(self.robots)


@dataclass(frozen=True)
class MapHeat:
    """The panels of one map, on one scale of colours."""

    map: str
    panels: Sequence[Panel]
    low: float
    middle: float
    high: float
    log: bool
    gradient: str
    """The colours from low to high, as CSS."""


@dataclass(frozen=True)
class HeatMaps:
    """One metric over robots × victims: per map, a panel for each contender on one colour scale."""

    kind: ClassVar = "heat"

    name: str
    title: str
    caption: str
    unit: str
    maps: Sequence[MapHeat]
    sheet: Figure
    """All panels on one picture, for the PNG."""
    data: pd.DataFrame


Block = Words | Table | Picture | HeatMaps


@dataclass(frozen=True)
class Section:
    """A part of the report under a heading of its own."""

    title: str
    blocks: Sequence[Block]
    note: str = ""
    """What holds for all of them."""

    @property
    def groups(self) -> Iterator[tuple[str, list[Block]]]:
        """The blocks in their order, those of one kind that follow each other together."""
        for kind, blocks in groupby(self.blocks, key=lambda block: block.kind):
            yield kind, list(blocks)

    @property
    def anchor(self) -> str:
        """The name that links within the page lead to."""
        return f"section-{slug(self.title)}"


def _labels(values: Sequence[int]) -> list[tuple[int, int]]:
    step = -(-len(values) // MAX_LABELS)
    return list(enumerate(values))[::step]
