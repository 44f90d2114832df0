"""Better incumbents between the root relaxation and the tree.

Ruin and recreate where the relaxation goes; the integer program restricted to the few columns of the
relaxation's last points and of the incumbent, whose solution is mostly much better than that; then with
ever more of the columns of small reduced cost. Where that is too hard, fix-and-optimise: some robots at
a time (`heuristics.robot_subsets`), then the victims of a region (`heuristics.victim_regions`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...arrays import Bools
from ..heuristics.robot_subsets import improve_robot_subsets
from ..heuristics.ruin_and_recreate import ruin_and_recreate
from ..heuristics.victim_regions import VictimRegions
from ..incumbent import Progress
from ..problem import Routes, RoutingData
from ..stop import MaximumRuntime, StoppingCriterion
from .root import Root

_TINY = 1e-6


class IncumbentSearch:
    """Better routes than the incumbent, found after `root`."""

    def __init__(self, root: Root) -> None:
        self.root = root
        self.progress, self.data = root.progress, root.progress.data
        self.formulation, self.relaxed = root.formulation, root.relaxed
        self.tuning, self.heuristics = root.parameters.branch_and_cut, root.parameters.heuristics

    def run(self, solve: Callable[[Progress], object], *, whole: bool) -> None:
        """Look for better routes for a share of the time.

        Parameters
        ----------
        solve : callable
            Closes in on the best routes of some of the robots.
        whole : bool
            Whether the mission is none of a subset of robots itself.
        """
        progress, tuning = self.progress, self.tuning
        # Where little is open, or the mission is small, a tree is of more use than local search.
        if progress.open() > tuning.polish_above_gap:
            progress.begin("ruin and recreate")
            self.polish()
        if progress.done():
            return
        if whole and self.data.n_robots >= tuning.many_robots:
            progress.begin("fix-and-optimise")
            self.fix_and_optimise(solve)
        else:
            progress.begin("restricted program")
            # A tree over all columns, too, is often soon done where so little was to be done so far.
            seconds = min(tuning.restricted_share * progress.left(), progress.spent())
            self.restricted(-math.inf, seconds)

    def polish(self) -> None:
        """Ruin and recreate, with robots only where the relaxation or the incumbent has them go.

        There are few better places, and the search is lost among the others.
        """
        progress, tuning = self.progress, self.tuning
        n_pairs = self.formulation.n_pairs
        visited = self.root.used()[:n_pairs] | (self.relaxed.point[:n_pairs] > _TINY)
        goes = np.zeros_like(self.data.can_visit)
        goes[tuple(self.formulation.pairs[visited].T)] = True
        # On small missions trees take less time than any local search worth the name.
        seconds = min(
            tuning.polish_share * progress.left(), 2 * progress.spent(), tuning.polish_seconds
        )
        progress.offer(
            ruin_and_recreate(
                replace(self.data, able=self.data.able & goes[:, :, None]),
                progress.routes,
                progress.objective,
                stop=progress.until_done(seconds),
                seed=self.root.seed + 1,
                parameters=self.heuristics,
            )
        )

    def fix_and_optimise(self, solve: Callable[[Progress], object]) -> None:
        """Restricted programs, with ever more columns as long as they are easy; else in pieces."""
        tuning = self.tuning
        stop = MaximumRuntime(
            min(tuning.incumbent_share * self.progress.left(), tuning.incumbent_seconds)
        )
        for width in (-math.inf, *tuning.reduced_costs):
            left = stop.seconds_left()
            limit = tuning.program_share * left
            solved = self.restricted(width, limit)
            if not solved or left - stop.seconds_left() > tuning.easy_share * limit:
                self.by_robot_subsets(solve, tuning.subsets_share * stop.seconds_left())
                self.by_victim_regions(stop)
                break

    def restricted(self, width: float, seconds: float) -> bool:
        """The program on the columns in use and those of small reduced cost; whether it was solved.

        `width` is the reduced cost up to which columns are taken in, as a share of what is open.
        """
        used = self.root.seen | self.root.used()
        used |= self.relaxed.reduced_costs <= width * (self.progress.value - self.relaxed.bound)
        return self.on(used, seconds)

    def on(self, columns: Bools, seconds: float) -> bool:
        """The program on some columns; whether it was solved."""
        if self.progress.done():
            return False
        upper = np.where(columns, self.formulation.upper, 0.0)
        return self.root.search(upper, stop=self.progress.until_done(seconds)).complete

    def by_robot_subsets(self, solve: Callable[[Progress], object], seconds: float) -> None:
        """Some robots at a time, those between which the relaxation splits victims."""
        visit = np.zeros(self.data.can_visit.shape)
        # Points of linear programs are a hair below their bounds at times.
        visit[tuple(self.formulation.pairs.T)] = np.maximum(
            self.relaxed.point[: self.formulation.n_pairs], 0.0
        )
        shared = np.minimum(visit[:, None], visit[None]).sum(axis=2)
        np.fill_diagonal(shared, 0.0)

        def improved(subset: RoutingData, routes: Routes, stop: StoppingCriterion) -> Routes:
            inner = Progress(subset, self.progress.objective, routes, stop=stop)
            solve(inner)
            return inner.routes

        improve_robot_subsets(
            self.progress,
            shared,
            improved,
            stop=self.progress.until_done(seconds),
            seed=self.root.seed,
            parameters=self.heuristics,
        )

    def by_victim_regions(self, stop: StoppingCriterion) -> None:
        """The program of a region at a time, until `stop`, or until many in a row bring nothing."""
        point = self.relaxed.point
        undecided = np.clip(np.minimum(point, 1.0 - point), 0.0, None)
        # What is about no victim goes to the last place.
        of_victim = np.zeros(self.data.n_victims + 1)
        np.add.at(of_victim, self.formulation.ends[:, 0], undecided)
        np.add.at(of_victim, self.formulation.ends[:, 1], undecided)
        regions = VictimRegions(self.data, of_victim[:-1], self.root.seed, self.heuristics)
        failures = 0
        while failures < self.heuristics.region_failures:
            left, value = stop.seconds_left(), self.progress.value
            if left <= 0.0 or self.progress.done() or regions.exhausted:
                break
            inside = np.append(regions.draw(), True)
            used = inside[self.formulation.ends].all(axis=1) | self.root.used()
            solved = self.on(used, min(self.heuristics.region_seconds, left))
            failures = 0 if self.progress.value < value else failures + 1
            easy = self.tuning.easy_share * self.heuristics.region_seconds
            if not solved:
                regions.shrink()
            elif left - stop.seconds_left() < easy:
                regions.grow()
