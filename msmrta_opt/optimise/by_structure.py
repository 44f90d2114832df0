"""The solver ``auto``: the matrix decides how a program is solved.

A program proven to be an assignment goes to an assignment algorithm, one proven totally unimodular to
the simplex method; any other is relaxed first, and goes to HiGHS' branch and bound only if the
relaxation's vertex is not integral.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..arrays import Floats
from .assignment import solve_assignment
from .check import TIGHT, dual_bound, settled, violations
from .program import Program
from .scaling import objective_size
from .solvers import Options, Outcome, get
from .structure import Structure, integral_relaxation

BY_MATRIX = ("assignment algorithm", "simplex", "integral vertex")
"""How a matrix is told to be solved without branching, by duality."""


def is_by_matrix(proof: str) -> bool:
    """Whether `proof`, of an outcome, is by duality and what the matrix proves, without branching."""
    return any(way in proof for way in BY_MATRIX)


def solve_by_structure(
    program: Program, options: Options, recognised: Callable[[], Structure | None]
) -> tuple[str, Outcome]:
    """The name of the solver that solved it, and what it said.

    `recognised` tells the structure of the program's matrix.
    """
    highs = get("highs")
    if not program.integer.any():
        return highs.name, highs.solve(program, replace(options, start=None))
    began = time.perf_counter()
    structure = recognised()
    if structure is not None:
        relaxed = integral_relaxation(program, structure)
        found = solve_assignment(program, structure)
        if found is not None:
            x, duals = found
            bound = dual_bound(relaxed, duals)
            if _is_tight(program, x, bound):
                proof = f"{structure.description}; assignment algorithm, dual values"
                duals = _on_rows(program, relaxed, duals)
                return "lsa", Outcome("optimal", x, bound, duals=duals, proof=proof)
        proof = f"{structure.description}; simplex, dual values"
    else:
        relaxed = program.relaxed()
        proof = "integral vertex of the relaxation, dual values"
    outcome = highs.solve(relaxed, replace(options, start=None, gap=None))
    if outcome.status == "optimal" and outcome.x is not None:
        x = settled(program, outcome.x)
        if not violations(program, x):
            proven = None if outcome.duals is None else dual_bound(relaxed, outcome.duals)
            if outcome.duals is not None and proven is not None and _is_tight(program, x, proven):
                duals = _on_rows(program, relaxed, outcome.duals)
                return highs.name, replace(outcome, x=x, bound=proven, duals=duals, proof=proof)
    if outcome.status == "infeasible":
        return highs.name, replace(outcome, message="the relaxation is infeasible")
    if options.time_limit is not None:
        left = max(options.time_limit - (time.perf_counter() - began), 0.0)
        options = replace(options, time_limit=left)
    return highs.name, highs.solve(program, options)


def _is_tight(program: Program, x: Floats, bound: float) -> bool:
    value = program.value(x)
    return abs(value - bound) <= TIGHT * objective_size(program, value)


def _on_rows(program: Program, relaxed: Program, duals: Floats) -> Floats:
    """The `duals` of `relaxed`, with those of the single-entry rows that gave it tighter bounds.

    The reduced cost of a column at such a bound is the row's dual value in `program`, whose own bounds
    are wider.
    """
    matrix = program.matrix
    single = np.flatnonzero(np.diff(matrix.indptr) == 1)
    single = single[matrix.data[matrix.indptr[single]] != 0]
    if not single.size:
        return duals
    at = matrix.indptr[single]
    column, factor = matrix.indices[at], matrix.data[at]
    reduced = (program.sign * program.cost - matrix.T @ duals)[column]
    at_lower = reduced > 0
    bound = np.where(at_lower, relaxed.lower[column], relaxed.upper[column])
    own = np.where(at_lower, program.lower[column], program.upper[column])
    is_lower = at_lower == (factor > 0)
    side = np.where(is_lower, program.row_lower[single], program.row_upper[single])
    gives = np.flatnonzero((reduced != 0) & (bound != own) & (factor * bound == side))
    gives = gives[np.unique(column[gives], return_index=True)[1]]
    moved = duals.copy()
    moved[single[gives]] += reduced[gives] / factor[gives]
    return moved
