r"""Branch and cut where SCIP is not installed: HiGHS solves, cuts are added, HiGHS solves again.

HiGHS takes no cuts while it branches. So the integer program is solved with the cuts known, its
solution's violated cuts are added, and so on until the solution is connected. Each of these programs
is a relaxation, so each of their bounds holds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import highspy
import numpy as np

from ..objective_step import objective_step
from ..parameters import BranchAndCutParameters
from ..problem import Routes
from ..run_highs import quiet_highs, run_highs
from ..stop import StoppingCriterion
from .points import point_supports, routes_of
from .separation import Cut, separate
from .subproblem import Subproblem, Tree, TreeError

_FAILED = (
    highspy.HighsModelStatus.kLoadError,
    highspy.HighsModelStatus.kModelError,
    highspy.HighsModelStatus.kPresolveError,
    highspy.HighsModelStatus.kSolveError,
    highspy.HighsModelStatus.kPostsolveError,
)
_NOTHING_BETTER = (
    highspy.HighsModelStatus.kInfeasible,
    highspy.HighsModelStatus.kObjectiveBound,
    highspy.HighsModelStatus.kUnboundedOrInfeasible,
)


def search_by_highs(
    problem: Subproblem,
    *,
    stop: StoppingCriterion,
    seed: int,
    parameters: BranchAndCutParameters,
    improved: Callable[[Routes], object],
    proved: Callable[[float], object],
) -> Tree:
    """As `tree.search_tree`, by HiGHS.

    Raises
    ------
    TreeError
        If HiGHS fails.
    """
    del parameters
    formulation, known = problem.formulation, problem.known
    step = objective_step(formulation.data, formulation.objective)
    cuts = list(problem.cuts)
    used = np.flatnonzero(problem.upper > 0)
    bound, nodes = -np.inf, 0
    while not stop.met():
        highs = quiet_highs(seed)
        highs.setOptionValue("mip_rel_gap", 0.0)
        if np.isfinite(known):
            # Half a step up: rounding must not cut off a solution exactly at the limit.
            highs.setOptionValue("objective_bound", step.below(known) + step.step / 2)
        if highs.passModel(_model(problem, cuts)) == highspy.HighsStatus.kError:
            raise TreeError("HiGHS failed: it does not take the program")
        run_highs(highs, stop)
        info, status = highs.getInfo(), highs.getModelStatus()
        if status in _FAILED:
            raise TreeError(f"HiGHS failed: {highs.modelStatusToString(status)}")
        nodes += max(0, int(info.mip_node_count))
        if status in _NOTHING_BETTER:
            return Tree(known, complete=True, nodes=nodes)
        bound = max(bound, float(info.mip_dual_bound))
        proved(bound)
        if info.primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible:
            break
        x = np.zeros(formulation.n_columns)
        x[used] = np.round(highs.getSolution().col_value)
        supports = point_supports(formulation, x)
        new = [cut for s in supports for cut in separate(s, tolerance=0.5 - 1e-6)]
        if not new:
            routes = routes_of(formulation, x)
            if routes is not None:
                improved(routes)
            finished = status == highspy.HighsModelStatus.kOptimal
            if finished or routes is None:
                return Tree(min(known, bound), complete=finished, nodes=nodes)
            continue
        cuts.extend(new)
    return Tree(min(known, bound), complete=False, nodes=nodes)


def _model(problem: Subproblem, cuts: Sequence[Cut]) -> highspy.HighsLp:
    """The integer program on the columns that are not fixed to 0."""
    used = np.flatnonzero(problem.upper > 0)
    program = problem.formulation.program(cuts, problem.rows)
    matrix = program.matrix[:, used].tocsc()
    model = highspy.HighsLp()
    model.num_col_, model.num_row_ = len(used), matrix.shape[0]
    model.col_cost_ = program.cost[used]
    model.offset_ = program.offset
    model.col_lower_, model.col_upper_ = problem.lower[used], problem.upper[used]
    model.row_lower_, model.row_upper_ = program.row_lower, program.row_upper
    model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    model.a_matrix_.start_, model.a_matrix_.index_ = matrix.indptr, matrix.indices
    model.a_matrix_.value_ = matrix.data
    model.integrality_ = [
        highspy.HighsVarType.kInteger if i else highspy.HighsVarType.kContinuous
        for i in program.integer[used]
    ]
    return model
