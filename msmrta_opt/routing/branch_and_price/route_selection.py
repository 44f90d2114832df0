"""Whole routes chosen among given paths, by the integer program over paths."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import highspy
import numpy as np

from ..problem import Routes
from ..run_highs import run_highs
from ..stop import StoppingCriterion
from .path_program import Path, PathProgram, routes_of

_NONE = (
    highspy.HighsModelStatus.kInfeasible,
    highspy.HighsModelStatus.kObjectiveBound,
    highspy.HighsModelStatus.kUnboundedOrInfeasible,
)
"""Statuses that say that no choice costs as little as the cutoff."""


@dataclass(frozen=True, eq=False)
class Selection:
    """An outcome of the integer program."""

    routes: Routes | None
    """The best found, if any was."""
    bound: float
    """No choice of the paths costs less, but for those that the cutoff excludes."""


def select_routes(
    program: PathProgram,
    paths: list[Path],
    stop: StoppingCriterion,
    cutoff: float,
    proved: Callable[[float], object] | None = None,
) -> Selection:
    """The cheapest choice of `paths` that serves every task.

    Parameters
    ----------
    program : PathProgram
        With no path yet, and without artificial variables.
    paths : list of Path
        To choose from.
    stop : StoppingCriterion
        When to end.
    cutoff : float
        Choices that cost more than this are of no interest.
    proved : callable, optional
        Told the bound now and then. With it, infeasibility is asked for again without presolve,
        which is known to find some feasible programs infeasible.
    """
    highs = program.highs
    program.add(paths)
    columns = np.arange(program.first_path, program.first_path + len(paths), dtype=np.int32)
    integer = np.full(len(paths), highspy.HighsVarType.kInteger)
    highs.changeColsIntegrality(len(columns), columns, integer)
    highs.setOptionValue("mip_rel_gap", 0.0)
    highs.setOptionValue("mip_abs_gap", 1e-6)
    if math.isfinite(cutoff):
        highs.setOptionValue("objective_bound", cutoff)
    run_highs(highs, stop, proved or (lambda bound: None))
    if proved is not None and highs.getModelStatus() in _NONE:
        highs.setOptionValue("presolve", "off")
        highs.clearSolver()
        run_highs(highs, stop, proved)
    if highs.getModelStatus() in _NONE:
        return Selection(None, math.inf)
    info = highs.getInfo()
    bound = float(info.mip_dual_bound)
    if info.primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible:
        return Selection(None, bound)
    x = np.array(highs.getSolution().col_value)[columns]
    chosen = (paths[p] for p in np.flatnonzero(x > 0.5))
    return Selection(routes_of(program.data, program.tasks, chosen), bound)
