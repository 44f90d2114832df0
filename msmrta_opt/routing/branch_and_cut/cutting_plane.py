r"""The cutting-plane bound: the linear relaxation of the edge formulation, solved on a live model.

The model starts with the edges to each victim's nearest neighbours. In every round, it is solved by
the dual simplex method, connectivity cuts that its point violates are added, missing edges of
negative reduced cost are priced in, and cuts that have been slack for a while are purged.

Every round proves a bound, finished or not: for any dual values p of the rows with the right signs, no
solution costs less than

    p'b + sum_j min(0, d_j) u_j,        d = c - A'p over *all* columns, also those priced out

(weak duality). So neither the solver's tolerances nor an early stop can make a bound too high.

Source: Dantzig, Fulkerson and Johnson (1954) for the method; Applegate, Bixby, Chvátal and Cook, The
Traveling Salesman Problem (2006), chapters 5 and 12, for purging, pricing and safe bounds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import highspy
import numpy as np
from scipy.sparse import csr_array, vstack

from ...arrays import Bools, Floats, Ints
from ..parameters import BranchAndCutParameters
from ..problem import SUMS, Routes
from ..run_highs import quiet_highs, run_highs
from ..stop import StoppingCriterion
from .edge_formulation import EdgeFormulation, Row
from .points import point_of, point_supports
from .separation import Cut, separate


@dataclass(frozen=True, eq=False)
class Relaxed:
    """What the relaxation proved, and its last point."""

    bound: float
    """No solution costs less; offset included."""
    dual_values: Floats
    """That prove it: of the formulation's rows, then of `cuts`."""
    cuts: tuple[Cut, ...]
    reduced_costs: Floats
    """At `dual_values`, of all columns, ``(n_columns,)``."""
    point: Floats
    """The last point, zero where priced out, ``(n_columns,)``."""
    finished: bool
    """Whether no cut was violated and no column had a negative reduced cost."""


class Relaxation:
    """The live model. `solve` may be called again, to go on.

    Parameters
    ----------
    formulation : EdgeFormulation
        The program.
    routes : Routes, optional
        Feasible routes whose edges to start with, beside those to the nearest neighbours.
    parameters : BranchAndCutParameters, optional
        How to search.
    """

    def __init__(
        self,
        formulation: EdgeFormulation,
        *,
        routes: Routes | None = None,
        parameters: BranchAndCutParameters | None = None,
    ) -> None:
        self.formulation = formulation
        self.parameters = parameters or BranchAndCutParameters()
        self.lower, self.upper = np.zeros(formulation.n_columns), formulation.upper
        self.cuts: list[Cut] = []
        self._rows: list[Row] = []
        self._slack_rounds: list[int] = []
        self._first, self._row_lower, self._row_upper = formulation.rows
        self._by_column = self._first.tocsc()
        self._live = np.empty(0, dtype=np.int64)
        self._place = np.full(formulation.n_columns, -1)
        self._highs = quiet_highs()
        none = np.empty(0, dtype=np.int32)
        n = len(self._row_lower)
        self._highs.addRows(
            n, self._row_lower, self._row_upper, 0, np.zeros(n, np.int32), none, np.empty(0)
        )
        entering = np.arange(formulation.n_columns) < formulation.start("e")
        entering[_nearest(formulation, self.parameters.neighbours)] = True
        if routes is not None:
            entering |= point_of(formulation, routes) > 0
        self._enter(np.flatnonzero(entering))
        self.best: Relaxed | None = None
        self.seen = np.zeros(formulation.n_columns, dtype=bool)
        """Columns that were positive at one of the last points."""
        self._points: list[Bools] = []

    def solve(
        self,
        stop: StoppingCriterion | None = None,
        proved: Callable[[float], object] = lambda bound: None,
    ) -> Relaxed:
        """The bound: cut, price and purge until nothing is left to do, or until stopped.

        It also ends where its last rounds together raised the bound by less than a small share.

        Parameters
        ----------
        stop : StoppingCriterion, optional
            When to end; it ends a linear program once begun, too.
        proved : callable
            Told of every better bound.
        """
        stop = stop or StoppingCriterion()
        history: list[float] = []
        while True:
            solved, x, dual_values = self._optimise(stop)
            if dual_values is None:
                # With too few edges nothing may be feasible, and no reduced cost says which to add.
                missing = np.flatnonzero((self._place < 0) & (self.upper > 0))
                if not self.infeasible or not len(missing):
                    break
                self._enter(missing)
                continue
            bound, used, reduced = self._safe_bound(dual_values)
            entering = self._priced_in(reduced) if solved else np.empty(0, dtype=np.int64)
            cuts = self._violated(x) if solved else []
            finished = solved and not len(entering) and not cuts
            if self.best is None or bound > self.best.bound or finished:
                highest = bound if self.best is None else max(bound, self.best.bound)
                if self.best is None or bound >= self.best.bound:
                    self.best = Relaxed(bound, used, tuple(self.cuts), reduced, x, finished)
                proved(highest)
            history.append(self.best.bound)
            self._remember(x)
            if finished or not solved or stop.met() or self._tails_off(history):
                break
            self._purge(x)
            self._add(cuts)
            self._enter(entering)
        if self.best is None:
            nothing = np.zeros(len(self._row_lower))
            bound, used, reduced = self._safe_bound(nothing, n_cuts=0)
            x = np.zeros(self.formulation.n_columns)
            self.best = Relaxed(bound, used, (), reduced, x, finished=False)
        return self.best

    def _tails_off(self, history: list[float]) -> bool:
        """Whether the last rounds together brought too little."""
        rounds = self.parameters.tailing_off_rounds
        if len(history) <= rounds:
            return False
        gain = history[-1] - history[-1 - rounds]
        return gain < self.parameters.tailing_off_gain * abs(history[-1])

    def _optimise(self, stop: StoppingCriterion) -> tuple[bool, Floats, Floats | None]:
        """Whether the linear program was solved, its point, and its dual values if there are any."""
        x = np.zeros(self.formulation.n_columns)
        if stop.seconds_left() <= 0.0:
            return False, x, None
        run_highs(self._highs, stop)
        solved = self._highs.getModelStatus() == highspy.HighsModelStatus.kOptimal
        solution = self._highs.getSolution()
        if self.infeasible or not solution.dual_valid:
            return False, x, None
        x[self._live] = solution.col_value
        return solved, x, self.formulation.dual_values_of_cost(np.array(solution.row_dual))

    @property
    def infeasible(self) -> bool:
        """Whether the last linear program had no feasible point."""
        return bool(self._highs.getModelStatus() == highspy.HighsModelStatus.kInfeasible)

    def _safe_bound(
        self, dual_values: Floats, *, n_cuts: int | None = None
    ) -> tuple[float, Floats, Floats]:
        """Bound, dual values with the right signs, and reduced costs of all columns."""
        n = len(self._row_lower)
        rows = self._rows[:n_cuts]
        dual = dual_values.copy()
        dual[np.isneginf(np.append(self._row_lower, np.full(len(rows), -np.inf))) & (dual > 0)] = 0
        dual[np.isposinf(np.append(self._row_upper, np.zeros(len(rows)))) & (dual < 0)] = 0
        reduced = self.formulation.cost - self._first.T @ dual[:n]
        active = [(row, value) for row, value in zip(rows, dual[n:], strict=True) if value != 0]
        if active:
            column = np.concatenate([row[0] for row, _ in active])
            weight = np.concatenate([row[1] * value for row, value in active])
            reduced -= np.bincount(column, weights=weight, minlength=len(reduced))
        side = np.where(dual[:n] > 0, self._row_lower, self._row_upper)
        used = dual[:n] != 0
        terms = np.concatenate(
            [
                dual[:n][used] * side[used],
                np.where(reduced > 0, self.lower, self.upper) * reduced,
            ]
        )
        margin = SUMS * float(np.abs(terms).sum())
        return float(terms.sum()) - margin + self.formulation.offset, dual, reduced

    def _priced_in(self, reduced: Floats) -> Ints:
        """Missing edges of negative reduced cost, the most negative first."""
        absent = (self._place < 0) & (self.upper > 0) & (reduced < -1e-7)
        found = np.flatnonzero(absent)
        limit = max(200, len(self._live) // 5)
        return found[np.argsort(reduced[found])[:limit]]

    def _remember(self, x: Floats) -> None:
        self._points = [*self._points, x > 1e-6][-self.parameters.remembered_points :]
        self.seen = np.logical_or.reduce(self._points)

    def _violated(self, x: Floats) -> list[Cut]:
        known, parameters = set(self.cuts), self.parameters
        return [
            cut
            for support in point_supports(self.formulation, x)
            for cut in separate(support, tolerance=parameters.root_tolerance)[
                : parameters.cuts_per_robot
            ]
            if cut not in known
        ]

    def _add(self, cuts: list[Cut]) -> None:
        rows = [self.formulation.cut_row(cut) for cut in cuts]
        live = []
        for column, weight, _ in rows:
            here = self._place[column]
            live.append((here[here >= 0], weight[here >= 0]))
        self.cuts.extend(cuts)
        self._rows.extend(rows)
        self._slack_rounds.extend([0] * len(cuts))
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
            sizes = [len(column) for column, _, _ in self._rows]
            cuts = csr_array(
                (
                    np.concatenate([weight for _, weight, _ in self._rows]),
                    np.concatenate([column for column, _, _ in self._rows]),
                    np.cumsum([0, *sizes]),
                ),
                shape=(len(sizes), self.formulation.n_columns),
            )
            matrix = vstack([matrix, cuts.tocsc()[:, entering]]).tocsc()
        self._highs.addCols(
            len(entering),
            self.formulation.weighted_cost[entering],
            self.lower[entering],
            self.upper[entering],
            matrix.nnz,
            matrix.indptr[:-1].astype(np.int32),
            matrix.indices.astype(np.int32),
            matrix.data,
        )

    def _purge(self, x: Floats) -> None:
        """Delete the cuts that have been slack for too many rounds."""
        activity = np.array([float(weight @ x[column]) for column, weight, _ in self._rows])
        slack = activity < -1e-6
        self._slack_rounds = [
            n + 1 if s else 0 for n, s in zip(self._slack_rounds, slack, strict=True)
        ]
        gone = np.array([n > self.parameters.purge_after for n in self._slack_rounds], dtype=bool)
        if gone.sum() < 10:
            return
        first = len(self._row_lower)
        rows = (np.flatnonzero(gone) + first).astype(np.int32)
        self._highs.deleteRows(len(rows), rows)
        keep = np.flatnonzero(~gone)
        self.cuts = [self.cuts[n] for n in keep]
        self._rows = [self._rows[n] for n in keep]
        self._slack_rounds = [self._slack_rounds[n] for n in keep]


def _nearest(formulation: EdgeFormulation, neighbours: int) -> Ints:
    """Columns of the edges from each victim of each robot to its nearest neighbours."""
    chosen = np.zeros(len(formulation.edges), dtype=bool)
    for slice_ in formulation.edge_of_robot:
        edges = formulation.edges[slice_]
        time = formulation.data.way(*edges.T)
        order = np.argsort(time, kind="stable")
        seen = np.zeros(formulation.data.n_victims, dtype=np.int64)
        for n in order:
            _, i, j = edges[n]
            if seen[i] < neighbours or seen[j] < neighbours:
                chosen[slice_.start + n] = True
                seen[i] += 1
                seen[j] += 1
    return np.flatnonzero(chosen) + formulation.start("e")
