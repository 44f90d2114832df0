"""The restricted master program: the relaxation over the paths known so far, and its dual values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import highspy
import numpy as np

from ...arrays import Floats
from ..problem import RoutingData
from ..run_highs import run_highs
from ..stop import StoppingCriterion
from .duals import Duals
from .path_program import Path, PathProgram
from .tasks import Tasks

TINY = 1e-9
"""Shares of a path, and of a priority, up to which they count as none."""
_DUAL, _PRIMAL = 1, 4
"""Names that HiGHS has for its simplex methods."""


class Master:
    """The relaxation on the paths known so far.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    tasks : Tasks
        Its requirements.
    artificial_cost : float
        Of leaving a task unserved; to be raised if that pays.
    """

    def __init__(self, data: RoutingData, tasks: Tasks, artificial_cost: float) -> None:
        self.data, self.tasks, self.artificial_cost = data, tasks, artificial_cost
        self.paths: list[Path] = []
        self.breakpoints: list[Floats] = [np.zeros(1) for _ in range(data.n_victims)]
        self.value = math.inf
        """Of the last solution."""
        self.unserved = 0.0
        """How much it leaves to artificial variables."""
        self.used: list[tuple[float, Path]] = []
        """Its shares above 0, and their paths."""
        self._known: set[Path] = set()
        self._program: PathProgram | None = None

    def add(self, paths: Iterable[Path]) -> int:
        """Add paths; returns how many are new."""
        new = [path for path in dict.fromkeys(paths) if path not in self._known]
        self._known.update(new)
        self.paths += new
        if self._program is not None:
            self._program.add(new)
        return len(new)

    def keep(self, wanted: Callable[[Path], bool]) -> None:
        """Forget paths that are not wanted."""
        self.paths = [path for path in self.paths if wanted(path)]
        self._known = set(self.paths)
        self._program = None

    def raise_artificial_cost(self, factor: float) -> None:
        """Make it cost more to leave tasks unserved."""
        self.artificial_cost *= factor
        self._program = None

    def set_breakpoints(self, v: int, breakpoints: Floats) -> None:
        """Give victim `v` other breakpoints."""
        self.breakpoints[v] = breakpoints
        self._program = None

    def solve(self, stop: StoppingCriterion) -> Duals | None:
        """The dual values, made to hold exactly; ``None`` if it could not be solved."""
        first = self._program is None
        if self._program is None:
            self._program = PathProgram(
                self.data, self.tasks, self.breakpoints, self.artificial_cost
            )
            self._program.add(self.paths)
        highs = self._program.highs
        # From scratch the dual simplex method is fastest, after new paths the primal.
        highs.setOptionValue("simplex_strategy", _DUAL if first else _PRIMAL)
        run_highs(highs, stop)
        if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        solution = highs.getSolution()
        self.value = float(highs.getInfo().objective_function_value)
        self.unserved = float(np.sum(solution.col_value[: len(self.tasks)]))
        z = np.array(solution.col_value)[self._program.first_path :]
        self.used = [(float(z[p]), self.paths[p]) for p in np.flatnonzero(z > TINY)]
        return self._duals(np.array(solution.row_dual), self._program)

    def _duals(self, dual: Floats, program: PathProgram) -> Duals:
        """Densities of each victim that add up to its priority."""
        tasks, priority = self.tasks, self.data.priority
        density = [np.full(len(self.breakpoints[v]), priority[v]) for v in tasks.victim]
        for v, own in enumerate(tasks.of):
            if not tasks.split(v):
                continue
            n = len(self.breakpoints[v])
            raw = np.array([dual[program.link[g] : program.link[g] + n] for g in own])
            raw = np.maximum(raw, 0.0)
            total = raw.sum(axis=0)
            even = np.full_like(raw, priority[v] / len(own))
            scaled = raw * np.divide(priority[v], total, out=np.zeros(n), where=total > 0)
            for g, mu in zip(own, np.where(total > TINY, scaled, even), strict=True):
                density[g] = mu
        return Duals(
            np.maximum(dual[: len(tasks)], 0.0),
            tuple(density),
            tuple(self.breakpoints),
            tasks.victim,
        )
