r"""The strong method: an answer and a bound that close in on each other.

1. The cutting-plane relaxation (`relaxation`) bounds from below.
2. Better answers: local search where the relaxation goes; the integer program on the few columns of
   its points and of the incumbent, whose solution is mostly much better than that; then with ever more
   of the cheap columns. Where that is too hard, some robots at a time (`parts`), then the victims of a
   region at a time (`regions`).
3. Reduced costs fix most columns (`fixing`).
4. Branch and cut (`branch_and_cut`, or `resolve` without SCIP) on the rest, for better answers only.

It may be stopped at any moment.
"""

from __future__ import annotations

import importlib.util
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Protocol

import numpy as np

from ...arrays import Bools, Floats
from ...mission.errors import InputError
from ..bound import Bound
from ..heuristics.robot_subsets import improve_by_parts
from ..heuristics.ruin_and_recreate import improve
from ..heuristics.victim_regions import Regions
from ..incumbent import Progress, Report
from ..objective_step import granularity
from ..problem import Objective, Routes, RoutingData, faults
from .cutting_plane import Relaxation, Relaxed
from .edge_formulation import Columns
from .reduced_cost_fixing import fixed
from .separation import Cut
from .symmetry import Row, in_order, own_visits
from .tree import Tree

NEAR = 0.005
"""Gap up to which trees are left to themselves."""
POLISH, RESTRICTED, SEEK = 0.2, 0.3, 0.85
"""Shares of the time left, for what looks for better answers before the tree."""
PROGRAM, PARTS = 0.4, 0.4
"""Shares of what is left of the time to seek: for a small program, and for some robots at a time."""
LONGEST_REGION, MOST_IN_VAIN = 5.0, 25
"""Seconds for the program of a region; regions in a row that bring nothing, after which it is enough."""
EASY = 0.2
"""Share of its limit that an easy program takes at most."""
WIDTHS = (-math.inf, 0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2)
"""Reduced costs up to which small programs take columns in, as shares of what is open; first none."""
MANY_ROBOTS = 6
"""From which on it pays to look long for better answers, before the tree."""
LONGEST_POLISH, LONGEST_SEEK = 30.0, 60.0
"""Seconds of local search at a time, and of small programs: by then little more is found."""
_TINY = 1e-6


class _Search(Protocol):
    def __call__(
        self,
        columns: Columns,
        cuts: tuple[Cut, ...],
        lower: Floats,
        upper: Floats,
        *,
        best: float,
        time_limit: float,
        seed: int,
        improved: Callable[[Routes], object],
        go_on: Callable[[float], bool],
        more: Sequence[Row],
    ) -> Tree: ...


def strong_bound(
    data: RoutingData,
    objective: Objective,
    incumbent: Routes,
    *,
    time_limit: float = math.inf,
    gap: float = 0.0,
    seed: int = 0,
    report: Report | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> tuple[Routes, Bound]:
    """The best routes found, and a bound that no routes are better than.

    Parameters
    ----------
    data : RoutingData
        The joint problem. Travel times should satisfy the triangle inequality, as walking does:
        without it answers and bounds hold, but may not meet.
    objective : {"total_time", "makespan"}
        What to minimise.
    incumbent : Routes
        Feasible routes to begin with; the better they are, the sooner the gap closes.
    time_limit : float
        Seconds of wall time.
    gap : float
        Stop when this share of the value, 0 to 1, is all that the bound leaves open.
    seed : int
        Of all random choices.
    report : callable, optional
        Called whenever the routes or the bound got better.
    should_stop : callable, optional
        Asked often; the search ends soon after it says so.

    Raises
    ------
    InputError
        If `incumbent` is not feasible, or the objective is latency.
    SolverError
        If a bound exceeds the value of feasible routes: a bug, never to be passed over.
    """
    if wrong := faults(data, incumbent):
        raise InputError(f"not feasible: {wrong[0]}", field="incumbent")
    if objective not in ("total_time", "makespan"):
        raise InputError(f"{objective!r}; give 'total_time' or 'makespan'", field="objective")
    run = _Run(data, objective, incumbent, time_limit, gap, seed, report, should_stop)
    run.close_in()
    return run.routes, run.result()


def combinatorial_bound(data: RoutingData, objective: Objective) -> float:
    """A bound at once: each requirement alone, by whoever is soonest done with it."""
    alone = _least_ways(data)[:, :, None] + data.service[None]
    soonest = np.where(data.able, alone, np.inf).min(axis=0, initial=np.inf)[data.required]
    if objective == "makespan":
        return float(soonest.max(initial=0.0))
    travel = soonest - data.service[data.required]
    return data.total_service + float(travel.max(initial=0.0))


def _least_ways(data: RoutingData) -> Floats:
    """Least travel of r to v and home, by whatever detour, ``(n_robots, n_victims)``.

    Where times satisfy the triangle inequality, as walking does, this is the direct way.
    """
    pair = data.can_visit[:, :, None] & data.can_visit[:, None, :]
    between = np.where(pair, data.between, np.inf)
    out, back = (np.where(data.can_visit, way, np.inf) for way in (data.leave, data.back))
    while True:
        shorter_out = np.minimum(out, (out[:, :, None] + between).min(axis=1))
        shorter_back = np.minimum(back, (between + back[:, None, :]).min(axis=2))
        if np.array_equal(shorter_out, out) and np.array_equal(shorter_back, back):
            return out + back
        out, back = shorter_out, shorter_back


def search_tree() -> _Search:
    """Branch and cut by SCIP where it is installed, by HiGHS where not."""
    if importlib.util.find_spec("pyscipopt") is not None:
        from .scip_tree import branch_and_cut

        return branch_and_cut
    from .highs_tree import resolve

    return resolve


class _Run(Progress):
    """The state of one run."""

    def __init__(
        self,
        data: RoutingData,
        objective: Objective,
        incumbent: Routes,
        time_limit: float,
        gap: float,
        seed: int,
        report: Report | None,
        should_stop: Callable[[], bool] | None,
    ) -> None:
        super().__init__(
            data,
            objective,
            incumbent,
            granularity(data, objective),
            time_limit=time_limit,
            gap=gap,
            report=report,
            should_stop=should_stop,
        )
        self.seed = seed
        self.columns = Columns.of(data, objective, self.value)
        self.relaxed: Relaxed | None = None
        self.seen = np.zeros(self.columns.n_columns, dtype=bool)
        self.raise_bound(combinatorial_bound(data, objective), "combinatorial")

    def close_in(self, *, whole: bool = True) -> None:
        """Close in from both sides until done; `whole`, if this is no part of another run."""
        if self.done():
            return
        relaxed = self.relax()
        many = whole and self.data.n_robots >= MANY_ROBOTS
        for step in (self.polish, self.seek if many else self.restricted, self.branch):
            if not self.done():
                step(relaxed)

    def relax(self) -> Relaxed:
        """The root bound."""
        relaxation = Relaxation(self.columns, routes=self.routes)
        self.relaxed = relaxation.solve(
            time_limit=self.left(),
            tolerance=1e-2,
            tail=(15, 2e-5),
            report=lambda bound: self.raise_bound(bound, "root LP"),
            should_stop=self.done,
        )
        self.seen = relaxation.seen
        return self.relaxed

    def restricted(self, relaxed: Relaxed) -> None:
        """The integer program on the columns that the relaxation or the incumbent used."""
        self.on_few(relaxed, RESTRICTED * self.left(), WIDTHS[0])

    def seek(self, relaxed: Relaxed) -> None:
        """Small programs, with ever more columns as long as they are easy; else in pieces."""
        until = time.monotonic() + min(SEEK * self.left(), LONGEST_SEEK)
        for width in WIDTHS:
            began = time.monotonic()
            seconds = PROGRAM * (until - began)
            solved = self.on_few(relaxed, seconds, width)
            if not solved or time.monotonic() - began > EASY * seconds:
                self.by_robots(relaxed, PARTS * (until - time.monotonic()))
                self.by_regions(relaxed, until)
                break

    def on_few(self, relaxed: Relaxed, seconds: float, width: float) -> bool:
        """Branch and cut on the columns in use and on cheap ones; returns whether it was solved."""
        used = self.seen | self.taken()
        used |= relaxed.reduced <= width * (self.value - relaxed.bound)
        return self.on(used, relaxed, seconds)

    def on(self, used: Bools, relaxed: Relaxed, seconds: float) -> bool:
        """Branch and cut on some columns; returns whether it was solved."""
        if self.done():
            return False
        upper = np.where(used, self.columns.upper, 0.0)
        return self.search(relaxed, upper, self.value, seconds=seconds).complete

    def by_robots(self, relaxed: Relaxed, seconds: float) -> None:
        """The strong method on some robots at a time."""
        visit = np.zeros(self.data.can_visit.shape)
        # Points of linear programs are a hair below their bounds at times.
        visit[tuple(self.columns.pairs.T)] = np.maximum(relaxed.point[: self.columns.n_pairs], 0.0)
        split = np.minimum(visit[:, None], visit[None]).sum(axis=2)
        np.fill_diagonal(split, 0.0)

        def solve(part: RoutingData, routes: Routes, limit: float) -> Routes:
            run = _Run(part, self.objective, routes, limit, 0.0, self.seed, None, self.done)
            run.close_in(whole=False)
            return run.routes

        improve_by_parts(
            self.data,
            self.objective,
            self.routes,
            split,
            solve,
            seconds=seconds,
            seed=self.seed,
            improved=self.offer,
            should_stop=self.done,
        )

    def by_regions(self, relaxed: Relaxed, until: float) -> None:
        """The program of a region at a time, until then, or until many in a row brought nothing."""
        regions = Regions(self.columns, relaxed.point, self.seed)
        in_vain = 0
        while in_vain < MOST_IN_VAIN and not (self.done() or regions.exhausted):
            began, worth = time.monotonic(), self.value
            if began >= until:
                break
            used = regions.draw() | self.taken()
            solved = self.on(used, relaxed, min(LONGEST_REGION, until - began))
            in_vain = 0 if self.value < worth else in_vain + 1
            if not solved:
                regions.shrink()
            elif time.monotonic() - began < EASY * LONGEST_REGION:
                regions.grow()

    @cached_property
    def own_visits(self) -> list[Row]:
        """Rows of every tree."""
        return own_visits(self.columns)

    def taken(self) -> Bools:
        """The columns that the incumbent uses."""
        return np.asarray(self.columns.point(self.routes) > 0)

    def near(self) -> bool:
        """Whether so little is open that local search is of no more use than a tree."""
        return self.open() <= NEAR

    def polish(self, relaxed: Relaxed) -> None:
        """Local search on the incumbent, unless so little is open that trees are of more use.

        Robots go only where the relaxation or the incumbent has them go: there are few better places,
        and the search is lost among the others.
        """
        if self.near():
            return
        visited = self.taken()[: self.columns.n_pairs]
        visited |= relaxed.point[: self.columns.n_pairs] > _TINY
        goes = np.zeros_like(self.data.can_visit)
        goes[tuple(self.columns.pairs[visited].T)] = True
        # On small missions trees take less time than any local search worth the name.
        seconds = min(POLISH * self.left(), 2 * self.spent(), LONGEST_POLISH)
        self.offer(
            improve(
                replace(self.data, able=self.data.able & goes[:, :, None]),
                self.routes,
                self.objective,
                seconds=seconds,
                seed=self.seed + 1,
                should_stop=self.done,
            )
        )

    def search(
        self,
        relaxed: Relaxed,
        upper: Floats,
        target: float,
        *,
        seconds: float,
        proved: Callable[[float], None] = lambda bound: None,
        more: Sequence[Row] = (),
    ) -> Tree:
        """Branch and cut for answers better than `target` on columns whose `upper` is not 0."""
        lower, upper = fixed(self.columns, relaxed, target, np.zeros(self.columns.n_columns), upper)

        def go_on(bound: float) -> bool:
            proved(bound)
            return not self.done()

        return search_tree()(
            self.columns,
            relaxed.cuts,
            lower,
            upper,
            best=target,
            time_limit=min(seconds, self.left()),
            seed=self.seed,
            improved=self.offer,
            go_on=go_on,
            more=[*self.own_visits, *more],
        )

    def branch(self, relaxed: Relaxed) -> None:
        """Branch and cut on all that fixing leaves."""
        target = self.value

        def proved(bound: float) -> None:
            self.raise_bound(min(bound, target, self.value), "branch and cut")

        tree = self.search(
            relaxed,
            self.columns.upper,
            target,
            seconds=self.left(),
            proved=proved,
            more=in_order(self.columns),
        )
        proved(tree.bound)

    def result(self) -> Bound:
        """The bound with its root relaxation."""
        if self.relaxed is None:
            return Bound(self.bound, self.proof, self.grain.step)
        cuts, prices = self.relaxed.cuts, self.relaxed.prices
        return Bound(self.bound, self.proof, self.grain.step, self.columns, cuts, prices)
