"""MOSEK: linear and mixed-integer programs, through its Optimizer API.

It does nothing without a licence, so it counts as installed only where a licence can be found.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Floats
from ...mission.errors import SolverError
from ..program import Program
from .base import Options, Outcome, Solver
from .outcomes import gap_of_larger, incumbent, own_bound, relaxation_first, unbounded_or_infeasible


@relaxation_first
def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with MOSEK; a continuous one by the simplex method, so at a vertex.

    Raises
    ------
    SolverError
        With MOSEK's own words, for instance about its licence.
    """
    import mosek

    began = time.perf_counter()
    kind = mosek.soltype.itg if program.integer.any() else mosek.soltype.bas
    try:
        with mosek.Task() as task:
            _set_options(mosek, task, options)
            _fill(mosek, task, program)
            task.optimize()
            unsure = (
                mosek.prosta.dual_infeas,
                mosek.prosta.prim_and_dual_infeas,
                mosek.prosta.prim_infeas_or_unbounded,
            )
            if not task.solutiondef(kind) or task.getprosta(kind) not in unsure:
                return _outcome(mosek, task, kind, program)
    except mosek.Error as error:
        raise SolverError(f"MOSEK: {error}") from error
    return unbounded_or_infeasible(run, program, options, began)


def _set_options(mosek: Any, task: Any, options: Options) -> None:
    if options.verbose:
        task.set_Stream(mosek.streamtype.log, sys.stdout.write)
    task.putintparam(mosek.iparam.optimizer, mosek.optimizertype.free_simplex)
    task.putintparam(mosek.iparam.num_threads, options.threads or 1)
    task.putintparam(mosek.iparam.mio_seed, options.seed or 0)
    task.putdouparam(mosek.dparam.mio_tol_rel_gap, gap_of_larger(options.gap or 0.0))
    task.putdouparam(mosek.dparam.mio_tol_abs_gap, 0.0)
    if options.time_limit is not None:
        task.putdouparam(mosek.dparam.optimizer_max_time, options.time_limit)
        task.putdouparam(mosek.dparam.mio_max_time, options.time_limit)


def _fill(mosek: Any, task: Any, program: Program) -> None:
    """Give `task` the program, as a minimisation without offset."""
    columns, rows = program.n_columns, program.n_rows
    task.appendvars(columns)
    task.appendcons(rows)
    task.putobjsense(mosek.objsense.minimize)
    task.putcslice(0, columns, (program.sign * program.cost).tolist())
    task.putvarboundslice(0, columns, *_bounds(mosek, program.lower, program.upper))
    whole = np.flatnonzero(program.integer).tolist()
    task.putvartypelist(whole, [mosek.variabletype.type_int] * len(whole))
    if rows:
        task.putconboundslice(0, rows, *_bounds(mosek, program.row_lower, program.row_upper))
        matrix = program.matrix
        starts, ends = matrix.indptr[:-1].tolist(), matrix.indptr[1:].tolist()
        task.putarowslice(0, rows, starts, ends, matrix.indices.tolist(), matrix.data.tolist())


def _bounds(mosek: Any, lower: Floats, upper: Floats) -> tuple[list[Any], list[float], list[float]]:
    key = mosek.boundkey
    low, high = np.isfinite(lower), np.isfinite(upper)
    names = np.select([lower == upper, low & high, low, high], ["fx", "ra", "lo", "up"], "fr")
    values = np.where(low, lower, 0.0).tolist(), np.where(high, upper, 0.0).tolist()
    return [getattr(key, name) for name in names], *values


def _outcome(mosek: Any, task: Any, kind: Any, program: Program) -> Outcome:
    if not task.solutiondef(kind):
        return Outcome("no_solution", message="stopped before there was any solution")
    integer = bool(program.integer.any())
    status, known = task.getsolsta(kind), mosek.solsta
    message = str(status)
    nodes = int(task.getintinf(mosek.iinfitem.mio_num_branch)) if integer else None
    if task.getprosta(kind) == mosek.prosta.prim_infeas:
        return Outcome("infeasible", nodes=nodes, message=message)
    if not integer:
        if status != known.optimal:
            return Outcome("no_solution", message=message)
        x, duals = np.array(task.getxx(kind)), np.array(task.gety(kind))
        return Outcome("optimal", x, duals=duals, proof="LP duality", message=message)
    bound = None
    if task.getintinf(mosek.iinfitem.mio_obj_bound_defined):
        bound = own_bound(program, task.getdouinf(mosek.dinfitem.mio_obj_bound))
    if status not in (known.integer_optimal, known.prim_feas):
        return Outcome("no_solution", None, bound, nodes, message=message)
    return incumbent(program, np.array(task.getxx(kind)), bound, nodes=nodes, message=message)


def _licensed() -> bool:
    """Whether a licence is where MOSEK looks for one; nothing is imported."""
    places = os.environ.get("MOSEKLM_LICENSE_FILE", str(Path.home() / "mosek" / "mosek.lic"))
    # A place with an @ is a licence server.
    return any("@" in place or Path(place).exists() for place in places.split(os.pathsep))


SOLVER = Solver(
    name="mosek",
    title="MOSEK, simplex and branch and cut (commercial)",
    package="Mosek",
    module="mosek",
    install="pip install Mosek, and put its licence at ~/mosek/mosek.lic",
    abilities=frozenset(
        ["integer", "lp", "time_limit", "gap", "seed", "threads", "verbose", "bound", "duals"]
    ),
    run=run,
    rank=15,
    available=_licensed,
)
