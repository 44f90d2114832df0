"""A baseline: sequential single-item auctions over all requirements.

In each round every robot bids on every open requirement what serving it would add to its own time,
by the cheapest insertion into its route so far; the lowest bid of all wins. A robot that visits the
victim already bids the service alone.

Source: Koenig et al., *The power of sequential single-item auctions for agent coordination* (2006),
with the team objective of total time.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..mission.instance import Instance
from ..mission.plan import Plan
from ..stages.situation import Situation, Stop
from .support.baseline import plan_by
from .support.planner import Planner


def run(instance: Instance, *, seed: int = 0) -> Plan:
    """Plan `instance` by sequential single-item auctions; `seed` is that of scouting."""
    return plan_by(allocate, instance, planner=PLANNER, seed=seed, options={})


def allocate(situation: Situation) -> list[Stop]:
    """Queue every available requirement; ties: first robot, then first victim, then first kind."""
    instance = situation.instance
    remaining = situation.available.copy()
    to_first = situation.distances.between(instance.starts, instance.cells)
    between = situation.distances.between(instance.cells, instance.cells)
    routes: list[list[int]] = [[] for _ in instance.robots]
    served: dict[tuple[int, int], list[int]] = {}
    detour = to_first / instance.speed[:, None]
    place = np.zeros(to_first.shape, dtype=np.int64)
    while remaining.any():
        bids = detour[:, :, None] + instance.service[None]
        bids = np.where(situation.able & remaining, bids, np.inf)
        robot, v, k = (int(i) for i in np.unravel_index(bids.argmin(), bids.shape))
        remaining[v, k] = False
        if v not in routes[robot]:
            routes[robot].insert(int(place[robot, v]), v)
            added, place[robot] = _cheapest_insertions(to_first[robot], between, routes[robot])
            detour[robot] = added / instance.speed[robot]
        served.setdefault((robot, v), []).append(k)
    return [
        Stop(robot, instance.cells[v], "SSI", v, tuple(served[robot, v]))
        for robot, route in enumerate(routes)
        for v in route
    ]


def _cheapest_insertions(
    to_first: NDArray[np.float64], between: NDArray[np.float64], route: list[int]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """What visiting each victim would add to an open route, in cells, and at which place.

    Victims on the route add nothing. Both of shape ``(n_victims,)``.
    """
    before = np.vstack([to_first, between[route]])
    after = np.vstack([between[route], np.zeros_like(to_first)])
    legs = np.array([to_first[route[0]], *between[route[:-1], route[1:]], 0.0])
    added = before + after - legs[:, None]
    place = added.argmin(axis=0)
    cheapest = added[place, np.arange(len(to_first))]
    cheapest[route] = 0.0
    return cheapest, place


PLANNER = Planner("ssi", "sequential single-item auctions (Koenig et al.)", run)
