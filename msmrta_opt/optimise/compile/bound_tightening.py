"""Bounds that single rows imply, by the minimum and the maximum that the rest of a row can be.

Savelsbergh (1994), "Preprocessing and probing techniques for mixed integer programming problems", 1.2.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import Floats
from ..program import Program

ROUNDS = 4
"""Passes over all rows; each may use what the one before found."""
SLACK = 1e-9
"""Relative room that is left to continuous columns for rounding."""
WHOLE = 1e-6
"""How far below a whole number a bound of an integer column still admits it."""


def tightened(program: Program) -> Program:
    """The same program with the bounds that its rows imply; it has the same points."""
    matrix = program.matrix
    n_rows = program.n_rows
    used = matrix.data != 0
    rows = np.repeat(np.arange(n_rows), np.diff(matrix.indptr))[used]
    columns, factors = matrix.indices[used], matrix.data[used]
    lower, upper = program.lower.copy(), program.upper.copy()
    for _ in range(ROUNDS):
        before = lower.copy(), upper.copy()
        for sign, side in ((1.0, program.row_upper), (-1.0, program.row_lower)):
            a, maximum = sign * factors, sign * side
            ends = a * np.where(a > 0, lower[columns], upper[columns])
            endless = np.isinf(ends)
            n_endless = np.bincount(rows[endless], minlength=n_rows)
            sums = np.bincount(rows, np.where(endless, 0.0, ends), minlength=n_rows)
            sizes = np.bincount(rows, np.where(endless, 0.0, np.abs(ends)), minlength=n_rows)
            known = np.isfinite(maximum[rows]) & (n_endless[rows] == endless)
            at, a, row = columns[known], a[known], rows[known]
            rest = sums[row] - np.where(endless[known], 0.0, ends[known])
            reach = (maximum[row] - rest) / a
            room = SLACK * (np.abs(maximum[row]) + sizes[row]) / np.abs(a)
            whole = program.integer[at]
            high = np.where(whole, np.floor(reach + WHOLE), reach + room)
            low = np.where(whole, np.ceil(reach - WHOLE), reach - room)
            np.minimum.at(upper, at[a > 0], high[a > 0])
            np.maximum.at(lower, at[a < 0], low[a < 0])
        if _same(before, (lower, upper)):
            break
    return replace(program, lower=lower, upper=upper)


def _same(before: tuple[Floats, Floats], after: tuple[Floats, Floats]) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))
