"""Which values an objective can take at all: bounds may be rounded up to them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from .objectives import Objective, objective_of
from .problem import RoutingData

_LARGEST_DENOMINATOR = 10_000
_EXACT = 1e-9
_ROUNDING = 1e-6


@dataclass(frozen=True)
class ObjectiveStep:
    """Which values the objective can take: ``offset`` plus multiples of ``step``; any if it is 0."""

    offset: float
    step: float

    def up(self, bound: float) -> float:
        """The smallest possible value from `bound` on, up to rounding."""
        if self.step == 0.0 or not math.isfinite(bound):
            return bound
        steps = (bound - self.offset) / self.step
        slack = _ROUNDING * max(1.0, abs(bound)) / self.step
        # A slack of a step and more would round nothing: so small a step says nothing.
        return max(bound, self.offset + self.step * math.ceil(steps - min(slack, 0.5)))

    def below(self, value: float) -> float:
        """The greatest value that is better than the possible value `value`, up to rounding."""
        slack = _ROUNDING * max(1.0, abs(value))
        return value - (self.step - slack if self.step > 2 * slack else slack)


def objective_step(data: RoutingData, objective: str | Objective) -> ObjectiveStep:
    """Which values `objective` can take.

    They are multiples of the times' divisor, for weighted objectives times the priorities'.
    """
    objective = objective_of(objective)
    constant = objective.service_is_constant
    step = time_step(data, service=not constant)
    if objective.weighted:
        step *= _priority_step(data)
    return ObjectiveStep(data.total_service if constant else 0.0, step)


def time_step(data: RoutingData, *, service: bool = True) -> float:
    """The exact greatest common divisor of all times, with or without service; 0 if not known.

    Walking distances are whole and speeds are short decimals, so times are fractions with small
    denominators. If one is not (to 1e-9), nothing is claimed.
    """
    able = data.can_visit
    both = able[:, :, None] & able[:, None, :]
    times = [data.leave[able], data.back[able], data.between[both]]
    if service:
        times.append(data.service[data.required])
    divisor = Fraction(0)
    for time in np.unique(np.concatenate(times)):
        exact = Fraction(float(time)).limit_denominator(_LARGEST_DENOMINATOR)
        if abs(float(exact) - time) > _EXACT:
            return 0.0
        divisor = _common(divisor, exact)
        if divisor and divisor < Fraction(1, _LARGEST_DENOMINATOR):
            return 0.0
    return float(divisor)


def _priority_step(data: RoutingData) -> float:
    divisor = Fraction(0)
    for priority in set(data.priority.tolist()):
        exact = Fraction(priority).limit_denominator(_LARGEST_DENOMINATOR)
        if float(exact) != priority:
            return 0.0
        divisor = _common(divisor, exact)
    return float(divisor)


def _common(a: Fraction, b: Fraction) -> Fraction:
    """The greatest common divisor of two fractions."""
    return Fraction(
        math.gcd(a.numerator * b.denominator, b.numerator * a.denominator),
        a.denominator * b.denominator,
    )
