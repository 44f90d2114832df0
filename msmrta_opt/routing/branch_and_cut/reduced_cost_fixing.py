r"""Reduced-cost fixing: what an upper bound and the relaxation's duals exclude for good.

With prices p that prove the bound L, an answer with column j away from the bound that its reduced
cost d_j leans on costs at least ``L + |d_j|``. If that is not less than the upper bound U, no *better*
answer has it, and j is fixed. Where all times are multiples of a known g, better means at most
``U - g``, and every bound may be rounded up.

Source: Dantzig, Fulkerson and Johnson (1954); Nemhauser and Wolsey, Integer and Combinatorial
Optimization (1988), section II.5.2.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Bools, Floats
from ..objective_step import objective_step
from .cutting_plane import Relaxed
from .edge_formulation import Columns

_ROUNDING = 1e-6


def fixed(
    columns: Columns, relaxed: Relaxed, upper: float, lower_side: Floats, upper_side: Floats
) -> tuple[Floats, Floats]:
    """The columns' bounds once those that no answer better than `upper` needs are fixed.

    Parameters
    ----------
    columns : Columns
        The program.
    relaxed : Relaxed
        Its bound and reduced costs, proved with the sides given.
    upper : float
        Value of an answer known.
    lower_side, upper_side : float arrays, shape (n_columns,)
        Bounds so far.

    Returns
    -------
    lower, upper : float arrays, shape (n_columns,)
        A crossed pair never arises: where both sides are excluded, the column keeps its bounds, for
        then no better answer exists and the bound itself says so.
    """
    better = objective_step(columns.data, columns.objective).below(upper)
    room = better - relaxed.bound
    low, high = lower_side.copy(), upper_side.copy()
    free = columns.integer & (low < high)
    high[free & (relaxed.reduced > max(room, 0.0) + _ROUNDING)] = 0.0
    low[free & (relaxed.reduced < -max(room, 0.0) - _ROUNDING)] = 1.0
    return _follow(columns, low, high)


def _follow(columns: Columns, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Without the visit of a victim, nothing else of it remains: no ends, edges or services."""
    y, f, last, a, e = (columns.start(name) for name in "yflae")
    n = columns.n_pairs
    never: Bools = high[y : y + n] == 0.0
    if (never & (low[y : y + n] > 0)).any():
        return low, high
    high[f : f + n][never] = 0.0
    high[last : last + n][never] = 0.0
    high[a : a + len(columns.services)][never[columns.services[:, 0]]] = 0.0
    robot, i, j = columns.edges.T
    high[e:][never[columns.pair_of[robot, i]] | never[columns.pair_of[robot, j]]] = 0.0
    np.minimum(low, high, out=low)
    return low, high
