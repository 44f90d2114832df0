"""Feasible programs that a solver, or its presolve, calls infeasible: each has a point by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.programs import INF, program

from msmrta_opt.diagnosis.conflict import find_conflict
from msmrta_opt.optimise.check import violations
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program


def mixed(rows: list[list[int]], lower: list[float], upper: list[float], top: list[int]) -> Program:
    """Variables from 0 to `top`, whole but for the last."""
    whole = [True] * (len(top) - 1) + [False]
    return program(rows, upper, 0, row_lower=lower, upper=top, integer=whole, sense="max")


TRIALS: dict[str, tuple[Program, list[float], tuple[float, float]]] = {
    # A point, and the least and the greatest sum of all variables, by all values of the whole ones.
    "four rows": (
        mixed(
            [[0, 7, 0, 4, 0, 1], [0, 0, -5, 0, 0, 5], [6, 0, 2, 0, 7, 8], [-9, 0, 0, 0, 0, 7]],
            [14, -INF, 67, 44],
            [14, 17, INF, INF],
            [1, 1, 4, 1, 1, 24],
        ),
        [0, 1, 4, 0, 1, 7],
        (13, 13),
    ),
    # The next four are of the same kind, drawn at random: HiGHS' presolve calls each infeasible.
    "two equations": (
        mixed(
            [[-4, -8, 0, -2], [0, -2, 0, -5], [0, 5, -5, -7], [-6, 0, -9, 2], [0, 6, 0, 7]],
            [-14, -20, -INF, -3, -INF],
            [-14, INF, -20, -3, 27],
            [1, 1, 1, 19],
        ),
        [0, 1, 1, 3],
        (5, 5),
    ),
    "large sides": (
        mixed(
            [[3, 0, -9, 1], [0, 7, 0, 2], [-7, 0, 0, 9], [3, -1, 0, -3], [0, 0, 0, -4]],
            [13, -INF, 117, -40, -54],
            [13, 33, INF, INF, INF],
            [3, 1, 1, 22],
        ),
        [0, 1, 0, 13],
        (13, 14),
    ),
    "whole numbers up to 3": (
        mixed(
            [
                [-7, 0, 0, -4, 3],
                [-6, 2, 0, 0, 2],
                [0, 0, 0, 0, -2],
                [0, 6, 0, -6, 3],
                [0, -2, 0, -3, 5],
            ],
            [-INF, 14, -INF, -INF, 29],
            [15, 14, -11, 9, INF],
            [1, 3, 1, 3, 10],
        ),
        [0, 0, 1, 2, 7],
        (9, 10),
    ),
    "negative coefficients": (
        mixed(
            [[0, 2, 0, -7], [0, 2, 0, -1], [0, -3, 7, 4], [-2, -2, 0, -4], [-7, -5, 0, -6]],
            [-57, -INF, -INF, -36, -61],
            [INF, -5, 36, -36, INF],
            [1, 1, 1, 17],
        ),
        [1, 1, 1, 8],
        (10, 11),
    ),
    # Asked for its conflict, HiGHS did not end. By hand: a = 1, z = 8 - 3 b.
    "three rows": (
        mixed(
            [[-23, 0, 1], [-12, 0, 1], [-3, -9, -3]], [-INF, -7, -27], [-15, INF, -27], [1, 1, 10]
        ),
        [1, 0, 8],
        (7, 9),
    ),
}


@pytest.mark.parametrize("name", TRIALS)
@pytest.mark.parametrize("cost", [0.0, -1.0, 1.0, 0.5])
@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk"])
def test_a_feasible_program_is_not_called_infeasible(solver: str, cost: float, name: str) -> None:
    trial, point, (least, greatest) = TRIALS[name]
    assert violations(trial, np.array(point)) == []
    best = cost * (greatest if cost > 0 else least)
    found = solve_program(replace(trial, cost=np.full(len(point), cost)), solver=solver)
    assert (found.status, found.objective) == ("optimal", pytest.approx(best))


FAR_APART = {
    # A switch by a big M, and a row in a small unit: feasible, however far the sizes are apart.
    "a big M of 1e16": program([[1, -1e16]], 0, 1, upper=[5, 1], sense="max"),
    "a big M of 1e20": program([[1, -1e20]], 0, 1, upper=[5, 1], sense="max"),
    "nanoseconds": program([[1e-9]], INF, 1, row_lower=1.0, upper=1e12),
    "picoseconds": program([[1e-12]], INF, 1, row_lower=1.0, upper=1e13),
}


@pytest.mark.parametrize(
    "trial",
    [*(trial for trial, *_ in TRIALS.values()), *FAR_APART.values()],
    ids=[*TRIALS, *FAR_APART],
)
def test_a_feasible_program_is_not_explained_away(trial: Program) -> None:
    for cost in (0.0, -1.0, 1.0):
        costs = np.full(trial.n_columns, cost)
        assert find_conflict(replace(trial, cost=costs)).status == "feasible"
