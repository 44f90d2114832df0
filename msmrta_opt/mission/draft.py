"""A mission to edit: robots and victims at places of one's own, or drawn at random."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, TypeVar

from pydantic import ValidationError

from .errors import InputError, all_of, at, each_of
from .generate import SERVICE_TIME, generate_mission
from .grid import GridMap
from .instance import Instance, Robot, Victim
from .places import cell_of, in_its_row, names_in, number, with_ids
from .validation import problems_of, said_of

ROBOT_FIELDS = ("id", "speed", "capabilities")
VICTIM_FIELDS = ("id", "requirements", "priority")
SPEED = 0.3
"""Of a robot whose speed is not given, in cells per time unit."""

Rows = Sequence[Mapping[str, str]]
Member = TypeVar("Member", Robot, Victim)


def draft_mission(
    grid: GridMap,
    robots: int | Rows,
    victims: int | Rows,
    *,
    service_time: Mapping[str, float] = SERVICE_TIME,
    snap: float = 0.0,
    seed: int = 0,
    name: str = "",
) -> Instance:
    """A mission with robots and victims at given places, or so many at random ones.

    Parameters
    ----------
    grid : GridMap
        The map.
    robots, victims : int or rows
        How many to draw, as `generate_mission` does; or rows of text values as `read_places` gives
        them: a place (``x`` and ``y`` in metres, or ``row`` and ``col``), and what `ROBOT_FIELDS` and
        `VICTIM_FIELDS` name. A robot without capabilities has all kinds, a victim without
        requirements needs the first kind.
    service_time : mapping
        Service time in time units, by kind.
    snap : float
        Metres by which a place in a wall may be moved, see `places.cell_of`.
    seed : int
        Of what is random.
    name : str
        Of the mission; the map's, if not given.

    Raises
    ------
    InputError
        If a place or a value cannot be taken; ``robots[2]`` is the third row, unless it says from
        which line of which file it comes. `MistakesError` of several mistakes.
    """
    kinds = tuple(service_time)
    if not kinds:
        raise InputError("no kind; give at least one, as NAME=TIME", field="kinds")

    drawn = _drawn(grid, robots, victims, kinds, seed)
    wrong: list[InputError] = []
    document: dict[str, object] = {
        "name": name or grid.name,
        "map": grid,
        "capabilities": kinds,
        "service_time": dict(service_time),
        "robots": drawn.robots
        if isinstance(robots, int)
        else _members(robots, "robots", lambda i, row: _robot(i, row, grid, snap, kinds), wrong),
        "victims": drawn.victims
        if isinstance(victims, int)
        else _members(victims, "victims", lambda i, row: _victim(i, row, grid, snap, kinds), wrong),
    }
    rows = {
        group: given
        for group, given in (("robots", robots), ("victims", victims))
        if not isinstance(given, int)
    }
    if not wrong:
        try:
            return Instance.model_validate(document)
        except ValidationError as error:
            wrong = list(each_of(problems_of(error)))
    raise all_of([_where(error, rows) for error in wrong])


class _Drawn(NamedTuple):
    robots: tuple[Robot, ...]
    victims: tuple[Victim, ...]


def _drawn(
    grid: GridMap, robots: int | Rows, victims: int | Rows, kinds: tuple[str, ...], seed: int
) -> _Drawn:
    """Robots and victims drawn at random, with the kinds' names; none where rows are given."""
    if not isinstance(robots, int) and not isinstance(victims, int):
        return _Drawn((), ())
    mission = generate_mission(
        grid,
        robots if isinstance(robots, int) else 1,
        victims if isinstance(victims, int) else 0,
        seed=seed,
        kinds=len(kinds),
        per_robot=(1, len(kinds)),
        per_victim=(1, min(2, len(kinds))),
    )
    own = dict(zip(mission.capabilities, kinds, strict=True))
    return _Drawn(
        tuple(
            robot.model_copy(update={"capabilities": tuple(own[k] for k in robot.capabilities)})
            for robot in mission.robots
        ),
        tuple(
            victim.model_copy(update={"requirements": tuple(own[k] for k in victim.requirements)})
            for victim in mission.victims
        ),
    )


def _members(
    rows: Rows,
    group: str,
    make: Callable[[int, Mapping[str, str]], Member],
    wrong: list[InputError],
) -> list[Member]:
    """Of each row the member; what is wrong is added to `wrong`."""
    made = []
    try:
        ids = with_ids(rows, group)
    except InputError as error:
        wrong += each_of(error)
        ids = list(range(len(rows)))
    for i, (identity, row) in enumerate(zip(ids, rows, strict=True)):
        try:
            made.append(make(identity, row))
        except ValidationError as error:
            wrong += [said_of(at(group, i), each) for each in each_of(problems_of(error))]
        except InputError as error:
            wrong.append(said_of(at(group, i), error))
    return made


def _where(error: InputError, rows: Mapping[str, Rows]) -> InputError:
    """`error` of a member, said of the file and line that its row comes from, if it does."""
    found = re.fullmatch(r"(robots|victims)\[(\d+)\]\.?(.*)", error.field)
    if found is None or found[1] not in rows:
        return error
    return in_its_row(error, rows[found[1]][int(found[2])], found[3]) or error


def _robot(
    identity: int, row: Mapping[str, str], grid: GridMap, snap: float, kinds: tuple[str, ...]
) -> Robot:
    return Robot(
        id=identity,
        start=cell_of(row, grid, snap=snap),
        speed=number(row, "speed") if "speed" in row else SPEED,
        capabilities=tuple(names_in(row, "capabilities")) or kinds,
    )


def _victim(
    identity: int, row: Mapping[str, str], grid: GridMap, snap: float, kinds: tuple[str, ...]
) -> Victim:
    return Victim(
        id=identity,
        cell=cell_of(row, grid, snap=snap),
        requirements=tuple(names_in(row, "requirements")) or kinds[:1],
        priority=number(row, "priority") if "priority" in row else 1.0,
    )
