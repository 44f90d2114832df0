"""COPT: linear and mixed-integer programs, through coptpy.

Without a licence it solves programs of up to 2000 variables and rows.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from ...mission.errors import SolverError
from ..program import Program
from .base import Options, Outcome, Solver
from .outcomes import gap_of_larger, incumbent, own_bound, relaxation_first, unbounded_or_infeasible


@relaxation_first
def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with COPT.

    Raises
    ------
    SolverError
        With COPT's own words, for instance about its licence.
    """
    import coptpy

    began = time.perf_counter()
    try:
        configuration = coptpy.EnvrConfig()
        configuration.set("nobanner", "0" if options.verbose else "1")
        model = coptpy.Envr(configuration).createModel()
        _set_options(model, options)
        _fill(coptpy.COPT, model, program)
        if options.start is not None:
            variables = model.getVars().getAll()
            for j in np.flatnonzero(np.isfinite(options.start)):
                model.setMipStart(variables[j], float(options.start[j]))
            model.loadMipStart()
        model.solve()
        if model.status not in (coptpy.COPT.UNBOUNDED, coptpy.COPT.INF_OR_UNB):
            return _outcome(coptpy.COPT, model, program)
    except coptpy.CoptError as error:
        raise SolverError(f"COPT: {error}") from error
    return unbounded_or_infeasible(run, program, options, began)


def _set_options(model: Any, options: Options) -> None:
    model.setParam("Logging", int(options.verbose))
    model.setParam("Threads", options.threads or 1)
    model.setParam("RelGap", min(gap_of_larger(options.gap or 0.0), 1.0))
    model.setParam("AbsGap", 0.0)
    if options.time_limit is not None:
        model.setParam("TimeLimit", min(options.time_limit, 1e20))


def _fill(copt: Any, model: Any, program: Program) -> None:
    """Give `model` the program, as a minimisation without offset."""
    infinity = copt.INFINITY
    sides = [
        np.clip(side, -infinity, infinity)
        for side in (program.row_lower, program.row_upper, program.lower, program.upper)
    ]
    kinds = np.where(program.integer, copt.INTEGER, copt.CONTINUOUS)
    model.loadMatrix(program.sign * program.cost, program.matrix.tocsc(), *sides, kinds)


def _outcome(copt: Any, model: Any, program: Program) -> Outcome:
    name = f"COPT status {model.status}"
    integer = bool(program.integer.any())
    nodes = int(model.nodecnt) if integer else None
    if model.status == copt.INFEASIBLE:
        return Outcome("infeasible", nodes=nodes, message="infeasible")
    if model.status in (copt.NUMERICAL, copt.IMPRECISE):
        return Outcome("error", message=f"{name}: numerical trouble")
    if not integer:  # before it is optimal, a point of the simplex method need not be feasible
        if model.status != copt.OPTIMAL:
            return Outcome("no_solution", message=name)
        x, duals = np.array(model.getValues()), np.array(model.getDuals())
        return Outcome("optimal", x, duals=duals, proof="LP duality", message="optimal")
    bound = own_bound(program, model.bestbnd)
    if not model.hasmipsol:
        return Outcome("no_solution", None, bound, nodes, message=name)
    return incumbent(program, np.array(model.getValues()), bound, nodes=nodes, message=name)


SOLVER = Solver(
    name="copt",
    title="COPT, simplex and branch and cut (commercial)",
    package="coptpy",
    module="coptpy",
    install="pip install coptpy",
    abilities=frozenset(
        ["integer", "lp", "time_limit", "gap", "threads", "start", "verbose", "bound", "duals"]
    ),
    run=run,
    rank=14,
)
