"""Basic solutions of the relaxation in exact numbers.

A basis says which columns and rows are not at a bound; a square system of linear equations then gives
their values, and its transpose the dual multipliers. It is solved by iterative refinement: floats solve
for what is left over, which is worked out in integers, until fractions can be read off (Wan 2006, *An
algorithm to solve integer linear systems exactly using numerical methods*); what is read off is put
into the equations.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from .exact import ExactProgram, Rational, Row
from .relaxation import Relaxation

BITS_A_ROUND = 24
MAX_BITS = 40_000
LARGEST_BASIS = 5_000


def exact_duals(
    program: ExactProgram, rows: Sequence[Row], relaxation: Relaxation
) -> list[Rational] | None:
    """The multipliers of `rows` at the present basis; ``None`` if they cannot be had."""
    basic_columns, basic_rows = relaxation.basic()
    columns, active = np.flatnonzero(basic_columns).tolist(), np.flatnonzero(~basic_rows).tolist()
    system = _system(rows, columns, active)
    if system is None:
        return None
    # Transposed: one equation a basic column, one unknown an active row.
    turned: list[list[tuple[int, int]]] = [[] for _ in columns]
    for i, entries in enumerate(system):
        for k, a in entries:
            turned[k].append((i, a))
    found = solve(turned, [program.cost[j] for j in columns])
    if found is None:
        return None
    duals: list[Rational] = [0] * len(rows)
    for i, y in zip(active, found, strict=True):
        duals[i] = y
    return duals


def exact_point(rows: Sequence[Row], relaxation: Relaxation) -> list[Rational] | None:
    """The point of the present basis, columns at their nearer bound; ``None`` if it cannot be had."""
    relaxed = relaxation.solve()
    if relaxed.x is None:
        return None
    x = relaxed.x.tolist()
    basic_columns, basic_rows = relaxation.basic()
    columns, active = np.flatnonzero(basic_columns).tolist(), np.flatnonzero(~basic_rows).tolist()
    system = _system(rows, columns, active)
    if system is None:
        return None
    point = [_nearest(bounds, value) for bounds, value in zip(relaxation.bounds, x, strict=True)]
    basic = set(columns)
    sides: list[Fraction] = []
    for i in active:
        row, activity, value = rows[i], Fraction(0), 0.0
        for j, a in zip(row.columns, row.coefficients, strict=True):
            value += float(a) * x[j]
            if j not in basic:
                activity += a * point[j]
        side = min(
            (s for s in (row.lower, row.upper) if s is not None),
            key=lambda s: abs(float(s) - value),
            default=None,
        )
        if side is None:
            return None
        sides.append(side - activity)
    found = solve(system, sides)
    if found is None:
        return None
    for j, exact in zip(columns, found, strict=True):
        point[j] = exact
    return point


def _nearest(bounds: tuple[Rational | None, Rational | None], value: float) -> Rational:
    sides = [bound for bound in bounds if bound is not None]
    return min(sides, key=lambda bound: abs(float(bound) - value), default=0)


def _system(
    rows: Sequence[Row], columns: list[int], active: list[int]
) -> list[list[tuple[int, int]]] | None:
    """The active rows' entries in the basic columns; ``None`` if that is not square, or too large."""
    if len(columns) != len(active) or len(columns) > LARGEST_BASIS:
        return None
    place = {j: k for k, j in enumerate(columns)}
    return [
        [
            (place[j], a)
            for j, a in zip(rows[i].columns, rows[i].coefficients, strict=True)
            if j in place
        ]
        for i in active
    ]


def solve(
    system: Sequence[Sequence[tuple[int, int]]], sides: Sequence[Rational]
) -> list[Fraction] | None:
    """The solution of a square system, row by row pairs of a column and a coefficient.

    ``None`` if it is singular, or floats are too coarse for it.
    """
    n = len(system)
    if not n:
        return []
    # Rows are scaled to be of one size as floats; their sides with them.
    shifts = [max((a.bit_length() for _, a in row), default=0) for row in system]
    if not all(shifts):
        return None
    data = [
        math.ldexp(*_float(a, -shift))
        for row, shift in zip(system, shifts, strict=True)
        for _, a in row
    ]
    index = [k for row in system for k, _ in row]
    starts = np.cumsum([0, *(len(row) for row in system)])
    matrix = csc_array((data, index, starts), shape=(n, n))  # transposed, as it is by rows
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            factors = splu(matrix)
    except (RuntimeError, RuntimeWarning, Warning):
        return None
    common = math.lcm(*(s.denominator for s in sides))
    left = [s.numerator * (common // s.denominator) for s in sides]
    sought = [0] * n
    bits, check_at, largest = 0, 48, None
    while bits < MAX_BITS:
        size = max(r.bit_length() - s for r, s in zip(left, shifts, strict=True))
        largest = size + 3 * BITS_A_ROUND if largest is None else largest
        if size > largest:  # what is left over should shrink as fast as the unit does
            return None
        floats = [math.ldexp(*_float(r, -s - size)) for r, s in zip(left, shifts, strict=True)]
        step = factors.solve(np.array(floats), trans="T")
        if not np.isfinite(step).all():
            return None
        # What is sought is (sought + step * 2**size) / 2**bits; some more bits are taken of it.
        change = [_scaled(v, size + BITS_A_ROUND) for v in step.tolist()]
        sought = [(s << BITS_A_ROUND) + c for s, c in zip(sought, change, strict=True)]
        left = [
            (r << BITS_A_ROUND) - sum(a * change[k] for k, a in row)
            for r, row in zip(left, system, strict=True)
        ]
        bits += BITS_A_ROUND
        if not any(left) or bits >= check_at:
            check_at = bits * 3 // 2
            found = _read_off(sought, bits, not any(left))
            if found is not None and all(
                sum((a * found[k] for k, a in row), Fraction(0)) == s * common
                for row, s in zip(system, sides, strict=True)
            ):
                return [v / common for v in found]
            if not any(left):
                return None
    return None


def _float(number: int, shift: int) -> tuple[float, int]:
    """`number` times ``2**shift`` as a float and an exponent."""
    length = number.bit_length()
    if length > 900:
        return float(number >> (length - 60)), length - 60 + shift
    return float(number), shift


def _scaled(value: float, exponent: int) -> int:
    """The integer next to ``value * 2**exponent``."""
    if exponent < 900:
        return round(math.ldexp(value, exponent))
    over, under = value.as_integer_ratio()
    return (over << exponent) // under


def _read_off(sought: list[int], bits: int, exact: bool) -> list[Fraction] | None:
    """Fractions with small denominators next to ``sought / 2**bits``; ``None`` if there are none."""
    if exact:
        return [Fraction(s, 1 << bits) for s in sought]
    maximum = 1 << max(bits // 2 - 2, 1)
    common, found = 1, []
    for s in sought:
        near = Fraction(s * common, 1 << bits).limit_denominator(max(maximum // common, 1))
        if abs(near * (1 << bits) - s * common) * maximum > common << bits:
            return None
        found.append(near / common)
        common *= near.denominator
        if common > maximum:
            return None
    return found
