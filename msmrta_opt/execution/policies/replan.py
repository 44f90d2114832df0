"""Plan anew, by any planner or by a formulation, with a price for every visit that is changed.

Candidates are the repaired plan, the planner's, and those on the way from the one to the other; which of
them there are does not depend on the price, ``stability``. So the higher it is, the fewer visits are
changed. By a formulation (``model``), such as ``joint_replan``, the price is part of the program.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from ...mission.errors import InputError, NoPlanError
from ...optimise import registry
from ...optimise.solution import Solution
from ...optimise.solve import solve
from ...planners import check_options, planners
from ...planners import plan as make_plan
from ...planners.support.improvement import routes_of
from ...planners.support.planner import IMPROVING, SOLVING, load
from ...routing.heuristics.ruin_and_recreate import ruin_and_recreate
from ...routing.objectives import DEFAULT, objective_of
from ...routing.parameters import Parameters
from ...routing.problem import Routes, RoutingData, faults
from ...routing.stop import MaximumIterations, MaximumRuntime, StoppingCriterion
from ..replanning import Remaining, towards
from ..state import Decide, Policy, Queues, Situated, State

LARGEST = 1e30
"""Prices and seconds go up to there, as times do in missions."""
ITERATIONS = 20_000
"""Of local search, where no seconds are given; then the same seed gives the same run."""


def begin(situated: Situated) -> Decide:
    """Whenever there is news, all visits that are to come are planned anew."""
    options = situated.options
    left_out: set[tuple[int, int]] = set()

    def replan(state: State) -> Queues | None:
        left_out.update(state.left_out)
        remaining = Remaining.of(state, situated, left_out)
        if remaining is None:
            return None
        kept = remaining.repaired()
        if options["model"]:
            return remaining.queues(_by_model(remaining, options, kept))
        aim, price = objective_of(options["objective"]), float(options["stability"])
        found = candidates(remaining, options, situated.seed)
        _, _, best = min(
            (remaining.worth(aim, routes) + price * changes, changes, i)
            for i, routes in enumerate(found)
            for changes in [remaining.changes(routes)]
        )
        return remaining.queues(found[best])

    return replan


def candidates(remaining: Remaining, options: Mapping[str, Any], seed: int) -> list[Routes]:
    """Ways to go on, whatever a change is worth; the repaired plan is the first of them."""
    kept = remaining.repaired()
    found = [kept]
    data, aim = remaining.data, objective_of(options["objective"])
    chosen = planners()[options["planner"]]
    given: dict[str, Any] = {"seed": seed} if "seed" in chosen.options else {}
    if chosen.heeds_objective:
        given["objective"] = aim.name
    seconds, began = options["seconds"], time.perf_counter()
    if "time_limit" in chosen.options:
        given["time_limit"] = 1.0 if seconds is None else seconds
    try:
        planned = routes_of(make_plan(remaining.mission, planner=chosen.name, **given))
    except NoPlanError:
        return found
    if not faults(data, planned):
        found.append(planned)
    stop: StoppingCriterion = MaximumIterations(ITERATIONS)
    if seconds is not None:
        stop = MaximumRuntime(max(seconds - (time.perf_counter() - began), 0.0))
    if not chosen.improves_itself or len(found) == 1:  # or its plan goes beyond robots' limits
        found += [
            ruin_and_recreate(
                data,
                routes,
                aim,
                stop=stop,
                seed=seed,
                parameters=Parameters().heuristics,
            )
            for routes in found[-1:]
        ]
    old: dict[int, int] = {}
    for r, route in enumerate(remaining.kept_of(data.able)):
        for v, _ in route:
            old[v] = -1 if v in old else r
    old = {v: r for v, r in old.items() if r >= 0}
    steps = (step for routes in found[1:] for step in towards(data, routes, old))
    return [*found, *(step for step in steps if not faults(data, step))]


def _by_model(remaining: Remaining, options: Mapping[str, Any], kept: Routes) -> Routes:
    """The routes of a formulation's solution; the repaired plan where none is found in time."""
    data = remaining.data
    parameters = registry.get(options["model"]).spec.parameters
    given = {"stability": options["stability"]} if "stability" in parameters else {}
    solution = solve(options["model"], data, time_limit=options["seconds"], **given)
    return routes_of_solution(data, solution) if solution.found else kept


def routes_of_solution(data: RoutingData, solution: Solution) -> Routes:
    """The routes of a solution of a formulation of stage ``routing``."""
    routes = []
    goes, serves = solution.values["x"] > 0.5, solution.values["a"] > 0.5
    for r in range(data.n_robots):
        route, place = [], data.n_victims
        while goes[r, place].any():
            place = int(goes[r, place].argmax())
            route.append((place, tuple(int(k) for k in serves[r, place].nonzero()[0])))
        routes.append(tuple(route))
    return tuple(routes)


def _check(options: Mapping[str, Any]) -> None:
    check_options(options["planner"], {})
    objective_of(options["objective"])
    of_model = registry.get(options["model"]).spec.parameters if options["model"] else {}
    for name in ("stability", "seconds"):
        value = options[name]
        if name == "seconds" and value is None:
            continue
        top = LARGEST
        if name == "stability" and "stability" in of_model:
            top = of_model["stability"].high
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= top:
            raise InputError(f"{value!r}; give a number from 0 to {top:g}", field=name)
    if options["model"]:
        stage = registry.get(options["model"]).spec.stage
        if stage != "routing":
            raise InputError(f"is of stage {stage}; give one of stage routing", field="model")


def _load(options: Mapping[str, Any]) -> None:
    planners()[options["planner"]].load({})
    load(IMPROVING)
    if options["model"]:
        load((*SOLVING, "msmrta_opt.isolation"))


POLICY = Policy(
    "replan",
    "all visits to come planned anew, each changed visit at a price",
    begin,
    defaults={
        "planner": "ssi",
        "objective": DEFAULT,
        "stability": 0.0,
        "seconds": None,
        "model": "",
    },
    check=_check,
    load=_load,
)
