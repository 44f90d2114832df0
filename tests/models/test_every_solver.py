"""Every shipped formulation, by every installed solver that is able, is worth what brute force says.

A solver that refuses all questions to a formulation is skipped with what it says; a formulation that
every solver refuses fails.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.oracles import KNOWN, Question, questions

from msmrta_opt.mission.errors import SolverError
from msmrta_opt.optimise.registry import listings
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import AUTO, solve
from msmrta_opt.optimise.solvers import solvers

MODELS = Path(__file__).parents[2] / "models"
SHIPPED = [item.name for item in listings() if item.path.parent == MODELS]
SOLVERS = list(solvers())
INFEASIBLE = {
    *("clustering_pmedian", "victim_generalized"),
    *("joint_routing_flow", "joint_routing_mtz"),
}
"""Formulations of which some questions have no answer; the others always have one."""


@cache
def asked(name: str) -> tuple[Question, ...]:
    return tuple(questions(name))


def answer(name: str, question: Question, solver: str) -> Solution | str:
    """What `solver` answers, or why it is not one for such a question."""
    parameters: dict[str, Any] = question.parameters
    try:
        solution = solve(name, question.data, solver=solver, **parameters)
    except SolverError as error:
        if f"solver {solver} cannot do" in str(error):
            return str(error)
        raise
    return f"{solver}: {solution.message}" if solution.status == "skipped" else solution


@cache
def refusals(name: str, solver: str) -> tuple[str, ...]:
    """What `solver` says to those questions about `name` that it refuses; the others are checked."""
    refused = []
    for question in asked(name):
        solution = answer(name, question, solver)
        if isinstance(solution, str):
            refused.append(solution)
        elif question.best is None:
            assert solution.status == "infeasible"
            assert not solution.found
        else:
            assert solution.status == "optimal", solution.message
            assert solution.check == "passed"
            assert solution.objective == pytest.approx(question.best, abs=1e-5)
            assert solution.bound == pytest.approx(question.best, abs=1e-5)
            assert question.worth(solution) == pytest.approx(question.best, abs=1e-5)
    return tuple(refused)


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("solver", [AUTO, *SOLVERS])
def test_a_formulation_is_worth_what_brute_force_finds(name: str, solver: str) -> None:
    if solver != AUTO and not solvers()[solver].installed:
        pytest.skip(f"{solver} is not installed; {solvers()[solver].install}")
    refused = refusals(name, solver)
    if len(refused) == len(asked(name)):
        pytest.skip(refused[0])


@pytest.mark.parametrize("name", SHIPPED)
def test_a_formulation_has_an_oracle_and_a_solver_that_was_held_to_it(name: str) -> None:
    assert name in KNOWN
    installed = [solver for solver in SOLVERS if solvers()[solver].installed]
    answered = [solver for solver in installed if len(refusals(name, solver)) < len(asked(name))]
    assert answered, [refusals(name, solver)[0] for solver in installed]


@pytest.mark.parametrize("name", SHIPPED)
def test_questions_without_an_answer_are_among_those_asked(name: str) -> None:
    assert any(question.best is None for question in asked(name)) == (name in INFEASIBLE)
    assert any(question.best is not None for question in asked(name))
