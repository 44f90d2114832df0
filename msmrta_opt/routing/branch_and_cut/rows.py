"""Rows of a sparse matrix, gathered block by block."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array

from ...arrays import Floats, Ints


class Rows:
    """A growing list of rows with their sides."""

    def __init__(self, n_columns: int) -> None:
        self.n_columns = n_columns
        self.n_rows = 0
        self.parts: list[tuple[Ints, Ints, Floats]] = []
        self.sides: list[tuple[Floats, Floats]] = []

    def add(self, row: Ints, column: Ints, weight: Floats, lower: Floats, upper: Floats) -> None:
        """Rows with the entries ``(row, column, weight)``, counted from 0 within the block."""
        self.parts.append((row + self.n_rows, column, weight))
        self.sides.append((lower, upper))
        self.n_rows += len(lower)

    def done(self) -> tuple[csr_array, Floats, Floats]:
        """The matrix and its sides."""
        none = (np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64), np.empty(0))
        row, column, weight = (np.concatenate(p) for p in zip(none, *self.parts, strict=True))
        shape = (self.n_rows, self.n_columns)
        matrix = csr_array(coo_array((weight, (row, column)), shape=shape))
        lower = np.concatenate([np.empty(0), *(lower for lower, _ in self.sides)])
        upper = np.concatenate([np.empty(0), *(upper for _, upper in self.sides)])
        return matrix, lower, upper
