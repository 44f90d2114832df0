"""Bounds of columns that the program does not state, but implies: lemmas for derivations.

An integer column with a bound that is no integer has the next one within. A column without a bound has
one if a row has, whose other columns are bounded: only so can what rounding leaves of its reduced cost
be paid.
"""

from __future__ import annotations

import math
from collections import defaultdict
from fractions import Fraction
from functools import partial

from .derivation import Box, Lemma, Lemmas, Side, Uses
from .exact import ExactProgram, Rational, Row

PASSES = 20
LARGEST = 1 << 50
"""Implied bounds beyond this are of no use."""


def implied_bounds(program: ExactProgram, lemmas: Lemmas) -> Box:
    """The bounds of `program`'s columns, and what it implies for those without."""
    box = Box.of(program)
    for j, integer in enumerate(program.integer):
        if integer:
            _round(box, lemmas, j)
    missing = {j for j in range(program.n_columns) if box.lower[j] is None or box.upper[j] is None}
    if not missing:
        return box
    rows: dict[int, list[Row]] = defaultdict(list)
    for row in program.rows:
        for j in row.columns:
            if j in missing:
                rows[j].append(row)
    for _ in range(PASSES):
        added = [_imply(program, box, lemmas, j, rows[j]) for j in sorted(missing)]
        if not any(added):
            break
        missing = {j for j in missing if box.lower[j] is None or box.upper[j] is None}
    return box


def _round(box: Box, lemmas: Lemmas, j: int) -> None:
    for sides, sense, rounded in ((box.lower, "G", math.ceil), (box.upper, "L", math.floor)):
        side = sides[j]
        if side is not None and side.bound.denominator != 1:
            whole = rounded(side.bound)
            at = lemmas.rounded(sense, Fraction(side.bound), ((j, 1),), ((side.at, 1),))
            sides[j] = Side(whole, at)


def _imply(program: ExactProgram, box: Box, lemmas: Lemmas, j: int, rows: list[Row]) -> bool:
    """Add the tightest bounds of column `j` that single rows imply, where it has none."""
    added = False
    for upper in (False, True):
        sides = box.upper if upper else box.lower
        if sides[j] is not None:
            continue
        best: tuple[Fraction, Uses] | None = None
        for row in rows:
            found = _by_row(box, row, j, upper)
            if found and (best is None or (found[0] < best[0] if upper else found[0] > best[0])):
                best = found
        if best is None or abs(best[0]) > LARGEST:
            continue
        bound, uses = best
        sense = "L" if upper else "G"
        value: Rational = int(bound) if bound.denominator == 1 else bound
        if program.integer[j]:
            value = math.floor(bound) if upper else math.ceil(bound)
            at = lemmas.rounded(sense, bound, ((j, 1),), uses)
        else:
            at = lemmas.add(Lemma(sense, value, ((j, 1),), "lin", partial(tuple, uses)))
        sides[j] = Side(value, at)
        added = True
    return added


def _by_row(box: Box, row: Row, j: int, upper: bool) -> tuple[Fraction, Uses] | None:
    """The bound of column `j` that `row` implies, and the multipliers that derive it."""
    own = next(a for k, a in zip(row.columns, row.coefficients, strict=True) if k == j)
    # Over its own coefficient the row gives an upper bound where that sign and side agree.
    from_upper = (own > 0) == upper
    side, at = (row.upper, row.at_upper) if from_upper else (row.lower, row.at_lower)
    if side is None:
        return None
    bound = Fraction(side, own)
    uses: list[tuple[int, Rational]] = [(at, Fraction(row.factor, own))]
    for k, a in zip(row.columns, row.coefficients, strict=True):
        if k == j:
            continue
        ratio = Fraction(a, own)
        other = box.lower[k] if (ratio > 0) == upper else box.upper[k]
        if other is None:
            return None
        bound -= ratio * other.bound
        uses.append((other.at, -ratio))
    return bound, tuple(uses)
