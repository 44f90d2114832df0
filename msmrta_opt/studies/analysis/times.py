"""Times of competitors on the same problems: steps of performance profiles, shifted geometric means."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..record import SKIPPED, Record

if TYPE_CHECKING:
    import pandas as pd

SHIFT_SECONDS = 0.01
"""Shift of the geometric means of solving times."""


def shifted_geometric_mean(seconds: ArrayLike, shift: float = SHIFT_SECONDS) -> float:
    """exp(mean log(t + shift)) − shift; NaN of nothing."""
    times = np.asarray(seconds, dtype=float)
    return float(np.exp(np.mean(np.log(times + shift))) - shift) if times.size else float("nan")


def shifted_geometric_means(
    records: Sequence[Record], shift: float = SHIFT_SECONDS
) -> dict[tuple[str, str], tuple[float, int, int]]:
    """Per model and solver: shifted geometric mean of seconds, solved to optimality, tried.

    Only optimal solves have a time; the two counts say how many that are.
    """
    groups: dict[tuple[str, str], list[Record]] = {}
    for record in records:
        if record.verdict != SKIPPED:
            groups.setdefault((record.model or "", record.solver or ""), []).append(record)
    means = {}
    for key, group in groups.items():
        times = [r.seconds for r in group if r.verdict == "optimal" and r.seconds is not None]
        means[key] = (shifted_geometric_mean(times, shift), len(times), len(group))
    return means


def profile(times: pd.DataFrame) -> pd.DataFrame:
    """The steps of a performance profile.

    Source: Dolan and Moré (2002).

    Parameters
    ----------
    times : DataFrame
        Seconds by problem (rows) and competitor (columns); NaN where that did not finish.

    Returns
    -------
    DataFrame
        Columns ``who``, ``factor`` (of the quickest on the same problem) and ``share (%)``, of the
        problems that anybody finished, within that factor.
    """
    import pandas as pd

    times = finished(times)
    factors = times.div(times.min(axis="columns"), axis="index")
    parts = []
    for who in factors:
        steps = np.sort(factors[who].dropna().to_numpy(float))
        share = 100 * np.arange(1, len(steps) + 1) / max(len(times), 1)
        part = pd.DataFrame({"who": who, "factor": steps, "share (%)": share})
        parts.append(part.drop_duplicates("factor", keep="last"))
    columns = ["who", "factor", "share (%)"]
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)


def finished(times: pd.DataFrame) -> pd.DataFrame:
    """The problems that anybody finished in a time that the clock tells."""
    return times.where(times > 0).dropna(how="all")


def solving_times(records: Sequence[Record]) -> pd.DataFrame:
    """Seconds to optimality by program (rows) and solver (columns) that tried any."""
    import pandas as pd

    tried = [record for record in records if record.verdict != SKIPPED]
    times: dict[str, dict[tuple[Any, ...], float]] = {r.solver or "": {} for r in tried}
    for record in tried:
        program = (record.instance, record.model, record.solver_seed)
        is_optimal = record.verdict == "optimal" and record.seconds is not None
        times[record.solver or ""][program] = record.seconds if is_optimal else float("nan")  # type: ignore[assignment]
    programs = dict.fromkeys(program for mine in times.values() for program in mine)
    table = {
        solver: [mine.get(p, float("nan")) for p in programs] for solver, mine in times.items()
    }
    return pd.DataFrame(table, dtype=float)
