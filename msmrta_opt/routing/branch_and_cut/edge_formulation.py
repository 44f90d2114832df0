r"""The joint problem as an integer program on undirected edges: rows over `edge_variables`.

    sum over e at v + f[r,v] + l[r,v] = 2 y[r,v]     every visited vertex has degree two
    sum_v f[r,v] = sum_v l[r,v] ≤ 1                  a robot starts and ends once, or stays at home
    sum_r a[r,v,k] = 1,  a[r,v,k] ≤ y[r,v]           every requirement is served, by a visitor
    time of r ≤ T, ≤ endurance;  travel of r ≤ longest walk

and the connectivity cuts of `separation`, which are too many to be written down.

Where only travel counts (total time without endurance), who of the visitors serves what is
immaterial: ``a`` disappears, and what remains of it is ``sum_{r able} y[r,v] ≥ 1`` for those kinds k
of v whose able robots contain no other kind's. Service is then a constant.

Source: the vertex-visiting ("generalised") symmetric travelling salesman formulation of Fischetti,
Salazar González and Toth, Networks 26 (1995) and Operations Research 45 (1997), one layer per robot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack

from ...arrays import Floats, Ints
from ...optimise.program import Block, Program
from ..problem import RoutingData
from .edge_variables import EdgeVariables
from .separation import Cut

Row = tuple[Ints, Floats, float]
"""Columns, their weights, and the maximum of their weighted sum."""


@dataclass(frozen=True, eq=False)
class EdgeFormulation(EdgeVariables):
    """The integer program, connectivity cuts apart."""

    @cached_property
    def rows(self) -> tuple[csr_array, Floats, Floats]:
        """Rows but for the cuts: matrix ``(n_rows, n_columns)``, lower and upper sides ``(n_rows,)``."""
        rows = _Rows(self.n_columns)
        y, f, last, a, e = (self.start(name) for name in "yflae")
        pair = np.arange(self.n_pairs)
        one = np.ones(self.n_pairs)
        edge = np.arange(len(self.edges))
        tail = self.pair_of[self.edges[:, 0], self.edges[:, 1]]
        head = self.pair_of[self.edges[:, 0], self.edges[:, 2]]
        rows.add(
            np.concatenate([pair, pair, pair, tail, head]),
            np.concatenate([y + pair, f + pair, last + pair, e + edge, e + edge]),
            np.concatenate([-2 * one, one, one, np.ones(2 * len(edge))]),
            np.zeros(self.n_pairs),
            np.zeros(self.n_pairs),
        )
        n, robot = self.data.n_robots, self.pairs[:, 0]
        rows.add(robot, f + pair, one, np.zeros(n), np.ones(n))
        rows.add(
            np.concatenate([robot, robot]),
            np.concatenate([f + pair, last + pair]),
            np.concatenate([one, -one]),
            np.zeros(n),
            np.zeros(n),
        )
        if len(self.services):
            self._add_services(rows, y, a)
        else:
            self._add_covering(rows, y)
        self._add_limits(rows)
        return rows.done()

    def _add_services(self, rows: _Rows, y: int, a: int) -> None:
        position = np.full(self.data.required.shape, -1)
        position[self.data.required] = np.arange(self.data.required.sum())
        pair, kind = self.services.T
        service = np.arange(len(pair))
        one = np.ones(len(pair))
        sides = np.ones(int(self.data.required.sum()))
        rows.add(position[self.pairs[pair, 1], kind], a + service, one, sides, sides)
        rows.add(
            np.concatenate([service, service]),
            np.concatenate([a + service, y + pair]),
            np.concatenate([one, -one]),
            np.full(len(pair), -np.inf),
            np.zeros(len(pair)),
        )

    def _add_covering(self, rows: _Rows, y: int) -> None:
        victim, kind = decisive(self.data).T
        row, robot = np.nonzero(self.data.able[:, victim, kind].T)
        column = y + self.pair_of[robot, victim[row]]
        sides = np.ones(len(victim))
        rows.add(row, column, np.ones(len(column)), sides, np.full(len(victim), np.inf))

    def _add_limits(self, rows: _Rows) -> None:
        data = self.data
        for time, maximum in ((self.busy, data.endurance), (self.travel, data.longest_walk)):
            limited = np.flatnonzero(np.isfinite(maximum))
            row = np.full(data.n_robots, -1)
            row[limited] = np.arange(len(limited))
            used = np.flatnonzero((self.robot >= 0) & (time != 0) & (row[self.robot] >= 0))
            below = np.full(len(limited), -np.inf)
            rows.add(row[self.robot[used]], used, time[used], below, maximum[limited])
        if self.objective.only_last:
            used = np.flatnonzero((self.robot >= 0) & (self.busy != 0))
            robots = np.arange(data.n_robots)
            rows.add(
                np.concatenate([self.robot[used], robots]),
                np.concatenate([used, np.full(data.n_robots, self.start("T"))]),
                np.concatenate([self.busy[used], -np.ones(data.n_robots)]),
                np.full(data.n_robots, -np.inf),
                np.zeros(data.n_robots),
            )

    def cut_row(self, cut: Cut) -> Row:
        """A connectivity cut."""
        inside = np.zeros(self.data.n_victims, dtype=bool)
        inside[list(cut.members)] = True
        slice_ = self.edge_of_robot[cut.robot]
        edges = self.edges[slice_]
        within = np.flatnonzero(inside[edges[:, 1]] & inside[edges[:, 2]]) + slice_.start
        members = self.pair_of[cut.robot, list(cut.members)]
        y, f, last, e = (self.start(name) for name in "yfle")
        terms: list[tuple[Ints, float]] = [(e + within, 1.0), (y + members, -1.0)]
        if cut.first:
            terms.append((f + members, 1.0))
        if cut.last:
            terms.append((last + members, 1.0))
        if cut.vertex is not None:
            terms.append((np.array([y + self.pair_of[cut.robot, cut.vertex]]), 1.0))
        if cut.first and cut.last:
            own = self.pair_of[cut.robot]
            terms.append((f + own[own >= 0], -1.0))
        column = np.concatenate([columns for columns, _ in terms])
        weight = np.concatenate([np.full(len(columns), w) for columns, w in terms])
        unique, where = np.unique(column, return_inverse=True)
        total = np.bincount(where, weights=weight, minlength=len(unique))
        return unique[total != 0], total[total != 0], 0.0

    def program(self, cuts: Sequence[Cut] = (), rows: Sequence[Row] = ()) -> Program:
        """The integer program with `cuts` and `rows` as further rows."""
        matrix, lower, upper = self.rows
        more = _Rows(self.n_columns)
        for column, weight, maximum in (*map(self.cut_row, cuts), *rows):
            first = np.zeros(len(column), dtype=np.int64)
            more.add(first, column, weight, np.array([-np.inf]), np.array([maximum]))
        more_matrix, more_lower, more_upper = more.done()
        n = len(lower)
        return Program(
            sense="min",
            cost=self.cost,
            offset=self.offset,
            matrix=csr_array(vstack([matrix, more_matrix])),
            row_lower=np.concatenate([lower, more_lower]),
            row_upper=np.concatenate([upper, more_upper]),
            lower=np.zeros(self.n_columns),
            upper=self.upper,
            integer=self.integer,
            columns=self.blocks,
            rows=(Block("row {i}", 0, (n,)), Block("cut {i}", n, (more.n_rows,))),
        )

    def dual_values_of_cost(self, dual_values: Floats) -> Floats:
        """Dual values for `cost` that prove as much as these do for `weighted_cost`.

        The weighted cost is the makespan, with a little of every row ``time of r ≤ T`` added: so its
        dual values take that little more of those rows, all scaled to an objective of T again.
        """
        if not self.time_weight:
            return dual_values
        n_rows = len(self.rows[1])
        dual_values = dual_values.copy()
        dual_values[n_rows - self.data.n_robots : n_rows] -= self.time_weight
        return dual_values / self.weight_of_value


def decisive(data: RoutingData) -> Ints:
    """Requirements whose able robots contain those of no other kind of the same victim.

    Of kinds with the same able robots, the first. Shape ``(n_decisive, 2)``: victim and kind.
    """
    kept = []
    for v in range(data.n_victims):
        kinds = np.flatnonzero(data.required[v]).tolist()
        able = {k: frozenset(np.flatnonzero(data.able[:, v, k]).tolist()) for k in kinds}
        kept += [
            (v, k)
            for k in kinds
            if not any(
                able[other] < able[k] or (able[other] == able[k] and other < k) for other in kinds
            )
        ]
    return np.array(kept, dtype=np.int64).reshape(-1, 2)


class _Rows:
    """Rows of a sparse matrix with their sides, gathered block by block."""

    def __init__(self, n_columns: int) -> None:
        self.n_columns = n_columns
        self.n_rows = 0
        self.entries: list[tuple[Ints, Ints, Floats]] = []
        self.sides: list[tuple[Floats, Floats]] = []

    def add(self, row: Ints, column: Ints, weight: Floats, lower: Floats, upper: Floats) -> None:
        """Rows with the entries ``(row, column, weight)``, counted from 0 within the block."""
        self.entries.append((row + self.n_rows, column, weight))
        self.sides.append((lower, upper))
        self.n_rows += len(lower)

    def done(self) -> tuple[csr_array, Floats, Floats]:
        """The matrix and its sides."""
        none = (np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64), np.empty(0))
        row, column, weight = (np.concatenate(p) for p in zip(none, *self.entries, strict=True))
        shape = (self.n_rows, self.n_columns)
        matrix = csr_array(coo_array((weight, (row, column)), shape=shape))
        lower = np.concatenate([np.empty(0), *(lower for lower, _ in self.sides)])
        upper = np.concatenate([np.empty(0), *(upper for _, upper in self.sides)])
        return matrix, lower, upper
