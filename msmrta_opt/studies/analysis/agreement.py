"""Where solves of one program contradict each other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

from ...mission.counting import in_full
from ..record import Record
from ..solves import records_of

if TYPE_CHECKING:
    import pandas as pd

TOLERANCE = 1e-6
"""Relative difference up to which two optima agree."""
SMALLEST = 1e-3
"""Where the size of an objective is not known, values are compared as if they were at least this."""


def size_of(*rows: Record) -> float:
    """What differences between the objectives of `rows` are relative to: no constant is part of it."""
    sizes = [row.objective_size for row in rows if row.objective_size is not None]
    values = [abs(value) for row in rows if (value := row.objective) is not None]
    return max(sizes) if sizes else max(SMALLEST, *values, 0.0)


def disagreements(rows: Sequence[Record] | pd.DataFrame, tolerance: float = TOLERANCE) -> list[str]:
    """Where solves of one formulation on one instance contradict each other, one line each.

    Two optima differ, a feasible value is better than a proven bound, or one solve proves a
    program infeasible or unbounded for which another has a point or a bound.

    Parameters
    ----------
    rows : sequence of Record or DataFrame
        Of a comparison.
    tolerance : float
        Relative difference up to which two values agree.
    """
    groups: dict[tuple[str, str | None], list[Record]] = {}
    for row in records_of(rows):
        groups.setdefault((row.instance, row.model), []).append(row)
    found = []
    for (instance, model), group in groups.items():
        values = [(row, x) for row in group if (x := row.objective) is not None]
        bounds = [(row, x) for row in group if (x := row.bound) is not None]
        refused = [row for row in group if row.verdict == "infeasible"]
        endless = [row for row in group if row.verdict == "unbounded"]
        for (one, value), (other, bound) in product(values, bounds):
            sign = 1.0 if other.sense == "min" else -1.0
            if sign * (bound - value) > tolerance * size_of(one, other):
                found.append(
                    f"{model} on {instance}: {one.solver} has {in_full(value)}, but"
                    f" {other.solver} proves that nothing is better than {in_full(bound)}"
                )
        if refused and values:
            (one, value), *_ = values
            found.append(
                f"{model} on {instance}: {refused[0].solver} proves it infeasible, but"
                f" {one.solver} has {in_full(value)}"
            )
        if endless and (refused or bounds):
            other = (refused or [row for row, _ in bounds])[0]
            found.append(
                f"{model} on {instance}: {endless[0].solver} proves it unbounded, but"
                f" {other.solver} has it {other.verdict}"
            )
    return found
