"""What adapters of solvers share when they report.

All give their solver a minimisation of ``sign * cost`` without offset, since bounds of maximisations
have another sign from one interface to the next, and speak in the program's own sense.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import wraps

import numpy as np

from ...arrays import Floats
from ..program import INFINITE, Program
from ..solution import Status
from .base import Options, Outcome

Adapter = Callable[[Program, Options], Outcome]

PROVEN = 1e-6
"""Relative difference up to which a bound proves a value, as solvers' own tolerances have it."""


def own_bound(program: Program, minimum: float) -> float | None:
    """The bound `minimum` on ``sign * cost @ x`` as one on the program's own objective."""
    if not np.isfinite(minimum) or abs(minimum) >= INFINITE:
        return None
    return program.sign * float(minimum) + program.offset


def incumbent(
    program: Program,
    x: Floats,
    bound: float | None,
    *,
    nodes: int | None = None,
    message: str = "",
) -> Outcome:
    """The outcome with the point `x`: optimal if `bound` (in the program's own sense) proves it.

    A solver that stops at a gap calls that optimal; here it is what it is, a feasible point.
    """
    value = program.value(x)
    proven = bound is not None and abs(value - bound) <= PROVEN * max(1.0, abs(value))
    status: Status = "optimal" if proven else "feasible"
    return Outcome(status, x, bound, nodes, proof="branch and bound", message=message)


def gap_of_larger(gap: float) -> float:
    """The gap to ask of a solver that divides by the larger of objective and bound.

    Ours is relative to the objective z alone. With ``d = |z - b|`` and ``|b| ≤ |z| + d``,
    ``d ≤ g/(1+g) max(|z|, |b|)`` gives ``d ≤ g |z|``.
    """
    return gap / (1.0 + gap)


def time_left(options: Options, began: float) -> Options:
    """`options` with what is left of the time limit since `began`, by `time.perf_counter`."""
    if options.time_limit is None:
        return options
    left = options.time_limit - (time.perf_counter() - began)
    return replace(options, time_limit=max(left, 0.0))


def unbounded_or_infeasible(
    run: Adapter, program: Program, options: Options, began: float
) -> Outcome:
    """Tell apart what a solver or an unbounded relaxation leaves open.

    Parameters
    ----------
    run : callable
        The solver's adapter.
    program : Program
        Known to be unbounded or infeasible, or to have an unbounded relaxation. With rational data an
        integer program with an unbounded relaxation and any point is unbounded too.
    options : Options
        As asked for.
    began : float
        `time.perf_counter` when the first attempt began: both share the time limit.
    """
    costless = replace(program, cost=np.zeros(program.n_columns))
    outcome = run(costless, replace(time_left(options, began), start=None))
    if outcome.status in ("optimal", "feasible"):
        return Outcome("unbounded", outcome.x, nodes=outcome.nodes, message="unbounded")
    if outcome.status == "infeasible":
        return outcome
    return Outcome(
        "no_solution", message="unbounded or infeasible, and stopped before it was known"
    )


def relaxation_first(run: Adapter) -> Adapter:
    """The adapter `run`, with the relaxation solved first where the program may be unbounded.

    On an unbounded mixed-integer program SCIP can go round in circles, Gurobi can call a point
    optimal, and COPT can stop at 1e30. Each is right on the relaxation. A program in which no column
    alone improves the objective without end is bounded, so that most go straight to `run`.
    """

    @wraps(run)
    def guarded(program: Program, options: Options) -> Outcome:
        began = time.perf_counter()
        if program.integer.any() and _may_be_unbounded(program):
            relaxation = run(program.relaxed(), replace(options, start=None, gap=None))
            if relaxation.status == "unbounded":
                return unbounded_or_infeasible(run, program, options, began)
            options = time_left(options, began)
        return run(program, options)

    return guarded


def _may_be_unbounded(program: Program) -> bool:
    cost = program.sign * program.cost
    endless = ((cost < 0) & np.isinf(program.upper)) | ((cost > 0) & np.isinf(program.lower))
    return bool(endless.any())
