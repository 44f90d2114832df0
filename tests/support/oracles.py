"""Small questions to every shipped formulation, and what brute force says to them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from support import brute, exhaustive
from support.joint_cases import on_a_line, small_mission
from support.joint_oracle import minimum
from support.small_cases import dense_case

from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.optimise.data import ClusterData, ClusteringData, VictimData
from msmrta_opt.optimise.registry import get
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.problem import Routes, RoutingData, faults
from msmrta_opt.stages.data import stage_data
from msmrta_opt.stages.options import StagedOptions

ANSWER = {"clustering": ("y", "median"), "cluster": ("x",), "victim": ("x",), "joint": ("x", "y")}
"""The binary variables that make an answer, by stage; of routes see `routes_of`."""
WEIGHTS: dict[str, dict[str, dict[str, float]]] = {
    "joint_routing_flow": {"total_time": {"w": 0}, "makespan": {"w": 1}},
    "joint_replan": {
        "total_time": {"w": 0, "stability": 0},
        "makespan": {"w": 1, "stability": 1},  # of nothing that was planned
    },
    "joint_routing_mtz": {
        "total_time": {"w_total": 1, "w_makespan": 0, "w_latency": 0},
        "makespan": {"w_total": 0, "w_makespan": 1, "w_latency": 0},
        "latency": {"w_total": 0, "w_makespan": 0, "w_latency": 1},
    },
}
"""By formulation, the parameters that make it minimise an objective."""
KNOWN = {*brute.ORACLES, *brute.WALKED, *exhaustive.ORACLES, *WEIGHTS}
"""The formulations that have an oracle."""


@dataclass(frozen=True)
class Question:
    """Data and parameters, the best that brute force finds, and its worth of any answer.

    ``best`` is ``None`` if there is no answer; so is ``worth`` of what is not one.
    """

    data: Any
    parameters: dict[str, float]
    best: float | None
    worth: Callable[[Solution], float | None]


def assert_solves(question: Question, solution: Solution) -> None:
    """It finds, and proves, the best of all solutions, or that there is none."""
    if question.best is None:
        assert solution.status == "infeasible"
        assert not solution.found
        return
    assert solution.status == "optimal", solution.message
    assert solution.check == "passed"
    assert solution.objective == pytest.approx(question.best, abs=1e-5)
    assert solution.bound == pytest.approx(question.best, abs=1e-5)
    assert question.worth(solution) == pytest.approx(question.best, abs=1e-5)


def assert_agrees(name: str, data: Any, **parameters: float) -> None:
    """Both ways of solving the formulation `name` find, and prove, what its oracle finds."""
    question = question_of(name, data, parameters)
    for structure in (True, False):
        assert_solves(question, solve(name, data, structure=structure, **parameters))


def question_of(name: str, data: Any, parameters: dict[str, float]) -> Question:
    """The formulation `name` on data of tables, with what its oracle finds."""
    ask = _by_tables if name in brute.ORACLES | brute.WALKED else _by_answers
    return ask(name, data, parameters)


def questions(name: str) -> Iterator[Question]:
    """Questions to the formulation `name`, some of them without an answer where that can be."""
    spec = get(name).spec
    if name in WEIGHTS:
        for objective, weights in WEIGHTS[name].items():
            for data in _missions():
                yield _about_routes(data, objective, weights)
        return
    known = _walked() if name in brute.WALKED else _data(spec.stage)
    for number, data in enumerate(known):
        shares = (0.25, 0.5, 1.0)
        parameters = {
            parameter: shares[(number + place) % 3]
            for place, parameter in enumerate(spec.parameters)
        }
        yield question_of(name, data, parameters)


def _by_tables(name: str, data: Any, parameters: dict[str, float]) -> Question:
    judged = (brute.ORACLES | brute.WALKED)[name](data, *parameters.values())
    return Question(
        data, parameters, judged.best, lambda solution: judged.worth_of(solution.values["x"])
    )


def _by_answers(name: str, data: Any, parameters: dict[str, float]) -> Question:
    answers, tables = exhaustive.ORACLES[name](data, **parameters), ANSWER[get(name).spec.stage]
    best = max if name == "cluster_fair" else min
    return Question(
        data,
        parameters,
        best(answers.values(), default=None),
        lambda solution: answers.get(exhaustive.key(*(solution.values[t] for t in tables))),
    )


def _about_routes(data: RoutingData, objective: str, weights: dict[str, float]) -> Question:
    def worth(solution: Solution) -> float | None:
        routes = routes_of(solution)
        return None if faults(data, routes) else value(data, routes, objective)

    best = minimum(data, objective)
    return Question(data, weights, best if np.isfinite(best) else None, worth)


def routes_of(solution: Solution) -> Routes:
    """The routes that ``x`` and ``a`` say, followed from each robot's start."""
    x, a = solution.values["x"] > 0.5, solution.values["a"] > 0.5
    routes = []
    for r in range(len(x)):
        route, place = [], x.shape[2]
        while x[r, place].any():
            place = int(np.argmax(x[r, place]))
            route.append((place, tuple(int(k) for k in np.flatnonzero(a[r, place]))))
        routes.append(tuple(route))
    return tuple(routes)


def _missions() -> list[RoutingData]:
    """Two robots: on a line, kept to their limits; limits that leave no plan; among walls."""
    line = on_a_line([0, 10], [3, 4], [[[True], [True]]] * 2, service=1)
    return [
        replace(line, longest_walk=np.array([3.5, 6.5])),
        replace(line, longest_walk=np.array([2.5, 6.5])),
        small_mission(0, 2, 3),
        small_mission(3, 2, 2, return_to_start=True),
    ]


def _walked() -> list[ClusterData]:
    """Clusters among walls, one of them out of a robot's reach, and robots to keep apart."""
    rows = [".....@.", ".@@@.@.", "......@"]
    grid = grid_from_rows(rows)
    missions = [
        generate_mission(grid, n_robots, 5, seed=seed, solvable=False)
        for seed, n_robots in enumerate((3, 3, 3, 2))
    ]
    options = StagedOptions.of(apart="0,1")
    return [stage_data(mission, "cluster", options) for mission in missions]


def _data(stage: str) -> list[Any]:
    """Dense data, and where things run out: clusters, reach, budgets or endurance."""
    dense = [dense_case(stage, seed) for seed in range(4)]
    return [*dense, *SCARCE.get(stage, [])]


_APART = ClusteringData(
    distance=np.array([[0.0, 3, 0], [3, 0, 0], [0, 0, 0]]),
    can_reach=np.array([[True, True, False], [True, True, False], [False, False, True]]),
    weight=np.array([1.0, 2, 1]),
    n_clusters=2,
)
_CHOOSY = VictimData(
    # Robot 0 cannot serve victim 1, nobody victim 2; endurance 9 is enough for one victim only.
    success=np.array([[5.0, 0, 0], [4, 6, 0]]),
    failure=np.array([[1.0, 0, 0], [0, 2, 0]]),
    can_serve=np.array([[True, False, False], [True, True, False]]),
    busy=np.array([1.0, 0]),
    budget=np.array([1, 1]),
    endurance=np.array([5.0, 9]),
)
SCARCE: dict[str, list[Any]] = {
    # Two parts of a map need two medians: with one there is no answer.
    "clustering": [_APART, replace(_APART, n_clusters=1)],
    "cluster": [
        ClusterData(np.array([[3.0], [5], [4]]), np.array([[3.0], [0], [4]]), np.array([1, 0, 1])),
        ClusterData(np.array([[3.0, 1, 2]]), np.zeros((1, 3)), np.array([2])),
    ],
    "victim": [
        _CHOOSY,
        replace(_CHOOSY, endurance=np.array([4.0, 5])),  # nobody has time for victim 1
        replace(_CHOOSY, can_serve=np.zeros((2, 3), bool)),
    ],
}
