"""Random missions, the same for the same seed on every machine.

`random_mission` draws everything freely, so some requirements may be of kinds that no robot has.
`generate_mission` makes missions that can be solved, or lack exactly what they are told to lack.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .grid import Cell, GridMap
from .instance import Instance, Robot, Victim
from .layouts import check_share, largest_region, random_stream, share_of

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
MOST_KINDS = 1000

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Range = tuple[int, int]


def random_mission(
    grid: GridMap,
    n_robots: int,
    n_victims: int,
    *,
    seed: int,
    per_robot: tuple[int, int] = (1, 3),
    per_victim: tuple[int, int] = (2, 2),
    speeds: Sequence[float] = SPEEDS,
) -> Instance:
    """A mission with robots and victims on random free cells.

    Parameters
    ----------
    grid : GridMap
        The map. Victims stand on different cells as long as there are enough.
    n_robots, n_victims : int
        How many.
    seed : int
        Determines everything that is random.
    per_robot, per_victim : (least, most)
        How many kinds a robot has, and a victim needs, drawn evenly.
    speeds : sequence of float
        Cells per time unit, drawn evenly.

    Raises
    ------
    InputError
        If the map has no free cell, or a count is out of range.
    """
    _check_range("per_robot", per_robot, len(KINDS))
    _check_range("per_victim", per_victim, len(KINDS))
    _check_speeds(speeds)
    if not 0 <= seed < 2**32:
        raise InputError(f"{seed!r}; give a whole number, 0 to 2**32 - 1", field="seed")
    if n_robots < 1 or n_victims < 0:
        raise InputError("at least one robot and no fewer than no victims", field="counts")
    free = np.argwhere(grid.free)
    if not len(free):
        raise InputError("the map has no free cell", field="map")
    # RandomState's streams are frozen by numpy for good; those of Generator's methods are not.
    random = np.random.RandomState(seed)

    def kinds(least: int, most: int) -> tuple[str, ...]:
        count = random.randint(least, most + 1)
        chosen = set(random.choice(len(KINDS), size=count, replace=False).tolist())
        return tuple(kind for k, kind in enumerate(KINDS) if k in chosen)

    def cells(count: int) -> list[tuple[int, int]]:
        picks = random.choice(len(free), size=count, replace=count > len(free))
        return [(int(row), int(col)) for row, col in free[picks]]

    robots = [
        Robot(
            id=i,
            start=cell,
            speed=float(speeds[random.randint(len(speeds))]),
            capabilities=kinds(*per_robot),
        )
        for i, cell in enumerate(cells(n_robots))
    ]
    victims = [
        Victim(id=i, cell=cell, requirements=kinds(*per_victim))
        for i, cell in enumerate(cells(n_victims))
    ]
    return Instance(
        name=f"{grid.name or 'map'}-{n_robots}x{n_victims}-s{seed}",
        map=grid,
        capabilities=KINDS,
        service_time=SERVICE_TIME,
        robots=tuple(robots),
        victims=tuple(victims),
    )


def kinds_with_times(count: int) -> dict[str, float]:
    """`count` kinds and their service times in time units: the paper's six, then kind7, kind8, ….

    The times of the further ones repeat those of the paper's, in their order.
    """
    names = [*KINDS[:count], *(f"kind{k}" for k in range(len(KINDS) + 1, count + 1))]
    return {kind: SERVICE_TIME[KINDS[k % len(KINDS)]] for k, kind in enumerate(names)}


def generate_mission(
    grid: GridMap,
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
) -> Instance:
    """A mission that can be solved, up to the shares that are asked not to be.

    Robots and victims stand on cells of their own in the largest connected region of the map. Every
    kind is had by some robot; so every requirement can be met by a robot that reaches the victim,
    except as `unreachable` and `unmeetable` say, whose counts are exact.

    Parameters
    ----------
    grid : GridMap
        The map.
    n_robots, n_victims : int
        How many.
    seed : int
        Determines everything that is random.
    kinds : int
        How many kinds of help there are; see `kinds_with_times`.
    per_robot, per_victim : (least, most)
        How many kinds a robot has, and a victim needs, drawn evenly. Robots get more, within the
        range, where otherwise some kind would be had by none.
    speeds : sequence of float
        Cells per time unit, drawn evenly.
    priorities : (least, most), optional
        Priority of a victim, a whole number drawn evenly; 1 if not given.
    unreachable : float
        Share of the victims that stand where no robot can walk, 0 to 1, to the nearest victim.
    unmeetable : float
        Share of all requirements that are of kinds that no robot has, 0 to 1, to the nearest
        requirement. As few kinds as will do are without a robot.

    Raises
    ------
    InputError
        If a number is out of range, the map has too few cells in or out of reach, the robots
        cannot have all kinds between them, or the share of unmeetable requirements cannot be had.
    """
    if not 1 <= kinds <= MOST_KINDS:
        raise InputError(f"{kinds!r}; give 1 to {MOST_KINDS}", field="kinds")
    _check_range("per_robot", per_robot, kinds)
    _check_range("per_victim", per_victim, kinds)
    if priorities is not None:
        _check_range("priorities", priorities, 10**9)
    _check_speeds(speeds)
    check_share(unreachable, "unreachable")
    check_share(unmeetable, "unmeetable")
    if n_robots < 1 or n_victims < 0:
        raise InputError("at least one robot and no fewer than no victims", field="counts")
    random = random_stream(seed, "mission")
    n_cut_off = share_of(unreachable, n_victims)
    starts, cells = _places(grid, n_robots, n_victims, n_cut_off, random)

    needs = random.randint(per_victim[0], per_victim[1] + 1, size=n_victims, dtype=np.int64)
    n_unmeetable = share_of(unmeetable, int(needs.sum()))
    n_lacking = _kinds_without_a_robot(needs, n_unmeetable, kinds)
    shuffled = random.permutation(kinds)
    lacking, had = shuffled[:n_lacking], shuffled[n_lacking:]
    P = _capabilities(had, n_robots, per_robot, kinds, random)  # noqa: N806 - the paper's names
    Q = _requirements(lacking, had, needs, n_unmeetable, kinds, random)  # noqa: N806

    times = kinds_with_times(kinds)
    names = np.array(list(times), dtype=object)
    paces = random.randint(len(speeds), size=n_robots, dtype=np.int64)
    low, high = priorities or (1, 1)
    urgency = random.randint(low, high + 1, size=n_victims, dtype=np.int64)
    return Instance(
        name=f"{grid.name or 'map'}-{n_robots}x{n_victims}-s{seed}",
        description=(
            f"{n_cut_off} of {n_victims} victims out of reach; "
            f"{n_unmeetable} of {needs.sum()} requirements of kinds that no robot has."
        ),
        map=grid,
        capabilities=tuple(times),
        service_time=times,
        robots=tuple(
            Robot(
                id=r,
                start=starts[r],
                speed=float(speeds[paces[r]]),
                capabilities=tuple(names[P[r]]),
            )
            for r in range(n_robots)
        ),
        victims=tuple(
            Victim(
                id=v,
                cell=cells[v],
                requirements=tuple(names[Q[v]]),
                priority=float(urgency[v]),
            )
            for v in range(n_victims)
        ),
    )


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
    least = int(np.maximum(needs - (kinds - count), 0).sum())
    if least > n_unmeetable:
        raise InputError(
            f"{n_unmeetable} requirements of kinds that no robot has, but with {count} such of "
            f"{kinds} kinds at least {least} are; give more kinds, or fewer requirements a victim",
            field="unmeetable",
        )
    return count


def _capabilities(
    had: Ints, n_robots: int, per_robot: Range, kinds: int, random: np.random.RandomState
) -> Bools:
    """P, shape ``(n_robots, kinds)``: every kind of `had` with at least one robot."""
    least, most = per_robot
    if most > len(had):
        raise InputError(
            f"up to {most} kinds a robot, where only {len(had)} of {kinds} are to be had by any; "
            "give a lower range or more kinds",
            field="per_robot",
        )
    if n_robots * most < len(had):
        raise InputError(
            f"{len(had)} kinds, but {n_robots} robots with at most {most} each have only "
            f"{n_robots * most}; give fewer kinds, more robots or more kinds a robot",
            field="kinds",
        )
    counts = random.randint(least, most + 1, size=n_robots, dtype=np.int64)
    while counts.sum() < len(had):
        wanting = np.flatnonzero(counts < most)
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
    least, most = np.maximum(needs - len(had), 0), np.minimum(needs, len(lacking))
    slots = random.permutation(np.repeat(np.arange(n_victims), most - least))
    chosen = slots[: n_unmeetable - int(least.sum())]
    unmet = least + np.bincount(chosen, minlength=n_victims)
    Q = np.zeros((n_victims, kinds), dtype=bool)  # noqa: N806 - the paper's name
    for v in range(n_victims):
        Q[v, random.permutation(lacking)[: unmet[v]]] = True
        Q[v, random.permutation(had)[: needs[v] - unmet[v]]] = True
    return Q


def _as_cells(cells: Ints) -> list[Cell]:
    return [(int(row), int(col)) for row, col in cells]


def _check_range(field: str, given: Range, highest: int) -> None:
    least, most = given
    if not 0 <= least <= most <= highest:
        raise InputError(f"{given}; give 0 ≤ least ≤ most ≤ {highest}", field=field)


def _check_speeds(speeds: Sequence[float]) -> None:
    if not speeds or not all(0 < speed < float("inf") for speed in speeds):
        raise InputError(f"{speeds!r}; give cells per time unit above 0", field="speeds")
