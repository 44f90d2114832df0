"""That every number of a program is one: what is not is named by its column and its row."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...mission.errors import ModelError
from ..program import Program


def require_numbers(name: str, program: Program) -> None:
    """Refuse costs, coefficients or a constant that are not finite, and sides or bounds that are NaN.

    Raises
    ------
    ModelError
        Naming the first of them.
    """
    for where, value in _wrong(program):
        raise ModelError(
            f"{name}: {where} is {value:g}; give a finite number: what the model divides by may be 0"
        )


def _wrong(program: Program) -> Iterator[tuple[str, float]]:
    """Where numbers are none, and what stands there."""
    matrix = program.matrix
    if not math.isfinite(program.offset):
        yield "the objective's constant", program.offset
    for j in np.flatnonzero(~np.isfinite(program.cost)):
        yield f"the cost of {program.column_name(int(j))}", float(program.cost[j])
    for entry in np.flatnonzero(~np.isfinite(matrix.data)):
        row = int(np.searchsorted(matrix.indptr, entry, "right")) - 1
        column = program.column_name(int(matrix.indices[entry]))
        where = f"the coefficient of {column} in row '{program.row_name(row)}'"
        yield where, float(matrix.data[entry])
    for i in np.flatnonzero(np.isnan(program.row_upper)):
        yield f"the right-hand side of row '{program.row_name(int(i))}'", math.nan
    for j in np.flatnonzero(np.isnan(program.lower) | np.isnan(program.upper)):
        yield f"a bound of {program.column_name(int(j))}", math.nan
