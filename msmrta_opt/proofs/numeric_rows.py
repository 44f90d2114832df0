"""Rows of a program in floating-point numbers: what the search for cuts looks at."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Bools, Floats, Ints
from .derivation import Box, Side
from .exact import ExactProgram, Row


@dataclass(frozen=True, slots=True)
class VariableBound:
    """``y ≤ at_zero + slope · z`` (or ≥) for a continuous column y, by row `row`, with z integer."""

    row: int
    column: int
    at_zero: Fraction
    slope: Fraction


class NumericRows:
    """The rows of a relaxation: first those of the program, then cuts.

    Parameters
    ----------
    program : ExactProgram
        Whose rows they are.
    box : Box
        The bounds of its columns.
    """

    def __init__(self, program: ExactProgram, box: Box) -> None:
        self.box = box
        self.rows: list[Row] = []
        self.n_columns = program.n_columns
        self.integer: Bools = np.array(program.integer, dtype=bool)
        self.lower = _floats(box.lower, -math.inf)
        self.upper = _floats(box.upper, math.inf)
        self.columns: list[Ints] = []
        self.coefficients: list[Floats] = []
        self.sides: list[tuple[float, float]] = []
        self.is_whole: list[bool] = []
        """Whether all columns of a row are integer."""
        self.with_column: dict[int, list[int]] = defaultdict(list)
        """Rows of a continuous column, but those that only bound it."""
        self.variable_bounds: dict[int, list[tuple[bool, VariableBound]]] = defaultdict(list)
        """Of a continuous column: whether one is an upper bound, and the bound."""
        self.add(program.rows)
        for i, row in enumerate(program.rows):
            self._note_bound(i, row)

    def add(self, rows: Sequence[Row]) -> None:
        """Add rows, in the order of the relaxation's."""
        for i, row in enumerate(rows, len(self.rows)):
            self.rows.append(row)
            columns: Ints = np.array(row.columns, dtype=np.int64)
            self.columns.append(columns)
            self.coefficients.append(np.array([float(a) for a in row.coefficients]))
            self.sides.append((
                -math.inf if row.lower is None else float(row.lower),
                math.inf if row.upper is None else float(row.upper),
            ))  # fmt: skip
            continuous = columns[~self.integer[columns]].tolist()
            self.is_whole.append(not continuous)
            if len(columns) != 2 or len(continuous) != 1:
                for j in continuous:
                    self.with_column[j].append(i)

    def remove(self, rows: Sequence[int]) -> None:
        """Forget cuts, which are the last of the rows."""
        gone = set(rows)
        kept = [row for i, row in enumerate(self.rows) if i not in gone]
        first = min(gone)
        for lines in (self.rows, self.columns, self.coefficients, self.sides, self.is_whole):
            del lines[first:]
        for numbers in self.with_column.values():
            numbers[:] = [i for i in numbers if i < first]
        self.add(kept[first:])

    def _note_bound(self, i: int, row: Row) -> None:
        """A row of a continuous column and an integer one bounds the first by the second."""
        continuous = [j for j in row.columns if not self.integer[j]]
        if len(row.columns) != 2 or len(continuous) != 1:
            return
        y = continuous[0]
        of = dict(zip(row.columns, row.coefficients, strict=True))
        (z,) = (j for j in row.columns if j != y)
        for is_upper, side in ((of[y] > 0, row.upper), (of[y] < 0, row.lower)):
            if side is not None:
                bound = VariableBound(i, z, Fraction(side, of[y]), Fraction(-of[z], of[y]))
                self.variable_bounds[y].append((is_upper, bound))


def _floats(sides: Sequence[Side | None], infinity: float) -> Floats:
    return np.array([infinity if side is None else float(side.bound) for side in sides])
