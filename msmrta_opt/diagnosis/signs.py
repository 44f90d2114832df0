"""Rows as they are written: ``x + y >= 2`` is stored as ``-x - y ≤ -2``, and told with its own signs."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats
from ..optimise.program import Program


def signs(program: Program) -> Floats:
    """-1 for each row without a positive coefficient, which is told negated, else 1; ``(n_rows,)``."""
    matrix = program.matrix
    rows = np.repeat(np.arange(program.n_rows), np.diff(matrix.indptr))
    positive = np.bincount(rows, matrix.data > 0, minlength=program.n_rows)
    negative = np.bincount(rows, matrix.data < 0, minlength=program.n_rows)
    return np.where((positive == 0) & (negative > 0), -1.0, 1.0)
