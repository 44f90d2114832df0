"""The independent check of solutions and bounds: numpy on the program's arrays, no solver.

What fails it is never shown as a result. A row of whole numbers on whole-number columns is checked
exactly. Any other on whole-number columns may be missed by the rounding of its own numbers, relative to
the row's terms. A row with continuous columns may be missed by what solvers allow themselves, too, but
relative to what these columns are in it: a big M of a whole-number column excuses nothing.
"""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice

import numpy as np

from ..arrays import Bools, Floats, Ints
from .program import ROUNDING, Program
from .scaling import scaling

TOLERANCE = 1e-6
"""How far a row with continuous columns or a bound may be missed, relative to the size of its terms."""
TIGHT = 1e-9
"""Difference up to which a bound equals the objective, relative to it or to the unit of `scaling`."""
WIDE = 1e7
"""Ratio of numbers in one row from which tolerances of solvers hide the smaller."""
LARGE = 5e3
"""Size of whole numbers in a solution from which cuts, in floats, may have cut off a better one."""
PRECISION = 1e-14
"""Relative, of sums of some products of floats."""
LARGEST_EXACT = 2.0**53
"""Sums of whole numbers up to this are exact in floating point."""


def settled(program: Program, x: Floats) -> Floats:
    """`x` with what is only rounding taken out: integers made so exactly, bounds kept exactly.

    Anything beyond rounding stays as it is, for `violations` to find.
    """
    x = np.array(x, dtype=float)
    if x.shape != (program.n_columns,) or not np.isfinite(x).all():
        return x
    nearest = np.round(x)
    close = program.integer & (np.abs(x - nearest) <= TOLERANCE * 10)
    x[close] = nearest[close]
    inside = np.clip(x, program.lower, program.upper)
    slight = np.abs(inside - x) <= TOLERANCE * (1.0 + np.abs(x))
    x[slight] = inside[slight]
    return x


@dataclass(frozen=True, eq=False)
class Point:
    """A point that was looked at, with what is only rounding taken out."""

    x: Floats
    wrong: list[str]
    """What is wrong with it, worst first."""
    violation: float
    """The largest share of its terms by which a row is missed."""

    @classmethod
    def of(cls, program: Program, x: Floats) -> Point:
        """`x`, looked at as a solution of `program`."""
        x = settled(program, x)
        if x.shape != (program.n_columns,) or not np.isfinite(x).all():
            return cls(x, violations(program, x), np.inf)
        missed, allowed = row_misses(program, x)
        return cls(x, _violations(program, x, missed, allowed, 3), _share(program, x, missed))


def violations(program: Program, x: Floats, *, maximum: int = 3) -> list[str]:
    """What is wrong with `x` as a solution of `program`, worst first; empty if nothing is.

    Parameters
    ----------
    program : Program
        The arrays to check against.
    x : float array, shape (n_columns,)
        The point.
    maximum : int
        How many to name.
    """
    if x.shape != (program.n_columns,) or not np.isfinite(x).all():
        return [f"the point has shape {x.shape} or values that are not finite"]
    return _violations(program, x, *row_misses(program, x), maximum)


def _violations(
    program: Program, x: Floats, missed: Floats, allowed: Floats, maximum: int
) -> list[str]:
    found: list[tuple[float, str]] = []
    wrong = ~(missed <= allowed)
    found.extend(
        (float(missed[i]), f"row '{program.row_name(int(i))}' is missed by {missed[i]:.2g}")
        for i in _worst(missed, wrong, maximum)
    )
    outside = np.maximum(program.lower - x, x - program.upper) / (1.0 + np.abs(x))
    found.extend(
        (outside[j], f"{program.column_name(j)} = {x[j]:g} is outside its bounds")
        for j in _worst(outside, ~(outside <= TOLERANCE), maximum)
    )
    fraction = np.where(program.integer, np.abs(x - np.round(x)), 0.0)
    found.extend(
        (fraction[j], f"{program.column_name(j)} = {x[j]:g} is not integral")
        for j in _worst(fraction, ~(fraction <= TOLERANCE), maximum)
    )
    return [text for _, text in sorted(found, key=lambda item: -item[0])[:maximum]]


def _share(program: Program, x: Floats, missed: Floats) -> float:
    """The largest share of its terms by which a row is missed at `x`; 0 if none is."""
    if (missed <= 0).all():
        return 0.0
    terms = _terms(program, x)
    share = np.divide(missed, terms, out=np.ones_like(missed), where=terms > 0)
    return float(share[missed > 0].max(initial=0.0))


def _terms(program: Program, x: Floats) -> Floats:
    """The sizes of each row's terms, added up."""
    return np.asarray(np.abs(program.matrix) @ np.abs(x))


def row_misses(program: Program, x: Floats) -> tuple[Floats, Floats]:
    """By how much each row is missed at `x`, 0 or less if it is not, and by how much it may be."""
    activity = program.matrix @ x
    missed = np.maximum(program.row_lower - activity, activity - program.row_upper)
    sizes = (np.abs(part).max(initial=0.0) for part in (program.matrix.data, x))
    if (missed <= 0).all() and np.prod([*sizes, program.n_columns]) < LARGEST_EXACT:
        return missed, np.zeros_like(missed)
    whole, decimal = kinds_of_rows(program)
    matrix = program.matrix
    rows = np.repeat(np.arange(program.n_rows), np.diff(matrix.indptr))
    terms, continuous = _terms(program, x), _terms(program, np.where(program.integer, 0.0, x))
    sides = _largest_end(program.row_lower, program.row_upper)
    # Where a column is scaled by much, the unit of its rows may be larger than all that is in them.
    largest = np.zeros(program.n_rows)
    np.fmax.at(largest, rows, np.abs(matrix.data) * ~program.integer[matrix.indices])
    unit = np.minimum(1.0 / scaling(program).row, largest)
    allowed = ROUNDING * np.maximum(terms, sides)
    allowed = np.where(decimal, allowed, TOLERANCE * (unit + continuous) + allowed)
    allowed[whole] = 0.0
    allowed[np.diff(program.matrix.indptr) == 0] = ROUNDING
    for i in np.flatnonzero(whole & (np.maximum(terms, sides) >= LARGEST_EXACT)):
        missed[i] = _missed_in_integers(program, x, int(i))
    return missed, allowed


def is_badly_scaled(program: Program) -> bool:
    """Whether a row or the objective has numbers so different that tolerances hide the small ones."""
    size = np.abs(program.matrix.data)
    limits = [(np.inf, 0.0)]
    if size.size:
        rows = np.repeat(np.arange(program.n_rows), np.diff(program.matrix.indptr))[size > 0]
        low, high = np.full(program.n_rows, np.inf), np.zeros(program.n_rows)
        np.minimum.at(low, rows, size[size > 0])
        bounds = np.maximum(np.abs(program.lower), np.abs(program.upper))
        reach = np.where(program.integer & np.isfinite(bounds), np.maximum(bounds, 1.0), 1.0)
        np.maximum.at(high, rows, (size * reach[program.matrix.indices])[size > 0])
        # Some solvers' tolerances are relative to the side.
        high = np.maximum(high, _largest_end(program.row_lower, program.row_upper))
        limits += list(zip(low, high, strict=True))
    costs = np.abs(program.cost[program.cost != 0])
    if costs.size:
        limits.append((costs.min(), costs.max()))
    return any(high > WIDE * low for low, high in limits)


def has_large_integers(program: Program, x: Floats) -> bool:
    """Whether integers are so large in `x` that solvers' cuts near it are not to be relied on.

    Bounds do not matter: the smallest models have far ones that no row comes near.
    """
    free = program.integer & (program.lower < program.upper)
    return bool((np.abs(x[free]) >= LARGE).any())


def kinds_of_rows(program: Program) -> tuple[Bools, Bools]:
    """Which rows are of whole numbers on whole-number columns, and which of others on these."""
    matrix = program.matrix
    rows = np.repeat(np.arange(program.n_rows), np.diff(matrix.indptr))

    def none(entries: Bools) -> Bools:
        return np.asarray(np.bincount(rows[entries], minlength=program.n_rows) == 0)

    on_whole = none(~program.integer[matrix.indices] & (matrix.data != 0))
    sides = [
        np.isinf(side) | (side == np.round(side)) for side in (program.row_lower, program.row_upper)
    ]
    whole = on_whole & none(matrix.data != np.round(matrix.data)) & sides[0] & sides[1]
    return whole, on_whole & ~whole


def _missed_in_integers(program: Program, x: Floats, row: int) -> float:
    """By how much a row of whole numbers is missed, without any rounding."""
    entries = slice(program.matrix.indptr[row], program.matrix.indptr[row + 1])
    terms = zip(program.matrix.data[entries], x[program.matrix.indices[entries]], strict=True)
    activity = sum(int(a) * round(float(value)) for a, value in terms)
    lower, upper = program.row_lower[row], program.row_upper[row]
    below = int(lower) - activity if np.isfinite(lower) else -1
    above = activity - int(upper) if np.isfinite(upper) else -1
    return float(max(below, above))


def _worst(missed: Floats, wrong: Bools, maximum: int) -> list[int]:
    """Positions of what is wrong, or not a number, worst first."""
    if not wrong.any():
        return []
    places = np.flatnonzero(wrong)
    by_how_much = np.where(np.isnan(missed[places]), np.inf, missed[places])
    return [int(i) for i in places[np.argsort(-by_how_much, kind="stable")][:maximum]]


def proves_infeasible(program: Program, ray: Floats) -> bool:
    """Whether `ray`, one multiplier for each row, proves in fractions that the relaxation is infeasible.

    By Farkas' lemma: the rows, so multiplied and added, ask for more than the bounds allow, by more than
    the rounding of the rows' own numbers. A ray that solvers rounded is also tried as the simple
    fractions near to it, of its largest part and of its smallest, and so are rows alone.
    """
    if any(
        _asks_too_much(program, [Fraction(sign * int(k == i)) for k in range(program.n_rows)])
        for i in rows_out_of_reach(program)[:3]
        for sign in (1, -1)
    ):
        return True
    size = np.abs(ray)
    if not np.isfinite(ray).all() or not size.any():
        return False
    shares, multiples = (
        [Fraction(float(part)) for part in ray / unit]
        for unit in (size.max(), size[size > 0].min())
    )
    simple = ([part.limit_denominator(1000) for part in parts] for parts in (shares, multiples))
    return any(
        _asks_too_much(program, [sign * part for part in trial])
        for trial in (*simple, shares)
        for sign in (1, -1)
    )


def rows_out_of_reach(program: Program) -> Ints:
    """Rows that, as far as floats can tell, no point within the bounds satisfies."""
    up, down = program.matrix.maximum(0), program.matrix.minimum(0)
    with np.errstate(invalid="ignore"):
        high = up @ program.upper + down @ program.lower
        low = up @ program.lower + down @ program.upper
        short = (high < program.row_lower) | (low > program.row_upper)
    return np.flatnonzero(short)


def _asks_too_much(program: Program, ray: list[Fraction]) -> bool:
    # In whole numbers over a common denominator: fractions would be reduced at every step.
    matrix, rows = program.matrix, [i for i, share in enumerate(ray) if share]
    if not rows:
        return False
    sides = np.array([(program.row_lower if ray[i] > 0 else program.row_upper)[i] for i in rows])
    if not np.isfinite(sides).all():
        return False
    common = math.lcm(*(ray[i].denominator for i in rows))
    shares = [ray[i].numerator * (common // ray[i].denominator) for i in rows]
    whole, _ = kinds_of_rows(program)
    ends = np.maximum(np.abs(program.lower), np.abs(program.upper))
    largest = np.where(np.isfinite(ends), ends, 0.0)
    weight: dict[int, int] = {}
    rounded: dict[int, int] = {}
    parts = [slice(matrix.indptr[i], matrix.indptr[i + 1]) for i in rows]
    numbers, unit = _over_one_denominator(np.concatenate([matrix.data[part] for part in parts]))
    entry, loose = iter(numbers), Fraction(0)
    for i, share, side, part in zip(rows, shares, sides.tolist(), parts, strict=True):
        columns = matrix.indices[part].tolist()
        terms = [share * number for number in islice(entry, len(columns))]
        for j, term in zip(columns, terms, strict=True):
            weight[j] = weight.get(j, 0) + term
        if not whole[i]:
            size = float(np.abs(matrix.data[part]) @ largest[columns])
            loose += abs(ray[i]) * Fraction(max(abs(side), size))
            for j, term in zip(columns, terms, strict=True):
                rounded[j] = rounded.get(j, 0) + abs(term)
    asked, of_sides = _over_one_denominator(sides)
    held = {j: (program.upper if w > 0 else program.lower)[j] for j, w in weight.items() if w}
    for j, end in held.items():
        if not np.isfinite(end) and abs(weight[j]) > rounded.get(j, 0) * Fraction(ROUNDING):
            return False
    bounded = {j: end for j, end in held.items() if np.isfinite(end)}
    given, of_ends = _over_one_denominator(np.array(list(bounded.values())))
    spare = Fraction(sum(map(operator.mul, shares, asked)), common * of_sides) - Fraction(
        sum(map(operator.mul, (weight[j] for j in bounded), given)), common * unit * of_ends
    )
    return spare > loose * Fraction(ROUNDING)


def _over_one_denominator(values: Floats) -> tuple[list[int], int]:
    """Numerators of floats, exact, and their common denominator, a power of two."""
    ratios = [value.as_integer_ratio() for value in values.tolist()]
    common = max((below for _, below in ratios), default=1)
    return [above * (common // below) for above, below in ratios], common


def dual_bound(program: Program, duals: Floats) -> float:
    """The bound that dual values `duals` prove on the program's objective, by weak LP duality.

    Whatever the duals are, no feasible point is better; good duals make the bound tight. It is
    infinite where a dual value has the wrong sign for a one-sided row or a free column. Where large
    parts of it cancel out, it is lowered by what their rounding may be.

    Parameters
    ----------
    program : Program
        The arrays.
    duals : float array, shape (n_rows,)
        For a minimisation of ``sign * cost``: positive duals lean on ``row_lower``, negative ones
        on ``row_upper``.
    """
    matrix, sizes = program.matrix, np.abs(program.cost)
    rounding = 1e-9 * float(sizes.max(initial=0.0))
    duals, of_rows, sides = _leaning(duals, program.row_lower, program.row_upper, rounding)
    # By numpy alone: most programs are so small that sparse matrices' own bookkeeping would prevail.
    terms = matrix.data * np.repeat(duals, np.diff(matrix.indptr))
    reduced = program.sign * program.cost - _by_column(program, terms)
    left, of_columns, ends = _leaning(reduced, program.lower, program.upper, rounding)
    minimum = of_rows + of_columns
    parts = np.where(left == 0, 0.0, sizes + _by_column(program, np.abs(terms)))
    # What is 0 but for rounding might lean on the other end.
    is_open = np.abs(left) <= PRECISION * parts
    ends = np.where(is_open, _largest_end(program.lower, program.upper), np.abs(ends))
    size = parts @ ends + np.abs(duals) @ np.abs(sides)
    error = PRECISION * float(size)
    if error > TIGHT * abs(minimum):
        minimum -= error
    return program.sign * minimum + program.offset


def _by_column(program: Program, entries: Floats) -> Floats:
    """The sum of `entries` of the matrix in each column."""
    return np.asarray(np.bincount(program.matrix.indices, entries, program.n_columns), float)


def _largest_end(lower: Floats, upper: Floats) -> Floats:
    """The largest finite end of each, as a size."""
    ends = (np.where(np.isfinite(end), np.abs(end), 0.0) for end in (lower, upper))
    return np.maximum(*ends)


def _leaning(
    weight: Floats, lower: Floats, upper: Floats, rounding: float
) -> tuple[Floats, float, Floats]:
    """`weight` without what leans on an infinite side by no more than rounding, and what it proves.

    That is the minimum of ``weight @ z`` over ``lower ≤ z ≤ upper``. Third come the sides on which it
    leans, 0 where there is no weight.
    """
    side = np.where(weight > 0, lower, upper)
    if not np.isfinite(side).all():
        weight = np.where(np.isinf(side) & (np.abs(weight) <= rounding), 0.0, weight)
        side = np.where(weight == 0, 0.0, side)
    return weight, float(weight @ side), side
