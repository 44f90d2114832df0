"""Mixed-integer rounding cuts in exact numbers, with their derivations.

Rows are added up to an equation Σ a t = b in terms t ≥ 0 that are distances from bounds (of columns, or
of a continuous column from a multiple of an integer one) and slacks of rows. Divided by δ, with
f = b/δ − ⌊b/δ⌋ > 0 and the fractions f_t of the coefficients of integer terms, it gives

    Σ_integer (⌊a/δ⌋ + max(0, f_t − f) / (1 − f)) t + Σ_continuous min(0, a/δ) / (1 − f) t ≤ ⌊b/δ⌋

(mixed-integer rounding; Nemhauser and Wolsey 1990). In a proof this is a disjunction: with k = ⌊a/δ⌋
where f_t ≤ f and ⌈a/δ⌉ elsewhere, either Σ k t ≤ ⌊b/δ⌋ or Σ k t ≥ ⌊b/δ⌋ + 1. On the first side the cut
is that plus multiples of t ≥ 0; on the second it is 1/(1 − f) times the equation over δ, less f/(1 − f)
times the disjunction's side, plus such multiples. Coefficients are then rounded to short ones, for
which the columns' bounds pay.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from .derivation import Box, Lemma, Lemmas, Side, Uses
from .exact import ExactProgram, Rational, Row
from .numeric_rows import VariableBound
from .rounding_choice import HALVINGS
from .separation import WEIGHT_BITS
from .summed_rows import Found

SHORT = 16
"""Bits of a cut's coefficients beyond their size."""
LONGEST_NUMBER = 220
"""Bits."""


@dataclass(slots=True)
class Term:
    """``constant + Σ coefficients · columns ≥ 0``, which is `weight` times constraint `at`."""

    columns: Iterable[int]
    coefficients: list[int]
    constant: Rational
    at: int
    weight: int
    integer: bool
    a: Fraction
    """Its coefficient in the equation."""


@dataclass(slots=True)
class Equation:
    """The terms, the side, and the multipliers of the equations among the rows."""

    terms: list[Term]
    side: Fraction
    equations: list[tuple[int, Fraction]]


def derive(
    program: ExactProgram, rows: list[Row], box: Box, lemmas: Lemmas, found: Found
) -> Row | None:
    """The cut that was `found`, derived by lemmas; ``None`` if nothing is left of it."""
    equation = _equation(program, rows, box, found)
    if equation is None:
        return None
    delta = _delta(equation.terms, found.delta)
    if delta is None or not (equation.side / delta) % 1:
        return None
    return _Rounding(box, equation, delta).by_lemmas(lemmas)


def _equation(program: ExactProgram, rows: list[Row], box: Box, found: Found) -> Equation | None:
    """What the sum of the rows amounts to."""
    weights = {i: _simple(weight) for i, weight in found.weights.items()}
    common = math.lcm(*(weight.denominator for weight in weights.values()))
    total: dict[int, int] = {}
    result = Equation([], Fraction(0), [])
    side = 0
    for i, weight in weights.items():
        row, times = rows[i], int(weight * common)
        for j, c in zip(row.columns, row.coefficients, strict=True):
            total[j] = total.get(j, 0) + times * c
        end = row.upper if i in found.at_upper else row.lower
        if end is None:
            return None
        side += times * end
        if row.lower == row.upper:
            result.equations.append((row.at_upper, weight * row.factor))
        else:
            result.terms.append(_slack(program, row, i in found.at_upper, weight))
    result.side = Fraction(side, common)
    on_integers: dict[int, Fraction] = {}
    for j, numerator in total.items():
        a = Fraction(numerator, common)
        if program.integer[j]:
            on_integers[j] = on_integers.get(j, Fraction(0)) + a
        elif a:
            if j not in found.nearest:
                return None
            is_upper, bound = found.nearest[j]
            sign = -1 if is_upper else 1
            if isinstance(bound, VariableBound):
                result.side -= a * bound.at_zero
                on_integers[bound.column] = (
                    on_integers.get(bound.column, Fraction(0)) + a * bound.slope
                )
                result.terms.append(_from_row(program, rows[bound.row], j, is_upper, sign * a))
            else:
                result.side -= a * bound.bound
                result.terms.append(_distance(j, bound, is_upper, False, sign * a))
    for j, a in on_integers.items():
        if not a:
            continue
        is_upper = j in found.from_upper or box.lower[j] is None
        end_of = box.upper[j] if is_upper else box.lower[j]
        if end_of is None:
            return None
        result.side -= a * end_of.bound
        result.terms.append(_distance(j, end_of, is_upper, True, -a if is_upper else a))
    return result


def _slack(program: ExactProgram, row: Row, at_upper: bool, weight: Fraction) -> Term:
    """The slack of a row, of which the sum holds `weight` times the row."""
    sign = -1 if at_upper else 1
    side, at = (row.upper, row.at_upper) if at_upper else (row.lower, row.at_lower)
    assert side is not None
    whole = all(program.integer[j] for j in row.columns)
    coefficients = [sign * a for a in row.coefficients]
    a = weight if at_upper else -weight
    return Term(row.columns, coefficients, -sign * side, at, sign * row.factor, whole, a)


def _from_row(program: ExactProgram, row: Row, y: int, is_upper: bool, a: Fraction) -> Term:
    """How far a continuous column is from its variable bound, times its coefficient in the row."""
    own = next(c for j, c in zip(row.columns, row.coefficients, strict=True) if j == y)
    slack = _slack(program, row, (own > 0) == is_upper, Fraction(1))
    slack.integer, slack.a = False, a / abs(own)
    return slack


def _distance(j: int, side: Side, is_upper: bool, integer: bool, a: Fraction) -> Term:
    """How far a column is from a bound."""
    sign = -1 if is_upper else 1
    return Term((j,), [sign], -sign * side.bound, side.at, sign, integer, a)


def _delta(terms: list[Term], near: float) -> Fraction | None:
    """The size of a coefficient, or its half and so on, that is nearest to `near`."""
    best, minimum = None, math.inf
    for term in terms:
        if term.integer and term.a:
            size = float(abs(term.a))
            for k in range(HALVINGS + 1):
                if abs(size / 2**k - near) < minimum:
                    best, minimum = abs(term.a) / 2**k, abs(size / 2**k - near)
    return best if minimum <= 1e-3 * near else None


class _Rounding:
    """One cut."""

    def __init__(self, box: Box, equation: Equation, delta: Fraction) -> None:
        self.box = box
        self.terms = equation.terms
        self.equations = equation.equations
        self.delta = delta
        side = equation.side / delta
        self.whole = math.floor(side)
        self.f = side - self.whole
        self.k: list[int] = []
        """The coefficients of the terms in the disjunction."""
        self.g: list[Fraction] = []
        """Those in the cut."""
        for term in equation.terms:
            a = term.a / delta
            below = math.floor(a)
            if term.integer:
                over = a - below - self.f
                self.k.append(below if over <= 0 else below + 1)
                exact = below + over / (1 - self.f) if over > 0 else Fraction(below)
            else:
                self.k.append(0)
                exact = a / (1 - self.f) if a < 0 else Fraction(0)
            self.g.append(_shortened(exact, term))

    def by_lemmas(self, lemmas: Lemmas) -> Row | None:
        """The cut as a row, with lemmas that derive it."""
        split, fixed = self._sum(self.k, 0)
        if not split or fixed.denominator != 1:
            return None
        edge = self.whole - int(fixed)
        if all(
            k == g and k <= term.a / self.delta
            for term, k, g in zip(self.terms, self.k, self.g, strict=True)
        ):
            return self._rounded(lemmas, split, fixed)
        shift = max((g.denominator.bit_length() - 1 for g in self.g), default=0)
        sum_of_g, constant = self._sum([int(g * (1 << shift)) for g in self.g], shift)
        paid: dict[int, Rational] = {}
        side = self._shorten(sum_of_g, self.whole - constant, paid, shift)
        # Everything is a multiple of a power of two; the row is in integers.
        scale = Fraction(1 << shift, math.gcd(*sum_of_g.values()) or 1)
        columns = sorted(sum_of_g)
        coefficients = [int(Fraction(sum_of_g[j], 1 << shift) * scale) for j in columns]
        upper = math.ceil(side * scale)
        if (
            not columns
            or max(upper.bit_length(), *map(int.bit_length, coefficients)) > LONGEST_NUMBER
        ):
            return None
        terms = tuple(zip(columns, coefficients, strict=True))
        split_terms = tuple(sorted(split.items()))
        low = lemmas.add(Lemma("L", edge, split_terms, "asm"))
        high = lemmas.add(Lemma("G", edge + 1, split_terms, "asm"))
        on_low = lemmas.add(
            Lemma("L", upper, terms, "lin", partial(self._on_low, low, paid, scale))
        )
        on_high = lemmas.add(
            Lemma("L", upper, terms, "lin", partial(self._on_high, high, paid, scale))
        )
        order = tuple((at, 0) for at in (on_low, low, on_high, high))
        at = lemmas.add(Lemma("L", upper, terms, "uns", partial(tuple, order)))
        return Row(columns, coefficients, None, upper, 1, -1, at)

    def _on_low(self, low: int, paid: dict[int, Rational], scale: Fraction) -> Uses:
        """The multipliers where the disjunction's ≤ holds."""
        uses: list[tuple[int, Rational]] = [(low, 1), *paid.items()]
        uses += [
            (term.at, (g - k) * term.weight)
            for term, k, g in zip(self.terms, self.k, self.g, strict=True)
            if k != g
        ]
        return _merged(uses, scale)

    def _on_high(self, high: int, paid: dict[int, Rational], scale: Fraction) -> Uses:
        """The multipliers where its ≥ holds."""
        over, both = 1 / (1 - self.f), 1 / (self.delta * (1 - self.f))
        uses: list[tuple[int, Rational]] = [(high, -self.f * over), *paid.items()]
        uses += [(at, weight * both) for at, weight in self.equations]
        uses += [
            (term.at, (g + self.f * over * k - term.a * both) * term.weight)
            for term, k, g in zip(self.terms, self.k, self.g, strict=True)
        ]
        return _merged(uses, scale)

    def _rounded(self, lemmas: Lemmas, split: dict[int, int], fixed: Fraction) -> Row:
        """The cut where it is a rounded sum of the rows and of multiples of the terms."""
        uses: list[tuple[int, Rational]] = [(at, w / self.delta) for at, w in self.equations]
        uses += [
            (term.at, (k - term.a / self.delta) * term.weight)
            for term, k in zip(self.terms, self.k, strict=True)
        ]
        terms = tuple(sorted(split.items()))
        side = self.whole + self.f - fixed
        at = lemmas.rounded("L", side, terms, _merged(uses, Fraction(1)))
        upper = math.floor(side)
        return Row([j for j, _ in terms], [a for _, a in terms], None, upper, 1, -1, at)

    def _sum(self, weights: Iterable[int], shift: int) -> tuple[dict[int, int], Fraction]:
        """``2**shift`` times the sum of coefficients of the weighted terms, and that of constants."""
        total: dict[int, int] = {}
        constant = Fraction(0)
        for term, weight in zip(self.terms, weights, strict=True):
            if weight:
                constant += weight * term.constant
                for j, c in zip(term.columns, term.coefficients, strict=True):
                    total[j] = total.get(j, 0) + weight * c
        return {j: c for j, c in total.items() if c}, constant / (1 << shift)

    def _shorten(
        self, total: dict[int, int], side: Fraction, paid: dict[int, Rational], shift: int
    ) -> Fraction:
        """Round the coefficients, with what that costs added to the side; `paid` by bounds."""
        largest = max((c.bit_length() for c in total.values()), default=0)
        unit = 1 << max(largest - SHORT, 0)
        for j, c in list(total.items()):
            low, high = self.box.lower[j], self.box.upper[j]
            left = c % unit
            if left and low is not None:
                paid[low.at] = paid.get(low.at, 0) - Fraction(left, 1 << shift)
                side -= Fraction(left, 1 << shift) * low.bound
                total[j] -= left
            elif left and high is not None:
                paid[high.at] = paid.get(high.at, 0) + Fraction(unit - left, 1 << shift)
                side += Fraction(unit - left, 1 << shift) * high.bound
                total[j] += unit - left
            if not total[j]:
                del total[j]
        return side


def _simple(weight: float) -> Fraction:
    """A simple fraction next to `weight`, if there is one; else a short one."""
    near = Fraction(weight).limit_denominator(2048)
    if abs(float(near) - weight) <= 1e-12 * abs(weight):
        return near
    return Fraction(round(weight * 2.0**WEIGHT_BITS), 1 << WEIGHT_BITS)


def _shortened(g: Fraction, term: Term) -> Fraction:
    """`g`, rounded down to a number of few bits."""
    if g.denominator == 1:
        return g
    bits = SHORT + 4 + max(c.bit_length() for c in term.coefficients)
    return Fraction(math.floor(g * (1 << bits)), 1 << bits)


def _merged(uses: Iterable[tuple[int, Rational]], scale: Fraction) -> Uses:
    """Each reference once, with `scale` times the sum of its multipliers, if that is not 0."""
    total: dict[int, Rational] = {}
    for at, weight in uses:
        total[at] = total[at] + weight if at in total else weight
    return tuple((at, weight * scale) for at, weight in total.items() if weight)
