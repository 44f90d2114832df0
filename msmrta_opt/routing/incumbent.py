"""Incumbent, bound and clock of a search: what both exact methods keep."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from ..mission.errors import SolverError
from .bound import Proof, gap
from .objective_step import Grain
from .problem import Objective, Routes, RoutingData, faults, value

Report = Callable[[Routes, float, float, str], None]
"""Called with routes, their value, the bound, and what has just happened."""

ROUNDING = 1e-6
"""Relative difference up to which values are the same."""


class Progress:
    """What is known so far; it only gets better.

    Bounds are rounded up to values of `grain`, after being lowered by the share `leeway` for sums of
    floats.
    """

    def __init__(
        self,
        data: RoutingData,
        objective: Objective,
        incumbent: Routes,
        grain: Grain,
        *,
        leeway: float = 0.0,
        time_limit: float,
        gap: float,
        report: Report | None,
        should_stop: Callable[[], bool] | None,
    ) -> None:
        self.data, self.objective, self.gap = data, objective, gap
        self.began = time.monotonic()
        self.until = self.began + time_limit
        self.report, self.should_stop = report, should_stop or (lambda: False)
        self.grain, self.leeway = grain, leeway
        self.routes, self.value = incumbent, value(data, incumbent, objective)
        self.bound = -math.inf
        self.proof: Proof = "combinatorial"

    def left(self) -> float:
        """Seconds left."""
        return self.until - time.monotonic()

    def spent(self) -> float:
        """Seconds spent."""
        return time.monotonic() - self.began

    def open(self) -> float:
        """Share of the incumbent's value that the bound leaves open."""
        return gap(self.value, self.bound)

    def closed(self) -> bool:
        """Whether that is little enough."""
        return self.open() <= max(self.gap, ROUNDING)

    def done(self) -> bool:
        """Whether to stop: gap, time, or because someone asked."""
        return self.closed() or self.left() <= 0 or self.should_stop()

    def better(self) -> float:
        """What answers are worth at most that are better than the incumbent."""
        return self.grain.below(self.value)

    def raise_bound(self, bound: float, proof: Proof, *, of_better: bool = False) -> None:
        """A new bound, rounded up to a possible value.

        If it is only one of answers better than the incumbent, it may come out above it: then there
        are none.
        """
        bound = self.possible(bound)
        if bound > self.value + ROUNDING * max(1.0, abs(self.value)) and not of_better:
            raise SolverError(
                f"internal error: bound {bound!r} ({proof}) above the feasible {self.value!r}"
            )
        bound = min(bound, self.value)
        if bound > self.bound + ROUNDING:
            self.bound, self.proof = bound, proof
            self.tell(proof)

    def hopeless(self, bound: float) -> bool:
        """Whether answers worth at least `bound` are no better than the incumbent."""
        return self.possible(bound) > self.better() + ROUNDING

    def possible(self, bound: float) -> float:
        """The least possible value from `bound` on, with the leeway."""
        return self.grain.up(bound * (1.0 - self.leeway))

    def offer(self, routes: Routes) -> bool:
        """Routes that may be better than the incumbent; whether they are."""
        if faults(self.data, routes):
            return False
        worth = value(self.data, routes, self.objective)
        if worth >= self.value - ROUNDING:
            return False
        if worth < self.bound - ROUNDING * max(1.0, abs(worth)):
            raise SolverError(
                f"internal error: routes worth {worth!r} below the bound {self.bound!r}"
            )
        self.routes, self.value = routes, worth
        self.bound = min(self.bound, worth)
        self.tell("better routes")
        return True

    def tell(self, what: str) -> None:
        """Report the state."""
        if self.report is not None:
            self.report(self.routes, self.value, self.bound, what)
