"""GLPK: linear and mixed-integer programs, through swiglpk.

A small classical branch and cut, for an opinion that shares no code with the others. It counts no
nodes and forgets its bound when it stops, so the bound is that of the root relaxation, or what the
gap reached implies.
"""

from __future__ import annotations

import time
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ...arrays import Floats
from ..program import Program
from .apart import run_apart
from .base import Options, Outcome, Solver
from .outcomes import incumbent, own_bound, time_left, unbounded_or_infeasible

LONGEST = 2**31 - 1
"""Milliseconds that stand for no limit."""


def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with GLPK, in a process of its own: GLPK ends its process on an error.

    It cannot be asked to end. So it writes down each incumbent, which remains if its process is killed.
    """
    with TemporaryDirectory() as folder:
        saved = Path(folder) / "incumbent"
        outcome = run_apart(partial(_solve, saved=str(saved)), program, options)
        if outcome.x is None and outcome.status == "no_solution" and saved.exists():
            x = _written(saved.read_text(), program.n_columns)
            if x is not None:
                return Outcome(
                    "feasible", x, message="interrupted: the incumbent that it wrote last"
                )
    return outcome


def _written(text: str, n: int) -> Floats | None:
    """The point in GLPK's file of a solution, ``None`` where that is not whole."""
    lines = [line.split() for line in text.splitlines()]
    values = [float(words[2]) for words in lines if words[:1] == ["j"] and len(words) == 3]
    return np.array(values) if lines[-1:] == [["e", "o", "f"]] and len(values) == n else None


def _solve(program: Program, options: Options, saved: str = "") -> Outcome:
    """The relaxation by the simplex method, then branch and cut, each incumbent written to `saved`."""
    import swiglpk as glp

    began = time.perf_counter()
    program = program.with_whole_bounds()  # GLPK refuses others
    glp.glp_term_out(glp.GLP_ON if options.verbose else glp.GLP_OFF)
    problem = glp.glp_create_prob()
    try:
        _fill(glp, problem, program)
        parameters = glp.glp_smcp()
        glp.glp_init_smcp(parameters)
        parameters.tm_lim = _milliseconds(options, began)
        glp.glp_adv_basis(problem, 0)
        code = glp.glp_simplex(problem, parameters)
        status = glp.glp_get_status(problem)
        if code == glp.GLP_EBOUND:
            return Outcome("infeasible", message="a column or row has its bounds crossed")
        if code == 0 and status == glp.GLP_NOFEAS:
            return Outcome("infeasible", message="the relaxation is infeasible")
        if code == 0 and status == glp.GLP_UNBND:
            if program.integer.any():
                return unbounded_or_infeasible(_solve, program, options, began)
            return Outcome("unbounded", message="unbounded")
        if code == glp.GLP_ETMLIM:
            return Outcome("no_solution", message="time limit")
        if code != 0 or status != glp.GLP_OPT:
            return Outcome("error", message=f"GLPK: simplex ends with code {code}, status {status}")
        if not program.integer.any():
            return _of_relaxation(glp, problem, program)
        return _integer(glp, problem, program, options, began, saved)
    finally:
        glp.glp_delete_prob(problem)


def _milliseconds(options: Options, began: float) -> int:
    if options.time_limit is None:
        return LONGEST
    left = time_left(options, began).time_limit or 0.0
    return int(min(left * 1000, LONGEST))


def _fill(glp: Any, problem: Any, program: Program) -> None:
    """Give `problem` the program, as a minimisation without offset. GLPK counts from 1."""
    glp.glp_set_obj_dir(problem, glp.GLP_MIN)
    glp.glp_add_cols(problem, program.n_columns)
    cost = program.sign * program.cost
    for j in range(program.n_columns):
        bounds = _bounds(glp, program.lower[j], program.upper[j])
        glp.glp_set_col_bnds(problem, j + 1, *bounds)
        glp.glp_set_obj_coef(problem, j + 1, float(cost[j]))
        if program.integer[j]:
            glp.glp_set_col_kind(problem, j + 1, glp.GLP_IV)
    if program.n_rows == 0:
        return
    glp.glp_add_rows(problem, program.n_rows)
    for i in range(program.n_rows):
        bounds = _bounds(glp, program.row_lower[i], program.row_upper[i])
        glp.glp_set_row_bnds(problem, i + 1, *bounds)
    matrix = program.matrix.tocoo()
    rows, columns = glp.intArray(matrix.nnz + 1), glp.intArray(matrix.nnz + 1)
    values = glp.doubleArray(matrix.nnz + 1)
    entries = zip(*(part.tolist() for part in (*matrix.coords, matrix.data)), strict=True)
    for k, (i, j, value) in enumerate(entries, start=1):
        rows[k], columns[k], values[k] = i + 1, j + 1, value
    glp.glp_load_matrix(problem, matrix.nnz, rows, columns, values)


def _bounds(glp: Any, lower: float, upper: float) -> tuple[int, float, float]:
    low, high = np.isfinite(lower), np.isfinite(upper)
    if low and high:
        kind = glp.GLP_FX if lower == upper else glp.GLP_DB
    elif low or high:
        kind = glp.GLP_LO if low else glp.GLP_UP
    else:
        kind = glp.GLP_FR
    return kind, float(lower) if low else 0.0, float(upper) if high else 0.0


def _of_relaxation(glp: Any, problem: Any, program: Program) -> Outcome:
    x = [glp.glp_get_col_prim(problem, j + 1) for j in range(program.n_columns)]
    duals = [glp.glp_get_row_dual(problem, i + 1) for i in range(program.n_rows)]
    return Outcome(
        "optimal", np.array(x), duals=np.array(duals), proof="LP duality", message="optimal"
    )


def _integer(
    glp: Any, problem: Any, program: Program, options: Options, began: float, saved: str
) -> Outcome:
    root = glp.glp_get_obj_val(problem)
    gap = options.gap or 0.0
    parameters = glp.glp_iocp()
    glp.glp_init_iocp(parameters)
    # Without GLPK's integer presolver: it loses rows and reports points that violate them.
    parameters.gmi_cuts = parameters.mir_cuts = glp.GLP_ON
    parameters.cov_cuts = parameters.clq_cuts = glp.GLP_ON
    # Its own 1e-5 and 1e-7 show in the objective.
    parameters.tol_int, parameters.tol_obj = 1e-7, 1e-10
    parameters.mip_gap = gap
    parameters.tm_lim = _milliseconds(options, began)
    if saved:
        parameters.save_sol = saved
    code = glp.glp_intopt(problem, parameters)
    status = glp.glp_mip_status(problem)
    if code == glp.GLP_ENOPFS or (code == 0 and status == glp.GLP_NOFEAS):
        return Outcome("infeasible", message="no integer point")
    stopped = {glp.GLP_ETMLIM: "time limit", glp.GLP_EMIPGAP: "gap reached", 0: "optimal"}
    if code not in stopped:
        return Outcome("error", message=f"GLPK: branch and cut ends with code {code}")
    if status not in (glp.GLP_OPT, glp.GLP_FEAS):
        bound = own_bound(program, root)
        return Outcome("no_solution", None, bound, message=stopped[code])
    x = np.array([glp.glp_mip_col_val(problem, j + 1) for j in range(program.n_columns)])
    value = glp.glp_mip_obj_val(problem)
    minimum = root
    if code == 0:
        minimum = value
    elif code == glp.GLP_EMIPGAP:
        minimum = max(root, value - gap * abs(value))
    return incumbent(program, x, own_bound(program, minimum), message=stopped[code])


def version() -> str:
    """GLPK's own version; swiglpk counts apart."""
    import swiglpk

    return str(swiglpk.glp_version())


SOLVER = Solver(
    name="glpk",
    title="GLPK, simplex and branch and cut",
    package="swiglpk",
    module="swiglpk",
    install="pip install 'msmrta_opt[solvers]'",
    abilities=frozenset(["integer", "lp", "time_limit", "gap", "verbose", "bound", "duals"]),
    run=run,
    ask_version=version,
    tolerances={"feasibility": 1e-7, "integrality": 1e-7},
    rank=4,
)
