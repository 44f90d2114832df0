"""The baseline of the paper: MRGA, goal allocation by repeated planning.

A goal is one requirement of one victim. (1) Victims are clustered by K-means, one cluster per robot.
(2) Robots go to clusters by a linear assignment of how many of a cluster's goals they can do. (3)
Each robot takes the nearest goal that it can do in its cluster. (4) Until no goal is left, the cheapest
pair of a goal g and a capable robot r is allocated, its cost is added to the robot's makespan, and the
robot moves to the goal:

    cost = α (service_g + makespan_r) + (1 − α + β) distance_rg + β aborted_rg / redundancy_g

where redundancy_g is the number of robots that have the goal's kind, and aborted_rg the goal's service
time times the number of r's goals so far with the same redundancy. For a robot that has no goal yet the
cost is the distance alone, as it is in (3).

Source: Carreno et al., *Task allocation strategy for heterogeneous robot teams in offshore missions*
(2020), as the program of Osooli et al. (2023) has it. As published, every distance inside the loop is
a path search, anew each time; with a shared table of distances the same allocation shows how much of
the time is the algorithm and how much the search.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ..mission.errors import InputError
from ..mission.grid import Cell
from ..mission.instance import Instance
from ..mission.plan import Plan
from ..stages.k_means import k_means
from ..stages.situation import Situation, Stop
from .support.baseline import goals, plan_by, queue_of
from .support.planner import CLUSTERING, Planner

ALPHA = 0.25
BETA = 0.20
DISTANCES = ("search", "table")
Distances = Callable[[Cell, Sequence[Cell]], NDArray[np.float64]]


def run(
    instance: Instance,
    *,
    distances: str = "table",
    alpha: float = ALPHA,
    beta: float = BETA,
    seed: int = 0,
) -> Plan:
    """Plan `instance` by MRGA.

    Parameters
    ----------
    distances : {"table", "search"}
        A shared table of distances, or, as published, a path search for every distance in the loop.
    alpha, beta : float
        The weights of the cost, 0 to 1.
    seed : int
        Of scouting and K-means.

    Raises
    ------
    InputError
        If an option is out of range.
    """
    _check({"distances": distances, "alpha": alpha, "beta": beta})
    return plan_by(
        lambda situation: allocate(situation, distances, alpha, beta, seed),
        instance,
        planner=PLANNER,
        seed=seed,
        options={"distances": distances, "alpha": alpha, "beta": beta},
    )


def _check(options: Mapping[str, Any]) -> None:
    """Refuse values that are out of range."""
    distances = options.get("distances", "table")
    if distances not in DISTANCES:
        raise InputError(f"{distances!r}; give one of {', '.join(DISTANCES)}", field="distances")
    for name in ("alpha", "beta"):
        value = options.get(name, 0.0)
        if isinstance(value, bool) or not isinstance(value, Real) or not 0 <= float(value) <= 1:
            raise InputError(f"{value!r}; give a number from 0 to 1", field=name)


def allocate(
    situation: Situation, distances: str, alpha: float, beta: float, seed: int
) -> list[Stop]:
    """Queue every available requirement by MRGA."""
    instance = situation.instance
    todo = goals(situation)
    if not todo:
        return []
    measure = _by_search(situation) if distances == "search" else _by_table(situation)
    cells = [situation.cells[v] for v, _ in todo]
    victim = np.array([v for v, _ in todo])
    kind = np.array([k for _, k in todo])
    service = instance.service[victim, kind]
    redundancy = instance.P.sum(axis=0)[kind]
    able = situation.able[:, victim, kind]
    is_open = np.ones(len(todo), dtype=bool)
    position = list(instance.starts)
    makespan = np.zeros(instance.n_robots)
    taken: list[list[int]] = [[] for _ in instance.robots]

    def give(robot: int, goal: int, cost: float) -> None:
        is_open[goal] = False
        taken[robot].append(goal)
        makespan[robot] += cost
        position[robot] = cells[goal]

    cluster = _clusters(instance, seed)[victim]
    for robot, own in _first_clusters(able, cluster):
        near = np.flatnonzero(is_open & able[robot] & (cluster == own))
        if near.size:
            distance = measure(position[robot], [cells[g] for g in near])
            give(robot, int(near[distance.argmin()]), float(distance.min()))

    # What each robot would take next changes for who has just taken a goal, or wanted that goal.
    cost = np.full(able.shape, np.inf)
    best = np.zeros(instance.n_robots, dtype=np.int64)
    moved = list(range(instance.n_robots))
    while is_open.any():
        for robot in moved:
            which = np.flatnonzero(is_open & able[robot])
            distance = measure(position[robot], [cells[g] for g in which])
            if taken[robot]:
                times = np.bincount(redundancy[taken[robot]], minlength=instance.n_robots + 1)
                aborted = times[redundancy[which]] * service[which]
                distance = (
                    alpha * (service[which] + makespan[robot])
                    + (1 - alpha + beta) * distance
                    + beta * aborted / redundancy[which]
                )
            cost[robot] = np.inf
            cost[robot, which] = distance
        changed = np.union1d(np.flatnonzero(~is_open[best]), moved)
        best[changed] = cost[changed].argmin(axis=1)
        robot = int(cost[np.arange(instance.n_robots), best].argmin())
        goal = int(best[robot])
        give(robot, goal, float(cost[robot, goal]))
        cost[:, goal] = np.inf
        # As published, every distance is a search anew.
        moved = list(range(instance.n_robots)) if distances == "search" else [robot]

    return [
        stop
        for robot, own in enumerate(taken)
        for stop in queue_of(situation, robot, [todo[g] for g in own], "MRGA")
    ]


def _clusters(instance: Instance, seed: int) -> NDArray[np.int64]:
    """The cluster of each victim, shape ``(n_victims,)``."""
    k = min(instance.n_robots, len(set(instance.cells)))
    return k_means(np.array(instance.cells, dtype=float), k, seed)


def _first_clusters(able: NDArray[np.bool_], cluster: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Pairs of a robot and its first cluster, by how many of its goals the robot can do."""
    doable = able.astype(float) @ np.eye(int(cluster.max()) + 1)[cluster]
    robots, clusters = linear_sum_assignment(doable.max() - doable)
    return [(int(r), int(c)) for r, c in zip(robots, clusters, strict=True)]


def _by_table(situation: Situation) -> Distances:
    return lambda start, ends: (
        situation.distances.between([start], ends)[0] if ends else np.empty(0)
    )


def _by_search(situation: Situation) -> Distances:
    walk = situation.instance.map.walk
    return lambda start, ends: np.array([len(walk(start, end)) - 1.0 for end in ends])


PLANNER = Planner(
    "mrga",
    "the paper's baseline (MRGA), goal by goal",
    run,
    check=_check,
    libraries=(*CLUSTERING, "networkx", "scipy.optimize"),
)
