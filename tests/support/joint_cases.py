"""Small joint problems, made up or cut from random missions, and answers to begin with."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.maps import read_map
from msmrta_opt.routing.problem import Routes, RoutingData
from msmrta_opt.stages.joint_routing import routing_data
from msmrta_opt.stages.situation import Situation

MAPS = Path(__file__).parents[2] / "instances" / "maps"


def small_mission(
    seed: int, n_robots: int = 3, n_victims: int = 6, *, map_number: int = 2, **options: object
) -> RoutingData:
    """A random mission among walls: different speeds, split victims, kinds that nobody has."""
    grid = read_map(MAPS / f"map{map_number}.map")
    mission = generate_mission(grid, n_robots, n_victims, seed=seed, solvable=False)
    return routing_data(Situation.of(mission), **options)  # type: ignore[arg-type]


def on_a_line(
    starts: list[float],
    victims: list[float],
    able: list[list[list[bool]]],
    *,
    service: float = 0.0,
    returns: bool = False,
) -> RoutingData:
    """Robots and victims on a line, all of speed one; ``able[r][v][k]``."""
    start, place = np.array(starts, float), np.array(victims, float)
    can = np.array(able, dtype=bool)
    n, m, kinds = can.shape
    leave = np.abs(start[:, None] - place[None, :])
    return RoutingData(
        leave=leave,
        length=np.repeat(np.abs(place[:, None] - place[None, :])[None], n, axis=0),
        back=leave if returns else np.zeros((n, m)),
        service=np.full((m, kinds), service),
        able=can,
        priority=np.ones(m),
        endurance=np.full(n, np.inf),
        longest_walk=np.full(n, np.inf),
    )


def any_routes(data: RoutingData) -> Routes:
    """Feasible routes where there are no limits: each requirement to the first robot able of it."""
    visits: list[dict[int, list[int]]] = [{} for _ in range(data.n_robots)]
    for v, k in np.argwhere(data.required):
        robot = int(np.argmax(data.able[:, v, k]))
        visits[robot].setdefault(int(v), []).append(int(k))
    return tuple(tuple((v, tuple(kinds)) for v, kinds in own.items()) for own in visits)
