"""The grid of an objective: a bound between two values that integer points can have is rounded up.

Costs that are multiples of a step only up to the rounding of floats (100/3 for one) count as well: what
is left of them times the columns' bounds is small, and is added to the bound exactly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from .derivation import Box
from .exact import ExactProgram, Rational

ROUNDING = 1e-12
"""Relative difference up to which a cost is a multiple of a step."""
LARGEST_RATIO = 100_000
"""Of the smallest cost to the step."""


@dataclass(frozen=True)
class Grid:
    """The objective is ``step`` times an integer combination, and a rest of small coefficients."""

    step: Fraction
    whole: tuple[tuple[int, int], ...]
    """Columns and their integer coefficients."""
    rest_above: tuple[tuple[int, Fraction], ...]
    """References of the bounds at which the rest is largest, and its coefficients there."""
    rest_below: tuple[tuple[int, Fraction], ...]
    above: Fraction
    """The largest value of the rest."""
    below: Fraction

    def minimum(self, bound: Fraction) -> int:
        """The least value of the combination where the objective is at least `bound`."""
        return math.ceil((bound - self.above) / self.step)

    def proved(self, bound: Fraction) -> Fraction:
        """The bound on the objective that follows from `bound`."""
        return self.step * self.minimum(bound) + self.below

    def target(self, point: Sequence[Rational]) -> Fraction:
        """A bound from which the value of `point` follows, up to the rest."""
        value = sum(k * point[j] for j, k in self.whole)
        return self.step * (value - 1) + self.above + self.step / 64

    @property
    def references(self) -> set[int]:
        """Of the bounds that it uses."""
        return {at for at, _ in (*self.rest_above, *self.rest_below)}


def grid_of(program: ExactProgram, box: Box) -> Grid | None:
    """The grid of the objective of `program`; ``None`` if it has none that is worth it."""
    whole: list[tuple[int, Fraction]] = []
    rest: list[tuple[int, Fraction]] = []
    for j, cost in enumerate(program.cost):
        if not cost:
            continue
        if program.lower[j] is not None and program.lower[j] == program.upper[j]:
            rest.append((j, cost))
        elif program.integer[j]:
            whole.append((j, cost))
        else:
            return None
    if not whole:
        return None
    step = _step([cost for _, cost in whole])
    if step is None:
        return None
    combination = []
    for j, cost in whole:
        k = round(cost / step)
        combination.append((j, k))
        if left := cost - k * step:
            rest.append((j, left))
    ends: list[list[tuple[int, Fraction]]] = [[], []]
    values = [Fraction(0), Fraction(0)]
    for j, left in rest:
        for which, positive in enumerate((box.upper, box.lower)):
            side = positive[j] if left > 0 else (box.lower, box.upper)[which][j]
            if side is None:
                return None
            ends[which].append((side.at, left))
            values[which] += left * side.bound
    if values[0] - values[1] > step / 256:
        return None
    return Grid(step, tuple(combination), tuple(ends[0]), tuple(ends[1]), values[0], values[1])


def _step(costs: Sequence[Fraction]) -> Fraction | None:
    """A number of which all `costs` are multiples, nearly."""
    smallest = min(map(abs, costs))
    together = 1
    for ratio in {abs(cost) / smallest for cost in costs}:
        near = ratio.limit_denominator(LARGEST_RATIO // together + 1)
        if abs(near - ratio) > ROUNDING * ratio:
            return None
        together = math.lcm(together, near.denominator)
        if together > LARGEST_RATIO:
            return None
    return smallest / together
