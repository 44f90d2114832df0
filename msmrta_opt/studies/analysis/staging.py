"""The price of deciding in stages: planners beside a proven bound, each stage's share of the loss.

The staged plan is taken apart from its end: first only the order of its visits is free, then also what
the auction decided, then what Eq. 2 decided, then all. Each step is solved exactly with the
earlier decisions fixed, so each stage's loss is the difference of two values, each with its bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...interruption import interrupted
from ...mission.instance import Instance
from ...mission.metrics import Metrics
from ...mission.plan import Plan
from ...planners import plan as make_plan
from ...planners.support.improvement import routes_of
from ...routing.heuristics.ruin_and_recreate import ruin_and_recreate
from ...routing.incumbent import Progress
from ...routing.methods import close_in
from ...routing.objectives import DEFAULT, objective_of
from ...routing.problem import RoutingData
from ...routing.stop import Interruption, MaximumRuntime, relative_gap
from ...stages.joint_routing import routing_data
from ...stages.situation import Situation

STEPS: tuple[tuple[str, frozenset[str]], ...] = (
    ("order of visits", frozenset({"B2", "B3", "B4"})),
    ("auction (B4)", frozenset({"B2", "B3"})),
    ("victim assignment (B3)", frozenset({"B2"})),
    ("cluster assignment (B2)", frozenset()),
)
"""What each step frees, and the stages whose assignments it still keeps."""


@dataclass(frozen=True)
class Loss:
    """What one stage costs: ``before - after``, where `after` has that stage's decisions free too.

    `bound` is proven for `after`; all in time units.
    """

    stage: str
    before: float
    after: float
    bound: float

    @property
    def loss(self) -> float:
        """What deciding this stage before the next ones, and without them, costs."""
        return self.before - self.after


@dataclass(frozen=True)
class Candidate:
    """One plan for a mission, with what is proven about its objective."""

    name: str
    metrics: Metrics
    value: float
    bound: float

    @property
    def gap(self) -> float:
        """Share of the value that the bound leaves open."""
        return relative_gap(self.value, self.bound)


def price_of_staging(
    plan: Plan, objective: str = DEFAULT, *, seconds: float = 10.0, seed: int = 0
) -> list[Loss]:
    """How much of a staged plan's loss is due to which stage.

    Parameters
    ----------
    plan : Plan
        Of the staged planner, whose visits are named by their stages.
    objective : str
        What is measured; one of `routing.objectives.OBJECTIVES`.
    seconds : float
        For each of the four steps.
    seed : int
        Of the search.

    Returns
    -------
    list of Loss
        Of each step; of those alone that were begun, where `interruption` ends it.
    """
    situation = Situation.of(plan.known)
    data = routing_data(situation)
    routes = routes_of(plan)
    before = objective_of(objective).of_plan(plan.metrics)
    losses = []
    ctrl_c = Interruption(interrupted)
    for stage, kept in STEPS:
        if interrupted():
            break
        restricted = replace(data, able=_able_with(plan, data, kept))
        search = MaximumRuntime(0.1 * seconds) | ctrl_c
        begin = ruin_and_recreate(restricted, routes, objective, stop=search, seed=seed)
        progress = Progress(restricted, objective, begin, stop=MaximumRuntime(seconds) | ctrl_c)
        bound = close_in(progress, seed=seed)
        routes, after = progress.routes, progress.value
        losses.append(Loss(stage, before, after, bound.value))
        before = after
    return losses


def _able_with(plan: Plan, data: RoutingData, kept: frozenset[str]) -> np.ndarray:
    """Who may serve what, ``(n_robots, n_victims, n_kinds)``, if the stages `kept` stay as they are."""
    known = plan.known
    victim = {record.id: v for v, record in enumerate(known.victims)}
    able = data.able.copy()
    for r, robot in enumerate(known.robots):
        for visit in plan.route(robot.id).visits:
            if visit.stage in kept:
                for kind in visit.served:
                    v, k = victim[visit.victim], known.capabilities.index(kind)
                    able[:, v, k] = False
                    able[r, v, k] = True
    return able


def candidates(
    mission: Instance,
    objective: str = DEFAULT,
    *,
    planners: Sequence[str] = ("msmrta", "mrga", "ssi", "greedy"),
    seconds: float = 30.0,
    seed: int = 0,
    staged: Mapping[str, Any] | None = None,
) -> list[Candidate]:
    """Every planner's plan, the same improved by local search, and the exact planner's.

    The search makes a fixed number of iterations: the same seed gives the same plans on any machine.

    Parameters
    ----------
    planners : sequence of str
        Which; the staged one is planned by both of its presets.
    seconds : float
        For the exact planner.
    staged : mapping of str to value, optional
        Further options of the staged planner.

    Returns
    -------
    list of Candidate
        The exact planner's last; without those that `interruption` left no time for.
    """
    exact = make_plan(mission, planner="exact", objective=objective, time_limit=seconds, seed=seed)
    bound = exact.certificates[0].bound or 0.0
    plans: dict[str, Plan] = {}
    improved: dict[str, Any] = {"improve": True, "objective": objective}
    for name in planners:
        for preset in ("paper", "authors") if name == "msmrta" else (None,):
            title = name if preset is None else f"{name}, {preset}"
            options: dict[str, Any] = {"seed": seed} | (
                {} if preset is None else {"preset": preset, **(staged or {})}
            )
            for words, more in (("", {}), (", improved", improved)):
                if not interrupted():
                    plans[title + words] = make_plan(mission, planner=name, **options, **more)
    plans["exact"] = exact
    return [
        Candidate(name, plan.metrics, objective_of(objective).of_plan(plan.metrics), bound)
        for name, plan in plans.items()
    ]
