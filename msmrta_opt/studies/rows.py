"""What comes of a comparison: one row a solve, what rows contradict, and their times on average."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from ..mission.errors import InputError
from ..optimise.solution import Status

if TYPE_CHECKING:
    import pandas as pd

TOLERANCE = 1e-6
"""Relative difference up to which two optima agree."""
WHOLE = frozenset({"seed", "nodes", "n_variables", "n_rows"})
SHIFT_SECONDS = 0.01
"""Shift of the geometric means of solving times."""


@dataclass(frozen=True)
class Row:
    """One solve: what was asked, and what came of it. Times are in seconds."""

    instance: str
    stage: str
    model: str
    solver: str
    seed: int | None
    status: Status
    sense: str = ""
    objective: float | None = None
    bound: float | None = None
    gap: float | None = None
    check: str = ""
    proof: str = ""
    message: str = ""
    canonicalise_seconds: float | None = None
    solve_seconds: float | None = None
    total_seconds: float | None = None
    nodes: int | None = None
    n_variables: int | None = None
    n_rows: int | None = None
    solver_version: str = ""
    machine: str = ""

    @property
    def key(self) -> tuple[str, str, str, int | None]:
        """What identifies the solve: instance, model, solver, seed."""
        return self.instance, self.model, self.solver, self.seed


def disagreements(rows: Sequence[Row] | pd.DataFrame, tolerance: float = TOLERANCE) -> list[str]:
    """Where solves of one formulation on one instance contradict each other, one line each.

    Two optima differ, a feasible value is better than a proven bound, or one solve proves a
    program infeasible or unbounded for which another has a point or a bound.

    Parameters
    ----------
    rows : sequence of Row or DataFrame
        Of a comparison.
    tolerance : float
        Relative difference up to which two values agree.
    """
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in as_rows(rows):
        groups.setdefault((row.instance, row.model), []).append(row)
    found = []
    for (instance, model), group in groups.items():
        values = [row for row in group if row.objective is not None]
        bounds = [row for row in group if row.bound is not None]
        refused = [row for row in group if row.status == "infeasible"]
        endless = [row for row in group if row.status == "unbounded"]
        for value, bound in product(values, bounds):
            sign = 1.0 if bound.sense == "min" else -1.0
            slack = tolerance * max(1.0, abs(value.objective or 0.0))
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
                f" {other.solver} has it {other.status}"
            )
    return found


def frame(rows: Sequence[Row]) -> pd.DataFrame:
    """The rows as a pandas table, one column per field of `Row`."""
    import pandas as pd

    return pd.DataFrame([asdict(row) for row in rows], columns=[f.name for f in fields(Row)])


def as_rows(rows: Sequence[Row] | pd.DataFrame) -> Sequence[Row]:
    """The rows of a comparison, whether they come as they are or as the table of `frame`.

    Raises
    ------
    InputError
        If the table lacks columns of `frame`.
    """
    if isinstance(rows, Sequence):
        return rows
    named = [name for name in rows.index.names if name is not None]
    table = rows.reset_index(level=named) if named else rows
    columns = [item.name for item in fields(Row)]
    if missing := [name for name in columns if name not in table.columns]:
        raise InputError(
            f"{', '.join(missing)}; give the table as compare returns it", field="missing columns"
        )
    known = table[columns].astype(object).where(table[columns].notna(), None)
    return [
        Row(**{name: _whole(name, value) for name, value in record.items()})
        for record in known.to_dict("records")
    ]


def _whole(name: str, value: Any) -> Any:
    """The value as a row has it: a column of whole numbers with gaps has become one of floats."""
    return int(value) if name in WHOLE and value is not None else value


def shifted_geometric_means(
    rows: Sequence[Row], shift: float = SHIFT_SECONDS
) -> dict[tuple[str, str], tuple[float, int, int]]:
    """Per model and solver: shifted geometric mean of total seconds, solved to optimality, tried.

    Only optimal solves have a time; the two counts say how many that are.
    """
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row.status != "skipped":
            groups.setdefault((row.model, row.solver), []).append(row)
    means = {}
    for key, group in groups.items():
        times = [
            row.total_seconds
            for row in group
            if row.status == "optimal" and row.total_seconds is not None
        ]
        mean = float(np.exp(np.mean(np.log(np.array(times) + shift))) - shift) if times else np.nan
        means[key] = (mean, len(times), len(group))
    return means


def as_documents(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """The rows as JSON-ready documents."""
    return [asdict(row) for row in rows]
