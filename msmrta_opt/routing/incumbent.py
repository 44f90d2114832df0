"""Incumbent and bound of a search: what every method keeps."""

from __future__ import annotations

import math
import time
from functools import cached_property

from ..mission.errors import InputError, SolverError
from .bound import Proof
from .callbacks import Callbacks, SearchState
from .objective_step import ROUNDING as ROUNDING
from .objective_step import ObjectiveStep, objective_step
from .objectives import Objective, objective_of
from .problem import SUMS, Routes, RoutingData, faults
from .stop import Interruption, StoppingCriterion, relative_gap

_NOTABLE = 1e-9
"""Relative difference from which on a value is better than another, constants apart."""


class Progress:
    """What is known so far; it only gets better.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    objective : str or Objective
        What to minimise; one of `objectives.OBJECTIVES`.
    incumbent : Routes
        Feasible routes to begin with.
    stop : StoppingCriterion, optional
        When to end the search; by default only once the gap is closed.
    callbacks : Callbacks, optional
        Told of what the search does.

    Raises
    ------
    InputError
        If `incumbent` is not feasible, or there is no such objective.
    """

    def __init__(
        self,
        data: RoutingData,
        objective: str | Objective,
        incumbent: Routes,
        *,
        stop: StoppingCriterion | None = None,
        callbacks: Callbacks | None = None,
    ) -> None:
        if wrong := faults(data, incumbent):
            raise InputError(f"not feasible: {wrong[0]}", field="incumbent")
        self.data, self.objective = data, objective_of(objective)
        self.stop, self.callbacks = stop or StoppingCriterion(), callbacks or Callbacks()
        self.began = time.monotonic()
        self.routes, self.value = incumbent, self.objective.value(data, incumbent)
        self.bound = -math.inf
        self.proof: Proof = "combinatorial"
        self.leeway = 0.0
        """Share by which bounds are lowered before they are rounded up, for sums of floats."""

    @cached_property
    def step(self) -> ObjectiveStep:
        """Which values the objective can take."""
        return objective_step(self.data, self.objective)

    def spent(self) -> float:
        """Seconds spent."""
        return time.monotonic() - self.began

    def left(self) -> float:
        """Seconds left; none once someone asked to stop."""
        return self.stop.seconds_left()

    def open(self) -> float:
        """Share of the incumbent's value that the bound leaves open."""
        return relative_gap(self.value, self.bound)

    def closed(self) -> bool:
        """Whether the incumbent is proved to be optimal."""
        return self.value - self.bound <= self.step.rounding(self.value)

    def done(self) -> bool:
        """Whether the gap is closed or the criterion met."""
        return self.closed() or self.stop.met(gap=self.open())

    def _notable(self) -> float:
        """By how much a value differs at the minimum from one like the incumbent's."""
        return _NOTABLE * abs(self.value - self.step.offset) + SUMS * abs(self.value)

    def until_done(self, seconds: float = math.inf) -> StoppingCriterion:
        """The criterion of a search within this one: `seconds`, or until this one is done."""
        return (self.stop | Interruption(self.done)).within(seconds)

    def better(self) -> float:
        """The maximum value of routes that are better than the incumbent."""
        return self.step.below(self.value)

    def bound_at_once(self) -> None:
        """Begin with the objective's combinatorial bound, unless there is a bound already."""
        if self.bound == -math.inf:
            self.raise_bound(self.objective.bound(self.data), "combinatorial")

    def raise_bound(self, bound: float, proof: Proof, *, of_better: bool = False) -> None:
        """A new bound, rounded up to a possible value.

        If it is only one of routes better than the incumbent, it may come out above it: then there
        are none.
        """
        bound = self.possible(bound)
        if bound > self.value + self.step.rounding(self.value) and not of_better:
            raise SolverError(
                f"internal error: bound {bound!r} ({proof}) above the feasible {self.value!r}"
            )
        bound = min(bound, self.value)
        if bound > self.bound + (self._notable() if bound < self.value else 0.0):
            self.bound, self.proof = bound, proof
            self.callbacks.bound_raised(self.state(), proof)

    def can_be_pruned(self, bound: float) -> bool:
        """Whether routes worth at least `bound` are no better than the incumbent."""
        return self.possible(bound) > self.better() + self._notable()

    def possible(self, bound: float) -> float:
        """The smallest possible value from `bound` on, with the leeway."""
        return self.step.up(bound * (1.0 - self.leeway))

    def offer(self, routes: Routes) -> bool:
        """Routes that may be better than the incumbent; whether they are."""
        if faults(self.data, routes):
            return False
        worth = self.objective.value(self.data, routes)
        if worth >= self.value - self._notable():
            return False
        if worth < self.bound - self.step.rounding(worth):
            raise SolverError(
                f"internal error: routes worth {worth!r} below the bound {self.bound!r}"
            )
        self.routes, self.value = routes, worth
        self.bound = min(self.bound, worth)
        self.callbacks.incumbent_found(self.state())
        return True

    def begin(self, phase: str) -> None:
        """Tell what happens now."""
        self.callbacks.phase_began(self.state(), phase)

    def state(self) -> SearchState:
        """How far the search has come."""
        return SearchState(self.routes, self.value, self.bound)
