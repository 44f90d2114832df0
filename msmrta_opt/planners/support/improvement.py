"""Improvement for everyone: local search on the routes of any plan, whoever made it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...interruption import interrupted, interruptible
from ...mission.errors import InputError
from ...mission.grid import AT_ONCE
from ...mission.plan import Plan
from ...routing.heuristics.ruin_and_recreate import ruin_and_recreate
from ...routing.objectives import DEFAULT, objective_of
from ...routing.parameters import Parameters
from ...routing.problem import Routes
from ...routing.scaling import in_convenient_units
from ...routing.stop import (
    AnyOf,
    Interruption,
    MaximumIterations,
    MaximumRuntime,
    StoppingCriterion,
)
from ...stages.joint_routing import routing_data
from ...stages.path_planning import path_planning
from ...stages.situation import Situation, Stop
from .planner import IMPROVING, Stopwatch, load

STAGE = "improved"


def improve_plan(
    plan: Plan,
    *,
    objective: str = DEFAULT,
    seconds: float | None = None,
    iterations: int | None = None,
    seed: int = 0,
    parameters: Parameters | Mapping[str, Any] | None = None,
) -> Plan:
    """A plan that serves the same, and is no worse by `objective`; Ctrl-C ends the search early.

    Parameters
    ----------
    plan : Plan
        Any planner's.
    objective : str
        What to improve; one of `routing.objectives.OBJECTIVES`.
    seconds : float, optional
        Wall time to spend; the result then depends on the machine's speed.
    iterations : int, optional
        Iterations to make; by default a fixed number, so that the result can be repeated.
    seed : int
        Of all random choices.
    parameters : Parameters or mapping, optional
        How to search; see `routing.parameters`.

    Raises
    ------
    InputError
        If there is no such objective, or the plan keeps to limits, which the search does not know.
    """
    aim, tuned = objective_of(objective), Parameters.of(parameters)
    if plan.limits:
        raise InputError(
            f"the plan keeps to {', '.join(plan.limits)}; ask the exact planner for a better one",
            field="improve",
        )
    if not any(route.visits for route in plan.routes):
        return plan
    load(IMPROVING)
    watch = Stopwatch()
    known, routes = plan.known, routes_of(plan)
    with interruptible(), watch("improvement"):
        situation = Situation.of(known)
        cells = situation.cells
        for first in range(0, len(cells), AT_ONCE):
            if interrupted():
                return plan
            situation.distances.between(cells[first : first + AT_ONCE], cells)
        data = in_convenient_units(routing_data(situation), aim, routes)
        limits: list[StoppingCriterion] = []
        if seconds is not None:
            limits.append(MaximumRuntime(seconds))
        if iterations is not None:
            limits.append(MaximumIterations(iterations))
        if not limits:
            limits.append(MaximumIterations(tuned.heuristics.default_iterations))
        found = ruin_and_recreate(
            data,
            routes,
            aim,
            stop=AnyOf(*limits, Interruption(interrupted)),
            seed=seed,
            parameters=tuned.heuristics,
        )
        walks = path_planning(known, stops_of(situation, found, STAGE))
    spent = seconds if seconds is not None else iterations
    options = {**plan.options, "improve": True if spent is None else spent, "objective": aim.name}
    if changed := tuned.changed():
        options["parameters"] = changed
    changes: dict[str, Any] = {
        "routes": walks,
        "options": options,
        "planning_seconds": {**plan.planning_seconds, **watch.seconds},
        "search": None,  # that of the old plan
    }
    # Validated anew, since figures that the old plan has worked out must not stay with it.
    fields = {name: getattr(plan, name) for name in Plan.model_fields}
    better = Plan.model_validate({**fields, **changes})
    return better if aim.of_plan(better.metrics) <= aim.of_plan(plan.metrics) else plan


def routes_of(plan: Plan) -> Routes:
    """Who serves what in which order in `plan`, by positions among its known victims.

    A robot's later visits to a victim are joined to its first.
    """
    known = plan.known
    position = {victim.id: v for v, victim in enumerate(known.victims)}
    kind = {name: k for k, name in enumerate(known.capabilities)}
    planned = {route.robot: route.visits for route in plan.routes}
    routes = []
    for robot in known.robots:
        visits: dict[int, list[int]] = {}
        for visit in planned.get(robot.id, ()):
            visits.setdefault(position[visit.victim], []).extend(
                kind[name] for name in visit.served
            )
        routes.append(tuple((v, tuple(sorted(kinds))) for v, kinds in visits.items() if kinds))
    return tuple(routes)


def stops_of(situation: Situation, routes: Routes, stage: str) -> Sequence[Stop]:
    """The queues of `routes`."""
    cells = situation.instance.cells
    return [
        Stop(r, cells[v], stage, v, kinds) for r, route in enumerate(routes) for v, kinds in route
    ]
