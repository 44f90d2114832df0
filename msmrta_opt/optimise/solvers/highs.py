"""HiGHS: linear and mixed-integer programs, through highspy on the program's arrays."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from threading import Lock
from typing import Any

import numpy as np

from ...arrays import Floats
from ...interruption import interrupted, until_interrupted
from ...mission.errors import SolverError
from ..program import Program
from .base import EVERY_ABILITY, Options, Outcome, Solver
from .outcomes import unbounded_or_infeasible

SMALL = 60
"""Columns and rows of an integer program up to which HiGHS goes without its presolve: it calls some
feasible ones infeasible, and is now and then caught in an endless loop, where it has little to gain."""
WITHOUT_JUMPS = ("mip_heuristic_run_feasibility_jump", False)
"""This heuristic crashes on some programs that have integers without bounds."""
PATIENCE = 0.5
"""Seconds that HiGHS has to end once the user asks for it."""
LEFT = "Interrupted, or beyond its time limit"
STRICTEST = 1e-10
"""The smallest tolerance for rows that HiGHS takes."""

_threads_in_use: int | None = None
_making = Lock()


def run(program: Program, options: Options) -> Outcome:
    """Solve `program` with HiGHS; a continuous one by the simplex method, so at a vertex."""
    try:
        import highspy
    except ImportError as error:
        # The libraries of OR-Tools, once loaded, keep those of highspy from being loaded.
        raise SolverError(f"HiGHS cannot be loaded in this process: {error}") from error
    began = time.perf_counter()
    program = program.with_whole_bounds()
    highs = new_highs()
    size = program.n_columns + program.n_rows
    set_options(highs, options, integer=bool(program.integer.any()), size=size)
    whole = program.integer
    if not np.isfinite([program.lower[whole], program.upper[whole]]).all():
        highs.setOptionValue(*WITHOUT_JUMPS)
    highs.passModel(model(highspy, program))
    if options.start is not None:
        known = np.flatnonzero(np.isfinite(options.start))
        highs.setSolution(len(known), known.astype(np.int32), options.start[known])
    if size > SMALL and whole.any():
        left = _searched(highs, program, options.time_limit)
        if left is not None:
            return left
    else:
        heed_interruption(highs)
        highs.run()
    if highs.getModelStatus() == highspy.HighsModelStatus.kUnboundedOrInfeasible:
        return unbounded_or_infeasible(run, program, options, began)
    return _outcome(highspy, highs, program)


def _searched(highs: Any, program: Program, limit: float | None) -> Outcome | None:
    """Run HiGHS' branch and bound; if it is to end and does not, what it has by then.

    It looks at nothing while a heuristic solves a part of the program, for half a minute at times, nor
    at the clock on its way back from a deep dive.
    """
    found = Outcome("no_solution", nodes=0, proof="branch and bound", message=LEFT)
    is_left = False

    def note(event: Any, **more: Any) -> None:
        nonlocal found
        data = event.data_out
        bound, nodes = _own_bound(program, data.mip_dual_bound), int(data.mip_node_count)
        found = replace(found, bound=bound, nodes=nodes, **more)

    def improving(event: Any) -> None:
        note(event, status="feasible", x=np.array(event.data_out.mip_solution))

    def look(event: Any) -> None:
        note(event)
        if interrupted() or is_left:
            event.interrupt()

    def end() -> None:
        nonlocal is_left
        is_left = True

    highs.cbMipImprovingSolution += improving
    highs.cbMipInterrupt += look
    late = None if limit is None else 1.05 * limit + PATIENCE
    return None if until_interrupted(highs.run, end, patience=PATIENCE, limit=late) else found


def new_highs() -> Any:
    """A HiGHS object.

    Some versions (1.16) print their name as they make one, before they can be told to be silent; so
    standard output leads nowhere meanwhile, below Python, where the library writes.
    """
    import highspy

    with _making:
        try:
            screen = os.dup(1)
        except OSError:  # closed: nothing can be printed
            return highspy.Highs()
        try:
            with open(os.devnull, "wb") as nowhere:
                os.dup2(nowhere.fileno(), 1)
            return highspy.Highs()
        finally:
            os.dup2(screen, 1)
            os.close(screen)


def heed_interruption(highs: Any) -> None:
    """Let HiGHS end, with the best that it has, once the user asks for it."""

    def look(event: Any) -> None:
        if interrupted():
            event.interrupt()

    highs.cbMipInterrupt += look
    highs.cbSimplexInterrupt += look


def infeasible_ray(program: Program, options: Options) -> Floats | None:
    """Multipliers of the rows that, by HiGHS, prove the relaxation of `program` infeasible, if it is."""
    import highspy

    highs = new_highs()
    set_options(highs, replace(options, gap=None), integer=False)
    highs.setOptionValue("presolve", "off")
    highs.setOptionValue("primal_feasibility_tolerance", STRICTEST)
    relaxed = program.relaxed()
    highs.passModel(model(highspy, replace(relaxed, cost=np.zeros(program.n_columns))))
    heed_interruption(highs)
    highs.run()
    if highs.getModelStatus() != highspy.HighsModelStatus.kInfeasible:
        return None
    _, found, ray = highs.getDualRay()
    return np.array(ray, dtype=float) if found else None


def set_options(highs: Any, options: Options, *, integer: bool, size: int = SMALL + 1) -> None:
    """Set the common options on a Highs object; defaults prove optimality on one thread."""
    # HiGHS has one scheduler per process; a new number of threads needs a new scheduler.
    global _threads_in_use
    threads = options.threads or 1
    if _threads_in_use not in (None, threads):
        highs.resetGlobalScheduler(True)
    _threads_in_use = threads
    values: dict[str, object] = {
        "output_flag": options.verbose,
        "threads": threads,
        "random_seed": options.seed or 0,
        # HiGHS stops at a relative gap of 1e-4 unless told otherwise.
        "mip_rel_gap": options.gap or 0.0,
        "mip_abs_gap": 0.0,
    }
    if not integer:
        values["solver"] = "simplex"
    elif options.presolve is False or size <= SMALL:
        values["presolve"] = "off"
    if options.time_limit is not None:
        values["time_limit"] = options.time_limit
    for name, value in values.items():
        highs.setOptionValue(name, value)


def model(highspy: Any, program: Program) -> Any:
    """The program as a minimisation: bounds of maximisations in HighsInfo have the other sign."""
    lp = highspy.HighsLp()
    lp.num_col_ = program.n_columns
    lp.num_row_ = program.n_rows
    lp.col_cost_ = program.sign * program.cost
    lp.offset_ = program.sign * program.offset  # a relative gap is measured with the constant
    lp.col_lower_ = program.lower
    lp.col_upper_ = program.upper
    lp.row_lower_ = program.row_lower
    lp.row_upper_ = program.row_upper
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = program.matrix.indptr
    lp.a_matrix_.index_ = program.matrix.indices
    lp.a_matrix_.value_ = program.matrix.data
    if program.integer.any():
        kinds = (highspy.HighsVarType.kContinuous, highspy.HighsVarType.kInteger)
        lp.integrality_ = [kinds[int(integer)] for integer in program.integer]
    return lp


def _outcome(highspy: Any, highs: Any, program: Program) -> Outcome:
    model_status = highs.getModelStatus()
    info = highs.getInfo()
    integer = bool(program.integer.any())
    # At a limit HiGHS reports a value and a point even where it has no feasible one.
    has_point = info.primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
    x = np.array(highs.getSolution().col_value) if has_point else None
    nodes = max(int(info.mip_node_count), 0) if integer else None
    name = highs.modelStatusToString(model_status)
    statuses = highspy.HighsModelStatus
    if model_status in (statuses.kOptimal, statuses.kModelEmpty):
        if x is None:
            x = np.zeros(program.n_columns)
        if not integer:
            duals = np.array(highs.getSolution().row_dual)
            return Outcome("optimal", x, duals=duals, proof="LP duality", message=name)
        bound = _own_bound(program, info.mip_dual_bound)
        return Outcome("optimal", x, bound, nodes, proof="branch and bound", message=name)
    if model_status == statuses.kInfeasible:
        return Outcome("infeasible", nodes=nodes, message=name)
    if model_status == statuses.kUnbounded:
        return Outcome("unbounded", x, nodes=nodes, message=name)
    stopped = (
        statuses.kTimeLimit,
        statuses.kInterrupt,
        statuses.kSolutionLimit,
        statuses.kIterationLimit,
        statuses.kObjectiveBound,
        statuses.kObjectiveTarget,
        statuses.kHighsInterrupt,
        statuses.kMemoryLimit,
    )
    if model_status in stopped:
        bound = _own_bound(program, info.mip_dual_bound) if integer else None
        return Outcome(
            "no_solution" if x is None else "feasible",
            x,
            bound,
            nodes,
            proof="branch and bound",
            message=name,
        )
    return Outcome("error", message=f"HiGHS: {name}")


def _own_bound(program: Program, bound: float) -> float | None:
    return program.sign * bound if np.isfinite(bound) else None


SOLVER = Solver(
    name="highs",
    title="HiGHS, simplex and branch and bound",
    package="highspy",
    module="highspy",
    install="pip install highspy",
    abilities=EVERY_ABILITY,
    run=run,
    tolerances={"feasibility": 1e-7, "integrality": 1e-6},
    rank=1,
)
