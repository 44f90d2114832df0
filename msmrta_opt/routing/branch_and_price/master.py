r"""The master program of column generation for latency: which of the known paths to walk.

    min   sum_p c_p z_p + sum_{v, j} priority_v x_vj
    s.t.  sum of z_p over paths that serve g                      >= 1     for every need g
          sum of z_p over paths of robot r                        <= 1     for every robot r
          len_j y_gj + sum of (t_gp - b_j) z_p over paths that
                       serve g in step j                          <= x_vj  for need g of v, step j
          y_gj = y_g,j+1 + sum of z_p over paths that serve g in step j + 1
          x, y, z >= 0

for victims v whose needs may be split over robots; x_vj is how much of the j-th step of time, from b_j
on, passes before v is complete, and y_gj how much of all paths serve g after it. For other victims
c_p holds their weighted completion times. The duals of the third kind of rows are the densities of
`latency_prices`. With whole z the program is exact, for any breakpoints; the more of them, the stronger
its relaxation. They are put where the needs of a victim change places as the one more probably still
undone, which is where no single need's time tells the maximum.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import highspy
import numpy as np

from ...arrays import Floats
from ..problem import Routes, RoutingData
from .duals import Prices, portions
from .ng_network import Stops
from .tasks import Needs

Path = tuple[int, Stops]
"""A robot, and what it serves when."""
MANY_BREAKS = 8
"""Of a victim, from which on those that do nothing are taken out."""
_TINY = 1e-9
_WORTHLESS = 1e-6
_DUAL, _PRIMAL = 1, 4
"""Names that HiGHS has for its simplex methods."""


@dataclass(frozen=True, eq=False)
class Chosen:
    """An outcome of the integer program."""

    routes: Routes | None
    """The best found, if any was."""
    bound: float
    """No choice of the paths costs less, but for those that the cutoff excludes."""


@dataclass(frozen=True)
class _Column:
    cost: float
    entries: dict[int, float]
    most: float = math.inf


class Master:
    """The program on the paths known so far.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    needs : Needs
        Its requirements.
    dear : float
        The price of leaving a need unserved; it keeps rewards in bounds, and is to be raised
        (`raise_price`) if that pays.
    """

    def __init__(self, data: RoutingData, needs: Needs, dear: float) -> None:
        self.data, self.needs, self.dear = data, needs, dear
        self.paths: list[Path] = []
        self.breaks: list[Floats] = [np.zeros(1) for _ in range(data.n_victims)]
        self._known: set[Path] = set()
        self._highs: highspy.Highs | None = None
        self.value = math.inf
        self.unserved = 0.0
        """How much is left unserved in the last solution."""
        self.used: list[tuple[float, Path]] = []
        """Shares above 0 in the last solution, and their paths."""

    @property
    def split(self) -> list[int]:
        """The victims whose needs may be split."""
        return [v for v in range(self.data.n_victims) if self.needs.split(v)]

    def add(self, paths: Iterable[Path]) -> int:
        """Add paths; returns how many are new."""
        new = [path for path in dict.fromkeys(paths) if path not in self._known]
        self._known.update(new)
        self.paths += new
        if self._highs is not None:
            _enter(self._highs, [self._column(path) for path in new])
        return len(new)

    def keep(self, wanted: Callable[[Path], bool]) -> None:
        """Forget paths that are not wanted."""
        self.paths = [path for path in self.paths if wanted(path)]
        self._known = set(self.paths)
        self._highs = None

    def solve(self, time_limit: float = math.inf) -> Prices | None:
        """The relaxation's prices, made to hold exactly; ``None`` if it could not be solved."""
        first = self._highs is None
        if self._highs is None:
            self._highs = self._model()
        # From scratch the dual simplex method is fastest, after new paths the primal.
        self._highs.setOptionValue("simplex_strategy", _DUAL if first else _PRIMAL)
        if math.isfinite(time_limit):
            self._highs.setOptionValue("time_limit", self._highs.getRunTime() + time_limit)
        self._highs.run()
        if self._highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        solution = self._highs.getSolution()
        self.value = float(self._highs.getInfo().objective_function_value)
        self.unserved = float(np.sum(solution.col_value[: len(self.needs)]))
        z = np.array(solution.col_value)[self._first_path :]
        self.used = [(float(z[p]), self.paths[p]) for p in np.flatnonzero(z > _TINY)]
        dual = np.array(solution.row_dual)
        weight = self.data.priority
        density = [np.full(len(self.breaks[v]), weight[v]) for v in self.needs.victim]
        for v in self.split:
            own = self.needs.of[v]
            steps = len(self.breaks[v])
            raw = np.array([dual[self._link[g] : self._link[g] + steps] for g in own])
            raw = np.maximum(raw, 0.0)
            total = raw.sum(axis=0)
            even = np.full_like(raw, weight[v] / len(own))
            scaled = raw * np.divide(weight[v], total, out=np.zeros(steps), where=total > 0)
            for g, mu in zip(own, np.where(total > _TINY, scaled, even), strict=True):
                density[g] = mu
        return Prices(
            np.maximum(dual[: len(self.needs)], 0.0),
            tuple(density),
            tuple(self.breaks),
            self.needs.victim,
        )

    def raise_price(self, factor: float) -> None:
        """Make it dearer to leave needs unserved."""
        self.dear *= factor
        self._highs = None

    def refine(self, prices: Prices) -> float:
        """Put breakpoints where they strengthen the relaxation; returns by how much at its point.

        Those between which `prices` do not change are taken out.
        """
        gain = 0.0
        times: dict[int, dict[float, float]] = defaultdict(lambda: defaultdict(float))
        for share, (_, stops) in self.used:
            for _, needs, time in stops:
                for g in needs:
                    times[g][time] += share
        for v in self.split:
            more, changes = _missed(self.breaks[v], [times[g] for g in self.needs.of[v]])
            if not len(changes):
                continue
            gain += float(self.data.priority[v]) * more
            kept = self.breaks[v]
            if len(kept) > MANY_BREAKS:
                density = np.array([prices.density[g] for g in self.needs.of[v]])
                kept = kept[np.append(True, (abs(np.diff(density)) > _TINY).any(axis=0))]
            self.breaks[v] = np.union1d(kept, changes)
            self._highs = None
        return gain

    def integer(
        self,
        *,
        paths: list[Path] | None = None,
        cutoff: float = math.inf,
        time_limit: float = math.inf,
        seed: int = 0,
        should_stop: Callable[[], bool] = lambda: False,
        proved: Callable[[float], object] = lambda bound: None,
    ) -> Chosen:
        """Choose whole paths.

        Parameters
        ----------
        paths : list of Path, optional
            To choose from; by default those known.
        cutoff : float
            Choices that cost more than this are of no interest.
        time_limit : float
            Seconds.
        seed : int
            Of the solver.
        should_stop : callable
            Asked now and then.
        proved : callable
            Told the bound now and then.
        """
        paths = self.paths if paths is None else paths
        highs = self._model(paths, whole=True)
        first = self._first_path
        self._highs = None
        columns = np.arange(first, first + len(paths), dtype=np.int32)
        integer = np.full(len(paths), highspy.HighsVarType.kInteger)
        highs.changeColsIntegrality(len(columns), columns, integer)
        highs.setOptionValue("random_seed", seed)
        highs.setOptionValue("mip_rel_gap", 0.0)
        highs.setOptionValue("mip_abs_gap", 1e-6)
        if math.isfinite(cutoff):
            highs.setOptionValue("objective_bound", cutoff)
        if math.isfinite(time_limit):
            highs.setOptionValue("time_limit", time_limit)

        def ask(event: highspy.HighsCallbackEvent) -> None:
            proved(float(event.data_out.mip_dual_bound))
            if should_stop():
                event.interrupt()

        highs.cbMipInterrupt += ask
        highs.run()
        status = highs.getModelStatus()
        info = highs.getInfo()
        if status in (
            highspy.HighsModelStatus.kInfeasible,
            highspy.HighsModelStatus.kObjectiveBound,
            highspy.HighsModelStatus.kUnboundedOrInfeasible,
        ):
            return Chosen(None, math.inf)
        bound = float(info.mip_dual_bound)
        if info.primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible:
            return Chosen(None, bound)
        x = np.array(highs.getSolution().col_value)[columns]
        return Chosen(self.routes([paths[p] for p in np.flatnonzero(x > 0.5)]), bound)

    def routes(self, paths: Iterable[Path]) -> Routes:
        """The routes that walk `paths`; what several of them serve is left to the soonest."""
        routes: list[list[tuple[int, tuple[int, ...]]]] = [[] for _ in range(self.data.n_robots)]
        visits = [(time, r, v, needs) for r, stops in paths for v, needs, time in stops]
        served: set[int] = set()
        for _, robot, v, needs in sorted(visits):
            own = [g for g in needs if g not in served]
            served.update(own)
            if own:
                kinds = sorted(k for g in own for k in self.needs.kinds[g])
                routes[robot].append((v, tuple(kinds)))
        return tuple(tuple(route) for route in routes)

    def _model(self, paths: list[Path] | None = None, *, whole: bool = False) -> highspy.Highs:
        """The program; needs may be left unserved, at a price, unless paths are `whole`."""
        n, n_robots = len(self.needs), self.data.n_robots
        lower = [1.0] * n + [-np.inf] * n_robots
        upper = [np.inf] * n + [1.0] * n_robots
        self._link, self._flow = {}, {}
        for v in self.split:
            steps = len(self.breaks[v])
            for g in self.needs.of[v]:
                self._link[g] = len(lower)
                self._flow[g] = len(lower) + steps
                lower += [0.0] * (2 * steps - 1)
                upper += [np.inf] * steps + [0.0] * (steps - 1)
        highs = highspy.Highs()
        highs.setOptionValue("output_flag", False)
        highs.setOptionValue("threads", 1)
        none = np.empty(0, dtype=np.int32)
        starts = np.zeros(len(lower), np.int32)
        highs.addRows(len(lower), np.array(lower), np.array(upper), 0, starts, none, np.empty(0))
        unserved = [_Column(self.dear, {g: 1.0}, most=0.0 if whole else np.inf) for g in range(n)]
        columns = unserved + [column for v in self.split for column in self._clock(v)]
        _enter(highs, columns)
        self._first_path = len(columns)
        _enter(highs, [self._column(path) for path in (self.paths if paths is None else paths)])
        return highs

    def _clock(self, v: int) -> Iterator[_Column]:
        """The columns x and y of victim `v`."""
        own, length = self.needs.of[v], np.diff(self.breaks[v]).tolist()
        for j in range(len(length) + 1):
            yield _Column(float(self.data.priority[v]), {self._link[g] + j: 1.0 for g in own})
        for g in own:
            link, flow = self._link[g], self._flow[g]
            for j, part in enumerate(length):
                entries = {link + j: -part, flow + j: 1.0}
                if j > 0:
                    entries[flow + j - 1] = -1.0
                yield _Column(0.0, entries)

    def _column(self, path: Path) -> _Column:
        robot, stops = path
        entries: dict[int, float] = defaultdict(float)
        entries[len(self.needs) + robot] = 1.0
        cost = 0.0
        for v, needs, time in stops:
            split = self.needs.split(v)
            breaks = self.breaks[v]
            # The step that the time ends in.
            j = max(int(breaks.searchsorted(time)) - 1, 0)
            if not split:
                cost += float(self.data.priority[v]) * time
            for g in needs:
                entries[g] += 1.0
                if split:
                    entries[self._link[g] + j] -= time - float(breaks[j])
                    if j > 0:
                        entries[self._flow[g] + j - 1] -= 1.0
        return _Column(cost, entries)


def _missed(breaks: Floats, times: list[dict[float, float]]) -> tuple[float, Floats]:
    """How much later a victim is complete than its steps see, and the breakpoints that they lack.

    Parameters
    ----------
    breaks : array, shape (n_breaks,)
        Where the victim's steps begin.
    times : list of {time: share}
        For each of its needs when it is done, in a relaxation.
    """
    at = np.unique([0.0, *(t for own in times for t in own)])
    done = np.array([[own.get(t, 0.0) for t in at] for own in times])
    # Rounded, so that equal sums taken in different orders tie.
    undone = np.round(done.sum(axis=1, keepdims=True) - done.cumsum(axis=1), 9)
    length = np.append(np.diff(at), 0.0)
    passed = np.diff(portions(breaks, at), axis=0, append=portions(breaks, at[-1:]))
    more = float(undone.max(axis=0) @ length - (undone @ passed).max(axis=0).sum())
    if more <= _WORTHLESS * max(1.0, at[-1]):
        return 0.0, np.empty(0)
    return more, at[np.flatnonzero(np.diff(undone.argmax(axis=0))) + 1]


def _enter(highs: highspy.Highs, columns: Sequence[_Column]) -> None:
    if columns:
        rows = [row for column in columns for row in column.entries]
        values = [value for column in columns for value in column.entries.values()]
        ends = np.cumsum([0, *(len(column.entries) for column in columns)])
        highs.addCols(
            len(columns),
            np.array([column.cost for column in columns]),
            np.zeros(len(columns)),
            np.array([column.most for column in columns]),
            len(rows),
            ends[:-1].astype(np.int32),
            np.array(rows, dtype=np.int32),
            np.array(values),
        )
