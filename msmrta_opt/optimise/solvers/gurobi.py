"""Gurobi: linear and mixed-integer programs, through gurobipy.

The licence inside its wheel suffices for programs of up to 2000 variables and rows.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from ...arrays import Bools
from ...mission.errors import SolverError
from ..program import Program
from .base import EVERY_ABILITY, Options, Outcome, Solver
from .outcomes import incumbent, own_bound, relaxation_first, unbounded_or_infeasible

MAX_SEEDS = 2_000_000_000
"""Gurobi has no more."""


@relaxation_first
def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with Gurobi.

    Raises
    ------
    SolverError
        With Gurobi's own words, for instance about its licence.
    """
    import gurobipy

    began = time.perf_counter()
    try:
        with (
            gurobipy.Env(params={"OutputFlag": int(options.verbose)}) as environment,
            gurobipy.Model(env=environment) as model,
        ):
            _set_options(model, options)
            x, rows = _fill(gurobipy, model, program)
            if options.start is not None:
                x.Start = np.where(
                    np.isfinite(options.start), options.start, gurobipy.GRB.UNDEFINED
                )
            model.optimize()
            grb = gurobipy.GRB
            if model.Status not in (grb.INF_OR_UNBD, grb.UNBOUNDED):
                return _outcome(grb, model, x, rows, program)
    except gurobipy.GurobiError as error:
        raise SolverError(f"Gurobi: {error}") from error
    # Gurobi calls a program unbounded for a ray alone, feasible or not.
    return unbounded_or_infeasible(run, program, options, began)


def _set_options(model: Any, options: Options) -> None:
    model.Params.Threads = options.threads or 1
    model.Params.Seed = (options.seed or 0) % MAX_SEEDS
    model.Params.MIPGap = options.gap or 0.0
    model.Params.MIPGapAbs = 0.0
    if options.time_limit is not None:
        model.Params.TimeLimit = options.time_limit


def _fill(gurobipy: Any, model: Any, program: Program) -> tuple[Any, list[tuple[Bools, Any]]]:
    """Give `model` the program, as a minimisation without offset; its variables and rows."""
    x = model.addMVar(
        program.n_columns,
        lb=program.lower,
        ub=program.upper,
        obj=program.sign * program.cost,
        vtype=np.where(program.integer, "I", "C"),
    )
    # Equations as such; what else is ranged is a pair of rows.
    added = []
    same = program.row_lower == program.row_upper
    for rows, sense, side in (
        (same, "=", program.row_lower),
        (~same & np.isfinite(program.row_lower), ">", program.row_lower),
        (~same & np.isfinite(program.row_upper), "<", program.row_upper),
    ):
        if rows.any():
            added.append((rows, model.addMConstr(program.matrix[rows], x, sense, side[rows])))
    return x, added


def _outcome(
    grb: Any, model: Any, x: Any, rows: list[tuple[Bools, Any]], program: Program
) -> Outcome:
    integer = bool(program.integer.any())
    nodes = int(model.NodeCount) if integer else None
    name = {getattr(grb.Status, name): name for name in dir(grb.Status) if name.isupper()}.get(
        model.Status, str(model.Status)
    )
    if model.Status == grb.INFEASIBLE:
        return Outcome("infeasible", nodes=nodes, message=name)
    if model.Status == grb.NUMERIC:
        return Outcome("error", message="Gurobi: NUMERIC")
    if not integer:  # before it is optimal, a point of the simplex method need not be feasible
        if model.Status != grb.OPTIMAL:
            return Outcome("no_solution", message=name)
        duals = np.zeros(program.n_rows)
        for where, constraints in rows:
            duals[where] += constraints.Pi
        return Outcome("optimal", x.X, duals=duals, proof="LP duality", message=name)
    bound = own_bound(program, model.ObjBound)
    if model.SolCount == 0:
        return Outcome("no_solution", None, bound, nodes, message=name)
    return incumbent(program, x.X, bound, nodes=nodes, message=name)


SOLVER = Solver(
    name="gurobi",
    title="Gurobi, simplex and branch and cut (commercial)",
    package="gurobipy",
    module="gurobipy",
    install="pip install gurobipy",
    abilities=EVERY_ABILITY,
    run=run,
    rank=11,
)
