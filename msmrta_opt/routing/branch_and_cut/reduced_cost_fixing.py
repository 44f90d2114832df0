r"""Reduced-cost fixing: what an upper bound and the relaxation's duals exclude for good.

With dual values p that prove the bound L, a solution with column j away from the bound that its
reduced cost d_j leans on costs at least ``L + |d_j|``. If that is not less than the upper bound U, no
*better* solution has it, and j is fixed. Where all values are multiples of a known step g, better means
at most ``U - g``, and every bound may be rounded up.

Source: Dantzig, Fulkerson and Johnson (1954); Nemhauser and Wolsey, Integer and Combinatorial
Optimization (1988), section II.5.2.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Bools, Floats
from ..objective_step import objective_step
from .cutting_plane import Relaxed
from .edge_variables import EdgeVariables

_ROUNDING = 1e-6


def fixed(
    variables: EdgeVariables, relaxed: Relaxed, value: float, lower: Floats, upper: Floats
) -> tuple[Floats, Floats]:
    """The columns' bounds once those that no solution better than `value` needs are fixed.

    Parameters
    ----------
    variables : EdgeVariables
        Of the program.
    relaxed : Relaxed
        Its bound and reduced costs, proved with the bounds given.
    value : float
        Of a solution known.
    lower, upper : float arrays, shape (n_columns,)
        Bounds so far.

    Returns
    -------
    lower, upper : float arrays, shape (n_columns,)
        A crossed pair never arises: where both bounds are excluded, the column keeps them, for then no
        better solution exists and the bound itself says so.
    """
    better = objective_step(variables.data, variables.objective).below(value)
    room = better - relaxed.bound
    low, high = lower.copy(), upper.copy()
    free = variables.integer & (low < high)
    high[free & (relaxed.reduced_costs > max(room, 0.0) + _ROUNDING)] = 0.0
    low[free & (relaxed.reduced_costs < -max(room, 0.0) - _ROUNDING)] = 1.0
    return _follow(variables, low, high)


def _follow(variables: EdgeVariables, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Without the visit of a victim, nothing else of it remains: no ends, edges or services."""
    y, f, last, a, e = (variables.start(name) for name in "yflae")
    n = variables.n_pairs
    never: Bools = high[y : y + n] == 0.0
    if (never & (low[y : y + n] > 0)).any():
        return low, high
    high[f : f + n][never] = 0.0
    high[last : last + n][never] = 0.0
    high[a : a + len(variables.services)][never[variables.services[:, 0]]] = 0.0
    robot, i, j = variables.edges.T
    high[e:][never[variables.pair_of[robot, i]] | never[variables.pair_of[robot, j]]] = 0.0
    np.minimum(low, high, out=low)
    return low, high
