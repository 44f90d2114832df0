"""Contradictions that can be read off a program: an empty row that asks for something, crossed sides."""

from __future__ import annotations

import numpy as np

from ..arrays import Bools, Floats
from .check import TOLERANCE
from .program import ROUNDING, Program

BY_HAND = "a contradiction within one row or pair of bounds"
"""How such an infeasibility is told to be proved."""


def contradiction(program: Program) -> str:
    """A row without entries that asks for something, or bounds that cross; empty if there is none.

    Solvers differ in what they make of these.
    """
    for i in np.flatnonzero(asks_of_nothing(program)):
        return f"row '{program.row_name(int(i))}' holds no variable and is not satisfied"
    for i in np.flatnonzero(_cross(program.row_lower, program.row_upper)):
        return f"the sides of row '{program.row_name(int(i))}' cross"
    for j in np.flatnonzero(_cross(program.lower, program.upper)):
        return f"the bounds of {program.column_name(int(j))} cross"
    return ""


def asks_of_nothing(program: Program) -> Bools:
    """Which rows hold no variable and are not satisfied, ``(n_rows,)``."""
    is_empty = np.diff(program.matrix.indptr) == 0
    return np.asarray(is_empty & (np.maximum(program.row_lower, -program.row_upper) > ROUNDING))


def _cross(lower: Floats, upper: Floats) -> Bools:
    """Where sides cross by more than rounding."""
    cross = lower > upper
    if cross.any():
        cross &= lower > upper + TOLERANCE * (1.0 + np.abs(upper))
    return cross
