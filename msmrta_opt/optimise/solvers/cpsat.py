"""CP-SAT: pure integer programs with finite bounds, through ortools.

CP-SAT reckons in integers. Each row and the objective are multiplied by the least common denominator
of their coefficients where that is small, else by a power of two. What rounding is left is worked
out, and rows are widened by it: CP-SAT solves a relaxation whose points miss a row by less than any
solver's tolerance, so that what it proves (a bound, infeasibility) holds for the program itself. The
bound is weakened by the rounding of the objective. A program whose numbers need more digits than
there are is refused, and so are continuous columns.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import lcm
from typing import Any

import numpy as np

from ...arrays import Floats, Ints
from ...interruption import until_interrupted
from ...mission.errors import UnsupportedError
from ..program import Program
from .apart import run_apart
from .base import Options, Outcome, Solver
from .outcomes import incumbent, own_bound

LARGEST = 2.0**50
"""Sums of scaled terms stay below this: floats hold such integers exactly, and CP-SAT adds a few."""
DENOMINATOR = 10**4
"""Coefficients are taken for fractions with denominators up to this, if they are very close to one."""
CLOSE = 1e-12
"""Relative difference up to which a coefficient is a fraction."""
FEASIBILITY = 1e-9
"""How far a row may be missed, relative to the size of its terms; the check allows 1e-6."""
ROUNDING = 4 * float(np.finfo(float).eps)
"""Relative error of sums and products in floats."""


@dataclass(frozen=True)
class Scaled:
    """A linear form as integers: ``weights @ x / scale``, within `error` of the form itself."""

    weights: Ints
    scale: float
    error: float
    """Of ``weights @ x`` against ``scale * coefficients @ x``, anywhere within the bounds."""
    exact: bool
    """Whether the coefficients are fractions with this denominator."""


def scaled(coefficients: Floats, magnitudes: Floats) -> Scaled:
    """Integer weights for a linear form.

    Parameters
    ----------
    coefficients : float array, shape (n,)
        The form's own.
    magnitudes : float array, shape (n,)
        The largest absolute values of its variables.

    Raises
    ------
    UnsupportedError
        If the coefficients need more digits than there is room for.
    """
    coefficients = np.where(
        magnitudes > 0, coefficients, 0.0
    )  # of what can only be 0 there is no limit
    size = float(np.abs(coefficients) @ magnitudes)
    scale = _denominator(coefficients)
    exact = scale is not None and scale * size <= LARGEST
    if scale is None or not exact:
        scale = 2.0 ** np.floor(np.log2(LARGEST / max(size, 1.0)))
    weights = np.round(scale * coefficients)
    error = 0.0
    if not (weights / scale == coefficients).all():
        rounding = np.abs(weights - scale * coefficients) @ magnitudes
        error = float(rounding + ROUNDING * scale * size)
    if not error <= FEASIBILITY * scale * max(1.0, size) or not np.isfinite(weights).all():
        raise UnsupportedError(
            f"solver cpsat cannot do coefficients from {np.abs(coefficients).min():g} to "
            f"{np.abs(coefficients).max():g} on variables up to {magnitudes.max():g} as integers"
        )
    return Scaled(weights.astype(np.int64), scale, error, exact)


def _denominator(coefficients: Floats) -> float | None:
    """The least common denominator of `coefficients`, if they are fractions with a small one."""
    if (coefficients == np.round(coefficients)).all():
        return 1.0
    fractions = [_fraction(value) for value in coefficients.tolist()]
    near = np.array([float(fraction) for fraction in fractions])
    common = lcm(*(fraction.denominator for fraction in fractions))
    if common > LARGEST or (np.abs(near - coefficients) > CLOSE * np.abs(coefficients)).any():
        return None
    return float(common)


@lru_cache(maxsize=2**16)
def _fraction(value: float) -> Fraction:
    return Fraction(value).limit_denominator(DENOMINATOR)


def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with CP-SAT, in a process of its own.

    Raises
    ------
    UnsupportedError
        If a column has an infinite bound, or the numbers need more digits than integers have.
    """
    magnitudes = np.maximum(np.abs(program.lower), np.abs(program.upper))
    if (magnitudes > LARGEST).any():
        j = int(np.argmax(magnitudes))
        name = program.column_name(j) if program.columns else f"column {j}"
        raise UnsupportedError(f"solver cpsat cannot do infinite bounds, as {name} has")
    return run_apart(_solve, program, options)


def _solve(program: Program, options: Options) -> Outcome:
    from ortools.sat.python import cp_model

    program = program.with_whole_bounds()
    lower, upper = program.lower, program.upper
    if (lower > upper).any():
        return Outcome("infeasible", message="a column has no integer within its bounds")
    model = cp_model.CpModel()
    variables = [
        model.new_int_var(low, high, "")
        for low, high in zip(lower.astype(int).tolist(), upper.astype(int).tolist(), strict=True)
    ]
    magnitudes = np.maximum(np.abs(lower), np.abs(upper))
    if not _add_rows(cp_model, model, variables, program, magnitudes):
        return Outcome("infeasible", message="a row has no integer within its bounds")
    objective = _add_objective(cp_model, model, variables, program, magnitudes)
    if options.start is not None:
        for j in np.flatnonzero(np.isfinite(options.start)):
            model.add_hint(variables[j], round(float(options.start[j])))

    solver = cp_model.CpSolver()
    parameters = solver.parameters
    parameters.num_workers = options.threads or 1
    parameters.random_seed = options.seed or 0
    parameters.relative_gap_limit = options.gap or 0.0
    parameters.absolute_gap_limit = 0.0
    # This step of the presolve of ortools 9.15 loses optima (google/or-tools#5293).
    parameters.presolve_inclusion_work_limit = 0
    parameters.log_search_progress = options.verbose
    if options.time_limit is not None:
        parameters.max_time_in_seconds = options.time_limit
    ends: list[Any] = []
    until_interrupted(lambda: ends.append(solver.solve(model)), solver.stop_search)
    status = solver.status_name(*ends)
    nodes = int(solver.num_branches)
    if status == "INFEASIBLE":
        return Outcome("infeasible", nodes=nodes, message=status)
    if status == "MODEL_INVALID":
        return Outcome("error", message=f"CP-SAT: {model.validate()}")
    minimum = solver.best_objective_bound
    # Without a bound yet, CP-SAT reports 0 or the end of its integers.
    known = abs(minimum) < LARGEST and not (status == "UNKNOWN" and minimum == 0)
    bound = own_bound(program, (minimum - objective.error) / objective.scale) if known else None
    if status == "UNKNOWN":
        return Outcome("no_solution", None, bound, nodes, message=status)
    x = np.array([solver.value(variable) for variable in variables], dtype=float)
    return incumbent(program, x, bound, nodes=nodes, message=status)


def _add_rows(
    cp_model: Any, model: Any, variables: list[Any], program: Program, magnitudes: Floats
) -> bool:
    """Add the rows, unless one cannot hold: CP-SAT takes crossed ends for something else."""
    matrix = program.matrix
    for i in range(program.n_rows):
        entries = slice(matrix.indptr[i], matrix.indptr[i + 1])
        columns = matrix.indices[entries]
        form = scaled(matrix.data[entries], magnitudes[columns])
        size = float(np.abs(form.weights) @ magnitudes[columns])
        tolerance = FEASIBILITY * (form.scale + size)
        if form.exact:  # a whole unit more would be another row
            tolerance = min(tolerance, 0.25)
        ends = form.scale * np.array([program.row_lower[i], program.row_upper[i]])
        slack = form.error + tolerance + ROUNDING * np.abs(ends)
        # A side beyond any activity says nothing, or everything.
        beyond = np.ceil(size) + 1
        low = np.clip(np.ceil(ends[0] - slack[0]), -beyond, beyond)
        high = np.clip(np.floor(ends[1] + slack[1]), -beyond, beyond)
        if low > high:
            return False
        terms = [variables[j] for j in columns]
        expression = cp_model.LinearExpr.weighted_sum(terms, form.weights.tolist())
        model.add_linear_constraint(expression, int(low), int(high))
    return True


def _add_objective(
    cp_model: Any, model: Any, variables: list[Any], program: Program, magnitudes: Floats
) -> Scaled:
    form = scaled(program.sign * program.cost, magnitudes)
    if form.weights.any():
        model.minimize(cp_model.LinearExpr.weighted_sum(variables, form.weights.tolist()))
    return form


SOLVER = Solver(
    name="cpsat",
    title="CP-SAT, constraint programming with clause learning",
    package="ortools",
    module="ortools",
    install="pip install 'msmrta_opt[solvers]'",
    abilities=frozenset(
        ["integer", "time_limit", "gap", "seed", "threads", "start", "verbose", "bound"]
    ),
    run=run,
    tolerances={"feasibility": FEASIBILITY},
    rank=3,
)
