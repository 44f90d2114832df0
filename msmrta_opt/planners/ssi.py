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
from .support.lowest_bids import LowestBids
from .support.planner import Planner


def run(instance: Instance, *, seed: int = 0) -> Plan:
    """Plan `instance` by sequential single-item auctions.

    Parameters
    ----------
    seed : int
        Of scouting.
    """
    return plan_by(allocate, instance, planner=PLANNER, seed=seed, options={})


def allocate(situation: Situation) -> list[Stop]:
    """Queue every available requirement; ties: first robot, then first victim, then first kind."""
    instance = situation.instance
    remaining, shape = situation.available.copy(), situation.available.shape
    to_first = situation.distances.between(instance.starts, instance.cells)
    between = situation.distances.between(instance.cells, instance.cells)
    insertions = [_Insertions(to_first[r], between) for r in range(instance.n_robots)]
    served: dict[tuple[int, int], list[int]] = {}

    def bids(robot: int) -> NDArray[np.float64]:
        detour = insertions[robot].cheapest() / instance.speed[robot]
        asked = situation.able[robot] & remaining
        return np.where(asked, detour[:, None] + instance.service, np.inf).ravel()

    lowest = LowestBids(np.array([bids(r) for r in range(instance.n_robots)]))
    while remaining.any():
        robot, requirement = lowest.next()
        v, k = (int(i) for i in np.unravel_index(requirement, shape))
        remaining[v, k] = False
        if v not in insertions[robot].route:
            insertions[robot].insert(v)
        lowest.withdraw(requirement, np.ones(instance.n_robots, dtype=bool))
        lowest.bid(robot, bids(robot))
        served.setdefault((robot, v), []).append(k)
    return [
        Stop(robot, situation.cells[v], "SSI", v, tuple(served[robot, v]))
        for robot, own in enumerate(insertions)
        for v in own.route
    ]


class _Insertions:
    """What visiting each victim would add to an open route, in cells, and at which place.

    Parameters
    ----------
    to_first : float array, shape (n_victims,)
        From the robot's start, in cells.
    between : float array, shape (n_victims, n_victims)
        Between victims, in cells.
    """

    def __init__(self, to_first: NDArray[np.float64], between: NDArray[np.float64]) -> None:
        self._to_first, self._between = to_first, between
        self.route: list[int] = []
        self._added = to_first.copy()
        self._place = np.zeros(len(to_first), dtype=np.int64)

    def cheapest(self) -> NDArray[np.float64]:
        """What each victim adds, ``(n_victims,)``; those on the route add nothing."""
        added = self._added.copy()
        added[self.route] = 0.0
        return added

    def insert(self, v: int) -> None:
        """Visit `v` where it adds least, at the first such place."""
        at = int(self._place[v])
        self.route.insert(at, v)
        lost = np.flatnonzero(self._place == at)
        self._place[self._place > at] += 1
        for place in (at, at + 1):
            added = self._adds(place)
            equal = (added == self._added) & (place < self._place)
            better = (added < self._added) | equal
            self._added[better], self._place[better] = added[better], place
        # Where the place that was best is none any more, all are looked at.
        if len(lost):
            every = self._everywhere(lost)
            self._place[lost] = every.argmin(axis=0)
            self._added[lost] = every.min(axis=0)

    def _adds(self, place: int) -> NDArray[np.float64]:
        """What each victim adds at a place of the route, ``(n_victims,)``."""
        route, between = self.route, self._between
        before = between[route[place - 1]] if place else self._to_first
        if place == len(route):
            return before
        after = route[place]
        return np.asarray(before + between[after] - before[after])

    def _everywhere(self, victims: NDArray[np.int64]) -> NDArray[np.float64]:
        """What `victims` add at each place of the route, ``(n_places, n_victims)``."""
        route, between = np.array(self.route), self._between
        ways = np.concatenate([self._to_first[None, victims], between[np.ix_(route, victims)]])
        legs = np.append(self._to_first[route[0]], between[route[:-1], route[1:]])
        ways[:-1] += ways[1:] - legs[:, None]
        return ways


PLANNER = Planner("ssi", "sequential single-item auctions (Koenig et al.)", run)
