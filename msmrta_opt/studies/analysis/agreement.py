"""Where solves of one program contradict each other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

from ..record import Record
from ..solves import records_of

if TYPE_CHECKING:
    import pandas as pd

TOLERANCE = 1e-6
"""Relative difference up to which two optima agree."""
SMALLEST = 1e-3
"""Values below this are compared as if they were this: a solver's zero is not exact."""


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
        values = [row for row in group if row.objective is not None]
        bounds = [row for row in group if row.bound is not None]
        refused = [row for row in group if row.verdict == "infeasible"]
        endless = [row for row in group if row.verdict == "unbounded"]
        for value, bound in product(values, bounds):
            sign = 1.0 if bound.sense == "min" else -1.0
            slack = tolerance * max(SMALLEST, abs(value.objective or 0.0))
            if sign * ((bound.bound or 0.0) - (value.objective or 0.0)) > slack:
                found.append(
                    f"{model} on {instance}: {value.solver} has {value.objective:.9g}, but"
                    f" {bound.solver} proves that nothing is better than {bound.bound:.9g}"
                )
        if refused and values:
            found.append(
                f"{model} on {instance}: {refused[0].solver} proves it infeasible, but"
                f" {values[0].solver} has {values[0].objective:.9g}"
            )
        if endless and (refused or bounds):
            other = (refused or bounds)[0]
            found.append(
                f"{model} on {instance}: {endless[0].solver} proves it unbounded, but"
                f" {other.solver} has it {other.verdict}"
            )
    return found
