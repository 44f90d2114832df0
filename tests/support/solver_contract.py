"""Every installed solver, what it declares, and programs whose solution is known by hand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pytest
from support.programs import INF, program

from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Options, Outcome, Solver, get

FREE = ("highs", "scip", "cpsat", "glpk")
COMMERCIAL = ("gurobi", "cplex", "xpress", "copt", "mosek")
INSTALLED = [name for name in (*FREE, *COMMERCIAL) if get(name).installed]


def able(*abilities: str) -> pytest.MarkDecorator:
    """The test is run for each installed solver that declares these abilities."""
    names = [name for name in INSTALLED if get(name).abilities.issuperset(abilities)]
    return pytest.mark.parametrize("solver", [get(name) for name in names], ids=names)


every_solver = able()


def solve(solver: Solver, asked: Program, **options: object) -> Solution:
    return solve_program(asked, solver=solver.name, options=Options(**options))  # type: ignore[arg-type]


def refusal(solver: Solver, asked: Program) -> str:
    """What the solver says to a program of a kind that it does not solve; empty if it does."""
    if not asked.integer.all() and "lp" not in solver.abilities:
        return f"solver {solver.name} cannot do continuous variables"
    infinite = not (np.isfinite(asked.lower).all() and np.isfinite(asked.upper).all())
    if infinite and solver.name == "cpsat":
        return "solver cpsat cannot do infinite bounds"
    return ""


def never(program: Program, options: Options) -> Outcome:
    raise AssertionError("a solver that must not be asked was asked")


def record(**changes: object) -> Solver:
    """A solver that can do nothing, but for these `changes`."""
    able_to_nothing = Solver(
        name="trial",
        title="",
        package="no-such-package",
        module="numpy",
        install="pip install trial",
        abilities=frozenset(),
        run=never,
    )
    return replace(able_to_nothing, **changes)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Case:
    asked: Program
    best: float | Literal["infeasible", "unbounded"]


KNOWN = {
    # x = y + 1 and z = 4 - 2y, so the cost is 13 - 3y, least at y = 2.
    "equality rows": Case(
        program([[1, 1, 1], [1, -1, 0]], [5, 1], [1, 2, 3], row_lower=[5, 1], upper=10), 7
    ),
    # 2x + 2y is even, so at most 6 of the 7.
    "a ranged row": Case(program([[2, 2]], 7, [1, 1], row_lower=3, upper=10, sense="max"), 3),
    # x is cheapest all the way down; then y may go to -1.
    "negative lower bounds": Case(
        program([[1, 2]], INF, [1, 1], row_lower=-7, lower=[-5, -3], upper=[5, 3]), -6
    ),
    # The relaxation's vertex is (3, 1.5), worth 21; (4, 0) is worth 20.
    "general integers": Case(program([[6, 4], [1, 2]], [24, 6], [5, 4], upper=10, sense="max"), 20),
    "a maximum with an offset": Case(
        program([[1, 1]], 4, [3, 2], upper=3, sense="max", offset=10), 21
    ),
    "a minimum with an offset": Case(
        program([[1, 1]], INF, [3, 2], row_lower=1, offset=-2.5), -0.5
    ),
    "a row without entries that holds": Case(
        program([[0, 0], [1, 1]], [1, 3], [1, -1], row_lower=[0, -INF], upper=5), -3
    ),
    "a row without entries that cannot hold": Case(
        program([[0, 0], [1, 1]], [2, 3], [1, -1], row_lower=[1, -INF], upper=5), "infeasible"
    ),
    "a row with no sides": Case(program([[1, 1]], INF, [1, -1], upper=5), -5),
    "no rows": Case(program(np.zeros((0, 2)), [], [1, -1], upper=5), -5),
    "no cost": Case(program([[1, 1]], 1, [0, 0], row_lower=1), 0),
    "a fixed column": Case(program([[1, 1]], 4, [1, -1], lower=[2, 0], upper=[2, 5]), 0),
    "all columns fixed": Case(program([[1, 1]], 7, [1, -1], lower=[2, 5], upper=[2, 5]), -3),
    "fractional bounds on integers": Case(
        program([[1, 1]], 9, [1, 2], lower=[0.5, -0.5], upper=[2.5, 3.5], sense="max"), 8
    ),
    "no integer between the bounds": Case(
        program([[1, 1]], 9, [1, 2], lower=[0.2, 0], upper=[0.8, 1]), "infeasible"
    ),
    "rows that contradict the bounds": Case(
        program([[1, 1]], INF, [1, 1], row_lower=5, upper=2), "infeasible"
    ),
    # The relaxation has points; twice a whole number is not 3.
    "infeasible for integers only": Case(
        program([[2, 2]], 3, [1, 1], row_lower=3, upper=10), "infeasible"
    ),
    "unbounded": Case(program([[1, -1]], 3, [-2, 1], upper=INF), "unbounded"),
    "unbounded without rows": Case(
        program(np.zeros((0, 1)), [], [1], upper=INF, sense="max"), "unbounded"
    ),
    # In floats 0.1 + 0.2 is more than 0.3.
    "tenths": Case(program([[0.1, 0.2]], 0.3, [0.1, 0.2], sense="max"), 0.3),
    "thirds": Case(program([[1 / 3, 1 / 3, 1 / 3]], 1, [1 / 3, 1, 1], row_lower=1, upper=3), 1),
    # Whole multiples of sqrt(2) and pi add up to sqrt(2) + pi in one way only.
    "irrational numbers": Case(
        program([[2**0.5, np.pi]], 2**0.5 + np.pi, [1, 1], row_lower=2**0.5 + np.pi, upper=9),
        2,
    ),
    "costs of very different size": Case(program([[1, 1]], INF, [1e6, 1e-2], row_lower=1), 1e-2),
    "small costs": Case(program([[1, 1]], 1, [1e-4, 2e-4], sense="max"), 2e-4),
    # Vertex where both rows are tight: x = y = 2/3.
    "a continuous minimum": Case(
        program([[2, 1], [1, 2]], INF, [1, 1], row_lower=2, upper=INF, integer=False), 4 / 3
    ),
    "a continuous maximum with an offset": Case(
        program([[2, 1], [1, 2]], 2, [1, 1], upper=INF, integer=False, sense="max", offset=-1),
        1 / 3,
    ),
    "a free continuous column": Case(
        program([[1]], INF, [1], row_lower=-7, lower=-INF, upper=INF, integer=False), -7
    ),
    "continuous and infeasible": Case(
        program(
            [[1, -1], [1, -1]], [3, INF], [1, 1], row_lower=[-INF, 4], integer=False, upper=INF
        ),
        "infeasible",
    ),
    "continuous and unbounded": Case(
        program([[1, -1]], 3, [-2, 1], upper=INF, integer=False), "unbounded"
    ),
    # x = 0 leaves y = 1.75; x = 1 leaves y = 1.
    "integer and continuous": Case(
        program([[2, 1], [1, 2]], [3, 3.5], [1, 1], upper=10, integer=[True, False], sense="max"), 2
    ),
}
