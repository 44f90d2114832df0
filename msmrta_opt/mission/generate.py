"""Random missions, the same for the same seed on every machine."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .errors import InputError
from .grid import GridMap
from .instance import Instance, Robot, Victim

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
    for name, (least, most) in {"per_robot": per_robot, "per_victim": per_victim}.items():
        if not 0 <= least <= most <= len(KINDS):
            raise InputError(f"{(least, most)}; give 0 ≤ least ≤ most ≤ {len(KINDS)}", field=name)
    if not speeds or not all(0 < speed < float("inf") for speed in speeds):
        raise InputError(f"{speeds!r}; give cells per time unit above 0", field="speeds")
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
