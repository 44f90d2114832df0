"""What may happen while a plan is executed: the scenario, a TOML file of its own.

``format = "msmrta-scenario/1"``; pydantic validates it, and `json_schema` publishes its schema. Speeds
and service times are the mission's own, each times a factor with a distribution; robots are lost at a
time or with a rate; victims are announced, or found by robots; cells are blocked and opened.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from .errors import InputError, all_of, at
from .fields import Amount, CellField, Id
from .grid import GridMap
from .instance import Instance, Victim
from .mistakes import mistakes_of_victim
from .positions import cells_of_a_scenario
from .suggestions import meant
from .validation import problems_of, read_model

FORMAT: Literal["msmrta-scenario/1"] = "msmrta-scenario/1"

Factor = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)]
Sigma = Annotated[float, Field(ge=0, le=5, allow_inf_nan=False)]
Rate = Annotated[float, Field(gt=0, le=1e30, allow_inf_nan=False)]
End = Annotated[float, Field(gt=0, le=1e30, allow_inf_nan=False)]

_NEEDED = {
    "fixed": ("value",),
    "lognormal": ("median", "sigma"),
    "triangular": ("low", "mode", "high"),
}
"""By distribution the fields that it has."""
_DEFAULTS = {"value": 1.0, "median": 1.0}


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Distribution(_Table):
    """By what a value of the mission is multiplied: its distribution.

    ``fixed`` has a ``value``; ``lognormal`` a ``median`` and ``sigma``, the standard deviation of its
    logarithm; ``triangular`` a ``low`` and a ``high`` end and the ``mode`` between them.
    """

    distribution: Literal["fixed", "lognormal", "triangular"] = "fixed"
    value: Factor | None = None
    median: Factor | None = None
    sigma: Sigma | None = None
    low: Factor | None = None
    mode: Factor | None = None
    high: Factor | None = None

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Self:
        if wrong := list(self._faults()):
            raise all_of(wrong)
        return self

    def _faults(self) -> Iterator[InputError]:
        needed = _NEEDED[self.distribution]
        for name in dict.fromkeys(field for fields in _NEEDED.values() for field in fields):
            given = getattr(self, name) is not None
            if given and name not in needed:
                right = f"a {self.distribution} distribution has {', '.join(needed)}"
                yield InputError(f"{getattr(self, name):g}; {right}", field=name)
            elif not given and name in needed and name not in _DEFAULTS:
                yield InputError(f"is missing; {self.distribution} needs it", field=name)
        if None not in (self.low, self.mode, self.high):
            low, mode, high = self.parameters
            if not low <= mode <= high:
                yield InputError(f"{mode:g}; give {low:g} to {high:g}, or other ends", field="mode")

    @property
    def parameters(self) -> tuple[float, ...]:
        """The values of the fields that the distribution has, in their order."""
        given = ((name, getattr(self, name)) for name in _NEEDED[self.distribution])
        return tuple(_DEFAULTS[name] if value is None else value for name, value in given)

    def may_be(self, factor: float) -> bool:
        """Whether `factor` can come of it."""
        if self.distribution == "lognormal":
            median, sigma = self.parameters
            return factor == median if sigma == 0 else 0 < factor < math.inf
        return self.parameters[0] <= factor <= self.parameters[-1]


class SpeedTable(Distribution):
    """The speed of a robot, or of every robot that has no table of its own."""

    robot: Id | None = None


class ServiceTable(Distribution):
    """The service time of a kind, or of every kind that has no table of its own."""

    kind: str | None = None


class LostTable(_Table):
    """A robot that is lost at a ``time``; or one, or any of all, with a ``rate`` per time unit."""

    robot: Id | None = None
    time: Amount | None = None
    rate: Rate | None = None

    @model_validator(mode="after")
    def _time_or_rate(self) -> Self:
        if (self.time is None) == (self.rate is None):
            raise InputError("give either a time or a rate", field="time")
        if self.time is not None and self.robot is None:
            raise InputError("is missing; say which robot is lost at that time", field="robot")
        return self


class VictimTable(Victim):
    """A victim that the plan does not know of.

    It becomes known when it is ``announced``, or before that when a robot sees its cell.
    """

    announced: Amount | None = None

    @property
    def victim(self) -> Victim:
        """As a victim of a mission."""
        return Victim(**{name: getattr(self, name) for name in Victim.model_fields})


class CorridorTable(_Table):
    """Cells that are ``blocked`` at a time, ``opened`` at a time, or both."""

    cells: Annotated[tuple[CellField, ...], Field(min_length=1)]
    blocked: Amount | None = None
    opened: Amount | None = None

    @model_validator(mode="after")
    def _at_a_time(self) -> Self:
        if self.blocked is None and self.opened is None:
            raise InputError("is missing; give blocked, opened or both", field="blocked")
        if self.blocked == self.opened:
            raise InputError(f"{self.opened:g}; give another time than blocked", field="opened")
        return self


class Scenario(_Table):
    """What may happen; without any table, nothing does.

    ``notice`` says when robots learn that a cell is blocked or opened: when one of them stands
    ``before`` it, or ``at_once``. ``visual_field_depth`` is how far robots see victims, in cells. Runs
    end at ``until``, whatever robots are doing then; without it, when nothing more can happen.
    """

    format: Literal["msmrta-scenario/1"] = FORMAT
    name: str = ""
    description: str = ""
    notice: Literal["before", "at_once"] = "before"
    visual_field_depth: Id = 0
    until: End | None = None
    speed: tuple[SpeedTable, ...] = ()
    service: tuple[ServiceTable, ...] = ()
    lost: tuple[LostTable, ...] = ()
    victims: tuple[VictimTable, ...] = ()
    corridors: tuple[CorridorTable, ...] = ()

    @model_validator(mode="after")
    def _says_each_thing_once(self) -> Self:
        wrong = [
            *_repeats("speed", "robot", [table.robot for table in self.speed]),
            *_repeats("service", "kind", [table.kind for table in self.service]),
            *_repeats("victims", "id", [table.id for table in self.victims]),
            *self._at_the_end(),
        ]
        if wrong:
            raise all_of(wrong)
        return self

    def _at_the_end(self) -> Iterator[InputError]:
        """What would happen just as the run ends, of which nobody could say whether it does."""
        times: list[tuple[str, float | None]] = []
        times += [(at("lost", i, "time"), table.time) for i, table in enumerate(self.lost)]
        times += [
            (at("victims", i, "announced"), table.announced) for i, table in enumerate(self.victims)
        ]
        for i, table in enumerate(self.corridors):
            ends = {"blocked": table.blocked, "opened": table.opened}
            times += [(at("corridors", i, name), time) for name, time in ends.items()]
        for field, time in times:
            if time is not None and time == self.until:
                yield InputError(f"{time:g}; the run ends then: give another time", field=field)

    @classmethod
    def read(cls, path: str | Path, grid: GridMap | None = None) -> Scenario:
        """Read a scenario file.

        Parameters
        ----------
        path : str or path
            The file.
        grid : GridMap, optional
            The map of the mission that it is for: with it cells may be given in metres, as x and y.

        Raises
        ------
        InputError
            Naming the file, the field, the offending value and what would be right; `MistakesError`
            of several mistakes.
        """
        read = read_model(cls, path, grid, cells_of_a_scenario, toml=True)
        if not read.model_fields_set:
            problem = f"is empty; give what may happen, or format = {FORMAT!r} alone for nothing"
            raise InputError(problem, file=path)
        return read

    @classmethod
    def from_document(cls, document: dict[str, Any], grid: GridMap | None = None) -> Scenario:
        """A scenario from what its file would hold; `grid` as for a file.

        Raises
        ------
        InputError
            As for a file.
        """
        try:
            return cls.model_validate(cells_of_a_scenario(document, grid))
        except ValidationError as error:
            raise problems_of(error, cls) from None

    @property
    def says_something(self) -> bool:
        """Whether it has a table: something that may happen."""
        return bool(self.speed or self.service or self.lost or self.victims or self.corridors)

    def speed_of(self, robot: int) -> Distribution:
        """The distribution of the factor of a robot's speed."""
        return _own(self.speed, "robot", robot)

    def service_of(self, kind: str) -> Distribution:
        """The distribution of the factor of a kind's service times."""
        return _own(self.service, "kind", kind)

    def check_for(self, mission: Instance) -> None:
        """Refuse what refers to robots, kinds, victims and cells that `mission` has not.

        Raises
        ------
        InputError
            Naming the field; `MistakesError` of several mistakes.
        """
        if wrong := list(_mistakes(self, mission)):
            raise all_of(wrong)


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a scenario file, as which its TOML is read."""
    return Scenario.model_json_schema()


def _own(tables: Sequence[Distribution], field: str, key: object) -> Distribution:
    """The table of `key`, or that of all, or a fixed 1."""
    own = {getattr(table, field): table for table in tables}
    return own.get(key) or own.get(None) or Distribution()


def _repeats(group: str, field: str, keys: Sequence[object]) -> Iterator[InputError]:
    for i, key in enumerate(keys):
        if key in keys[:i]:
            what = f"{key!r} is repeated" if key is not None else f"is a second without a {field}"
            yield InputError(f"{what}; give each once", field=at(group, i, field))


def _mistakes(scenario: Scenario, mission: Instance) -> Iterator[InputError]:
    robots = [str(robot.id) for robot in mission.robots]
    kinds, grid = mission.capabilities, mission.map
    named = [(at("speed", i, "robot"), table.robot) for i, table in enumerate(scenario.speed)]
    named += [(at("lost", i, "robot"), table.robot) for i, table in enumerate(scenario.lost)]
    for field, robot in named:
        if robot is not None and str(robot) not in robots:
            known = ", ".join(robots)
            yield InputError(f"{robot}; the mission has robots {known}", field=field)
    for i, service in enumerate(scenario.service):
        if service.kind is not None:
            yield from _unknown(at("service", i, "kind"), service.kind, kinds)
    ids = {victim.id for victim in mission.victims}
    for i, victim in enumerate(scenario.victims):
        if victim.id in ids:
            problem = f"{victim.id} is a victim of the mission; give a new one"
            yield InputError(problem, field=at("victims", i, "id"))
        yield from mistakes_of_victim(i, victim, grid, kinds)
    opened = _first((c.opened, c.cells) for c in scenario.corridors)
    blocked = _first((c.blocked, c.cells) for c in scenario.corridors)
    for i, corridor in enumerate(scenario.corridors):
        if corridor.opened is not None and corridor.opened < (corridor.blocked or 0.0):
            free = (c for c in corridor.cells if grid.contains(c) and grid.free[c])
            for cell in [c for c in free if blocked[c] > corridor.opened][:1]:
                problem = (
                    f"{corridor.opened:g}; {list(cell)} is free until it is blocked at "
                    f"{corridor.blocked:g}: give a later time, or leave it out"
                )
                yield InputError(problem, field=at("corridors", i, "opened"))
        for j, cell in enumerate(corridor.cells):
            field = at("corridors", i, "cells", j)
            if not grid.contains(cell):
                yield InputError(f"{list(cell)} is {grid.trouble(cell)}", field=field)
            elif (
                corridor.blocked is not None
                and not grid.free[cell]
                and opened.get(cell, math.inf) >= corridor.blocked
            ):
                problem = (
                    f"{list(cell)} is a wall of the map, which blocking does not change; give a free"
                    " cell, or one that is opened before"
                )
                yield InputError(problem, field=field)


def _first(
    changes: Iterable[tuple[float | None, Iterable[tuple[int, int]]]],
) -> dict[tuple[int, int], float]:
    """When each cell is first changed."""
    found: dict[tuple[int, int], float] = {}
    for time, cells in changes:
        for cell in cells if time is not None else ():
            found[cell] = min(found.get(cell, math.inf), time or 0.0)
    return found


def _unknown(field: str, kind: str, kinds: Sequence[str]) -> Iterator[InputError]:
    if kind not in kinds:
        known = ", ".join(kinds)
        yield InputError(f"{kind!r}{meant(kind, kinds)}; the mission has {known}", field=field)
