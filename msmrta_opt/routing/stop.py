"""When a search ends: criteria that compose, as ``MaximumRuntime(60) | RelativeGap(0.01)``.

Every search takes one criterion, asks it between steps, and gives each solver that it calls no more
than the seconds that the criterion leaves.

Source: the stopping criteria of PyVRP (Wouda, Lan and Kool, INFORMS Journal on Computing 36, 2024).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import cached_property

from ..mission.errors import InputError


def relative_gap(value: float, bound: float) -> float:
    """The share of a minimised value that its lower bound leaves open, 0 to 1."""
    return max(0.0, value - bound) / abs(value) if value else 0.0


class StoppingCriterion:
    """When to stop; this one by itself never says so."""

    def met(self, *, gap: float = math.inf, iterations: int = 0) -> bool:
        """Whether to stop at this relative gap, after so many iterations."""
        del gap, iterations
        return self.seconds_left() <= 0.0

    def seconds_left(self) -> float:
        """Seconds of wall time that may still be spent, at least 0; infinite without a limit."""
        return math.inf

    @property
    def maximum_iterations(self) -> float:
        """Iterations that may be made in all; infinite without a limit."""
        return math.inf

    def within(self, seconds: float) -> StoppingCriterion:
        """The same, or `seconds` from now, whichever comes first."""
        return self | MaximumRuntime(seconds)

    def __or__(self, other: StoppingCriterion) -> StoppingCriterion:
        return AnyOf(self, other)


class MaximumRuntime(StoppingCriterion):
    """Stop `seconds` of wall time after this was made."""

    def __init__(self, seconds: float) -> None:
        _refuse_below_zero(seconds, "seconds")
        self.until = time.monotonic() + seconds

    def seconds_left(self) -> float:
        """Seconds until then."""
        return max(self.until - time.monotonic(), 0.0)


class MaximumIterations(StoppingCriterion):
    """Stop after `iterations` iterations of the search that asks."""

    def __init__(self, iterations: int) -> None:
        _refuse_below_zero(iterations, "iterations")
        self.iterations = iterations

    def met(self, *, gap: float = math.inf, iterations: int = 0) -> bool:
        """Whether so many have been made."""
        del gap
        return iterations >= self.iterations

    @property
    def maximum_iterations(self) -> float:
        """So many."""
        return self.iterations


class RelativeGap(StoppingCriterion):
    """Stop when the bound leaves open no more than the share `gap` of the incumbent's value."""

    def __init__(self, gap: float) -> None:
        _refuse_below_zero(gap, "gap")
        self.gap = gap

    def met(self, *, gap: float = math.inf, iterations: int = 0) -> bool:
        """Whether so little is open."""
        del iterations
        return gap <= self.gap


class Interruption(StoppingCriterion):
    """Stop once `asked`, for instance the ``is_set`` of an event that Ctrl-C sets, returns true."""

    def __init__(self, asked: Callable[[], bool]) -> None:
        self.asked = asked

    def seconds_left(self) -> float:
        """None once it was asked for."""
        return 0.0 if self.asked() else math.inf


class AnyOf(StoppingCriterion):
    """Stop as soon as one of `criteria` is met."""

    def __init__(self, *criteria: StoppingCriterion) -> None:
        self.criteria = criteria

    def met(self, *, gap: float = math.inf, iterations: int = 0) -> bool:
        """Whether one of them is."""
        return any(one.met(gap=gap, iterations=iterations) for one in self.criteria)

    def seconds_left(self) -> float:
        """What the first of them leaves."""
        return min((one.seconds_left() for one in self.criteria), default=math.inf)

    @cached_property
    def maximum_iterations(self) -> float:
        """What the first of them allows."""
        return min((one.maximum_iterations for one in self.criteria), default=math.inf)


def _refuse_below_zero(number: float, name: str) -> None:
    if not number >= 0:
        raise InputError(f"{number!r}; give 0 or more", field=name)
