"""The exact planner: the joint problem, improved from above and bounded from below, at any time.

It starts from the best plan of the quick planners, improved by local search; total time and makespan
are then closed in on by branch and cut (`routing.branch_and_cut.search`), latency by column generation
(`routing.branch_and_price.search`). It stops at the time limit, at the gap, or at Ctrl-C, always with
the best plan and what is proven about it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from functools import partial

import numpy as np

from ..certify.bound import STAGE as STAGE_OF_BOUNDS
from ..interruption import interrupted, interruptible
from ..mission.errors import InputError
from ..mission.instance import Instance
from ..mission.plan import Certificate, Plan, Route, Unserved
from ..optimise.solve import solve
from ..routing.bound import Bound
from ..routing.bound import gap as relative_gap
from ..routing.branch_and_cut.root_proof import root_proof
from ..routing.branch_and_cut.search import strong_bound
from ..routing.branch_and_price.queue_bound import latency_bound
from ..routing.branch_and_price.root_proof import latency_proof
from ..routing.branch_and_price.search import search_latency
from ..routing.heuristics.ruin_and_recreate import improve
from ..routing.incumbent import Report
from ..routing.problem import Objective, Routes, RoutingData, faults, value
from ..stages.joint_routing import beyond_limits, routing_data
from ..stages.options import StagedOptions
from ..stages.path_planning import path_planning
from ..stages.requirement_analysis import missing_capabilities, requirement_analysis
from ..stages.scouting import scout_mission
from ..stages.situation import Situation, Stop
from . import greedy, ssi
from .support.improvement import check_objective, stops_of
from .support.planner import Planner, Stopwatch
from .support.record import assemble

STAGE = "exact"
SHARE_OF_SEARCH = 0.1
"""Of the time limit, for local search before the bound is sought."""
SEARCH_PER_VICTIM = 0.05
"""Most seconds per victim of that search."""
LEAST_SECONDS = 5.0
"""For a plan to begin with, where limits make that hard: without one there is nothing to answer."""


def run(
    instance: Instance,
    *,
    objective: Objective = "total_time",
    time_limit: float = 60.0,
    gap: float = 0.0,
    seed: int = 0,
    endurance: float | None = None,
    longest_walk: float | None = None,
    return_to_start: bool = False,
    report: Report | None = None,
) -> Plan:
    """Plan `instance` as well as the time allows, with a proven bound.

    Parameters
    ----------
    objective : {"total_time", "makespan", "latency"}
        What to minimise.
    time_limit : float
        Seconds.
    gap : float
        Relative gap to stop at.
    seed : int
        Of scouting and of the search.
    endurance : float, optional
        Most time units that a robot may be busy.
    longest_walk : float, optional
        Most cells that a robot may walk.
    return_to_start : bool
        Whether robots walk back after their last visit.
    report : callable, optional
        Called with routes, value, bound and what happened, whenever one of them got better.

    Raises
    ------
    InputError
        If an option is wrong, or no plan that keeps to the robots' limits exists or is found.
    """
    check_objective(objective)
    for name, number in {"time_limit": time_limit, "gap": gap}.items():
        if not number >= 0:
            raise InputError(f"{number!r}; give 0 or more", field=name)
    for name, most in {"endurance": endurance, "longest_walk": longest_walk}.items():
        if most is not None and not 0 <= most < math.inf:
            raise InputError(f"{most!r}; give a finite number, 0 or more", field=name)
    watch = Stopwatch()
    with watch("scouting"):
        known, scouting = scout_mission(instance, StagedOptions(seed=seed))
    with watch("requirement analysis"):
        situation = Situation.of(known)
        analysis = requirement_analysis(known.P, known.Q)
        missing = missing_capabilities(known.Q, analysis.potential, situation.reach)
        data = routing_data(
            situation,
            endurance=endurance,
            longest_walk=longest_walk,
            return_to_start=return_to_start,
        )
    # Until it is returned: a plan that is worked out is not lost to a late Ctrl-C.
    with interruptible():
        with watch("joint problem"):
            routes, bound = _solve(situation, data, objective, time_limit, gap, seed, report)
        with watch("path planning"):
            legs = path_planning(known, stops_of(situation, routes, STAGE))
            if return_to_start:
                legs = tuple(_with_way_back(known, route) for route in legs)
        plan = assemble(
            instance,
            known,
            planner=PLANNER.name,
            options={
                "objective": objective,
                "time_limit": time_limit,
                "gap": gap,
                "seed": seed,
                "endurance": endurance,
                "longest_walk": longest_walk,
                "return_to_start": return_to_start,
            },
            routes=legs,
            missing=missing,
            report=scouting,
            seconds=watch.seconds,
        )
        certificate = _certificate(known, data, routes, objective, bound)
        return plan.model_copy(
            update={
                "unserved": (*plan.unserved, *_beyond_limits(situation, data)),
                "certificates": (certificate,),
            }
        )


def _solve(
    situation: Situation,
    data: RoutingData,
    objective: Objective,
    time_limit: float,
    gap: float,
    seed: int,
    report: Report | None,
) -> tuple[Routes, Bound]:
    began = time.monotonic()

    def left() -> float:
        return max(time_limit - (time.monotonic() - began), 0.0)

    routes = _first(situation, data, objective, time_limit)
    if not data.required.any():
        return routes, Bound(0.0, "combinatorial")
    lower = latency_bound(data) if objective == "latency" else 0.0
    closed = relative_gap(value(data, routes, objective), lower) <= max(gap, 1e-9)
    if not closed and left() > 0:
        # Small missions are proven sooner than a search of seconds is worth.
        seconds = min(SHARE_OF_SEARCH * left(), SEARCH_PER_VICTIM * data.n_victims)
        routes = improve(
            data, routes, objective, seconds=seconds, seed=seed, should_stop=interrupted
        )
    search = (
        partial(search_latency, data)
        if objective == "latency"
        else partial(strong_bound, data, objective)
    )
    return search(
        routes,
        time_limit=left(),
        gap=gap,
        seed=seed,
        report=report,
        should_stop=interrupted,
    )


def _first(
    situation: Situation, data: RoutingData, objective: Objective, time_limit: float
) -> Routes:
    """The best of the quick planners' routes that keep to the limits, or else any that do."""
    found: list[Routes] = []
    for allocate in (ssi.allocate, greedy.allocate):
        routes = _within(data, allocate(situation))
        if not faults(data, routes):
            found.append(routes)
    if not found:
        # The quick planners do not know of limits.
        return _by_model(data, max(time_limit, LEAST_SECONDS))
    return min(found, key=lambda routes: value(data, routes, objective))


def _by_model(data: RoutingData, seconds: float) -> Routes:
    """Routes that keep to the limits, by the explicit model."""
    solution = solve("joint_routing_flow", data, gap=1.0, time_limit=seconds)
    if not solution.found:
        why = "exists" if solution.status == "infeasible" else "was found in time"
        raise InputError(
            f"no plan that keeps to the robots' limits {why}; give more",
            field="endurance" if np.isfinite(data.endurance).any() else "longest_walk",
        )
    goes, serves = solution.values["x"] > 0.5, solution.values["a"] > 0.5
    routes = []
    for r in range(data.n_robots):
        route, place = [], data.n_victims  # the start
        while goes[r, place].any():
            place = int(np.argmax(goes[r, place]))
            route.append((place, tuple(int(k) for k in np.flatnonzero(serves[r, place]))))
        routes.append(tuple(route))
    return tuple(routes)


def _within(data: RoutingData, stops: Sequence[Stop]) -> Routes:
    """The routes of `stops`, without the requirements that the limits leave out."""
    routes: list[list[tuple[int, tuple[int, ...]]]] = [[] for _ in range(data.n_robots)]
    for stop in stops:
        if stop.victim is None:
            continue
        kinds = tuple(k for k in stop.kinds if data.able[stop.robot, stop.victim, k])
        if kinds:
            routes[stop.robot].append((stop.victim, kinds))
    return tuple(tuple(route) for route in routes)


def _with_way_back(instance: Instance, route: Route) -> Route:
    if not route.visits:
        return route
    start = next(robot.start for robot in instance.robots if robot.id == route.robot)
    back = instance.map.walk(route.visits[-1].cells[-1], start)
    return route.model_copy(update={"back": tuple(back)})


def _beyond_limits(situation: Situation, data: RoutingData) -> list[Unserved]:
    """Available requirements that every capable robot could serve only beyond its limits."""
    instance = situation.instance
    return [
        Unserved(victim=instance.victims[v].id, kind=instance.capabilities[k], reason=reason)
        for (v, k), reason in beyond_limits(situation, data).items()
    ]


def _certificate(
    known: Instance, data: RoutingData, routes: Routes, objective: Objective, bound: Bound
) -> Certificate:
    worth = value(data, routes, objective)
    opening = relative_gap(worth, bound.value)
    program = bound.program
    return Certificate(
        stage=STAGE_OF_BOUNDS,
        model=objective,
        sense="min",
        solver="strong method" if objective != "latency" else "column generation",
        version="",
        status="optimal" if opening <= 1e-6 else "feasible",
        objective=worth,
        bound=bound.value,
        gap=0.0 if opening <= 1e-6 else opening,
        proof=bound.proof,
        check="passed" if not faults(data, routes) else faults(data, routes)[0],
        n_variables=0 if program is None else program.n_columns,
        n_rows=0 if program is None else program.n_rows,
        root=root_proof(known, bound, worth),
        pricing=None if bound.latency is None else latency_proof(known, data, bound.latency, worth),
    )


PLANNER = Planner("exact", "the joint problem, with a proven bound", run)
