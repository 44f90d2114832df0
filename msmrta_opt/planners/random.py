"""A baseline: a random feasible plan, to see what any thought at all is worth."""

from __future__ import annotations

import numpy as np

from ..mission.instance import Instance
from ..mission.plan import Plan
from ..stages.situation import Situation, Stop
from .support.baseline import goals, plan_by, queue_of
from .support.planner import Planner


def run(instance: Instance, *, seed: int = 0) -> Plan:
    """Plan `instance` at random.

    Parameters
    ----------
    seed : int
        Of scouting and of the plan: the same seed makes the same plan.
    """
    return plan_by(
        lambda situation: allocate(situation, seed),
        instance,
        planner=PLANNER,
        seed=seed,
        options={},
    )


def allocate(situation: Situation, seed: int) -> list[Stop]:
    """Give each available requirement, in random order, to a random robot that can serve it."""
    random = np.random.RandomState(seed)
    todo = goals(situation)
    taken: list[list[tuple[int, int]]] = [[] for _ in situation.instance.robots]
    for i in random.permutation(len(todo)):
        v, k = todo[i]
        able = np.flatnonzero(situation.able[:, v, k])
        taken[able[random.randint(len(able))]].append((v, k))
    return [
        stop
        for robot, own in enumerate(taken)
        for stop in queue_of(situation, robot, own, "random")
    ]


PLANNER = Planner("random", "a random feasible plan", run)
