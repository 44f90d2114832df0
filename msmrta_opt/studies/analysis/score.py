"""Formulations of one stage, which have different objectives, on common metrics.

Each formulation takes its place in the staged planner; the plan that comes of it is measured, and so
are both of the paper's equations at what was chosen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from ...isolation import Failure, Limits, run_isolated
from ...mission.errors import MsmrtaError
from ...mission.instance import Instance
from ...mission.metrics import METRICS, Metrics
from ...mission.plan import Plan
from ...mission.suggestions import none_of
from ...optimise import registry
from ...planners import plan as make_plan
from ...stages.cluster_assignment import cluster_data
from ...stages.clustering import clustering
from ...stages.data import stage_data
from ...stages.options import StagedOptions
from ...stages.requirement_analysis import requirement_analysis
from ...stages.situation import Situation
from .choices import Choices, choices

STAGES = {"clustering": "clustering_model", "cluster": "cluster_model", "victim": "victim_model"}
"""Stages of the staged planner, and the option that names their formulation."""
OPTIONS = frozenset(item.name for item in fields(StagedOptions)) - {"params"}


@dataclass(frozen=True)
class Score:
    """A formulation in the staged planner, on one instance.

    ``eq1`` and ``eq2`` are the paper's objectives at what was chosen, by the options' ψ and β;
    ``metrics`` are those of the plan. ``message`` says why there are none. ``gets`` is who gets what.
    """

    instance: str
    model: str
    eq1: float | None = None
    eq2: float | None = None
    served_in_b2: int | None = None
    served_in_b3: int | None = None
    served_in_b4: int | None = None
    metrics: Metrics | None = None
    message: str = ""
    gets: Choices = field(default_factory=dict)

    def __getattr__(self, name: str) -> Any:
        """A metric of the plan by its name, ``None`` without a plan."""
        if name not in METRICS:
            raise AttributeError(name)
        return self.metrics and getattr(self.metrics, name)

    def as_dict(self) -> dict[str, Any]:
        """All figures by name, those of the plan among them."""
        own = {item.name: getattr(self, item.name) for item in fields(self)}
        del own["metrics"], own["gets"]
        return {**own, **{name: getattr(self, name) for name in METRICS}}


def score(
    instance: Instance,
    stage: str,
    model: str,
    options: StagedOptions | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Score:
    """Plan `instance` with `model` in its stage, and measure the plan.

    Parameters
    ----------
    instance : Instance
        The mission.
    stage : str
        One of `STAGES`.
    model : str
        A formulation of that stage.
    options : StagedOptions, optional
        All else; the defaults are the planner's.
    parameters : mapping of str to float, optional
        Of the formulation; those that it does not have are left out.

    Raises
    ------
    InputError
        If the staged planner has no such stage.
    """
    if stage not in STAGES:
        raise none_of(stage, STAGES, "stage")
    given = {**(options or StagedOptions()).as_dict(), STAGES[stage]: model, **(parameters or {})}
    try:
        takes = registry.get(model, stage=stage).spec.parameters
        own = {name: value for name, value in given.items() if name in OPTIONS or name in takes}
        options = StagedOptions.of(**own)
        plan = make_plan(instance, **options.as_dict())
    except MsmrtaError as error:
        return Score(instance.name, model, message=str(error))
    served = {
        stage_name: sum(
            len(visit.served)
            for route in plan.routes
            for visit in route.visits
            if visit.stage == stage_name
        )
        for stage_name in ("B2", "B3", "B4")
    }
    return Score(
        instance.name,
        model,
        eq1=_eq1(plan, options),
        eq2=_eq2(plan, options),
        served_in_b2=served["B2"],
        served_in_b3=served["B3"],
        served_in_b4=served["B4"],
        metrics=plan.metrics,
        gets=choices(plan, stage),
    )


def scores(
    instances: Sequence[Instance],
    *,
    stage: str,
    models: Sequence[str],
    options: StagedOptions,
    parameters: Mapping[str, float] | None = None,
    time_limit: float | None = None,
    memory_limit: float | None = None,
) -> Iterator[Score]:
    """`score` of every formulation on every instance, each in a process of its own.

    Programs of their own, which read nothing of the mission, give no plan to measure.
    """
    if stage not in STAGES:
        return
    models = [model for model in models if _may_serve(model)]
    folders = tuple(str(folder) for folder in registry.folders())
    given = dict(parameters or {})
    calls = [(i, stage, model, options, given, folders) for i in instances for model in models]
    results = run_isolated(
        _score_isolated,
        calls,
        limits=Limits(time_limit, memory_limit),
        preload=("msmrta_opt.studies.analysis.score",),
    )
    with closing(results):
        for index, result in results:  # one at a time, so they come in order
            if isinstance(result, Failure):
                result = Score(calls[index][0].name, calls[index][2], message=result.message)
            yield result


def _may_serve(model: str) -> bool:
    try:
        return registry.get(model).reads_data
    except MsmrtaError:  # which its score will say
        return True


def _score_isolated(
    instance: Instance,
    stage: str,
    model: str,
    options: StagedOptions,
    parameters: dict[str, float],
    folders: tuple[str, ...],
) -> Score:
    for folder in folders:
        registry.add_models(folder)
    return score(instance, stage, model, options, parameters)


def _eq1(plan: Plan, options: StagedOptions) -> float:
    """Σ [(1 − ψ) w + ψ w^f] x of Eq. 1, where x is who took which cluster."""
    known = plan.known
    if not known.n_victims:
        return 0.0
    situation = Situation.of(known)
    analysis = requirement_analysis(known.P, known.Q)
    data = cluster_data(situation, analysis, clustering(situation, options), options)
    x = np.array(
        [[robot.id in record.robots for record in plan.clusters] for robot in known.robots]
    )
    return float((((1 - options.psi) * data.w + options.psi * data.w_full) * x).sum())


def _eq2(plan: Plan, options: StagedOptions) -> float:
    """Σ [(1 − β) S + β F] x of Eq. 2, where x is who was assigned which victim in stage B3."""
    data = stage_data(plan.instance, "victim", options)
    known = [victim.id for victim in plan.known.victims]
    x = np.zeros(data.can_serve.shape)
    for r, robot in enumerate(plan.instance.robots):
        for visit in plan.route(robot.id).visits:
            if visit.stage == "B3":
                x[r, known.index(visit.victim)] = 1.0
    return float((((1 - options.beta) * data.success + options.beta * data.failure) * x).sum())
