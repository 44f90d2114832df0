r"""The program over paths in HiGHS, of which column generation solves the relaxation.

    min   sum_p c_p z_p + sum_{v, j} priority_v x_vj
    s.t.  sum of z_p over paths that serve g                      >= 1     for every task g
          sum of z_p over paths of robot r                        <= 1     for every robot r
          len_j y_gj + sum of (t_gp - b_j) z_p over paths that
                       serve g in interval j                      <= x_vj  for task g of v, interval j
          y_gj = y_g,j+1 + sum of z_p over paths that serve g in interval j + 1
          x, y, z >= 0

for victims v whose tasks may be split over robots; x_vj is how much of the j-th interval of time, from
the breakpoint b_j on, passes before v is complete, and y_gj how much of all paths serve g after it. For
other victims c_p holds their weighted completion times. The dual values of the third kind of rows are
the densities of `duals`. With whole z the program is exact, for any breakpoints; the more of them, the
stronger its relaxation.

An artificial variable for each task keeps the relaxation feasible, and its dual values in bounds.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Floats
from ..problem import Routes, RoutingData
from ..run_highs import quiet_highs
from .ng_network import Stops
from .tasks import Tasks

Path = tuple[int, Stops]
"""A robot, and what it serves when."""


@dataclass(frozen=True)
class _Column:
    cost: float
    entries: dict[int, float]
    upper: float = math.inf


class PathProgram:
    """Its rows, and the columns entered so far.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    tasks : Tasks
        Its requirements.
    breakpoints : sequence of array
        Of each victim, the first at 0.
    artificial_cost : float, optional
        Of leaving a task unserved; without it every task is served.
    seed : int
        Of the solver.
    """

    def __init__(
        self,
        data: RoutingData,
        tasks: Tasks,
        breakpoints: Sequence[Floats],
        artificial_cost: float | None = None,
        seed: int = 0,
    ) -> None:
        self.data, self.tasks, self.breakpoints = data, tasks, breakpoints
        lower = [1.0] * len(tasks) + [-np.inf] * data.n_robots
        upper = [np.inf] * len(tasks) + [1.0] * data.n_robots
        self.link: dict[int, int] = {}
        """The first row of the third kind, by task."""
        self.flow: dict[int, int] = {}
        """The first of the fourth."""
        split = [v for v in range(data.n_victims) if tasks.split(v)]
        for v in split:
            n = len(breakpoints[v])
            for g in tasks.of[v]:
                self.link[g], self.flow[g] = len(lower), len(lower) + n
                lower += [0.0] * (2 * n - 1)
                upper += [np.inf] * n + [0.0] * (n - 1)
        self.highs = quiet_highs(seed)
        none, starts = np.empty(0, dtype=np.int32), np.zeros(len(lower), np.int32)
        self.highs.addRows(
            len(lower), np.array(lower), np.array(upper), 0, starts, none, np.empty(0)
        )
        cost, limit = (0.0, 0.0) if artificial_cost is None else (artificial_cost, math.inf)
        columns = [_Column(cost, {g: 1.0}, limit) for g in range(len(tasks))]
        columns += [column for v in split for column in self._completion(v)]
        self._enter(columns)
        self.first_path = len(columns)
        """The column of the first path that is added."""

    def add(self, paths: Iterable[Path]) -> None:
        """Enter paths, behind those that are there."""
        self._enter([self._column(path) for path in paths])

    def _completion(self, v: int) -> Iterator[_Column]:
        """The columns x and y of victim `v`."""
        own, length = self.tasks.of[v], np.diff(self.breakpoints[v]).tolist()
        for j in range(len(length) + 1):
            yield _Column(float(self.data.priority[v]), {self.link[g] + j: 1.0 for g in own})
        for g in own:
            link, flow = self.link[g], self.flow[g]
            for j, part in enumerate(length):
                entries = {link + j: -part, flow + j: 1.0}
                if j > 0:
                    entries[flow + j - 1] = -1.0
                yield _Column(0.0, entries)

    def _column(self, path: Path) -> _Column:
        robot, stops = path
        entries: dict[int, float] = defaultdict(float)
        entries[len(self.tasks) + robot] = 1.0
        cost = 0.0
        for v, served, time in stops:
            split = self.tasks.split(v)
            breakpoints = self.breakpoints[v]
            # The interval that the time ends in.
            j = max(int(breakpoints.searchsorted(time)) - 1, 0)
            if not split:
                cost += float(self.data.priority[v]) * time
            for g in served:
                entries[g] += 1.0
                if split:
                    entries[self.link[g] + j] -= time - float(breakpoints[j])
                    if j > 0:
                        entries[self.flow[g] + j - 1] -= 1.0
        return _Column(cost, entries)

    def _enter(self, columns: Sequence[_Column]) -> None:
        if columns:
            rows = [row for column in columns for row in column.entries]
            values = [value for column in columns for value in column.entries.values()]
            ends = np.cumsum([0, *(len(column.entries) for column in columns)])
            self.highs.addCols(
                len(columns),
                np.array([column.cost for column in columns]),
                np.zeros(len(columns)),
                np.array([column.upper for column in columns]),
                len(rows),
                ends[:-1].astype(np.int32),
                np.array(rows, dtype=np.int32),
                np.array(values),
            )


def paths_of(data: RoutingData, tasks: Tasks, routes: Routes) -> list[Path]:
    """The paths that `routes` are."""
    paths = []
    for r, route in enumerate(routes):
        clock, before, stops = 0.0, -1, []
        for v, kinds in route:
            clock += float(data.leave[r, v] if before < 0 else data.way(r, before, v))
            clock += float(data.service[v, list(kinds)].sum())
            stops.append((v, tasks.served(v, kinds), clock))
            before = v
        if stops:
            paths.append((r, tuple(stops)))
    return paths


def routes_of(data: RoutingData, tasks: Tasks, paths: Iterable[Path]) -> Routes:
    """The routes that walk `paths`; what several of them serve is left to the soonest."""
    routes: list[list[tuple[int, tuple[int, ...]]]] = [[] for _ in range(data.n_robots)]
    visits = [(time, r, v, own) for r, stops in paths for v, own, time in stops]
    served: set[int] = set()
    for _, robot, v, own in sorted(visits):
        new = [g for g in own if g not in served]
        served.update(new)
        if new:
            routes[robot].append((v, tuple(sorted(k for g in new for k in tasks.kinds[g]))))
    return tuple(tuple(route) for route in routes)
