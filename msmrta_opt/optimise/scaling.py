"""Powers of two that bring a program's numbers to the size for which solvers' tolerances are made.

Solvers call a row satisfied, a value integral or a gap closed within absolute tolerances of 1e-6 or so,
and drop small coefficients. So a mission in another unit of time would be another program to them. Rows,
continuous columns and the objective are therefore multiplied by powers of two, which rounds nothing,
until their geometric means are about 1. Integer columns stay as they are, and so does all that is of a
usual size.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..arrays import Floats
from .program import Program

USUAL = (2.0**-8, 2.0**14)
"""Sizes of coefficients at which nothing is scaled."""
USUAL_COST = (2.0**3, 2.0**20)
"""Sizes of the largest cost at which the objective is not scaled."""
ROUNDS = 4


@dataclass(frozen=True, eq=False)
class Scaling:
    """The factors of rows, columns and objective; variables are divided by those of their columns."""

    row: Floats
    column: Floats
    objective: float

    @property
    def unit(self) -> float:
        """What is 1 in the scaled objective, in the program's own."""
        return 1.0 / self.objective


@lru_cache(maxsize=4)
def scaling(program: Program) -> Scaling:
    """The factors for `program`."""
    row, column = np.ones(program.n_rows), np.ones(program.n_columns)
    size = np.abs(program.matrix.data)
    there = size > 0
    if there.any() and (size[there].min() < USUAL[0] or size.max() > USUAL[1]):
        row, column = _equilibrated(program)
    cost = np.abs(program.varying) * column
    largest = float(cost.max(initial=0.0))
    is_usual = largest == 0 or USUAL_COST[0] <= largest <= USUAL_COST[1]
    if is_usual or (largest <= USUAL_COST[1] and _has_whole_costs(program)):
        return Scaling(row, column, 1.0)
    return Scaling(row, column, float(2.0 ** (10 - np.floor(np.log2(largest)))))


def objective_size(program: Program, value: float) -> float:
    """What gaps at the objective `value` are relative to: without the constant, and at least a unit."""
    return max(scaling(program).unit, abs(value - program.constant))


def _has_whole_costs(program: Program) -> bool:
    """Whether the objective is whole: whole costs, of whole columns alone."""
    cost = program.varying
    return bool(program.integer[cost != 0].all() and (cost == np.round(cost)).all())


def _equilibrated(program: Program) -> tuple[Floats, Floats]:
    """Factors of rows and of continuous columns whose geometric means become about 1."""
    matrix = program.matrix.tocoo()
    there = matrix.data != 0
    at, of = (part[there] for part in matrix.coords)
    size = np.log2(np.abs(matrix.data[there]))
    row, column = np.zeros(program.n_rows), np.zeros(program.n_columns)
    # A column is not divided by more than it can reach: its bounds would fall below all tolerances.
    reach = np.maximum(np.abs(program.lower), np.abs(program.upper))
    maximum = np.log2(
        reach, where=(reach > 0) & np.isfinite(reach), out=np.full(len(reach), np.inf)
    )
    for _ in range(ROUNDS):
        row = -_middle(at, size + column[of], program.n_rows)
        column = -_middle(of, size + row[at], program.n_columns)
        column = np.where(program.integer, 0.0, np.minimum(column, np.floor(maximum)))
    row = -_middle(at, size + np.round(column)[of], program.n_rows)
    return 2.0 ** np.round(row), 2.0 ** np.round(column)


def _middle(place: np.ndarray, size: Floats, n: int) -> Floats:
    """The middle of the smallest and the largest `size` at each place, 0 where there is none."""
    low, high = np.full(n, np.inf), np.full(n, -np.inf)
    np.minimum.at(low, place, size)
    np.maximum.at(high, place, size)
    some = low <= high
    return np.where(some, np.where(some, low, 0.0) / 2 + np.where(some, high, 0.0) / 2, 0.0)


def scaled(program: Program, factors: Scaling) -> Program:
    """`program` with `factors`, and without the constant of its objective."""
    matrix = program.matrix
    if (factors.row != 1).any() or (factors.column != 1).any():
        matrix = matrix.copy()
        matrix.data = (
            matrix.data
            * np.repeat(factors.row, np.diff(matrix.indptr))
            * factors.column[matrix.indices]
        )
    return replace(
        program,
        cost=program.varying * factors.column * factors.objective,
        offset=0.0,
        matrix=matrix,
        row_lower=program.row_lower * factors.row,
        row_upper=program.row_upper * factors.row,
        lower=program.lower / factors.column,
        upper=program.upper / factors.column,
    )
