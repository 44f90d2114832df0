"""The independent check of solutions and bounds: numpy on the program's arrays, no solver.

What fails it is never shown as a result.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Floats
from .program import Program

TOLERANCE = 1e-6
"""How far a row or bound may be missed, relative to the size of its terms."""


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


def violations(program: Program, x: Floats, *, most: int = 3) -> list[str]:
    """What is wrong with `x` as a solution of `program`, worst first; empty if nothing is.

    Parameters
    ----------
    program : Program
        The arrays to check against.
    x : float array, shape (n_columns,)
        The point.
    most : int
        How many to name.
    """
    if x.shape != (program.n_columns,) or not np.isfinite(x).all():
        return [f"the point has shape {x.shape} or values that are not finite"]
    found: list[tuple[float, str]] = []

    activity = program.matrix @ x
    missed = np.maximum(program.row_lower - activity, activity - program.row_upper)
    scale = np.ones(len(missed))
    if not np.all(missed <= TOLERANCE):  # what is not missed at all is not in any scale
        scale += np.abs(program.matrix) @ np.abs(x)
    missed = missed / scale
    found.extend(
        (missed[i], f"row '{program.row_name(i)}' is missed by {missed[i] * scale[i]:.2g}")
        for i in _worst(missed, most)
    )
    outside = np.maximum(program.lower - x, x - program.upper) / (1.0 + np.abs(x))
    found.extend(
        (outside[j], f"{program.column_name(j)} = {x[j]:g} is outside its bounds")
        for j in _worst(outside, most)
    )
    fraction = np.where(program.integer, np.abs(x - np.round(x)), 0.0)
    found.extend(
        (fraction[j], f"{program.column_name(j)} = {x[j]:g} is not integral")
        for j in _worst(fraction, most)
    )
    return [text for _, text in sorted(found, key=lambda item: -item[0])[:most]]


def _worst(missed: Floats, most: int) -> list[int]:
    """Positions that miss by more than the tolerance, or by what is not a number, worst first."""
    wrong = np.flatnonzero(~(missed <= TOLERANCE))
    by_how_much = np.where(np.isnan(missed[wrong]), np.inf, missed[wrong])
    return [int(i) for i in wrong[np.argsort(-by_how_much, kind="stable")][:most]]


def dual_bound(program: Program, duals: Floats) -> float:
    """The bound that dual values `duals` prove on the program's objective, by weak LP duality.

    Whatever the duals are, no feasible point is better; good duals make the bound tight. It is
    infinite where a dual value has the wrong sign for a one-sided row or a free column.

    Parameters
    ----------
    program : Program
        The arrays.
    duals : float array, shape (n_rows,)
        For a minimisation of ``sign * cost``: positive duals lean on ``row_lower``, negative ones
        on ``row_upper``.
    """
    duals, of_rows = _leaning(duals, program.row_lower, program.row_upper)
    reduced = program.sign * program.cost - program.matrix.T @ duals
    _, of_columns = _leaning(reduced, program.lower, program.upper)
    return program.sign * (of_rows + of_columns) + program.offset


def _leaning(weight: Floats, lower: Floats, upper: Floats) -> tuple[Floats, float]:
    """`weight` without what leans on an infinite side by no more than rounding, and what it proves.

    That is the least value of ``weight @ z`` over ``lower ≤ z ≤ upper``.
    """
    side = np.where(weight > 0, lower, upper)
    weight = np.where(np.isinf(side) & (np.abs(weight) < 1e-9), 0.0, weight)
    leans = weight != 0
    return weight, float(np.sum(weight[leans] * side[leans]))
