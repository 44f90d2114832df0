"""SCIP: linear and mixed-integer programs, through pyscipopt. The second opinion."""

from __future__ import annotations

import time
from functools import cache
from typing import Any

import numpy as np

from ...interruption import until_interrupted
from ..program import Program
from .base import Options, Outcome, Solver
from .outcomes import incumbent, own_bound, relaxation_first, unbounded_or_infeasible


@relaxation_first
def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with SCIP, on one thread."""
    import pyscipopt

    began = time.perf_counter()
    model = pyscipopt.Model()
    _set_options(model, options)
    if not program.integer.any():
        # After its presolve SCIP can go round in circles on an unbounded program.
        model.setParam("presolving/maxrounds", 0)
    variables = _fill(pyscipopt, model, program)
    if options.start is not None:
        _give_start(model, variables, options.start)
    until_interrupted(model.optimizeNogil, model.interruptSolve)
    status = model.getStatus()
    if status in ("unbounded", "inforunbd"):
        return unbounded_or_infeasible(run, program, options, began)
    return _outcome(model, variables, program, status)


def _set_options(model: Any, options: Options) -> None:
    model.hideOutput(not options.verbose)
    model.setParam("misc/catchctrlc", False)
    if not options.presolve:
        model.setParam("presolving/maxrounds", 0)
    model.setParam("randomization/randomseedshift", options.seed or 0)
    model.setParam("limits/gap", options.gap or 0.0)
    # A partial start may leave open as many variables as it likes.
    model.setParam("heuristics/completesol/maxunknownrate", 1.0)
    if options.time_limit is not None:
        model.setParam("limits/time", min(options.time_limit, 1e20))


def _fill(pyscipopt: Any, model: Any, program: Program) -> list[Any]:
    """Give `model` the program, as a minimisation without offset; its variables in order."""
    cost = program.sign * program.cost
    variables = [
        model.addVar(
            vtype="I" if integer else "C",
            lb=lower if np.isfinite(lower) else None,
            ub=upper if np.isfinite(upper) else None,
            obj=weight,
        )
        for integer, lower, upper, weight in zip(
            program.integer.tolist(),
            program.lower.tolist(),
            program.upper.tolist(),
            cost.tolist(),
            strict=True,
        )
    ]
    matrix = program.matrix
    for i in range(program.n_rows):
        entries = slice(matrix.indptr[i], matrix.indptr[i + 1])
        terms = zip(matrix.indices[entries].tolist(), matrix.data[entries].tolist(), strict=True)
        expression = pyscipopt.Expr() + pyscipopt.quicksum(a * variables[j] for j, a in terms)
        lower, upper = float(program.row_lower[i]), float(program.row_upper[i])
        if np.isfinite(lower) and np.isfinite(upper):
            model.addCons(lower <= (expression <= upper))
        elif np.isfinite(lower):
            model.addCons(expression >= lower)
        elif np.isfinite(upper):
            model.addCons(expression <= upper)
    return variables


def _give_start(model: Any, variables: list[Any], start: Any) -> None:
    known = np.flatnonzero(np.isfinite(start))
    complete = len(known) == len(variables)
    solution = model.createSol() if complete else model.createPartialSol()
    for j in known:
        model.setSolVal(solution, variables[j], float(start[j]))
    model.addSol(solution)


def _outcome(model: Any, variables: list[Any], program: Program, status: str) -> Outcome:
    nodes = int(model.getNTotalNodes()) if program.integer.any() else None
    if status == "infeasible":
        return Outcome("infeasible", nodes=nodes, message=status)
    if status in ("unknown", "terminate"):
        return Outcome("error", message=f"SCIP: {status}")
    bound = own_bound(program, model.getDualbound())
    if model.getNSols() == 0:
        return Outcome("no_solution", None, bound, nodes, message=status)
    best = model.getBestSol()
    x = np.array([model.getSolVal(best, variable) for variable in variables], dtype=float)
    return incumbent(program, x, bound, nodes=nodes, message=status)


@cache
def version() -> str:
    """SCIP's own version; PySCIPOpt counts apart."""
    import pyscipopt

    scip = pyscipopt.Model()
    return f"{scip.getMajorVersion()}.{scip.getMinorVersion()}.{scip.getTechVersion()}"


SOLVER = Solver(
    name="scip",
    title="SCIP, branch cut and price",
    package="PySCIPOpt",
    module="pyscipopt",
    install="pip install 'msmrta_opt[solvers]'",
    abilities=frozenset(
        ["integer", "lp", "time_limit", "gap", "seed", "start", "verbose", "bound"]
    ),
    run=run,
    ask_version=version,
    tolerances={"feasibility": 1e-6, "integrality": 1e-6},
    rank=2,
)
