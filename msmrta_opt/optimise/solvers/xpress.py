"""Xpress: linear and mixed-integer programs, through its Python API (9.8 or later).

The community licence inside its wheel suffices for small programs.
"""

from __future__ import annotations

import time
import warnings
from typing import Any

import numpy as np

from ...mission.errors import SolverError
from ..program import Program
from .base import EVERY_ABILITY, Options, Outcome, Solver
from .outcomes import gap_of_larger, incumbent, own_bound, relaxation_first, unbounded_or_infeasible


@relaxation_first
def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with Xpress.

    Raises
    ------
    SolverError
        With Xpress' own words, for instance about its licence.
    """
    import xpress

    began = time.perf_counter()
    try:
        with warnings.catch_warnings(), _problem(xpress) as problem:
            _set_options(problem, options)
            _fill(xpress, problem, program)
            if options.start is not None and np.isfinite(options.start).any():
                known = np.flatnonzero(np.isfinite(options.start))
                problem.addMipSol(options.start[known].tolist(), known.tolist(), "start")
            problem.optimize()
            if problem.attributes.solstatus != xpress.SolStatus.UNBOUNDED:
                return _outcome(xpress, problem, program)
    except (xpress.SolverError, xpress.ModelError, xpress.InterfaceError) as error:
        raise SolverError(f"Xpress: {error}") from error
    return unbounded_or_infeasible(run, program, options, began)


def _problem(xpress: Any) -> Any:
    warnings.simplefilter("ignore")  # that the community licence is in use
    return xpress.problem()


def _set_options(problem: Any, options: Options) -> None:
    controls = problem.controls
    controls.outputlog = int(options.verbose)
    controls.threads = options.threads or 1
    controls.randomseed = options.seed or 0
    controls.miprelstop = gap_of_larger(options.gap or 0.0)
    controls.mipabsstop = 0.0
    # By default Xpress gives up points that are better by less than one in ten thousand.
    controls.miprelcutoff = controls.mipaddcutoff = 0.0
    if options.time_limit is not None:
        controls.timelimit = min(options.time_limit, 1e20)


def _fill(xpress: Any, problem: Any, program: Program) -> None:
    """Give `problem` the program, as a minimisation without offset."""
    infinity = xpress.infinity
    low, high = np.isfinite(program.row_lower), np.isfinite(program.row_upper)
    same = program.row_lower == program.row_upper
    kinds = np.select([same, low & high, low, high], ["E", "R", "G", "L"], "N")
    right = np.select([high, low], [program.row_upper, program.row_lower], 0.0)
    width = np.where(low & high, right - np.where(low, program.row_lower, 0.0), 0.0)
    matrix = program.matrix.tocsc()
    whole = np.flatnonzero(program.integer).tolist()
    problem.loadMIP(
        rowtype=kinds.tolist(),
        rhs=right.tolist(),
        rng=width.tolist(),
        objcoef=(program.sign * program.cost).tolist(),
        start=matrix.indptr.tolist(),
        rowind=matrix.indices.tolist(),
        rowcoef=matrix.data.tolist(),
        lb=np.clip(program.lower, -infinity, infinity).tolist(),
        ub=np.clip(program.upper, -infinity, infinity).tolist(),
        coltype=["I"] * len(whole),
        entind=whole,
    )


def _outcome(xpress: Any, problem: Any, program: Program) -> Outcome:
    found, statuses = problem.attributes.solstatus, xpress.SolStatus
    name = f"{problem.attributes.solvestatus.name}, {found.name}"
    integer = bool(program.integer.any())
    nodes = int(problem.attributes.nodes) if integer else None
    if found == statuses.INFEASIBLE:
        return Outcome("infeasible", nodes=nodes, message=name)
    if problem.attributes.solvestatus == xpress.SolveStatus.FAILED:
        return Outcome("error", message=f"Xpress: {name}")
    if not integer:  # before it is optimal, a point of the simplex method need not be feasible
        if found != statuses.OPTIMAL:
            return Outcome("no_solution", message=name)
        x = np.array(problem.getSolution())
        duals = np.array(problem.getDuals() if program.n_rows else [])
        return Outcome("optimal", x, duals=duals, proof="LP duality", message=name)
    # Before the root relaxation is solved, Xpress reports 0.
    bound = None
    if problem.attributes.mipstatus not in (
        xpress.MIPStatus.NOT_LOADED,
        xpress.MIPStatus.LP_NOT_OPTIMAL,
    ):
        bound = own_bound(program, problem.attributes.bestbound)
    if found not in (statuses.OPTIMAL, statuses.FEASIBLE):
        return Outcome("no_solution", None, bound, nodes, message=name)
    return incumbent(program, np.array(problem.getSolution()), bound, nodes=nodes, message=name)


SOLVER = Solver(
    name="xpress",
    title="Xpress, simplex and branch and cut (commercial)",
    package="xpress",
    module="xpress",
    install="pip install xpress",
    abilities=EVERY_ABILITY,
    run=run,
    rank=13,
)
