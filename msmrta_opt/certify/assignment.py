"""The linear assignment problem in whole numbers: a bound that its dual values prove by themselves."""

from __future__ import annotations

import numpy as np

from ..arrays import Ints

_NEVER = 1 << 62


def minimum_cost(cost: Ints) -> int:
    """No assignment of every row to a column of its own costs less; the cheapest costs just this.

    Found by the Hungarian method; what is returned rests on weak duality alone: for any v <= 0, no
    assignment costs less than the sum of v and of each row's minimum of ``cost - v``.

    Parameters
    ----------
    cost : int array, shape (n, m)
        With n <= m, and entries so small that ``n * m * cost`` is a 64-bit number.
    """
    n, m = cost.shape
    # Column 0 stands for no column, row 0 for no row.
    u, v = np.zeros(n + 1, dtype=np.int64), np.zeros(m + 1, dtype=np.int64)
    row_of, before = np.zeros(m + 1, dtype=np.int64), np.zeros(m + 1, dtype=np.int64)
    for row in range(1, n + 1):
        row_of[0], column = row, 0
        slack = np.full(m + 1, _NEVER)
        reached = np.zeros(m + 1, dtype=bool)
        while row_of[column] or column == 0:
            reached[column] = True
            here = row_of[column]
            reduced = cost[here - 1] - u[here] - v[1:]
            shorter = np.append(False, ~reached[1:] & (reduced < slack[1:]))
            slack[shorter] = reduced[shorter[1:]]
            before[shorter] = column
            column = int(np.where(reached, _NEVER, slack).argmin())
            step = slack[column]
            u[row_of[reached]] += step
            v[reached] -= step
            slack[~reached] -= step
        while column:
            row_of[column] = row_of[before[column]]
            column = int(before[column])
    held = np.minimum(v[1:], 0)
    return int((cost - held).min(axis=1).sum() + held.sum())
