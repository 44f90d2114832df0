"""Every shipped formulation, by every installed solver that is able, is worth what brute force says.

Which solvers are not installed here is said by `test_solvers`.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.oracles import KNOWN, Question, assert_solves, questions

from msmrta_opt.mission.errors import UnsupportedError
from msmrta_opt.optimise.registry import listings
from msmrta_opt.optimise.solve import AUTO, solve
from msmrta_opt.optimise.solvers import solvers

MODELS = Path(__file__).parents[2] / "models"
SHIPPED = [item.name for item in listings() if item.path.parent == MODELS]
INSTALLED = [name for name, solver in solvers().items() if solver.installed]
CONTINUOUS = {
    *("cluster_fair", "joint_assignment", "joint_replan", "joint_routing_flow"),
    "joint_routing_mtz",
    *("victim_balanced", "victim_bottleneck"),
}
NO_ASSIGNMENT = {
    *("cluster_apart", "cluster_printed", "cluster_budgeted", "clustering_pmedian"),
    *("victim_covering", "victim_generalized", "victim_printed"),
}
CANNOT = {"cpsat": CONTINUOUS, "lsa": CONTINUOUS | NO_ASSIGNMENT}
"""By solver, the formulations that it refuses whatever the data."""
INFEASIBLE = {
    *("clustering_pmedian", "victim_generalized"),
    *("joint_replan", "joint_routing_flow", "joint_routing_mtz"),
}
"""Formulations of which some questions have no answer; the others always have one."""


@cache
def asked(name: str) -> tuple[Question, ...]:
    return tuple(questions(name))


@cache
def refusals(name: str, solver: str) -> tuple[str, ...]:
    """What `solver` says to those questions about `name` that it refuses; the others are checked."""
    refused = []
    for question in asked(name):
        parameters: dict[str, Any] = question.parameters
        try:
            solution = solve(name, question.data, solver=solver, **parameters)
        except UnsupportedError as error:
            refused.append(str(error))
            continue
        if solution.status == "skipped":
            refused.append(f"{solver}: {solution.message}")
        else:
            assert_solves(question, solution)
    return tuple(refused)


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("solver", [AUTO, *INSTALLED])
def test_a_formulation_is_worth_what_brute_force_finds(name: str, solver: str) -> None:
    """All questions that the solver does not refuse; `CANNOT` says which it refuses all of."""
    assert (len(refusals(name, solver)) == len(asked(name))) == (name in CANNOT.get(solver, ()))


@pytest.mark.parametrize("name", SHIPPED)
def test_a_formulation_has_an_oracle(name: str) -> None:
    assert name in KNOWN


@pytest.mark.parametrize("name", SHIPPED)
def test_questions_without_a_solution_are_among_those_asked(name: str) -> None:
    assert any(question.best is None for question in asked(name)) == (name in INFEASIBLE)
    assert any(question.best is not None for question in asked(name))
