r"""Exact derivations of bounds from floating-point dual multipliers.

For any multipliers y of the rows, each of the sign that its side allows, the objective is at least

    Σ y b + Σ_j d_j · (lower bound of column j if d_j > 0, upper bound if d_j < 0),    d = c − A'y

(weak duality). So duals may be rounded to short fractions before, and what this leaves of the reduced
costs is paid at the columns' bounds: the bound that is then derived is exact, whatever the duals were.
It fails only where a column has no bound on the side that is needed; there y itself must be exact
(`basis`).

All is added up in integers over one denominator.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from ..arrays import Floats
from .derivation import Box, Combination
from .exact import ExactProgram, Rational, Row

PRECISIONS = (0, 7, 16, 28, 44)
"""Bits of the multipliers beyond the size of the costs, tried in this order: fewer are shorter to write
and quicker to check."""
LARGEST_DENOMINATOR = 5_040
"""Of multipliers that are taken for simple fractions, before these."""


class Bounds:
    """Bounds on the objective of `program` with `rows`, which may hold cuts beyond its own."""

    def __init__(self, program: ExactProgram, rows: list[Row]) -> None:
        self.program = program
        self.rows = rows
        self._cost_under = math.lcm(*(c.denominator for c in program.cost))
        self._cost = [c.numerator * (self._cost_under // c.denominator) for c in program.cost]
        largest = max((abs(float(c)) for c in program.cost), default=0.0)
        self._cost_size = math.frexp(largest)[1] if largest else 0
        self._absurd = next(filter(None, map(_absurd, program.rows)), None)
        self._enough = 0
        """The number of precisions that were not enough last time."""

    def derive(self, duals: Floats, box: Box, target: Fraction | None) -> Combination | None:
        """A derivation of at least `target` from `duals`; the best there is if that is ``None``.

        ``None`` if they do not give it.
        """
        simple = _simple(duals)
        if simple is not None:
            found = self.exactly(simple, box)
            if found is not None and (target is None or (found.value or 0) >= target):
                return found
        start = max(self._enough - 1, 0) if target is not None else len(PRECISIONS) - 1
        for place in range(start, len(PRECISIONS)):
            found = self._rounded(duals, box, PRECISIONS[place], self._cost, self._cost_size)
            if found is not None and (target is None or (found.value or 0) >= target):
                self._enough = place
                return found
        return None

    def contradiction(self, ray: Floats, box: Box) -> Combination | None:
        """A derivation of ``0 ≥ value > 0`` from a ray of the dual; ``None`` if it does not give it."""
        if (evident := self.evident(box)) is not None:
            return evident
        nothing = [0] * self.program.n_columns
        for bits in PRECISIONS:
            for signed in (ray, -ray):
                found = self._rounded(signed, box, bits, nothing, 1)
                if found is not None and found.value is not None and found.value > 0:
                    return replace(found, value=None)
        return None

    def evident(self, box: Box) -> Combination | None:
        """A contradiction that needs no relaxation: bounds that cross, or a row without columns."""
        for low, high in zip(box.lower, box.upper, strict=True):
            if low is not None and high is not None and low.bound > high.bound:
                return Combination(None, {low.at: 1, high.at: -1}, 1)
        return self._absurd

    def exactly(self, duals: Sequence[Rational], box: Box) -> Combination | None:
        """The derivation that exact `duals` give, if their signs allow it."""
        common = math.lcm(self._cost_under, *(y.denominator for y in duals))
        weights = [y.numerator * (common // y.denominator) for y in duals]
        cost = [c * (common // self._cost_under) for c in self._cost]
        return self._combined(weights, cost, common, box)

    def _rounded(
        self, duals: Floats, box: Box, bits: int, cost: list[int], size: int
    ) -> Combination | None:
        precisions, numbers = [], []
        for row, dual in zip(self.rows, duals.tolist(), strict=True):
            if not dual or (dual > 0 and row.lower is None) or (dual < 0 and row.upper is None):
                precisions.append(0)
                numbers.append(0)
                continue
            precision = bits - size + max((a.bit_length() for a in row.coefficients), default=1) - 1
            precisions.append(precision)
            numbers.append(_rounded_to(dual, precision))
        finest = max(0, max(precisions, default=0))
        weights = [
            (n << (finest - p)) * self._cost_under if n else 0
            for n, p in zip(numbers, precisions, strict=True)
        ]
        shifted = [c << finest for c in cost]
        return self._combined(weights, shifted, self._cost_under << finest, box)

    def _combined(
        self, weights: list[int], reduced: list[int], under: int, box: Box
    ) -> Combination | None:
        """The combination of rows by ``weights / under``, with bounds to make up what is left."""
        value, fractions = 0, Fraction(0)
        multipliers: dict[int, int] = {}
        for row, weight in zip(self.rows, weights, strict=True):
            if not weight:
                continue
            side, at = (row.lower, row.at_lower) if weight > 0 else (row.upper, row.at_upper)
            if side is None:
                return None
            value += weight * side
            multipliers[at] = multipliers.get(at, 0) + weight * row.factor
            for j, a in zip(row.columns, row.coefficients, strict=True):
                reduced[j] -= weight * a
        for j, left in enumerate(reduced):
            if not left:
                continue
            bound = box.lower[j] if left > 0 else box.upper[j]
            if bound is None:
                return None
            if isinstance(bound.bound, int):
                value += left * bound.bound
            else:
                fractions += left * bound.bound
            multipliers[bound.at] = multipliers.get(bound.at, 0) + left
        total = Fraction(value, under) + fractions / under
        return Combination(total, multipliers, under)


def _absurd(row: Row) -> Combination | None:
    """The contradiction that a row without columns is, if it is one."""
    if row.columns:
        return None
    if row.lower is not None and row.lower > 0:
        return Combination(None, {row.at_lower: 1}, 1)
    if row.upper is not None and row.upper < 0:
        return Combination(None, {row.at_upper: -1}, 1)
    return None


def _simple(duals: Floats) -> list[Rational] | None:
    """`duals` as fractions of small denominators, if they all are within rounding of some."""
    simple: list[Rational] = []
    common = 1
    for dual in duals.tolist():
        number: Rational = round(dual)
        if number != dual:
            number = Fraction(dual).limit_denominator(LARGEST_DENOMINATOR)
            common = math.lcm(common, number.denominator)
            if abs(float(number) - dual) > 1e-9 * abs(dual) or common > LARGEST_DENOMINATOR:
                return None
        simple.append(number)
    return simple


def _rounded_to(number: float, bits: int) -> int:
    """The integer next to ``number * 2**bits``."""
    try:
        return round(math.ldexp(number, bits))
    except OverflowError:
        over, under = number.as_integer_ratio()
        return (over << bits) // under if bits > 0 else over // (under << -bits)
