"""Which values an objective can take at all: bounds may be rounded up to them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Floats, Ints
from ..mission.exact import exact, greatest_common_divisor
from .objectives import Objective, objective_of
from .problem import SUMS, RoutingData

ROUNDING = 1e-6
"""Relative difference up to which values are the same, constants apart."""
_ROWS = 64
"""Of a table of lengths, looked at together."""
_SMALLEST = 1e-7
"""A step is of no use that is a smaller share of the longest time: rounding hides it."""


@dataclass(frozen=True)
class ObjectiveStep:
    """Which values the objective can take: ``offset`` plus multiples of ``step``; any if it is 0."""

    offset: float
    step: float

    def rounding(self, value: float) -> float:
        """How far apart values near `value` may be and yet be the same."""
        return ROUNDING * abs(value - self.offset) + SUMS * abs(value)

    def up(self, bound: float) -> float:
        """The smallest possible value from `bound` on, up to rounding."""
        if self.step == 0.0 or not math.isfinite(bound):
            return bound
        steps = (bound - self.offset) / self.step
        # A slack of a step and more would round nothing: so small a step says nothing.
        slack = min(self.rounding(bound) / self.step, 0.5)
        return max(bound, self.offset + self.step * math.ceil(steps - slack))

    def below(self, value: float) -> float:
        """The greatest value that is better than the possible value `value`, up to rounding."""
        slack = self.rounding(value)
        return value - (self.step - slack if self.step > 2 * slack else slack)


def objective_step(data: RoutingData, objective: str | Objective) -> ObjectiveStep:
    """Which values `objective` can take.

    They are multiples of the times' divisor, for weighted objectives times the priorities'.
    """
    objective = objective_of(objective)
    constant = objective.service_is_constant
    step = time_step(data, service=not constant)
    if objective.weighted:
        step *= _divisor(np.unique(data.priority), data.priority_unit)
    return ObjectiveStep(data.total_service if constant else 0.0, step)


def time_step(data: RoutingData, *, service: bool = True) -> float:
    """The greatest common divisor of all times, with or without service; 0 if it is of no use.

    Times are the fractions that they stand for in the mission's own unit; see `mission.exact`.
    """
    able = data.can_visit
    times = [data.leave[able], data.back[able], *_ways(data)]
    if service:
        times.append(data.service[data.required])
    return _divisor(np.unique(np.concatenate(times)), data.time_unit)


def _ways(data: RoutingData) -> Iterator[Floats]:
    """Times of ways of each robot between victims, with the divisor and the maximum of all of them."""
    lengths: dict[tuple[int, bytes], Floats] = {}
    unit = data.time_unit
    longest = [
        float(table.max(initial=0.0)) if _are_whole(table, unit) else None for table in data.length
    ]
    for r, own in enumerate(data.can_visit):
        table = r if len(data.length) > 1 else 0
        if (table, own.tobytes()) not in lengths:
            lengths[table, own.tobytes()] = _lengths(
                data.length[table], np.flatnonzero(own), unit, longest[table]
            )
        yield lengths[table, own.tobytes()] / data.speed[r]


def _are_whole(table: Floats, unit: float) -> bool:
    """Whether all lengths are whole numbers of cells, exactly."""
    return all(
        np.array_equal(cells, np.rint(cells)) and cells.max(initial=0.0) < 2**53
        for cells in (row * unit for row in table)
    )


def _lengths(table: Floats, victims: Ints, unit: float, longest: float | None) -> Floats:
    """Different lengths of ways between `victims`, with the divisor and the maximum of all of them.

    Where all are whole and some have no divisor but 1, the others do not change it: of the millions of
    ways of a large mission the first rows are enough. `longest` is then as good as their maximum.
    """
    found: Floats = np.zeros(0)
    for first in range(0, len(victims), _ROWS):
        some = table[np.ix_(victims[first : first + _ROWS], victims)]
        found = np.union1d(found, some)
        if longest is not None and np.gcd.reduce((found * unit).astype(np.int64)) == 1:
            return np.append(found, longest)
    return found


def _divisor(numbers: Floats, unit: float) -> float:
    """The greatest common divisor of `numbers`, which are exact once they are times `unit`."""
    own = numbers * unit
    smallest = _SMALLEST * float(own.max(initial=0.0))
    divisor = Fraction(0)
    for number in own.tolist():
        divisor = greatest_common_divisor((divisor, exact(number)))
        if 0 < divisor < smallest:
            return 0.0
    return float(divisor) / unit
