r"""The cutting-plane bound: the linear relaxation of `columns`, solved on a live model.

The model starts with the edges to each victim's nearest neighbours. In every round, it is solved by
the dual simplex method, connectivity cuts that its point violates are added, missing edges of
negative reduced cost are priced in, and cuts that have been slack for a while are purged.

Every round proves a bound, finished or not: for any prices p of the rows with the right signs, no
answer costs less than

    p'b + sum_j min(0, d_j) u_j,        d = c - A'p over *all* columns, also those priced out

(weak duality). So neither the solver's tolerances nor an early stop can make a bound too high.

Source: Dantzig, Fulkerson and Johnson (1954) for the method; Applegate, Bixby, Chvátal and Cook, The
Traveling Salesman Problem (2006), chapters 5 and 12, for purging, pricing and safe bounds.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import highspy
import numpy as np
from scipy.sparse import csr_array, vstack

from ...arrays import Bools, Floats, Ints
from ..problem import Routes
from .edge_formulation import Columns
from .extraction import point_supports
from .separation import Cut, separate

NEIGHBOURS = 6
"""Edges per robot and victim that the model starts with."""
PURGE_AFTER = 4
"""Rounds that a cut may be slack before it is purged."""
MOST_CUTS = 25
"""Cuts of one robot that are added in one round."""
LAST_POINTS = 15
"""Points whose columns are remembered: near the end all are close to answers worth having."""
_TINY = 1e-9


@dataclass(frozen=True, eq=False)
class Relaxed:
    """What the relaxation proved, and its last point."""

    bound: float
    """No answer costs less; offset included."""
    prices: Floats
    """That prove it: of the first rows, then of `cuts`."""
    cuts: tuple[Cut, ...]
    reduced: Floats
    """Reduced costs at `prices` of all columns, ``(n_columns,)``."""
    point: Floats
    """The last point, zero where priced out, ``(n_columns,)``."""
    finished: bool
    """Whether no cut was violated and no edge worth its price."""


class Relaxation:
    """The live model. `solve` may be called again, to go on.

    Parameters
    ----------
    columns : Columns
        The program.
    neighbours : int
        Edges per robot and victim to start with; all if there are no more.
    routes : Routes, optional
        Feasible routes whose edges to start with, too.
    """

    def __init__(
        self, columns: Columns, *, neighbours: int = NEIGHBOURS, routes: Routes | None = None
    ) -> None:
        self.columns = columns
        self.lower, self.upper = np.zeros(columns.n_columns), columns.upper
        self.cuts: list[Cut] = []
        self._rows: list[tuple[Ints, Floats]] = []
        self._slack: list[int] = []
        self._first, self._row_lower, self._row_upper = columns.rows
        self._by_column = self._first.tocsc()
        self._live = np.empty(0, dtype=np.int64)
        self._place = np.full(columns.n_columns, -1)
        self._highs = highspy.Highs()
        self._highs.setOptionValue("output_flag", False)
        self._highs.setOptionValue("threads", 1)
        none = np.empty(0, dtype=np.int32)
        n = len(self._row_lower)
        self._highs.addRows(
            n, self._row_lower, self._row_upper, 0, np.zeros(n, np.int32), none, np.empty(0)
        )
        entering = np.arange(columns.n_columns) < columns.start("e")
        entering[_nearest(columns, neighbours)] = True
        if routes is not None:
            entering |= columns.point(routes) > 0
        self._enter(np.flatnonzero(entering))
        self.best: Relaxed | None = None
        self.seen = np.zeros(columns.n_columns, dtype=bool)
        """Columns that were positive at one of the last points."""
        self._points: list[Bools] = []

    def solve(
        self,
        *,
        time_limit: float = np.inf,
        tolerance: float = 1e-6,
        tail: tuple[int, float] | None = None,
        report: Callable[[float], None] | None = None,
        should_stop: Callable[[], bool] | None = None,
    ) -> Relaxed:
        """The bound: cut, price and purge until nothing is left to do, or until stopped.

        Parameters
        ----------
        time_limit : float
            Seconds; a linear program once begun is stopped at the limit, too.
        tolerance : float
            Least violation of a cut that is added.
        tail : (rounds, gain), optional
            Stop when so many rounds together raised the bound by less than this share of it.
        report : callable, optional
            Called with every better bound.
        should_stop : callable, optional
            Asked between rounds.
        """
        until = time.monotonic() + time_limit
        history: list[float] = []
        while True:
            solved, x, prices = self._optimise(until)
            if prices is None:
                # With too few edges nothing may be feasible, and no reduced cost says which to add.
                missing = np.flatnonzero((self._place < 0) & (self.upper > 0))
                if not self.infeasible or not len(missing):
                    break
                self._enter(missing)
                continue
            bound, used, reduced = self._safe_bound(prices)
            entering = self._priced_in(reduced) if solved else np.empty(0, dtype=np.int64)
            cuts = self._violated(x, tolerance) if solved else []
            finished = solved and not len(entering) and not cuts
            if self.best is None or bound > self.best.bound or finished:
                highest = bound if self.best is None else max(bound, self.best.bound)
                if self.best is None or bound >= self.best.bound:
                    self.best = Relaxed(bound, used, tuple(self.cuts), reduced, x, finished)
                if report is not None:
                    report(highest)
            history.append(self.best.bound)
            self._remember(x)
            if finished or not solved or time.monotonic() > until:
                break
            if should_stop is not None and should_stop():
                break
            if tail is not None and len(history) > tail[0]:
                gain = history[-1] - history[-1 - tail[0]]
                if gain < tail[1] * abs(history[-1]):
                    break
            self._purge(x)
            self._add(cuts)
            self._enter(entering)
        if self.best is None:
            nothing = np.zeros(len(self._row_lower))
            bound, used, reduced = self._safe_bound(nothing, n_cuts=0)
            x = np.zeros(self.columns.n_columns)
            self.best = Relaxed(bound, used, (), reduced, x, finished=False)
        return self.best

    def _optimise(self, until: float) -> tuple[bool, Floats, Floats | None]:
        left = until - time.monotonic()
        x = np.zeros(self.columns.n_columns)
        if left <= 0:
            return False, x, None
        if np.isfinite(left):
            self._highs.setOptionValue("time_limit", self._highs.getRunTime() + left)
        self._highs.run()
        solved = self._highs.getModelStatus() == highspy.HighsModelStatus.kOptimal
        solution = self._highs.getSolution()
        if self.infeasible or not solution.dual_valid:
            return False, x, None
        x[self._live] = solution.col_value
        return solved, x, self.columns.unguided(np.array(solution.row_dual))

    @property
    def infeasible(self) -> bool:
        """Whether the last linear program had no feasible point."""
        return bool(self._highs.getModelStatus() == highspy.HighsModelStatus.kInfeasible)

    def _safe_bound(
        self, prices: Floats, *, n_cuts: int | None = None
    ) -> tuple[float, Floats, Floats]:
        """Bound, prices with the right signs, and reduced costs of all columns."""
        n = len(self._row_lower)
        rows = self._rows[:n_cuts]
        prices = prices.copy()
        prices[
            np.isneginf(np.append(self._row_lower, np.full(len(rows), -np.inf))) & (prices > 0)
        ] = 0
        prices[np.isposinf(np.append(self._row_upper, np.zeros(len(rows)))) & (prices < 0)] = 0
        reduced = self.columns.cost - self._first.T @ prices[:n]
        priced = [(row, price) for row, price in zip(rows, prices[n:], strict=True) if price != 0]
        if priced:
            column = np.concatenate([row[0] for row, _ in priced])
            weight = np.concatenate([row[1] * price for row, price in priced])
            reduced -= np.bincount(column, weights=weight, minlength=len(reduced))
        side = np.where(prices[:n] > 0, self._row_lower, self._row_upper)
        paid = prices[:n] != 0
        terms = np.concatenate(
            [
                prices[:n][paid] * side[paid],
                np.where(reduced > 0, self.lower, self.upper) * reduced,
            ]
        )
        margin = 1e-12 * float(np.abs(terms).sum()) + _TINY
        return float(terms.sum()) - margin + self.columns.offset, prices, reduced

    def _priced_in(self, reduced: Floats) -> Ints:
        """Missing edges of negative reduced cost, the most negative first."""
        absent = (self._place < 0) & (self.upper > 0) & (reduced < -1e-7)
        found = np.flatnonzero(absent)
        most = max(200, len(self._live) // 5)
        return found[np.argsort(reduced[found])[:most]]

    def _remember(self, x: Floats) -> None:
        self._points = [*self._points[1 - LAST_POINTS :], x > 1e-6]
        self.seen = np.logical_or.reduce(self._points)

    def _violated(self, x: Floats, tolerance: float) -> list[Cut]:
        known = set(self.cuts)
        return [
            cut
            for support in point_supports(self.columns, x)
            for cut in separate(support, tolerance=tolerance)[:MOST_CUTS]
            if cut not in known
        ]

    def _add(self, cuts: list[Cut]) -> None:
        rows = [self.columns.cut_row(cut) for cut in cuts]
        live = []
        for column, weight in rows:
            here = self._place[column]
            live.append((here[here >= 0], weight[here >= 0]))
        self.cuts.extend(cuts)
        self._rows.extend(rows)
        self._slack.extend([0] * len(cuts))
        if cuts:
            sizes = [len(column) for column, _ in live]
            self._highs.addRows(
                len(cuts),
                np.full(len(cuts), -np.inf),
                np.zeros(len(cuts)),
                sum(sizes),
                np.cumsum([0, *sizes[:-1]]).astype(np.int32),
                np.concatenate([column for column, _ in live]).astype(np.int32),
                np.concatenate([weight for _, weight in live]),
            )

    def _enter(self, entering: Ints) -> None:
        """Columns into the model, with their entries in the first rows and in all cuts."""
        if not len(entering):
            return
        self._place[entering] = len(self._live) + np.arange(len(entering))
        self._live = np.concatenate([self._live, entering])
        matrix = self._by_column[:, entering]
        if self._rows:
            sizes = [len(column) for column, _ in self._rows]
            cuts = csr_array(
                (
                    np.concatenate([weight for _, weight in self._rows]),
                    np.concatenate([column for column, _ in self._rows]),
                    np.cumsum([0, *sizes]),
                ),
                shape=(len(sizes), self.columns.n_columns),
            )
            matrix = vstack([matrix, cuts.tocsc()[:, entering]]).tocsc()
        self._highs.addCols(
            len(entering),
            self.columns.guide[entering],
            self.lower[entering],
            self.upper[entering],
            matrix.nnz,
            matrix.indptr[:-1].astype(np.int32),
            matrix.indices.astype(np.int32),
            matrix.data,
        )

    def _purge(self, x: Floats) -> None:
        """Delete the cuts that have been slack for `PURGE_AFTER` rounds."""
        activity = np.array([float(weight @ x[column]) for column, weight in self._rows])
        slack = activity < -1e-6
        self._slack = [n + 1 if s else 0 for n, s in zip(self._slack, slack, strict=True)]
        gone = np.array([n > PURGE_AFTER for n in self._slack], dtype=bool)
        if gone.sum() < 10:
            return
        first = len(self._row_lower)
        rows = (np.flatnonzero(gone) + first).astype(np.int32)
        self._highs.deleteRows(len(rows), rows)
        keep = np.flatnonzero(~gone)
        self.cuts = [self.cuts[n] for n in keep]
        self._rows = [self._rows[n] for n in keep]
        self._slack = [self._slack[n] for n in keep]


def _nearest(columns: Columns, neighbours: int) -> Ints:
    """Columns of the edges from each victim of each robot to its nearest neighbours."""
    chosen = np.zeros(len(columns.edges), dtype=bool)
    for slice_ in columns.edge_of_robot:
        edges = columns.edges[slice_]
        time = columns.data.between[tuple(edges.T)]
        order = np.argsort(time, kind="stable")
        seen = np.zeros(columns.data.n_victims, dtype=np.int64)
        for n in order:
            _, i, j = edges[n]
            if seen[i] < neighbours or seen[j] < neighbours:
                chosen[slice_.start + n] = True
                seen[i] += 1
                seen[j] += 1
    return np.flatnonzero(chosen) + columns.start("e")
