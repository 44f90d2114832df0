"""Recognised assignment programs, by an assignment algorithm, with dual values as proof.

The algorithm is SciPy's `linear_sum_assignment` (Jonker-Volgenant without initialisation). It gives
no duals, so they are worked out from its matching as shortest-path potentials of the residual graph;
whether they prove the optimum is then for `check.dual_bound` to say, not for this module.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..arrays import Floats, Ints
from .program import Program
from .structure import Structure


@dataclass(frozen=True, eq=False)
class _Table:
    """A recognised program as a table, whatever its costs: rows for those of the smaller side."""

    shape: tuple[int, int]
    place: tuple[Ints, Ints]
    """The row and the column of the table of each of the core's columns."""
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
    table = _table(structure)
    if table is None:
        return None
    weights = program.sign * program.cost[structure.core.columns]
    cost = np.full(table.shape, np.inf)
    np.minimum.at(cost, table.place, weights)
    matched = _match(cost, every_row=table.every_small_row)
    if matched is None:
        return None
    picked, u, v = matched
    # Of several columns for one pair a cheapest stands for all.
    row, column = table.place
    chosen = np.flatnonzero((picked[row] == column) & (weights == cost[table.place]))
    own = np.zeros(len(picked), dtype=np.int64)
    own[row[chosen]] = structure.core.columns[chosen]
    x = structure.core.fixed.copy()
    x[own[picked >= 0]] = 1.0
    return x, _duals(program, table, u, v)


@lru_cache(maxsize=4)
def _table(structure: Structure) -> _Table | None:
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
    return _Table(
        (len(small), len(large)),
        (place[pairs[:, small_kind]], place[pairs[:, 1 - small_kind]]),
        core.rows[small],
        core.rows[large],
        None if cardinality_row is None else int(core.rows[cardinality_row]),
        bool(must.all()),
    )


def _is_binary(lower: Floats, upper: Floats) -> bool:
    return bool(np.all(lower == 0) and np.all(upper == 1))


def _match(cost: Floats, *, every_row: bool) -> tuple[Ints, Floats, Floats] | None:
    """The matching (the column of each row, or -1), and potentials of rows and columns.

    ``cost`` is a minimisation's, ``inf`` where there is no pair, of shape ``(n_small, n_large)``.
    """
    from scipy.optimize import linear_sum_assignment

    n_small, n_large = cost.shape
    if not every_row:
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


def _duals(program: Program, table: _Table, u: Floats, v: Floats) -> Floats:
    duals = np.zeros(program.n_rows)
    if table.cardinality_row is not None:
        # The rows of the smaller side are at most one each; the cardinality row carries the rest.
        carried = float(u.max(initial=0.0))
        duals[table.cardinality_row] = carried
        u = u - carried
    duals[table.small_rows] = u
    duals[table.large_rows] = v
    return duals
