"""The data of any stage's formulations for an instance: Algorithm 1, as far as that stage."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import NDArray

from ..mission.errors import InputError
from ..mission.instance import Instance, require_mission
from ..mission.suggestions import meant
from ..optimise.axes import StageData
from ..optimise.data import ClusterData, ClusteringData, JointAssignmentData, VictimData
from ..routing.problem import RoutingData
from .cluster_assignment import ClusterAssignment, cluster_assignment, cluster_data
from .clustering import Clustering, clustering, clustering_data
from .joint_assignment import joint_assignment_data
from .joint_routing import limits_of, routing_data
from .options import StagedOptions
from .performance_analysis import performance_analysis
from .requirement_analysis import RequirementAnalysis, requirement_analysis
from .scouting import scout_mission
from .situation import Situation, without


@overload
def stage_data(
    instance: Instance, stage: Literal["clustering"], options: StagedOptions | None = None
) -> ClusteringData: ...
@overload
def stage_data(
    instance: Instance, stage: Literal["cluster"], options: StagedOptions | None = None
) -> ClusterData: ...
@overload
def stage_data(
    instance: Instance, stage: Literal["victim"], options: StagedOptions | None = None
) -> VictimData: ...
@overload
def stage_data(
    instance: Instance, stage: Literal["joint"], options: StagedOptions | None = None
) -> JointAssignmentData: ...
@overload
def stage_data(
    instance: Instance, stage: Literal["routing"], options: StagedOptions | None = None
) -> RoutingData: ...
@overload
def stage_data(instance: Instance, stage: str, options: StagedOptions | None = None) -> Any: ...
def stage_data(instance: Instance, stage: str, options: StagedOptions | None = None) -> Any:
    """What a formulation of `stage` takes, worked out as the staged planner does.

    Parameters
    ----------
    instance : Instance
        The mission; if it has scouts, only the victims that they find are known.
    stage : str
        One of `STAGES`.
    options : StagedOptions, optional
        Of the stages before, and of the data itself; the defaults are the planner's.

    Returns
    -------
    ClusteringData, ClusterData, VictimData, JointAssignmentData or RoutingData
        As the formulations of `stage` expect.

    Raises
    ------
    InputError
        If there is no such stage, or the mission has no known victims, so nothing to decide.
    CheckError
        If a stage before has no solution that passes its check.
    """
    if stage not in STAGES:
        raise InputError(
            f"no stage {stage!r}{meant(stage, STAGES)}; there are {', '.join(STAGES)}",
            field="stage",
        )
    so_far = SoFar(require_mission(instance), options or StagedOptions())
    if not so_far.situation.instance.n_victims:
        raise InputError(
            f"instance {instance.name!r} has no known victims; give at least one", field="victims"
        )
    return STAGES[stage].build(so_far)


class SoFar:
    """Algorithm 1 on an instance, each line worked out when first asked for."""

    def __init__(self, instance: Instance, options: StagedOptions) -> None:
        self.instance = instance
        self.options = options

    @cached_property
    def situation(self) -> Situation:
        """The victims that are known after scouting."""
        known, _ = scout_mission(self.instance, self.options)
        return Situation.of(known)

    @cached_property
    def analysis(self) -> RequirementAnalysis:
        """Who can satisfy whom."""
        known = self.situation.instance
        return requirement_analysis(known.P, known.Q)

    @cached_property
    def clusters(self) -> Clustering:
        """The victims in groups."""
        return clustering(self.situation, self.options)

    @cached_property
    def b2(self) -> ClusterAssignment:
        """The solution of Eq. 1."""
        return cluster_assignment(self.situation, self.analysis, self.clusters, self.options)

    @cached_property
    def remaining(self) -> NDArray[np.bool_]:
        """Available requirements that B2 leaves open, shape ``(n_victims, n_kinds)``."""
        return without(self.situation.available, self.b2.stops)


@dataclass(frozen=True)
class Stage:
    """A decision that formulations are written for.

    Parameters
    ----------
    data : type of StageData
        What they take: it declares the stage's name, its axes, and the variables that it reads.
    build : callable
        How that follows from the lines of Algorithm 1 before it.
    """

    data: type[StageData]
    build: Callable[[SoFar], StageData]


STAGES: Mapping[str, Stage] = MappingProxyType(
    {
        stage.data.stage: stage
        for stage in (
            Stage(ClusteringData, lambda m: clustering_data(m.situation)),
            Stage(
                ClusterData,
                lambda m: cluster_data(m.situation, m.analysis, m.clusters, m.options),
            ),
            Stage(
                VictimData,
                lambda m: performance_analysis(m.situation, m.b2.stops, m.remaining, m.options),
            ),
            Stage(
                JointAssignmentData,
                lambda m: joint_assignment_data(m.situation, m.analysis, m.clusters, m.options),
            ),
            Stage(RoutingData, lambda m: routing_data(m.situation, **limits_of(m.options))),
        )
    }
)
"""The stages by name. A new one is a data class, a line here, and a formulation."""
