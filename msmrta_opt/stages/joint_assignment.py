"""The data of Eqs. 1 and 2 as one program, which shows what deciding one after the other loses.

No line of Algorithm 1: it takes cluster assignment, performance analysis and victim assignment
together. What a robot does at its post is what stage B2 has it do there; when it would then be at a
victim depends on its own post, and what is left to do there on the robot that holds the victim's
cluster. A pair's times are the sum of the two, so each is worked out once per robot and post.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..mission.errors import InputError
from ..optimise.data import JointAssignmentData
from .cluster_assignment import STAGE, behind_walls, cluster_data, served_members
from .clustering import Clustering
from .options import StagedOptions
from .performance_analysis import lost_so_far
from .requirement_analysis import RequirementAnalysis
from .situation import Situation, Stop


def joint_assignment_data(
    situation: Situation,
    analysis: RequirementAnalysis,
    clusters: Clustering,
    options: StagedOptions,
) -> JointAssignmentData:
    """The data of Eqs. 1 and 2 for all posts at once.

    Parameters
    ----------
    situation, analysis, clusters
        From the stages before.
    options : StagedOptions
        ``weights``, ``members`` and ``through_centre``, as for the stages.

    Raises
    ------
    InputError
        If ``performance`` is ``robot``: times per robot alone leave nothing to choose together.
    """
    if options.performance != "pair":
        raise InputError(f"{options.performance!r}; give 'pair'", field="performance")
    instance = situation.instance
    eq_1 = cluster_data(situation, analysis, clusters, options)
    n_capabilities = np.maximum(instance.P.sum(axis=1), 1)

    # Queues are independent, so that with every robot at the same post one pass gives all times.
    posts = [*_posts(situation, analysis, clusters, options), []]
    after = [situation.after(stops) for stops in posts]
    busy = np.stack([busy for _, busy in after], axis=1)
    travel = [situation.distances.between(ends, instance.cells) for ends, _ in after]
    arrival = busy[:, :, None] + np.stack(travel, axis=1) / instance.speed[:, None, None]
    record = np.stack([lost_so_far(situation, stops) for stops in posts], axis=1)

    leaves = np.repeat(situation.available[None], instance.n_robots + 1, axis=0)
    for stop in (stop for stops in posts for stop in stops if stop.victim is not None):
        leaves[stop.robot, stop.victim, list(stop.kinds)] = False
    does = situation.able[:, None] & leaves[None]
    lost = ~instance.P[:, None, None, :] & leaves[None]
    can_serve = np.any(does, axis=3)
    service = (does * instance.service).sum(axis=3)
    redo = (lost * instance.service).sum(axis=3) / n_capabilities[:, None, None]
    return JointAssignmentData(
        w=eq_1.w,
        w_full=eq_1.w_full,
        cluster=clusters.labels,
        arrival=np.where(np.isfinite(arrival), arrival, 0.0),
        record=record / n_capabilities[:, None],
        service=np.where(can_serve, service, 0.0),
        redo=np.where(can_serve, redo, 0.0),
        can_serve=can_serve,
        ids={"r": eq_1.ids["r"], "v": [victim.id for victim in instance.victims]},
        around=eq_1.around,
    )


def _posts(
    situation: Situation,
    analysis: RequirementAnalysis,
    clusters: Clustering,
    options: StagedOptions,
) -> Iterator[list[Stop]]:
    """For each cluster, what stage B2 would have every robot do, were it its post."""
    deferred = behind_walls(situation, clusters)
    for c, centre in enumerate(clusters.cells):
        stops: list[Stop] = []
        for r, start in enumerate(situation.instance.starts):
            component = situation.instance.map.component
            if component[start] != component[centre]:
                continue
            served = served_members(situation, analysis, clusters, r, c, deferred, options)
            if served and options.through_centre:
                stops.append(Stop(r, centre, STAGE))
            stops.extend(served)
        yield stops
