"""A baseline: the nearest capable robot takes the nearest open victim, again and again."""

from __future__ import annotations

import numpy as np

from ..mission.instance import Instance
from ..mission.plan import Plan
from ..stages.cluster_assignment import kinds
from ..stages.situation import Situation, Stop
from .support.baseline import plan_by
from .support.lowest_bids import LowestBids
from .support.planner import Planner


def run(instance: Instance, *, seed: int = 0) -> Plan:
    """Plan `instance` greedily.

    Parameters
    ----------
    seed : int
        Of scouting.
    """
    return plan_by(allocate, instance, planner=PLANNER, seed=seed, options={})


def allocate(situation: Situation) -> list[Stop]:
    """Queue every available requirement.

    Of all pairs of a robot and a victim at which it can still serve something, the one with the
    shortest walk from where the robot is comes next (ties: first robot, then first victim); the
    robot goes there and serves all that it can.
    """
    instance = situation.instance
    remaining = situation.available.copy()
    walk = situation.distances.between(instance.starts, instance.cells)
    between = situation.distances.between(instance.cells, instance.cells)
    lowest = LowestBids(np.where(situation.able.any(axis=2), walk, np.inf))
    stops: list[Stop] = []
    while remaining.any():
        robot, v = lowest.next()
        served = situation.able[robot, v] & remaining[v]
        stops.append(Stop(robot, situation.cells[v], "greedy", v, kinds(served)))
        remaining[v] &= ~served
        lowest.withdraw(v, ~(situation.able[:, v] & remaining[v]).any(axis=1))
        lowest.bid(robot, np.where(np.isfinite(lowest.bids[robot]), between[v], np.inf))
    return stops


PLANNER = Planner("greedy", "nearest capable robot, again and again", run)
