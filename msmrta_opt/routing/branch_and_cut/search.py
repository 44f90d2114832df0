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
from ..bound import Bound
from ..heuristics.robot_subsets import improve_by_parts
from ..heuristics.ruin_and_recreate import ruin_and_recreate
from ..heuristics.victim_regions import Regions
from ..incumbent import Progress
from ..parameters import Parameters
from ..problem import Routes, RoutingData
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


def branch_and_cut(
    progress: Progress, *, seed: int = 0, parameters: Parameters | None = None
) -> Bound:
    """Close in on the best routes; they are then the incumbent of `progress`.

    Parameters
    ----------
    progress : Progress
        The joint problem with feasible routes, and when to stop; the better these routes are, the
        sooner the gap closes. Travel times should satisfy the triangle inequality, as walking does:
        without it solutions and bounds hold, but may not meet.
    seed : int
        Of all random choices.
    parameters : Parameters, optional
        How to search.

    Raises
    ------
    InputError
        If the edge formulation does not state the objective.
    SolverError
        If a bound exceeds the value of feasible routes: a bug, never to be passed over.
    """
    run = _Run(progress, seed, parameters or Parameters())
    run.close_in()
    return run.result()


def search_tree() -> _Search:
    """Branch and cut by SCIP where it is installed, by HiGHS where not."""
    if importlib.util.find_spec("pyscipopt") is not None:
        from .scip_tree import solve

        return solve
    from .highs_tree import resolve

    return resolve


class _Run:
    """The state of one run."""

    def __init__(self, progress: Progress, seed: int, parameters: Parameters) -> None:
        self.progress, self.data, self.objective = progress, progress.data, progress.objective
        self.seed, self.parameters = seed, parameters
        self.columns = Columns.of(self.data, self.objective, progress.value)
        self.relaxed: Relaxed | None = None
        self.seen = np.zeros(self.columns.n_columns, dtype=bool)
        progress.bound_at_once()

    def close_in(self, *, whole: bool = True) -> None:
        """Close in from both sides until done; `whole`, if this is no part of another run."""
        if self.progress.done():
            return
        relaxed = self.relax()
        many = whole and self.data.n_robots >= MANY_ROBOTS
        for step in (self.polish, self.seek if many else self.restricted, self.branch):
            if not self.progress.done():
                step(relaxed)

    def relax(self) -> Relaxed:
        """The root bound."""
        relaxation = Relaxation(self.columns, routes=self.progress.routes)
        self.relaxed = relaxation.solve(
            time_limit=self.progress.left(),
            tolerance=1e-2,
            tail=(15, 2e-5),
            report=lambda bound: self.progress.raise_bound(bound, "root LP"),
            should_stop=self.progress.done,
        )
        self.seen = relaxation.seen
        return self.relaxed

    def restricted(self, relaxed: Relaxed) -> None:
        """The integer program on the columns that the relaxation or the incumbent used."""
        self.on_few(relaxed, RESTRICTED * self.progress.left(), WIDTHS[0])

    def seek(self, relaxed: Relaxed) -> None:
        """Small programs, with ever more columns as long as they are easy; else in pieces."""
        until = time.monotonic() + min(SEEK * self.progress.left(), LONGEST_SEEK)
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
        used |= relaxed.reduced <= width * (self.progress.value - relaxed.bound)
        return self.on(used, relaxed, seconds)

    def on(self, used: Bools, relaxed: Relaxed, seconds: float) -> bool:
        """Branch and cut on some columns; returns whether it was solved."""
        if self.progress.done():
            return False
        upper = np.where(used, self.columns.upper, 0.0)
        return self.search(relaxed, upper, self.progress.value, seconds=seconds).complete

    def by_robots(self, relaxed: Relaxed, seconds: float) -> None:
        """The strong method on some robots at a time."""
        visit = np.zeros(self.data.can_visit.shape)
        # Points of linear programs are a hair below their bounds at times.
        visit[tuple(self.columns.pairs.T)] = np.maximum(relaxed.point[: self.columns.n_pairs], 0.0)
        split = np.minimum(visit[:, None], visit[None]).sum(axis=2)
        np.fill_diagonal(split, 0.0)

        def solve(part: RoutingData, routes: Routes, limit: float) -> Routes:
            inner = Progress(part, self.objective, routes, stop=self.progress.until_done(limit))
            _Run(inner, self.seed, self.parameters).close_in(whole=False)
            return inner.routes

        improve_by_parts(
            self.data,
            self.objective,
            self.progress.routes,
            split,
            solve,
            seconds=seconds,
            seed=self.seed,
            improved=self.progress.offer,
            should_stop=self.progress.done,
        )

    def by_regions(self, relaxed: Relaxed, until: float) -> None:
        """The program of a region at a time, until then, or until many in a row brought nothing."""
        regions = Regions(self.columns, relaxed.point, self.seed)
        in_vain = 0
        while in_vain < MOST_IN_VAIN and not (self.progress.done() or regions.exhausted):
            began, worth = time.monotonic(), self.progress.value
            if began >= until:
                break
            used = regions.draw() | self.taken()
            solved = self.on(used, relaxed, min(LONGEST_REGION, until - began))
            in_vain = 0 if self.progress.value < worth else in_vain + 1
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
        return np.asarray(self.columns.point(self.progress.routes) > 0)

    def near(self) -> bool:
        """Whether so little is open that local search is of no more use than a tree."""
        return self.progress.open() <= NEAR

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
        seconds = min(POLISH * self.progress.left(), 2 * self.progress.spent(), LONGEST_POLISH)
        self.progress.offer(
            ruin_and_recreate(
                replace(self.data, able=self.data.able & goes[:, :, None]),
                self.progress.routes,
                self.objective,
                stop=self.progress.until_done(seconds),
                seed=self.seed + 1,
                parameters=self.parameters.heuristics,
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
            return not self.progress.done()

        return search_tree()(
            self.columns,
            relaxed.cuts,
            lower,
            upper,
            best=target,
            time_limit=min(seconds, self.progress.left()),
            seed=self.seed,
            improved=self.progress.offer,
            go_on=go_on,
            more=[*self.own_visits, *more],
        )

    def branch(self, relaxed: Relaxed) -> None:
        """Branch and cut on all that fixing leaves."""
        target = self.progress.value

        def proved(bound: float) -> None:
            self.progress.raise_bound(min(bound, target, self.progress.value), "branch and cut")

        tree = self.search(
            relaxed,
            self.columns.upper,
            target,
            seconds=self.progress.left(),
            proved=proved,
            more=in_order(self.columns),
        )
        proved(tree.bound)

    def result(self) -> Bound:
        """The bound with its root relaxation."""
        progress = self.progress
        bound = Bound(progress.bound, progress.proof, progress.step.step)
        if self.relaxed is None:
            return bound
        cuts, prices = self.relaxed.cuts, self.relaxed.prices
        return replace(bound, columns=self.columns, cuts=cuts, prices=prices)
