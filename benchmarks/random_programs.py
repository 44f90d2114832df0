"""Random small programs of the shapes at which solvers go wrong, and their optima by brute force.

No solver is asked and no code of the package but its type of a program is used: the integer points
within the box of a program are all looked at, and for each the vertices of what is left to one or two
continuous variables. Rows are taken in two ways: as narrow as their decimals can be meant, and as wide
as solvers are allowed; where that makes a difference, both answers are right.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

import numpy as np
from scipy.sparse import csr_array

from msmrta_opt.arrays import Bools, Floats
from msmrta_opt.optimise.program import Block, Program

Random = np.random.Generator

WELL_SCALED = (
    *("whole", "decimal", "equations", "ties", "constant", "scaled rows", "scaled costs"),
    *("free integers", "mixed", "mixed decimal", "mixed equations", "cvxpy's rows", "one unit"),
    *("unbounded", "big M"),
)
BADLY_SCALED = ("wide", "wide big M", "wide mixed", "wide constant")
SHAPES = (*WELL_SCALED, *BADLY_SCALED)
NARROW, WIDE = 1e-13, 1e-11
"""Shares of its terms that a row on whole-number columns may be missed by: surely, and at most."""
MIXED = 4e-6
"""The same of one with continuous columns, at most."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A program, the box that holds its integer points, and what it is like."""

    shape: str
    program: Program
    low: Floats
    """Of whole numbers, shape ``(n_columns,)``; of continuous columns the bounds themselves."""
    high: Floats
    unbounded: bool = False
    """Whether any feasible point makes it unbounded."""

    @property
    def is_well_scaled(self) -> bool:
        """Whether any solver has to be right about it."""
        return self.shape in WELL_SCALED


@dataclass(frozen=True)
class Truth:
    """The best values without the constant; ``None`` where there is no point."""

    narrow: float | None
    wide: float | None
    size: float
    """Of the objective, to which tolerances are relative."""


def trial(number: int) -> Trial:
    """The program of that number."""
    random = np.random.default_rng(number)
    shape = SHAPES[number % len(SHAPES)]
    many = number // len(SHAPES) % 5 == 0
    make = _wide if shape in BADLY_SCALED else _usual
    return make(random, shape, many=many)


def scaled_trial(number: int) -> Trial:
    """A program of coefficients from 4e-9 to 4e9, by its number."""
    random = np.random.default_rng([number, 4])
    return _wide(random, BADLY_SCALED[number % len(BADLY_SCALED)], many=number % 2 == 0)


def _box(random: Random, *, many: bool) -> tuple[Floats, Floats]:
    """Bounds of whole-number columns with few points, or more than are looked at one by one."""
    if many and random.random() < 0.5:
        return np.zeros(15), np.ones(15)
    n = int(random.choice([5, 6] if many else [1, 2, 3, 4, 5]))
    low = random.integers(-3, 1, n).astype(float)
    width = random.integers(6, 8, n) if n == 5 else random.integers(4, 6, n)
    width = width if many else random.integers(0, 4, n)
    return low, low + width


def _rows(random: Random, n: int) -> Floats:
    m = int(random.integers(1, 6))
    return np.asarray(random.integers(-9, 10, (m, n)) * (random.random((m, n)) < 0.7), float)


def _usual(random: Random, shape: str, *, many: bool) -> Trial:
    """Whole data up to 9, and what the shape makes of them."""
    low, high = _box(random, many=many)
    n = len(low)
    matrix, cost = _rows(random, n), random.integers(-9, 10, n).astype(float)
    integer = np.ones(n, dtype=bool)
    if shape.startswith("mixed") or shape == "cvxpy's rows":
        low, high, integer = _some_continuous(random, low, high)
    if shape == "ties":
        matrix, cost = np.sign(matrix), np.sign(cost) if random.random() < 0.5 else cost * 0 + 1
    if shape == "big M" and n > 1:
        matrix[0] = 0
        matrix[0, 0], matrix[0, -1] = 1, -float(random.choice([10, 100, 1e3, 1e4, 1e5]))
        low[-1], high[-1], integer[-1] = 0, 1, True
    equations = 0.4 if "equations" in shape else 0.1
    row_lower, row_upper = _sides(random, matrix, _inside(random, low, high, integer), equations)
    if shape == "big M":
        row_lower[0], row_upper[0] = -np.inf, 0
    if "decimal" in shape:
        unit = 10.0 ** -int(random.integers(1, 4))
        matrix, cost, row_lower, row_upper = (
            np.round(part * unit, 3) for part in (matrix, cost, row_lower, row_upper)
        )
    if shape == "scaled rows":
        units = 10.0 ** random.integers(-9, 10, len(matrix))
        matrix, row_lower, row_upper = matrix * units[:, None], row_lower * units, row_upper * units
    if shape in ("scaled costs", "one unit"):
        cost = cost * 10.0 ** float(random.integers(-9, 10))
    if shape == "one unit":
        unit = 10.0 ** float(random.integers(-9, 10))
        matrix, row_lower, row_upper = matrix * unit, row_lower * unit, row_upper * unit
    offset = float(random.choice([0, 0, 5, -17.5]))
    if shape == "constant":
        offset = float(random.choice([1e5, -1e7, 1e9, 1e12, -0.1, 1e-7]))
    program = _program(random, cost, offset, matrix, row_lower, row_upper, low, high, integer)
    found = Trial(shape, program, low, high)
    if shape in ("free integers", "cvxpy's rows"):
        return _bounds_as_rows(random, found)
    return _without_end(random, found) if shape == "unbounded" else found


def _wide(random: Random, shape: str, *, many: bool) -> Trial:
    """Coefficients of very different size: 1 to 4 times a power of ten from -9 to 9."""
    low, high = _box(random, many=many)
    n = len(low)
    integer = np.ones(n, dtype=bool)
    if shape == "wide mixed":
        low, high, integer = _some_continuous(random, low, high)
    reach = int(random.choice([4, 6, 9]))
    there = np.sign(_rows(random, n))
    matrix = np.asarray(there * random.integers(1, 5, there.shape), float)
    cost = np.asarray(random.integers(-4, 5, n) * 10.0 ** random.integers(-reach, reach + 1, n))
    if shape == "wide big M" and n > 1:
        of = int(random.integers(0, n - 1))
        matrix[0] = 0
        matrix[0, of], matrix[0, -1] = 1, -(10.0 ** random.integers(5, 10))
        low[-1], high[-1], integer[-1] = 0, 1, True
    else:
        matrix = matrix * 10.0 ** random.integers(-reach, reach + 1, matrix.shape)
    row_lower, row_upper = _sides(random, matrix, _inside(random, low, high, integer), 0.1)
    if shape == "wide big M":
        row_lower[0], row_upper[0] = -np.inf, 0
    offset = float(random.choice([1e9, -1e6, 1e12])) if shape == "wide constant" else 0.0
    program = _program(random, cost, offset, matrix, row_lower, row_upper, low, high, integer)
    return Trial(shape, program, low, high)


def _some_continuous(random: Random, low: Floats, high: Floats) -> tuple[Floats, Floats, Bools]:
    n, k = len(low), int(random.integers(1, 3))
    k = min(k, n)
    integer = np.ones(n, dtype=bool)
    integer[random.choice(n, k, replace=False)] = False
    # Vertices are many, so whole numbers are few.
    width, maximum = (3, 4) if k == 2 else (5, 5)
    high = np.where(integer, np.minimum(high, low + width), high + 3)
    for j in np.flatnonzero(integer)[maximum if high.max() > 1 else 9 :]:
        high[j] = low[j]
    return low, high, integer


def _inside(random: Random, low: Floats, high: Floats, integer: Bools) -> Floats:
    point = np.array([random.integers(a, b + 1) for a, b in zip(low, high, strict=True)], float)
    return np.where(integer, point, low + np.round((high - low) * random.random(len(low)) * 4) / 4)


def _sides(
    random: Random, matrix: Floats, point: Floats, equations: float
) -> tuple[Floats, Floats]:
    """Sides that `point` keeps, or half the time may miss by one."""
    m = len(matrix)
    side = matrix @ point + (random.integers(-1, 2, m) if random.random() < 0.5 else 0)
    kind = random.choice(["<", ">", "=", "both"], m, p=[0.45, 0.45 - equations, equations, 0.1])
    width = random.integers(0, 5, m)
    return np.where(kind == "<", -np.inf, side), np.where(
        kind == ">", np.inf, np.where(kind == "both", side + width, side)
    )


def _program(
    random: Random,
    cost: Floats,
    offset: float,
    matrix: Floats,
    row_lower: Floats,
    row_upper: Floats,
    low: Floats,
    high: Floats,
    integer: Bools,
) -> Program:
    n, m = len(cost), len(row_lower)
    sense: Literal["min", "max"] = "max" if random.random() < 0.5 else "min"
    columns, rows = (Block("x", 0, (n,)),), (Block("row {i}", 0, (m,)),)
    return Program(
        sense, cost, offset, csr_array(matrix), row_lower, row_upper, low.copy(), high.copy(),
        integer, columns, rows,
    )  # fmt: skip


def _bounds_as_rows(random: Random, found: Trial) -> Trial:
    """The same with bounds as rows, some in sums with another column, and these columns free.

    In cvxpy's form all inequalities point one way, too.
    """
    asked, n = found.program, found.program.n_columns
    chosen = random.random(n) < (1.0 if found.shape == "cvxpy's rows" else 0.6)
    kept = np.flatnonzero(~chosen)
    rows, sides = [asked.matrix.toarray()], [(asked.row_lower, asked.row_upper)]
    lower, upper = asked.lower.copy(), asked.upper.copy()
    low, high = found.low.copy(), found.high.copy()
    for j in np.flatnonzero(chosen):
        row = np.zeros((1, n))
        row[0, j] = factor = float(random.choice([1, 1, 2, 3]))
        ends = np.array([[lower[j], upper[j]]]) * factor
        if len(kept) and (high - low).max() < 4 and random.random() < 0.4:
            other = random.choice(kept)
            row[0, other] = 1.0
            ends += [lower[other], upper[other]]
            low[j] -= high[other] - low[other]
            high[j] += high[other] - low[other]
        rows.append(row)
        sides.append((ends[:, 0], ends[:, 1]))
        lower[j], upper[j] = -np.inf, np.inf
    dense = np.vstack(rows)
    row_lower, row_upper = (np.concatenate(part) for part in zip(*sides, strict=True))
    if found.shape == "cvxpy's rows":
        two = np.isfinite(row_lower) & np.isfinite(row_upper) & (row_lower < row_upper)
        turned = np.isfinite(row_lower) & ~np.isfinite(row_upper)
        dense = np.vstack([dense * np.where(turned, -1.0, 1.0)[:, None], -dense[two]])
        row_lower, row_upper = (
            np.append(np.where(turned | two, -np.inf, row_lower), np.full(two.sum(), -np.inf)),
            np.append(np.where(turned, -row_lower, row_upper), -row_lower[two]),
        )
    program = replace(
        asked,
        matrix=csr_array(dense),
        row_lower=row_lower,
        row_upper=row_upper,
        lower=lower,
        upper=upper,
        rows=(Block("row {i}", 0, (len(dense),)),),
    )
    return replace(found, low=low, high=high, program=program)


def _without_end(random: Random, found: Trial) -> Trial:
    """The same with one column without an end in the direction that improves, which no row stops."""
    asked = found.program
    j = int(random.integers(asked.n_columns))
    if asked.cost[j] == 0:
        return found
    away = -asked.sign * np.sign(asked.cost[j])
    dense = asked.matrix.toarray()
    stops = np.isfinite(asked.row_upper) & (dense[:, j] * away > 0)
    stops |= np.isfinite(asked.row_lower) & (dense[:, j] * away < 0)
    dense[stops, j] = 0
    # What any one of its values does for a row, a large one does.
    helped = dense[:, j] != 0
    lower, upper = asked.lower.copy(), asked.upper.copy()
    (upper if away > 0 else lower)[j] = away * np.inf
    low, high = found.low.copy(), found.high.copy()
    far = low[j] if away > 0 else high[j]
    if helped.any():
        far = away * 1000.0
    low[j] = high[j] = far
    program = replace(asked, matrix=csr_array(dense), lower=lower, upper=upper)
    return replace(found, program=program, low=low, high=high, unbounded=True)


def truth(asked: Trial) -> Truth:
    """The optimum, by brute force."""
    program = asked.program
    whole, rest = np.flatnonzero(program.integer), np.flatnonzero(~program.integer)
    widths = [int(asked.high[j] - asked.low[j]) + 1 for j in whole]
    grid = np.indices(widths).reshape(len(whole), int(np.prod(widths))).T + asked.low[whole]
    value = program.sign * (grid @ program.cost[whole])
    order = np.argsort(value, kind="stable")
    grid, value = grid[order], value[order]
    matrix = program.matrix.toarray()
    lower, upper = program.row_lower, program.row_upper
    ends = np.maximum(*(np.where(np.isfinite(side), np.abs(side), 0.0) for side in (lower, upper)))
    mixed = (matrix[:, rest] != 0).any(axis=1)
    data = np.column_stack([matrix, *(np.where(np.isfinite(s), s, 0.0) for s in (lower, upper))])
    exact = (data == np.round(data)).all(axis=1)

    found: list[float | None] = []
    for loose in (False, True):
        keeps = np.ones(len(grid), dtype=bool)
        for i in np.flatnonzero(~mixed):
            # One row after another, of the points that are left.
            points = grid[keeps]
            activity = points @ matrix[i, whole]
            allowed = np.zeros(len(points))
            if not exact[i]:
                terms = np.abs(points) @ np.abs(matrix[i, whole])
                allowed = (WIDE if loose else NARROW) * np.maximum(terms, ends[i])
            keeps[keeps] = (activity >= lower[i] - allowed) & (activity <= upper[i] + allowed)
        if not keeps.any():
            found.append(None)
        elif not len(rest):
            found.append(program.sign * float(value[keeps][0]))
        else:
            total = value[keeps] + _rest(program, matrix, grid[keeps], mixed, loose=loose)
            found.append(None if np.isinf(total).all() else program.sign * float(total.min()))
    values = [abs(best) for best in found if best is not None]
    costs = np.abs(program.cost)
    return Truth(found[0], found[1], max([*values, float(costs.max(initial=0.0)), 1e-300]))


def _rest(program: Program, matrix: Floats, grid: Floats, mixed: Bools, *, loose: bool) -> Floats:
    """What the continuous columns add to the objective, at best, at each point of the others."""
    whole, rest = np.flatnonzero(program.integer), np.flatnonzero(~program.integer)
    activity = grid @ matrix[np.ix_(mixed, whole)].T
    at = np.maximum(np.abs(program.lower[rest]), np.abs(program.upper[rest]))
    size = np.abs(grid) @ np.abs(matrix[np.ix_(mixed, whole)]).T
    size += np.abs(matrix[np.ix_(mixed, rest)]) @ np.where(np.isfinite(at), at, 10.0)
    allowed = (MIXED if loose else 0.0) * (np.abs(matrix[mixed]).max(axis=1) + size)
    sides = []
    for sign, row_side, bound in (
        (-1.0, program.row_lower, program.lower),
        (1.0, program.row_upper, program.upper),
    ):
        of_rows = row_side[mixed] + sign * allowed - activity
        size = np.where(np.isfinite(bound[rest]), np.abs(bound[rest]), 0.0)
        of_bounds = bound[rest] + sign * (MIXED if loose else 0.0) * (1 + size)
        sides.append(np.hstack([of_rows, np.tile(of_bounds, (len(grid), 1))]))
    forms = np.vstack([matrix[np.ix_(mixed, rest)], np.eye(len(rest))])
    rounding = WIDE if loose else 1e-15
    return _of_continuous(forms, sides[0], sides[1], program.sign * program.cost[rest], rounding)


def _of_continuous(
    forms: Floats, low: Floats, high: Floats, cost: Floats, rounding: float
) -> Floats:
    """The minimum of ``cost @ z`` over ``low ≤ forms @ z ≤ high`` for each row of sides, by vertices."""
    best = np.full(len(low), np.inf)
    k = forms.shape[1]
    size = np.abs(forms).max(axis=1)
    for basis in combinations(range(len(forms)), k):
        square = forms[list(basis)]
        # By Cramer's rule, so that what is 0 stays 0.
        adjugate = np.eye(1) if k == 1 else np.array([[1, -1], [-1, 1]]) * square[::-1, ::-1].T
        determinant = float((square @ adjugate)[0, 0])
        if abs(determinant) <= 1e-9 * np.prod(size[list(basis)]):
            continue
        inverse = adjugate / determinant
        for choice in np.ndindex(*(2,) * k):
            ends = np.stack(
                [(low, high)[side][:, i] for i, side in zip(basis, choice, strict=True)], axis=1
            )
            there = np.asarray(np.isfinite(ends).all(axis=1))
            ends = np.where(there[:, None], ends, 0.0)
            z = ends @ inverse.T
            activity = z @ forms.T
            # What z is a sum of may be larger than z.
            terms = np.abs(ends) @ np.abs(inverse).T @ np.abs(forms).T
            within = np.abs(np.where(np.isfinite(low), low, 0.0))
            within = np.maximum(within, np.abs(np.where(np.isfinite(high), high, 0.0)))
            near = rounding * (terms + within)
            holds = there & ((activity >= low - near) & (activity <= high + near)).all(axis=1)
            best = np.where(holds, np.minimum(best, z @ cost), best)
    return best
