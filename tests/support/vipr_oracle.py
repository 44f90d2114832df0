"""Brute force on what a certificate itself states, in fractions: is its claim true?

The program is read by the checker's reader; everything else is worked out here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from pathlib import Path

from msmrta_opt.certify import vipr

Point = tuple[Fraction, ...]
WIDEST = range(-3, 5)
"""What is looked at of a variable without bounds: too little to confirm a claim, enough to refute it."""


def refutation(path: Path) -> str:
    """A point of the stated program that refutes the claim of the certificate at `path`, or nothing.

    A claim of infeasibility is refuted by a point, that of a range by one that is better than it, and by
    none at all where a solution is claimed. Continuous variables are looked at in steps of a half.
    """
    with path.open("rb") as file:
        reader = vipr.Reader(file)
        found = vipr.read_program(reader)
        vipr.read_claim(reader, found)
    values = [_value(found, point) for point in _points(found)]
    if found.infeasible:
        return f"there is a point of value {values[0]}" if values else ""
    best = (min if found.minimise else max)(values, default=None)
    if best is not None and found.lower is not None and best < found.lower:
        return f"the value {best} is below {found.lower}"
    if best is not None and found.upper is not None and best > found.upper:
        return f"the value {best} is above {found.upper}"
    reached = found.upper if found.minimise else found.lower
    return "there is no point" if best is None and reached is not None and _bounded(found) else ""


def _points(found: vipr.Certificate) -> Iterator[Point]:
    for point in product(*(_range(found, j) for j in range(len(found.names)))):
        if all(_holds(item, point) for item in found.constraints):
            yield point


def _range(found: vipr.Certificate, j: int) -> list[Fraction]:
    """What column `j` may be by its own bounds."""
    steps = 1 if j in found.integer else 2
    low, high = Fraction(WIDEST.start), Fraction(WIDEST.stop - 1)
    for item in found.constraints:
        if set(item.terms) == {j}:
            side = Fraction(item.side, item.terms[j])
            points_up = item.sense if item.terms[j] > 0 else -item.sense
            low = max(low, side) if points_up >= 0 else low
            high = min(high, side) if points_up <= 0 else high
    return [Fraction(k, steps) for k in range(math.ceil(low * steps), math.floor(high * steps) + 1)]


def _bounded(found: vipr.Certificate) -> bool:
    """Whether every column has bounds within what is looked at."""
    sides: dict[int, set[int]] = {}
    for item in found.constraints:
        if len(item.terms) == 1:
            ((j, a),) = item.terms.items()
            inside = abs(Fraction(item.side, a)) <= 3
            ways = {-1, 1} if not item.sense else {item.sense if a > 0 else -item.sense}
            sides.setdefault(j, set()).update(ways if inside else ())
    whole = found.integer == set(range(len(found.names)))
    return whole and all(sides.get(j) == {-1, 1} for j in range(len(found.names)))


def _holds(item: vipr.Constraint, point: Point) -> bool:
    beyond = sum(a * point[j] for j, a in item.terms.items()) - item.side
    return beyond == 0 if not item.sense else beyond * item.sense >= 0


def _value(found: vipr.Certificate, point: Point) -> Fraction:
    value = sum((a * point[j] for j, a in found.objective.items()), Fraction(0))
    return value / found.objective_under
