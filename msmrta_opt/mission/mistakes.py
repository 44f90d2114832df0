"""What no schema says of a mission: its parts refer to what exists, and its ids and kinds differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from .counting import counted
from .errors import InputError, at
from .grid import Cell, GridMap
from .suggestions import meant


class _Robot(Protocol):
    @property
    def id(self) -> int: ...
    @property
    def start(self) -> Cell: ...
    @property
    def capabilities(self) -> tuple[str, ...]: ...


class _Victim(Protocol):
    @property
    def id(self) -> int: ...
    @property
    def cell(self) -> Cell: ...
    @property
    def requirements(self) -> tuple[str, ...]: ...
    @property
    def service_time(self) -> Mapping[str, float]: ...


class _Scout(Protocol):
    @property
    def id(self) -> int: ...
    @property
    def start(self) -> Cell: ...


class _Mission(Protocol):
    @property
    def map(self) -> GridMap: ...
    @property
    def capabilities(self) -> tuple[str, ...]: ...
    @property
    def service_time(self) -> Mapping[str, float]: ...
    @property
    def robots(self) -> Sequence[_Robot]: ...
    @property
    def victims(self) -> Sequence[_Victim]: ...
    @property
    def scouts(self) -> Sequence[_Scout]: ...
    @property
    def clusters(self) -> tuple[int, ...] | None: ...


def mistakes(mission: _Mission) -> Iterator[InputError]:
    """Everything that refers to nothing, stands in a wall or is repeated, in the document's order."""
    kinds = mission.capabilities
    yield from _repeats("capabilities", kinds, "each kind is listed once")
    for kind in mission.service_time:
        yield from _unknown(at("service_time", kind), kind, kinds)
    for kind in dict.fromkeys(kinds):
        if kind not in mission.service_time:
            yield InputError(f"no time for kind {kind!r}; give one for each", field="service_time")
    groups: Mapping[str, Sequence[_Robot | _Victim | _Scout]] = {
        "robots": mission.robots,
        "victims": mission.victims,
        "scouts": mission.scouts,
    }
    for group, members in groups.items():
        ids = [member.id for member in members]
        yield from _repeats(group, ids, "ids differ within a group", suffix=".id")
    for i, robot in enumerate(mission.robots):
        yield from _misplaced(at("robots", i, "start"), robot.start, mission.map)
        yield from _kinds(at("robots", i, "capabilities"), robot.capabilities, kinds)
    for i, victim in enumerate(mission.victims):
        yield from mistakes_of_victim(i, victim, mission.map, kinds)
    for i, scout in enumerate(mission.scouts):
        yield from _misplaced(at("scouts", i, "start"), scout.start, mission.map)
    labels, n_victims = mission.clusters, len(mission.victims)
    if labels is not None and len(labels) != n_victims:
        yield InputError(
            f"{counted(len(labels), 'label')} for {counted(n_victims, 'victim')}; give one per victim",
            field="clusters",
        )


def mistakes_of_victim(
    i: int, victim: _Victim, grid: GridMap, kinds: Sequence[str]
) -> Iterator[InputError]:
    """The same of the victim at a position of a document, in a mission of these kinds."""
    yield from _misplaced(at("victims", i, "cell"), victim.cell, grid)
    yield from _kinds(at("victims", i, "requirements"), victim.requirements, kinds)
    yield from _not_needed(at("victims", i, "service_time"), victim, kinds)


def _misplaced(field: str, cell: Cell, grid: GridMap) -> Iterator[InputError]:
    n_rows, n_cols = grid.shape
    if not grid.contains(cell):
        yield InputError(
            f"{list(cell)} is outside the map; rows are 0 to {n_rows - 1},"
            f" columns 0 to {n_cols - 1}",
            field=field,
        )
    elif not grid.is_free(cell):
        yield InputError(f"{list(cell)} is in a wall; give a free cell", field=field)


def _unknown(field: str, kind: str, kinds: Sequence[str]) -> Iterator[InputError]:
    if kind not in kinds:
        known = ", ".join(kinds) or "none"
        yield InputError(
            f"unknown kind {kind!r}{meant(kind, kinds)}; known here: {known}", field=field
        )


def _kinds(field: str, names: Sequence[str], kinds: Sequence[str]) -> Iterator[InputError]:
    for kind in names:
        yield from _unknown(field, kind, kinds)
    yield from _repeats(field, names, "each kind is listed once")


def _not_needed(field: str, victim: _Victim, kinds: Sequence[str]) -> Iterator[InputError]:
    """Times of a victim's own for kinds that it does not need."""
    needed = ", ".join(victim.requirements) or "nothing"
    for kind in victim.service_time:
        if kind not in kinds:
            yield from _unknown(field, kind, victim.requirements)
        elif kind not in victim.requirements:
            yield InputError(
                f"a time for {kind!r}, which victim {victim.id} does not need (it needs {needed}); "
                "remove it, or add the kind to its requirements",
                field=field,
            )


def _repeats(
    field: str, values: Sequence[object], rule: str, *, suffix: str = ""
) -> Iterator[InputError]:
    seen: set[object] = set()
    for i, value in enumerate(values):
        if value in seen:
            yield InputError(f"{value!r} is repeated; {rule}", field=f"{field}[{i}]{suffix}")
        seen.add(value)
