r"""Branch and cut where SCIP is not installed: HiGHS solves, cuts are added, HiGHS solves again.

HiGHS takes no cuts while it branches. So the integer program is solved with the cuts known, its
solution's violated cuts are added, and so on until the solution is connected. Each of these programs
is a relaxation, so each of their bounds holds.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import highspy
import numpy as np
from scipy.sparse import vstack

from ...arrays import Floats
from ..objective_step import objective_step
from ..problem import Routes
from .edge_formulation import Columns
from .extraction import point_supports, routes_of
from .rows import Rows
from .separation import Cut, separate
from .symmetry import Row
from .tree import Tree


def resolve(
    columns: Columns,
    cuts: tuple[Cut, ...],
    lower: Floats,
    upper: Floats,
    *,
    best: float,
    time_limit: float,
    seed: int = 0,
    improved: Callable[[Routes], object] = lambda routes: None,
    go_on: Callable[[float], bool] = lambda bound: True,
    more: Sequence[Row] = (),
) -> Tree:
    """As `scip_tree.solve`, by HiGHS."""
    grain = objective_step(columns.data, columns.objective)
    until = time.monotonic() + time_limit
    known = list(cuts)
    rows = Rows(columns.n_columns)
    for column, weight, most in more:
        rows.add(np.zeros_like(column), column, weight, np.array([-np.inf]), np.array([most]))
    extra, extra_lower, extra_upper = rows.done()
    used = np.flatnonzero(upper > 0)
    bound, nodes = -np.inf, 0
    while (left := until - time.monotonic()) > 0 and go_on(bound):
        program = columns.program(known)
        matrix = vstack([program.matrix, extra], format="csr")[:, used].tocsc()
        model = highspy.HighsLp()
        model.num_col_, model.num_row_ = len(used), matrix.shape[0]
        model.col_cost_ = program.cost[used]
        model.offset_ = program.offset
        model.col_lower_, model.col_upper_ = lower[used], upper[used]
        model.row_lower_ = np.concatenate([program.row_lower, extra_lower])
        model.row_upper_ = np.concatenate([program.row_upper, extra_upper])
        model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        model.a_matrix_.start_, model.a_matrix_.index_ = matrix.indptr, matrix.indices
        model.a_matrix_.value_ = matrix.data
        model.integrality_ = [
            highspy.HighsVarType.kInteger if i else highspy.HighsVarType.kContinuous
            for i in program.integer[used]
        ]
        highs = highspy.Highs()
        highs.setOptionValue("output_flag", False)
        highs.setOptionValue("threads", 1)
        highs.setOptionValue("random_seed", seed)
        highs.setOptionValue("mip_rel_gap", 0.0)
        highs.setOptionValue("time_limit", left)
        if np.isfinite(best):
            # Half a step up: rounding must not cut off an answer exactly at the limit.
            highs.setOptionValue("objective_bound", grain.below(best) + grain.step / 2)
        highs.passModel(model)
        highs.run()
        info = highs.getInfo()
        status = highs.getModelStatus()
        nodes += max(0, int(info.mip_node_count))
        nothing_better = (
            highspy.HighsModelStatus.kInfeasible,
            highspy.HighsModelStatus.kObjectiveBound,
            highspy.HighsModelStatus.kUnboundedOrInfeasible,
        )
        if status in nothing_better:
            return Tree(best, complete=True, nodes=nodes)
        bound = max(bound, float(info.mip_dual_bound))
        if info.primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible:
            break
        x = np.zeros(columns.n_columns)
        x[used] = np.round(highs.getSolution().col_value)
        new = [cut for s in point_supports(columns, x) for cut in separate(s, tolerance=0.5 - 1e-6)]
        if not new:
            routes = routes_of(columns, x)
            if routes is not None:
                improved(routes)
            finished = status == highspy.HighsModelStatus.kOptimal
            if finished or routes is None:
                return Tree(min(best, bound), complete=finished, nodes=nodes)
            continue
        known.extend(new)
    return Tree(min(best, bound), complete=False, nodes=nodes)
