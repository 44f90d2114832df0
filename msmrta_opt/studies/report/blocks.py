"""What a report is made of: sections of tables, pictures and heat maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from matplotlib.figure import Figure

from .text import slug

if TYPE_CHECKING:
    import pandas as pd

MOST_LABELS = 10
"""Along one side of a panel of a heat map."""


@dataclass(frozen=True)
class Table:
    """A table, shown with the columns as they are called and kept as CSV."""

    kind: ClassVar = "table"

    name: str
    title: str
    data: pd.DataFrame
    note: str = ""
    """What is counted and how."""


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


Block = Table | Picture | HeatMaps


@dataclass(frozen=True)
class Section:
    """A part of the report under a heading of its own."""

    title: str
    blocks: Sequence[Block]

    @property
    def anchor(self) -> str:
        """The name that links within the page lead to."""
        return f"section-{slug(self.title)}"


def _labels(values: Sequence[int]) -> list[tuple[int, int]]:
    step = -(-len(values) // MOST_LABELS)
    return list(enumerate(values))[::step]
