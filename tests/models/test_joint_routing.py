"""The explicit joint models: against brute force, on the paper's mission, and by hand."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.joint_cases import on_a_line, small_mission
from support.joint_oracle import minimum
from support.oracles import WEIGHTS, routes_of

from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.problem import RoutingData, faults
from msmrta_opt.stages.data import stage_data

PAIRS = [(model, objective) for model, objectives in WEIGHTS.items() for objective in objectives]
both = pytest.mark.parametrize("model", WEIGHTS)

# Robots, victims, number of the map, options. Two kinds a victim; some that no robot has.
CASES = {
    0: small_mission(0, 2, 3),
    1: small_mission(1, 2, 4),
    2: small_mission(2, 3, 4, map_number=3),
    3: small_mission(3, 3, 3, return_to_start=True),
    4: small_mission(4, 3, 4, map_number=0, longest_walk=25),
    5: small_mission(5, 2, 4, endurance=200, return_to_start=True),
}


@cache
def expected(case: int, objective: str) -> float:
    return minimum(CASES[case], objective)


def answer(model: str, objective: str, data: RoutingData, *, solver: str = "auto") -> Solution:
    weights: dict[str, Any] = {**WEIGHTS[model][objective]}
    return solve(model, data, solver=solver, **weights)


def assert_worth(solution: Solution, data: RoutingData, objective: str, worth: float) -> None:
    """It is proven, and routes follow from it that hold and are worth the same."""
    assert solution.status == "optimal"
    assert solution.objective == pytest.approx(worth, abs=1e-5)
    assert solution.bound == pytest.approx(worth, abs=1e-5)
    routes = routes_of(solution)
    assert faults(data, routes) == []
    assert value(data, routes, objective) == pytest.approx(worth, abs=1e-5)


@pytest.mark.parametrize(("model", "objective"), PAIRS)
@pytest.mark.parametrize("case", CASES)
def test_a_small_mission_is_worth_what_brute_force_finds(
    case: int, model: str, objective: str
) -> None:
    data, worth = CASES[case], expected(case, objective)
    solution = answer(model, objective, data)
    if np.isfinite(worth):
        assert_worth(solution, data, objective, worth)
    else:
        assert solution.status == "infeasible"


@pytest.mark.parametrize(("model", "objective"), PAIRS)
def test_another_solver_agrees_with_brute_force(model: str, objective: str) -> None:
    pytest.importorskip("pyscipopt", reason="SCIP is not installed; pip install pyscipopt")
    solution = answer(model, objective, CASES[2], solver="scip")
    assert_worth(solution, CASES[2], objective, expected(2, objective))


# No hand reaches these: each is what two programs, and two solvers, must come to independently.
GRAIN = 5 / 6
"""All times of the paper's mission are multiples of it: cells by 0.2, 0.3 and 0.4, services by 5."""
WITH_SPEEDS: dict[str, float] = {"total_time": 1462 * GRAIN, "makespan": 540 * GRAIN}
IN_CELLS: dict[str, float] = {"total_time": 193, "makespan": 66}


@pytest.mark.parametrize(
    ("model", "objective", "solver", "cells"),
    [
        *(
            ("joint_routing_flow", objective, solver, cells)
            for objective in ("total_time", "makespan")
            for solver in ("highs", "scip")
            for cells in (False, True)
        ),
        # Of the weaker formulation, what is quick.
        ("joint_routing_mtz", "total_time", "scip", False),
        ("joint_routing_mtz", "makespan", "highs", False),
        ("joint_routing_mtz", "makespan", "scip", False),
        ("joint_routing_mtz", "total_time", "scip", True),
        ("joint_routing_mtz", "makespan", "highs", True),
    ],
)
def test_the_papers_mission_is_proven(
    paper: Instance, model: str, objective: str, solver: str, cells: bool
) -> None:
    if solver == "scip":
        pytest.importorskip("pyscipopt", reason="SCIP is not installed; pip install pyscipopt")
    data = stage_data(paper, "routing")
    if cells:
        speed = paper.speed
        data = replace(
            data,
            leave=data.leave * speed[:, None],
            length=data.between * speed[:, None, None],
            speed=np.ones(len(speed)),
            service=np.zeros_like(data.service),
        )
    worth = (IN_CELLS if cells else WITH_SPEEDS)[objective]
    assert_worth(answer(model, objective, data, solver=solver), data, objective, worth)


@both
def test_victims_on_one_cell_served_in_no_time_do_not_close_into_a_cycle(model: str) -> None:
    """The robot must walk the 5 cells to them, though going round among them costs nothing."""
    data = on_a_line([0], [5, 5, 5], [[[True]] * 3])
    assert_worth(answer(model, "total_time", data), data, "total_time", 5)


def two_robots(**limits: list[float]) -> RoutingData:
    """Robots at 0 and 10, victims at 3 and 4, which either can serve in one time unit each."""
    data = on_a_line([0, 10], [3, 4], [[[True], [True]]] * 2, service=1)
    arrays: dict[str, Any] = {name: np.array(limit) for name, limit in limits.items()}
    return replace(data, **arrays)


@both
@pytest.mark.parametrize(
    ("limits", "total"),
    [
        ({}, 4 + 2),  # robot 0 serves both
        ({"endurance": [6, 9]}, 4 + 2),  # … and is done at 6
        ({"endurance": [5.5, 9]}, 7 + 2),  # robot 1 serves both, and is done at 9
        ({"endurance": [5.5, 8.5]}, 3 + 6 + 2),  # one each
        ({"longest_walk": [3.5, 6.5]}, 3 + 6 + 2),
        ({"longest_walk": [2.5, 9]}, 7 + 2),  # robot 1 serves both, at 4 and 3
    ],
)
def test_robots_keep_to_their_limits(
    model: str, limits: dict[str, list[float]], total: float
) -> None:
    data = two_robots(**limits)
    assert_worth(answer(model, "total_time", data), data, "total_time", total)


@both
def test_limits_that_leave_no_plan_are_infeasible(model: str) -> None:
    data = two_robots(longest_walk=[2.5, 6.5])
    assert answer(model, "total_time", data).status == "infeasible"


@both
def test_the_way_back_counts_in_time_and_limits(model: str) -> None:
    """From 2 to 0, to 6 and back: 2 + 6 + 4 of travel and 2 of service."""
    data = on_a_line([2], [0, 6], [[[True], [True]]], service=1, returns=True)
    assert_worth(answer(model, "makespan", data), data, "makespan", 14)
    tired = replace(data, endurance=np.array([13.5]))
    assert answer(model, "makespan", tired).status == "infeasible"


def test_latency_is_weighted_by_priority() -> None:
    """Near first: done at 1 and 6, so 1 + 9 · 6 = 55. Far first: at 4 and 9, so 9 · 4 + 9 = 45."""
    data = on_a_line([0], [-1, 4], [[[True], [True]]])
    data = replace(data, priority=np.array([1.0, 9.0]))
    assert_worth(answer("joint_routing_mtz", "latency", data), data, "latency", 45)


def test_the_weight_leads_from_the_total_time_to_the_makespan() -> None:
    """Robot 1 alone is done at 5; one each, at 4 and 3, is better from w = 2/3 on."""
    data = on_a_line([0, 6], [3, 4], [[[True], [True]]] * 2, service=1)
    for w, best in ((0.0, 5.0), (0.5, 5.0), (0.75, 0.25 * 7 + 0.75 * 4), (1.0, 4.0)):
        assert solve("joint_routing_flow", data, w=w).objective == pytest.approx(best)


@pytest.mark.parametrize(
    ("model", "n_variables", "n_rows"),
    [
        # N = 2 robots, M = 3 victims, L = 1 kind.
        ("joint_routing_flow", 6 * (6 + 1 + 3) + 1, 3 * (1 + 2 * (6 + 1 + 6)) + 8),
        ("joint_replan", 6 * (6 + 1 + 3) + 1, 3 * (1 + 2 * (6 + 1 + 6)) + 8),
        ("joint_routing_mtz", 6 * (3 + 1 + 4) + 3 + 1, 3 * (1 + 2 * (6 + 1 + 5)) + 8),
    ],
)
def test_a_program_has_the_size_that_its_docstring_states(
    model: str, n_variables: int, n_rows: int
) -> None:
    solution = solve(model, on_a_line([0, 1], [2, 3, 4], [[[True]] * 3] * 2))
    assert (solution.n_variables, solution.n_rows) == (n_variables, n_rows)
