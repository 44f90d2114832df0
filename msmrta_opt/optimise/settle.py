"""What a program's solution is, beyond any solver's word: small ones by looking at all of their points.

Solvers certify falsehoods now and then: a presolve that calls a feasible program infeasible, a tolerance
that a badly scaled row slips through. A pure integer program within finite bounds has finitely many
points. Where they are few, all are looked at, by the rules of `check`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats
from .check import kinds_of_rows
from .program import ROUNDING, Program

FEW = 2**14
"""Points that are looked at in some milliseconds."""


@dataclass(frozen=True, eq=False)
class Settled:
    """A best point of a program, or that there is none."""

    x: Floats | None
    n_points: int

    @property
    def proof(self) -> str:
        """How it is known."""
        return f"all {self.n_points} points within the bounds"


def settle(program: Program) -> Settled | None:
    """The best of all points; ``None`` if they are not few, or sums of them may be inexact."""
    if not program.integer.all() or not np.isfinite([program.lower, program.upper]).all():
        return None
    widths = np.maximum(np.floor(program.upper) - np.ceil(program.lower) + 1, 0)
    with np.errstate(over="ignore"):  # a thousand binaries have more points than a float can count
        n_points = float(np.prod(widths))
    if n_points > FEW:
        return None
    if n_points == 0:
        return Settled(None, 0)
    grid = np.indices(tuple(int(n) for n in widths)).reshape(program.n_columns, int(n_points))
    points = np.asarray(grid.T + np.ceil(program.lower), float)
    size = np.abs(points).max(axis=0)
    matrix = program.matrix.toarray()
    terms = np.abs(matrix) @ size
    whole, _ = kinds_of_rows(program)
    if (terms[whole] >= 2.0**53).any():
        return _exactly(program, points)
    sides = np.maximum(
        np.where(np.isfinite(program.row_lower), np.abs(program.row_lower), 0.0),
        np.where(np.isfinite(program.row_upper), np.abs(program.row_upper), 0.0),
    )
    allowed = np.where(whole, 0.0, ROUNDING * np.maximum(np.abs(points) @ np.abs(matrix).T, sides))
    allowed = np.where((matrix == 0).all(axis=1), ROUNDING, allowed)
    activity = points @ matrix.T
    holds = (activity >= program.row_lower - allowed) & (activity <= program.row_upper + allowed)
    return _best(program, points[holds.all(axis=1)], int(n_points))


def _exactly(program: Program, points: Floats) -> Settled:
    """The same where whole numbers are too large for floats."""
    from .check import row_misses

    def holds(x: Floats) -> bool:
        missed, allowed = row_misses(program, x)
        return bool((missed <= allowed).all())

    return _best(program, points[[holds(x) for x in points]], len(points))


def _best(program: Program, points: Floats, n_points: int) -> Settled:
    if not len(points):
        return Settled(None, n_points)
    values = program.sign * (points @ program.cost)
    return Settled(points[int(np.argmin(values))], n_points)
