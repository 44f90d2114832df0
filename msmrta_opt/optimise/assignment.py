"""Recognised assignment programs, by an assignment algorithm, with dual values as proof.

The algorithm is SciPy's `linear_sum_assignment` (Jonker-Volgenant without initialisation). It gives
no duals, so they are worked out from its matching as shortest-path potentials of the residual graph;
whether they prove the optimum is then for `check.dual_bound` to say, not for this module.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Ints
from .program import Program
from .structure import Structure


@dataclass(frozen=True, eq=False)
class _Assignment:
    """A recognised program as a cost table: each row of it one of the smaller side's rows.

    ``cost`` is a minimisation's, ``inf`` where there is no column; ``column`` the program's column.
    """

    cost: Floats
    column: Ints
    small_rows: Ints
    large_rows: Ints
    cardinality_row: int | None
    every_small_row: bool
    """Whether each row of the smaller side must be matched."""


def solve_assignment(program: Program, structure: Structure) -> tuple[Floats, Floats] | None:
    """An optimal point of a recognised assignment, and its dual values.

    Returns
    -------
    x : float array, shape (n_columns,)
    duals : float array, shape (n_rows,)
        In the convention of `check.dual_bound`.

    ``None`` where the program is another one than this method handles (it then goes to the linear
    program), or has no feasible point.
    """
    table = _read(program, structure)
    if table is None:
        return None
    matched = _match(table)
    if matched is None:
        return None
    picked, u, v = matched
    x = structure.core.fixed.copy()
    taken = picked >= 0
    x[table.column[np.flatnonzero(taken), picked[taken]]] = 1.0
    return x, _duals(program, table, u, v)


def _read(program: Program, structure: Structure) -> _Assignment | None:
    core, side, pairs = structure.core, structure.side, structure.pairs
    if side is None or pairs is None or not _is_binary(core.lower, core.upper):
        return None
    if len(pairs) < len(core.columns) or structure.has_negative:
        return None
    cardinality = np.flatnonzero(side == 2)
    if len(cardinality) > 1:
        return None
    sides = [np.flatnonzero(side == kind) for kind in (0, 1)]
    ordinary = side < 2
    free_below, exactly_one = core.row_lower <= 0, core.row_lower == 1
    if not np.all((free_below | exactly_one)[ordinary]) or np.any(core.row_upper[ordinary] != 1):
        return None
    small_kind = int(len(sides[1]) < len(sides[0]))
    small, large = sides[small_kind], sides[1 - small_kind]
    if not len(small) or np.any(exactly_one[large]):
        return None
    must = exactly_one[small]
    cardinality_row = int(cardinality[0]) if len(cardinality) else None
    if cardinality_row is not None:
        low, high = core.row_lower[cardinality_row], core.row_upper[cardinality_row]
        if not (low == high == len(small)):
            return None
        must[:] = True
    if must.any() != must.all():
        return None
    place = np.empty(len(side), dtype=np.int64)
    place[small], place[large] = np.arange(len(small)), np.arange(len(large))
    row, col = place[pairs[:, small_kind]], place[pairs[:, 1 - small_kind]]
    cost = np.full((len(small), len(large)), np.inf)
    column = np.full((len(small), len(large)), -1, dtype=np.int64)
    # Of several columns for one pair a cheapest stands for all.
    weights = program.sign * program.cost[core.columns]
    np.minimum.at(cost, (row, col), weights)
    cheapest = weights == cost[row, col]
    column[row[cheapest], col[cheapest]] = core.columns[cheapest]
    return _Assignment(
        cost,
        column,
        core.rows[small],
        core.rows[large],
        None if cardinality_row is None else int(core.rows[cardinality_row]),
        bool(must.all()),
    )


def _is_binary(lower: Floats, upper: Floats) -> bool:
    return bool(np.all(lower == 0) and np.all(upper == 1))


def _match(table: _Assignment) -> tuple[Ints, Floats, Floats] | None:
    """The matching (place on the larger side, or -1), and potentials of both sides."""
    from scipy.optimize import linear_sum_assignment

    n_small, n_large = table.cost.shape
    cost = table.cost
    if not table.every_small_row:
        # A row that may stay unmatched takes a place of its own at no cost.
        cost = np.hstack([cost, np.zeros((n_small, n_small))])
    if cost.shape[0] > cost.shape[1]:
        return None
    try:
        rows, cols = linear_sum_assignment(cost)
    except ValueError:  # no matching avoids the missing columns
        return None
    picked = np.empty(n_small, dtype=np.int64)
    picked[rows] = cols
    u, v = _potentials(cost, picked)
    return np.where(picked < n_large, picked, -1), u, v[:n_large]


def _potentials(cost: Floats, picked: Ints) -> tuple[Floats, Floats]:
    """Dual potentials of an optimal matching: ``u_i + v_j ≤ cost_ij``, ``v ≤ 0``, tight on pairs.

    ``v`` of the matched places is a shortest path in the residual graph, by Bellman-Ford on the
    places of the smaller side; unmatched places have ``v = 0``.
    """
    own = cost[np.arange(len(picked)), picked]
    step = cost[:, picked] - own[:, None]
    distance = np.zeros(len(picked))
    for _ in range(len(picked)):
        shorter = np.minimum(distance, (distance[:, None] + step).min(axis=0))
        if np.array_equal(shorter, distance):
            break
        distance = shorter
    v = np.zeros(cost.shape[1])
    v[picked] = distance
    return own - distance, v


def _duals(program: Program, table: _Assignment, u: Floats, v: Floats) -> Floats:
    duals = np.zeros(program.n_rows)
    if table.cardinality_row is not None:
        # The rows of the smaller side are at most one each; the cardinality row carries the rest.
        carried = float(u.max(initial=0.0))
        duals[table.cardinality_row] = carried
        u = u - carried
    duals[table.small_rows] = u
    duals[table.large_rows] = v
    return duals
