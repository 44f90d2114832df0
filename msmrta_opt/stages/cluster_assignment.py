"""Cluster assignment (Algorithm 1, ClstrAsgn; Eq. 1): which robot takes which cluster, stage B2.

A robot goes to the centre of its cluster and serves from there the members that it can serve, by
Manhattan distance from the centre. A member behind a wall is deferred to the next stages: one whose
walking distance from the centre exceeds its Manhattan distance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats, Ints
from ..mission.grid import manhattan
from ..optimise import registry
from ..optimise.data import ClusterData
from ..optimise.solution import Solution
from ..optimise.solve import solve
from .clustering import Clustering
from .options import StagedOptions
from .requirement_analysis import RequirementAnalysis
from .situation import Situation, Stop, each_once, nearest_first

STAGE = "B2"


@dataclass(frozen=True, eq=False)
class ClusterAssignment:
    """Stage B2.

    Parameters
    ----------
    chosen : bool array, shape (n_robots, n_clusters)
        Whether r takes c.
    stops : list of Stop
        Each robot's way to its centres and the members it serves.
    deferred : frozenset of int
        Positions of victims behind a wall as seen from their cluster's centre.
    solution : Solution or None
        Of Eq. 1; ``None`` if there are no clusters.
    """

    chosen: NDArray[np.bool_]
    stops: list[Stop]
    deferred: frozenset[int]
    solution: Solution | None


def cluster_data(
    situation: Situation,
    analysis: RequirementAnalysis,
    clusters: Clustering,
    options: StagedOptions,
) -> ClusterData:
    """The weights of Eq. 1.

    Parameters
    ----------
    situation, analysis, clusters
        From the stages before.
    options : StagedOptions
        How to read them (``weights``), the ``budget``, and the robots to keep ``apart``.

    Raises
    ------
    InputError
        If ``apart`` names a robot that there is none of.
    """
    instance = situation.instance
    met = np.where(situation.reach, instance.P.astype(int) @ instance.Q.T.astype(int), 0)
    counted = met if options.weights == "text" else np.where(analysis.partial, met, 0)
    w, full = (_by_cluster(n, clusters) for n in (counted, np.where(analysis.full, met, 0)))
    robots = [robot.id for robot in instance.robots]
    budget = np.full(len(robots), options.budget, dtype=np.int64)
    apart = options.named_robots(robots)
    around = situation.around(centres=clusters.cells, labels=clusters.labels, apart=apart)
    return ClusterData(w, full, budget, ids={"r": robots}, around=around)


def _by_cluster(count: Ints, clusters: Clustering) -> Floats:
    """The sums over the members of each cluster, ``(n_robots, n_clusters)``."""
    order = np.argsort(clusters.labels, kind="stable")
    begins = np.searchsorted(clusters.labels[order], np.arange(clusters.n_clusters))
    return np.add.reduceat(count[:, order], begins, axis=1).astype(float)


def cluster_assignment(
    situation: Situation,
    analysis: RequirementAnalysis,
    clusters: Clustering,
    options: StagedOptions,
) -> ClusterAssignment:
    """Solve Eq. 1, and queue what each robot serves in its clusters.

    Parameters
    ----------
    situation, analysis, clusters
        From the stages before.
    options : StagedOptions
        ``cluster_model`` and its parameters, ``solver``, ``weights``, ``members``,
        ``through_centre``, ``budget``.

    Raises
    ------
    CheckError
        If there is no solution that passes its check.
    """
    deferred = behind_walls(situation, clusters)
    data = cluster_data(situation, analysis, clusters, options)
    chosen = np.zeros(data.w.shape, dtype=bool)
    if not clusters.n_clusters:
        return ClusterAssignment(chosen, [], deferred, None)
    model = registry.for_plans(options.cluster_model, "cluster")
    solution = solve(model, data, solver=options.solver, **options.values_for(model)).require()
    chosen = solution.values["x"] > 0.5
    stops: list[Stop] = []
    for r, start in enumerate(situation.instance.starts):
        # A robot cannot enter a cluster whose centre it cannot reach, and does not go to one around
        # which it can serve nobody.
        own = situation.instance.map.component[start]
        served = {
            int(c): served_members(situation, analysis, clusters, r, int(c), deferred, options)
            for c in np.flatnonzero(chosen[r])
            if situation.instance.map.component[clusters.cells[c]] == own
        }
        taken = [c for c, visits in served.items() if visits]
        order = nearest_first(situation.distances, start, [clusters.cells[c] for c in taken])
        for c in (taken[i] for i in order):
            if options.through_centre:
                stops.append(Stop(r, clusters.cells[c], STAGE))
            stops.extend(served[c])
    return ClusterAssignment(chosen, each_once(stops), deferred, solution)


def behind_walls(situation: Situation, clusters: Clustering) -> frozenset[int]:
    """The victims whose walk from their cluster's centre is longer than without walls."""
    order = np.argsort(clusters.labels, kind="stable")
    cells = np.array(situation.cells, dtype=np.int64).reshape(-1, 2)[order]
    centres = np.array(clusters.cells, dtype=np.int64).reshape(-1, 2)[clusters.labels[order]]
    walked = situation.instance.map.lengths(centres, cells)
    return frozenset(order[walked > np.abs(cells - centres).sum(axis=1)].tolist())


def served_members(
    situation: Situation,
    analysis: RequirementAnalysis,
    clusters: Clustering,
    robot: int,
    cluster: int,
    deferred: frozenset[int],
    options: StagedOptions,
) -> list[Stop]:
    """What `robot` serves in `cluster`, by Manhattan distance from the centre, then by victim."""
    centre, cells = clusters.cells[cluster], situation.cells
    able, served = situation.able[robot], {}
    for v in clusters.members(cluster):
        does = kinds(able[v])
        if does and v not in deferred and (options.members == "all" or analysis.partial[robot, v]):
            served[v] = does
    order = sorted(served, key=lambda v: (manhattan(centre, cells[v]), v))
    return [Stop(robot, cells[v], STAGE, v, served[v]) for v in order]


def kinds(row: NDArray[np.bool_]) -> tuple[int, ...]:
    """Positions of the kinds that are set in a row of shape ``(n_kinds,)``."""
    return tuple(row.nonzero()[0].tolist())
