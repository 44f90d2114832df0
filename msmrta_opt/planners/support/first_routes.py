"""Routes that an exact method starts from: the best of the quick planners', or any within limits."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from ...mission.errors import NoPlanError
from ...optimise.solve import solve
from ...routing.objectives import Objective
from ...routing.problem import Routes, RoutingData, faults
from ...routing.stop import StoppingCriterion
from ...stages.situation import Situation, Stop
from .. import greedy, ssi

MODEL = "joint_routing_flow"
"""The formulation that finds routes where limits make that hard."""
SHORTEST = 1.5
"""Seconds that it has at the minimum: without routes there is nothing to show."""
_LONG = 0.2
"""Seconds for one quick planner, from which on another is no longer quick."""


def first_routes(
    situation: Situation, data: RoutingData, objective: Objective, stop: StoppingCriterion
) -> Routes:
    """The best of the quick planners' routes that keep to the limits, or else any that do.

    Raises
    ------
    NoPlanError
        If there are no routes that keep to the limits, or none was found in time.
    """
    found: list[Routes] = []
    began = time.monotonic()
    for allocate in (ssi.allocate, greedy.allocate):
        if found and stop.met() and time.monotonic() - began > _LONG:
            break
        routes = _within(data, allocate(situation))
        if not faults(data, routes):
            found.append(routes)
    if not found:
        # The quick planners do not know of limits.
        return _by_model(data, max(stop.seconds_left(), SHORTEST))
    return min(found, key=lambda routes: objective.value(data, routes))


def _by_model(data: RoutingData, seconds: float) -> Routes:
    """Routes that keep to the limits, by the explicit model."""
    solution = solve(MODEL, data, gap=1.0, time_limit=seconds)
    if not solution.found:
        proven = solution.status == "infeasible"
        raise NoPlanError(
            "no plan that keeps to the robots' limits"
            f" {'exists' if proven else 'was found in time'}; give more",
            field="endurance" if np.isfinite(data.endurance).any() else "longest_walk",
            proven=proven,
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
