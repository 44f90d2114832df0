"""Random missions, the same for the same seed on every machine."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Bools, Ints
from .counting import counted
from .errors import InputError
from .grid import Cell, GridMap
from .instance import Instance, Robot, Victim
from .layouts import check_share, largest_region, random_stream, share_of
from .named_maps import find_map

KINDS = (
    "FirstAids",
    "DebrisRemover",
    "OxygenCylinder",
    "Defuser",
    "Manipulator",
    "FireExtinguisher",
)
SERVICE_TIME = dict(zip(KINDS, (15.0, 30.0, 20.0, 10.0, 45.0, 35.0), strict=True))
SPEEDS = (0.2, 0.3, 0.4)
MAXIMUM_KINDS = 1000

Range = tuple[int, int]


class _Wanted(NamedTuple):
    """What is asked of the draw."""

    grid: GridMap
    n_robots: int
    n_victims: int
    kinds: int
    per_robot: Range
    per_victim: Range
    n_speeds: int
    priorities: Range


class _Draw(NamedTuple):
    """All that is random about a mission, by position."""

    starts: list[Cell]
    cells: list[Cell]
    P: Bools
    Q: Bools
    speeds: Ints
    priorities: Ints
    description: str


def kinds_with_times(count: int) -> dict[str, float]:
    """`count` kinds and their service times in time units: the paper's six, then kind7, kind8, ….

    The times of the further ones repeat those of the paper's, in their order.
    """
    names = [*KINDS[:count], *(f"kind{k}" for k in range(len(KINDS) + 1, count + 1))]
    return {kind: SERVICE_TIME[KINDS[k % len(KINDS)]] for k, kind in enumerate(names)}


def generate_mission(
    grid: GridMap | str | Path,
    n_robots: int,
    n_victims: int,
    *,
    seed: int,
    kinds: int = len(KINDS),
    per_robot: Range = (1, 3),
    per_victim: Range = (2, 2),
    speeds: Sequence[float] = SPEEDS,
    priorities: Range | None = None,
    unreachable: float = 0.0,
    unmeetable: float = 0.0,
    solvable: bool = True,
) -> Instance:
    """A mission that can be solved, up to the shares that are asked not to be; or any mission.

    Robots and victims stand on cells of their own in the largest connected region of the map. Every
    kind is had by some robot; so every requirement can be met by a robot that reaches the victim,
    except as `unreachable` and `unmeetable` say, whose counts are exact.

    Parameters
    ----------
    grid : GridMap, str or path
        The map, the name of one that comes with the package, or a file.
    n_robots, n_victims : int
        How many.
    seed : int
        Determines everything that is random.
    kinds : int
        How many kinds of help there are; see `kinds_with_times`.
    per_robot, per_victim : (minimum, maximum)
        How many kinds a robot has, and a victim needs, drawn evenly. Robots get more, within the
        range, where otherwise some kind would be had by none.
    speeds : sequence of float
        Cells per time unit, drawn evenly.
    priorities : (minimum, maximum), optional
        Priority of a victim, a whole number drawn evenly; 1 if not given.
    unreachable : float
        Share of the victims that stand where no robot can walk, 0 to 1, to the nearest victim.
    unmeetable : float
        Share of all requirements that are of kinds that no robot has, 0 to 1, to the nearest
        requirement. As few kinds as will do are without a robot.
    solvable : bool
        If false, everything is drawn freely: robots and victims stand on any free cell, robots where
        others do, victims too once there are more than cells, and what a robot has does not depend
        on what is needed.

    Raises
    ------
    InputError
        If there is no such map, a number is out of range, the map has too few cells in or out of
        reach, the robots cannot have all kinds between them, or the share of unmeetable
        requirements cannot be had.
    """
    if not isinstance(grid, GridMap):
        grid = find_map(grid)
    if not 1 <= kinds <= MAXIMUM_KINDS:
        raise InputError(f"{kinds!r}; give 1 to {MAXIMUM_KINDS}", field="kinds")
    _check_range("per_robot", per_robot, kinds)
    _check_range("per_victim", per_victim, kinds)
    if priorities is not None:
        _check_range("priorities", priorities, 10**9)
    _check_speeds(speeds)
    for name, share in {"unreachable": unreachable, "unmeetable": unmeetable}.items():
        check_share(share, name)
        if share and not solvable:
            raise InputError("goes with missions that can be solved otherwise", field=name)
    for name, count in {"n_robots": n_robots, "n_victims": n_victims}.items():
        if isinstance(count, bool) or not isinstance(count, (int, np.integer)):
            raise InputError(f"{count!r}; give a whole number", field=name)
    if n_robots < 1 or n_victims < 0:
        raise InputError("at least one robot and no fewer than no victims", field="counts")
    wanted = _Wanted(
        *(grid, n_robots, n_victims, kinds, per_robot, per_victim),
        n_speeds=len(speeds),
        priorities=priorities or (1, 1),
    )
    if solvable:
        drawn = _solvable(wanted, unreachable, unmeetable, random_stream(seed, "mission"))
    else:
        drawn = _free(wanted, seed)
    times = kinds_with_times(kinds)
    names = np.array(list(times), dtype=object)
    return Instance(
        name=f"{grid.name or 'map'}-{n_robots}x{n_victims}-s{seed}",
        description=drawn.description,
        map=grid,
        capabilities=tuple(times),
        service_time=times,
        robots=tuple(
            Robot(
                id=r,
                start=drawn.starts[r],
                speed=float(speeds[drawn.speeds[r]]),
                capabilities=tuple(names[drawn.P[r]]),
            )
            for r in range(n_robots)
        ),
        victims=tuple(
            Victim(
                id=v,
                cell=drawn.cells[v],
                requirements=tuple(names[drawn.Q[v]]),
                priority=float(drawn.priorities[v]),
            )
            for v in range(n_victims)
        ),
    )


def random_mission(
    grid: GridMap, n_robots: int, n_victims: int, *, seed: int, **options: Any
) -> Instance:
    """The name of before for `generate_mission` with ``solvable=False``."""
    return generate_mission(grid, n_robots, n_victims, seed=seed, solvable=False, **options)


def _solvable(
    wanted: _Wanted, unreachable: float, unmeetable: float, random: np.random.RandomState
) -> _Draw:
    n_victims, kinds = wanted.n_victims, wanted.kinds
    n_cut_off = share_of(unreachable, n_victims)
    starts, cells = _places(wanted.grid, wanted.n_robots, n_victims, n_cut_off, random)
    needs = _drawn(random, wanted.per_victim, n_victims)
    n_unmeetable = share_of(unmeetable, int(needs.sum()))
    n_lacking = _kinds_without_a_robot(needs, n_unmeetable, kinds)
    shuffled = random.permutation(kinds)
    lacking, had = shuffled[:n_lacking], shuffled[n_lacking:]
    return _Draw(
        starts,
        cells,
        P=_capabilities(had, wanted.n_robots, wanted.per_robot, kinds, random),
        Q=_requirements(lacking, had, needs, n_unmeetable, kinds, random),
        speeds=_drawn(random, (0, wanted.n_speeds - 1), wanted.n_robots),
        priorities=_drawn(random, wanted.priorities, n_victims),
        description=f"{n_cut_off} of {n_victims} victims out of reach; "
        f"{n_unmeetable} of {needs.sum()} requirements of kinds that no robot has.",
    )


def _free(wanted: _Wanted, seed: int) -> _Draw:
    if not 0 <= seed < 2**32:
        raise InputError(f"{seed!r}; give a whole number, 0 to 2**32 - 1", field="seed")
    free = np.argwhere(wanted.grid.free)
    if not len(free):
        raise InputError("the map has no free cell", field="map")
    # RandomState's streams are frozen by numpy for good; those of Generator's methods are not.
    random = np.random.RandomState(seed)

    def some_cells(count: int) -> list[Cell]:
        return _as_cells(free[random.choice(len(free), size=count, replace=count > len(free))])

    def some_kinds(between: Range) -> Bools:
        count = random.randint(between[0], between[1] + 1)
        chosen = random.choice(wanted.kinds, size=count, replace=False)
        return np.isin(np.arange(wanted.kinds), chosen)

    starts = some_cells(wanted.n_robots)
    robots = [
        (random.randint(wanted.n_speeds), some_kinds(wanted.per_robot))
        for _ in range(wanted.n_robots)
    ]
    cells = some_cells(wanted.n_victims)
    needs = [some_kinds(wanted.per_victim) for _ in range(wanted.n_victims)]
    return _Draw(
        starts,
        cells,
        P=np.array([kinds for _, kinds in robots]),
        Q=np.array(needs, dtype=bool).reshape(wanted.n_victims, wanted.kinds),
        speeds=np.array([speed for speed, _ in robots], dtype=np.int64),
        priorities=_drawn(random, wanted.priorities, wanted.n_victims),
        description="",
    )


def _drawn(random: np.random.RandomState, between: Range, count: int) -> Ints:
    return random.randint(between[0], between[1] + 1, size=count, dtype=np.int64)


def _places(
    grid: GridMap, n_robots: int, n_victims: int, n_cut_off: int, random: np.random.RandomState
) -> tuple[list[Cell], list[Cell]]:
    """Start cells and victims' cells, all different; `n_cut_off` victims outside the region."""
    region = largest_region(grid)
    inside, outside = np.argwhere(region), np.argwhere(grid.free & ~region)
    n_within = n_robots + n_victims - n_cut_off
    if n_within > len(inside):
        raise InputError(
            f"{n_within} robots and victims within reach on {len(inside)} connected cells; "
            "each needs a cell of its own: give fewer, or a larger or less dense map",
            field="map",
        )
    if n_cut_off > len(outside):
        raise InputError(
            f"{n_cut_off} victims out of reach, but the map has {len(outside)} free cells outside "
            "its largest region; give less, or a map with walled-off cells",
            field="unreachable",
        )
    near = inside[random.permutation(len(inside))[:n_within]]
    far = outside[random.permutation(len(outside))[:n_cut_off]]
    victims = random.permutation(np.concatenate([near[n_robots:], far]))
    return _as_cells(near[:n_robots]), _as_cells(victims)


def _kinds_without_a_robot(needs: Ints, n_unmeetable: int, kinds: int) -> int:
    """The fewest kinds for `n_unmeetable` requirements, each victim needing a kind at most once."""
    if not n_unmeetable:
        return 0
    count = next(n for n in range(1, kinds + 1) if np.minimum(needs, n).sum() >= n_unmeetable)
    minimum = int(np.maximum(needs - (kinds - count), 0).sum())
    if minimum > n_unmeetable:
        raise InputError(
            f"{n_unmeetable} requirements of kinds that no robot has, but with {count} such of "
            f"{kinds} kinds at least {minimum} are; give more kinds, or fewer requirements a victim",
            field="unmeetable",
        )
    return count


def _capabilities(
    had: Ints, n_robots: int, per_robot: Range, kinds: int, random: np.random.RandomState
) -> Bools:
    """P, shape ``(n_robots, kinds)``: every kind of `had` with at least one robot."""
    minimum, maximum = per_robot
    if maximum > len(had):
        raise InputError(
            f"up to {maximum} kinds a robot, where only {len(had)} of {kinds} are to be had by any; "
            "give a lower range or more kinds",
            field="per_robot",
        )
    if n_robots * maximum < len(had):
        raise InputError(
            f"{len(had)} kinds, but at most {maximum} for each of {counted(n_robots, 'robot')} make"
            f" only {n_robots * maximum}; give fewer kinds, more robots or more kinds a robot",
            field="kinds",
        )
    counts = random.randint(minimum, maximum + 1, size=n_robots, dtype=np.int64)
    while counts.sum() < len(had):
        wanting = np.flatnonzero(counts < maximum)
        counts[wanting[random.randint(len(wanting), dtype=np.int64)]] += 1
    P = np.zeros((n_robots, kinds), dtype=bool)  # noqa: N806 - the paper's name
    # Each kind once, to random robots; then each robot's other kinds.
    owners = random.permutation(np.repeat(np.arange(n_robots), counts))[: len(had)]
    P[owners, had] = True
    for r in range(n_robots):
        others = random.permutation(had[~P[r, had]])
        P[r, others[: counts[r] - P[r].sum()]] = True
    return P


def _requirements(
    lacking: Ints,
    had: Ints,
    needs: Ints,
    n_unmeetable: int,
    kinds: int,
    random: np.random.RandomState,
) -> Bools:
    """Q, shape ``(n_victims, kinds)``: `needs` kinds a victim, `n_unmeetable` of them lacking."""
    n_victims = len(needs)
    minimum, maximum = np.maximum(needs - len(had), 0), np.minimum(needs, len(lacking))
    slots = random.permutation(np.repeat(np.arange(n_victims), maximum - minimum))
    chosen = slots[: n_unmeetable - int(minimum.sum())]
    unmet = minimum + np.bincount(chosen, minlength=n_victims)
    Q = np.zeros((n_victims, kinds), dtype=bool)  # noqa: N806 - the paper's name
    for v in range(n_victims):
        Q[v, random.permutation(lacking)[: unmet[v]]] = True
        Q[v, random.permutation(had)[: needs[v] - unmet[v]]] = True
    return Q


def _as_cells(cells: Ints) -> list[Cell]:
    return [(int(row), int(col)) for row, col in cells]


def _check_range(field: str, given: Range, highest: int) -> None:
    low, high = given
    if not 0 <= low <= high <= highest:
        raise InputError(f"{given}; give 0 ≤ minimum ≤ maximum ≤ {highest}", field=field)


def _check_speeds(speeds: Sequence[float]) -> None:
    if not speeds or not all(0 < speed < float("inf") for speed in speeds):
        raise InputError(f"{speeds!r}; give cells per time unit above 0", field="speeds")
