"""CPLEX: linear and mixed-integer programs, through its Python API.

The edition inside the wheel suffices for programs of up to 1000 variables and rows.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from ...mission.errors import SolverError
from ..program import Program
from .base import EVERY_ABILITY, Options, Outcome, Solver
from .outcomes import incumbent, own_bound, relaxation_first, unbounded_or_infeasible

MAX_SEEDS = 2_100_000_000
"""CPLEX has no more."""


@relaxation_first
def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with CPLEX.

    Raises
    ------
    SolverError
        With CPLEX' own words, for instance about its licence.
    """
    import cplex

    began = time.perf_counter()
    try:
        with cplex.Cplex() as model:
            _set_options(model, options)
            _fill(cplex, model, program)
            if options.start is not None:
                known = np.flatnonzero(np.isfinite(options.start))
                model.MIP_starts.add(
                    [known.tolist(), options.start[known].tolist()],
                    model.MIP_starts.effort_level.auto,
                )
            model.solve()
            statuses = model.solution.status
            unsure = (
                statuses.unbounded,
                statuses.MIP_unbounded,
                statuses.infeasible_or_unbounded,
                statuses.MIP_infeasible_or_unbounded,
            )
            if model.solution.get_status() not in unsure:
                return _outcome(model, program)
    except cplex.exceptions.CplexError as error:
        raise SolverError(f"CPLEX: {error}") from error
    # CPLEX calls a program unbounded for a ray alone, feasible or not.
    return unbounded_or_infeasible(run, program, options, began)


def _set_options(model: Any, options: Options) -> None:
    if not options.verbose:
        for stream in ("results", "warning", "error", "log"):
            getattr(model, f"set_{stream}_stream")(None)
    model.parameters.threads.set(options.threads or 1)
    model.parameters.randomseed.set((options.seed or 0) % MAX_SEEDS)
    model.parameters.mip.tolerances.mipgap.set(min(options.gap or 0.0, 1.0))
    model.parameters.mip.tolerances.absmipgap.set(0.0)
    if options.time_limit is not None:
        model.parameters.timelimit.set(min(options.time_limit, 1e75))


def _fill(cplex: Any, model: Any, program: Program) -> None:
    """Give `model` the program, as a minimisation without offset."""
    maximum = cplex.infinity
    model.variables.add(
        obj=(program.sign * program.cost).tolist(),
        lb=np.maximum(program.lower, -maximum).tolist(),
        ub=np.minimum(program.upper, maximum).tolist(),
        # Types make a mixed-integer program even of a continuous one.
        types="".join(np.where(program.integer, "I", "C")) if program.integer.any() else "",
    )
    low, high = np.isfinite(program.row_lower), np.isfinite(program.row_upper)
    same = program.row_lower == program.row_upper
    senses = np.select([same, low & high, low], ["E", "R", "G"], "L")
    width = np.where(low & high, program.row_upper, 0.0) - np.where(
        low & high, program.row_lower, 0
    )
    matrix = program.matrix
    model.linear_constraints.add(
        lin_expr=[
            [matrix.indices[a:b].tolist(), matrix.data[a:b].tolist()]
            for a, b in zip(matrix.indptr[:-1], matrix.indptr[1:], strict=True)
        ],
        senses="".join(senses),
        rhs=np.where(low, program.row_lower, np.minimum(program.row_upper, maximum)).tolist(),
        range_values=width.tolist(),
    )


def _outcome(model: Any, program: Program) -> Outcome:
    solution, statuses = model.solution, model.solution.status
    status, name = solution.get_status(), solution.get_status_string()
    integer = bool(program.integer.any())
    nodes = int(solution.progress.get_num_nodes_processed()) if integer else None
    if status in (statuses.infeasible, statuses.MIP_infeasible):
        return Outcome("infeasible", nodes=nodes, message=name)
    if not integer:  # before it is optimal, a point of the simplex method need not be feasible
        if status != statuses.optimal:
            return Outcome("no_solution", message=name)
        x, duals = np.array(solution.get_values()), np.array(solution.get_dual_values())
        return Outcome("optimal", x, duals=duals, proof="LP duality", message=name)
    bound = own_bound(program, solution.MIP.get_best_objective())
    if not solution.is_primal_feasible():
        return Outcome("no_solution", None, bound, nodes, message=name)
    return incumbent(program, np.array(solution.get_values()), bound, nodes=nodes, message=name)


SOLVER = Solver(
    name="cplex",
    title="CPLEX, simplex and branch and cut (commercial)",
    package="cplex",
    module="cplex",
    install="pip install cplex",
    abilities=EVERY_ABILITY,
    run=run,
    rank=12,
)
