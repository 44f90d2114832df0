"""What is planned: robots, victims, scouts and the map they share.

One JSON file per instance (``"format": "msmrta-instance/1"``); pydantic validates it, and
`json_schema` publishes its schema. The binary matrices are those of the paper's Algorithm 2: ``Q``
holds a row of requirements per victim, ``P`` a row of capabilities per robot.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator

from . import display
from .counting import rows_by_columns
from .errors import InputError, all_of, shown
from .fields import Amount, Id, Speed
from .fields import CellField as CellField
from .files import write_text
from .grid import Cell
from .map_field import MapField
from .mistakes import mistakes
from .positions import cells_of_positions
from .shipped import find_instance
from .suggestions import meant
from .validation import problems_of, read_model

FORMAT: Literal["msmrta-instance/1"] = "msmrta-instance/1"

T = TypeVar("T", bound=np.generic)


class _Record(BaseModel):
    """A frozen, strictly validated record of the document."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)


class Robot(_Record):
    """A rescue robot.

    ``start`` is a cell, ``speed`` is in cells per time unit, ``capabilities`` are names of kinds. Where
    the map has a frame, a file may give a place in metres, as ``{"x": 2.5, "y": 1.0}``.
    """

    id: Id
    start: CellField
    speed: Speed
    capabilities: tuple[str, ...]


class Victim(_Record):
    """A victim, that is, a task.

    ``service_time`` overrides the instance's times (in time units) per requirement kind;
    ``priority`` weights the victim's completion time.
    """

    id: Id
    cell: CellField
    requirements: tuple[str, ...]
    service_time: dict[str, Amount] = Field(default_factory=dict)
    priority: Amount = 1.0


class Scout(_Record):
    """A scouting robot; ``visual_field_depth`` is in cells, in each direction."""

    id: Id
    start: CellField
    visual_field_depth: Id


class Instance(_Record):
    """A rescue mission: the map, who needs what, and who can do what.

    Robots, victims and kinds are indexed by their position in the document: ``r``, ``v`` and ``k``
    in the formulas. Read one with `Instance.read`, vary one with `replace`.
    """

    format: Literal["msmrta-instance/1"] = FORMAT
    name: str = ""
    description: str = ""
    source: str = ""
    map: MapField
    capabilities: tuple[str, ...]
    service_time: dict[str, Amount]
    robots: Annotated[tuple[Robot, ...], Field(min_length=1)]
    victims: tuple[Victim, ...] = ()
    scouts: tuple[Scout, ...] = ()
    clusters: tuple[Id, ...] | None = None
    _looked_at: int = PrivateAttr(0)

    @model_validator(mode="after")
    def _refers_to_what_exists(self) -> Self:
        if self._looked_at == id(self):  # every plan for it asks again; a changed copy is another
            return self
        if wrong := list(mistakes(self)):
            raise all_of(wrong)
        self._looked_at = id(self)
        return self

    def __eq__(self, other: object) -> bool:
        # Not pydantic's own, which would compare the arrays that have been worked out so far.
        if not isinstance(other, Instance):
            return NotImplemented
        return all(getattr(self, n) == getattr(other, n) for n in type(self).model_fields)

    def __hash__(self) -> int:
        return hash((self.name, self.map, self.robots, self.n_victims))

    def __repr__(self) -> str:
        return f"Instance({self._summary})"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        robots = [
            {"robot": x.id, "start": x.start, "speed": x.speed, "capabilities": x.capabilities}
            for x in self.robots
        ]
        victims = [
            {"victim": x.id, "cell": x.cell, "requirements": x.requirements, "priority": x.priority}
            for x in self.victims
        ]
        scouts = [
            {"scout": x.id, "start": x.start, "sees (cells)": x.visual_field_depth}
            for x in self.scouts
        ]
        return display.page(
            self._summary,
            display.paragraph(self.description),
            display.table("Robots", robots),
            display.table("Victims", victims),
            display.table("Scouts", scouts),
        )

    @property
    def _summary(self) -> str:
        counts = [
            display.counted(self.n_robots, "robot"),
            display.counted(self.n_victims, "victim"),
            *([display.counted(len(self.scouts), "scout")] if self.scouts else []),
            display.counted(self.n_kinds, "kind"),
        ]
        return f"{self.name or 'unnamed'}: {', '.join(counts)}, map of {rows_by_columns(self.map.shape)}"

    # Sizes and arrays

    @property
    def n_robots(self) -> int:
        """N, the number of robots."""
        return len(self.robots)

    @property
    def n_victims(self) -> int:
        """M, the number of victims."""
        return len(self.victims)

    @property
    def n_kinds(self) -> int:
        """Number of kinds of capability, which are also the kinds of requirement."""
        return len(self.capabilities)

    @cached_property
    def Q(self) -> NDArray[np.bool_]:  # noqa: N802 - the paper's name
        """Requirements, shape ``(n_victims, n_kinds)``."""
        return _membership([v.requirements for v in self.victims], self.capabilities)

    @cached_property
    def P(self) -> NDArray[np.bool_]:  # noqa: N802 - the paper's name
        """Capabilities, shape ``(n_robots, n_kinds)``."""
        return _membership([r.capabilities for r in self.robots], self.capabilities)

    @cached_property
    def service(self) -> NDArray[np.float64]:
        """Service time in time units, 0 where not required, shape ``(n_victims, n_kinds)``."""
        times = np.array(
            [
                [v.service_time.get(kind, self.service_time[kind]) for kind in self.capabilities]
                for v in self.victims
            ],
            dtype=float,
        ).reshape(self.n_victims, self.n_kinds)
        return _frozen(np.where(self.Q, times, 0.0))

    @cached_property
    def speed(self) -> NDArray[np.float64]:
        """Speed per robot in cells per time unit, shape ``(n_robots,)``."""
        return _frozen(np.array([robot.speed for robot in self.robots]))

    @cached_property
    def priority(self) -> NDArray[np.float64]:
        """Priority per victim, shape ``(n_victims,)``."""
        return _frozen(np.array([victim.priority for victim in self.victims], dtype=float))

    @property
    def starts(self) -> list[Cell]:
        """Start cell of each robot."""
        return [robot.start for robot in self.robots]

    @property
    def cells(self) -> list[Cell]:
        """Cell of each victim."""
        return [victim.cell for victim in self.victims]

    # Files and variants

    @classmethod
    def read(cls, path: str | Path) -> Instance:
        """Read an instance file, or a shipped instance by its name; a file of that name comes first.

        Raises
        ------
        InputError
            Naming the file, the field, the offending value and what would be right.
        """
        file = find_instance(path)
        return read_model(cls, file, {"folder": file.parent}, cells_of_positions)

    @classmethod
    def from_document(cls, document: Mapping[str, Any], *, file: str | Path = "") -> Instance:
        """An instance from the document that `document` returns (its map held as rows)."""
        try:
            context: dict[str, Any] = {}
            text = json.dumps(cells_of_positions(document, context))
            return cls.model_validate_json(text, strict=True, context=context)
        except ValidationError as error:
            raise problems_of(error, cls).within(file) from None
        except InputError as error:
            raise error.within(file) from None

    def document(self) -> dict[str, Any]:
        """The instance as a JSON-ready document that needs no other file."""
        return self.model_dump(mode="json", exclude_defaults=False)

    def save(self, path: str | Path) -> None:
        """Write the instance to `path`, whole or not at all.

        The map is referred to where its file lies in or below the same folder, else written out.
        """
        path = Path(path)
        document = self.document()
        if self.map.source is not None and self.map.frame is None:
            source, folder = self.map.source.resolve(), path.parent.resolve()
            if source.is_relative_to(folder) and source.exists():
                document["map"] = source.relative_to(folder).as_posix()
        write_text(path, json.dumps(document, indent=1) + "\n")

    def replace(self, **changes: Any) -> Instance:
        """A validated copy with some fields changed.

        Pinned clusters are dropped when the victims change and no new labels are given.

        Raises
        ------
        InputError
            As for a file.
        """
        unknown = set(changes) - set(type(self).model_fields)
        if unknown:
            name = sorted(unknown)[0]
            known = type(self).model_fields
            raise InputError(
                f"no such field{meant(name, known)}; there are {', '.join(known)}", field=name
            )
        if "victims" in changes:
            changes.setdefault("clusters", None)
        values = {name: getattr(self, name) for name in type(self).model_fields} | changes
        try:
            return type(self).model_validate(values)
        except ValidationError as error:
            raise problems_of(error, type(self)) from None

    def with_victims(self, indices: Sequence[int]) -> Instance:
        """The same mission with only the victims at `indices`, their pinned clusters kept."""
        labels = None if self.clusters is None else tuple(self.clusters[i] for i in indices)
        return self.replace(victims=tuple(self.victims[i] for i in indices), clusters=labels)


def require_mission(value: object) -> Instance:
    """`value` itself, if it is a mission.

    Raises
    ------
    InputError
        If it is anything else, such as a file's name.
    """
    if not isinstance(value, Instance):
        raise InputError(
            f"{shown(value)}; give a mission, as msmrta_opt.read(FILE) returns it", field="instance"
        )
    return value


def json_schema() -> dict[str, Any]:
    """The JSON Schema of an instance file."""
    return Instance.model_json_schema()


def _membership(rows: Sequence[Sequence[str]], kinds: Sequence[str]) -> NDArray[np.bool_]:
    table = [[kind in row for kind in kinds] for row in rows]
    return _frozen(np.array(table, dtype=bool).reshape(len(rows), len(kinds)))


def _frozen(array: NDArray[T]) -> NDArray[T]:
    array.setflags(write=False)
    return array
