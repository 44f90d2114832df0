"""Which values an objective can take at all: bounds may be rounded up to them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Floats
from ..mission.exact import exact, greatest_common_divisor
from .objectives import Objective, objective_of
from .problem import RoutingData

_ROUNDING = 1e-6
_MOST_STEPS = 1_000_000
"""Steps in the largest of all numbers, from which on their divisor says nothing."""


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
        slack = _ROUNDING * abs(bound) / self.step
        # A slack of a step and more would round nothing: so small a step says nothing.
        return max(bound, self.offset + self.step * math.ceil(steps - min(slack, 0.5)))

    def below(self, value: float) -> float:
        """The greatest value that is better than the possible value `value`, up to rounding."""
        slack = _ROUNDING * abs(value)
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

    Walking distances are whole and speeds are short decimals, so times are simple fractions in the
    mission's own unit. If one is not, nothing is claimed.
    """
    able = data.can_visit
    both = able[:, :, None] & able[:, None, :]
    times = [data.leave[able], data.back[able], data.between[both]]
    if service:
        times.append(data.service[data.required])
    return _divisor(np.concatenate(times), data.time_unit)


def _priority_step(data: RoutingData) -> float:
    return _divisor(data.priority, data.priority_unit)


def _divisor(numbers: Floats, unit: float) -> float:
    """The greatest common divisor of `numbers`, which are exact once they are times `unit`."""
    values = np.unique(numbers)
    divisor, largest = Fraction(0), Fraction(float(values.max(initial=0.0)) * unit)
    for value in values.tolist():
        divisor = greatest_common_divisor([divisor, exact(value * unit)])
        if divisor * _MOST_STEPS < largest and divisor:
            return 0.0
    return float(divisor) / unit
