"""A baseline: the nearest capable robot takes the nearest open victim, again and again."""

from __future__ import annotations

import numpy as np

from ..mission.instance import Instance
from ..mission.plan import Plan
from ..stages.cluster_assignment import kinds
from ..stages.situation import Situation, Stop
from .support.baseline import plan_by
from .support.planner import Planner


def run(instance: Instance, *, seed: int = 0) -> Plan:
    """Plan `instance` greedily; `seed` is that of scouting."""
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
    stops: list[Stop] = []
    while remaining.any():
        useful = (situation.able & remaining).any(axis=2)
        reach = np.where(useful, walk, np.inf)
        robot, v = (int(i) for i in np.unravel_index(reach.argmin(), reach.shape))
        served = situation.able[robot, v] & remaining[v]
        stops.append(Stop(robot, instance.cells[v], "greedy", v, kinds(served)))
        remaining[v] &= ~served
        walk[robot] = situation.distances.between([instance.cells[v]], instance.cells)[0]
    return stops


PLANNER = Planner("greedy", "nearest capable robot, again and again", run)
