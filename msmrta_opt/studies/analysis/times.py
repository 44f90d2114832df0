"""Times of competitors on the same problems: performance profiles, and shifted geometric means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..record import SKIPPED, Record
from ..solves import records_of

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.ticker import Locator

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


def draw_profile(ax: Axes, times: pd.DataFrame, looks: Mapping[str, Mapping[str, Any]]) -> None:
    """Draw the profile of `times` as step functions.

    Parameters
    ----------
    ax : Axes
        Gets the factor on x, on a logarithmic scale, and percent of the problems on y.
    times : DataFrame
        As of `profile`.
    looks : mapping
        By competitor, what `Axes.plot` takes.
    """
    from matplotlib.ticker import FuncFormatter, NullFormatter

    steps, tried = profile(times), finished(times)
    worst = max(1.3 * steps["factor"].max(), 1.3) if len(steps) else 1.3
    for who in times:
        mine = steps[steps["who"] == who]
        share = mine["share (%)"].to_numpy(float)
        x = np.concatenate([[1.0], mine["factor"].to_numpy(float), [worst]])
        y = np.concatenate([[0.0], share, share[-1:] if len(share) else [0.0]])
        label = f"{who} ({int(tried[who].notna().sum())} of {len(tried)})"
        look = {name: value for name, value in looks[who].items() if name != "marker"}
        ax.plot(x, y, **look, drawstyle="steps-post", linewidth=2, label=label)
    ax.set_xscale("log")
    ax.set_xlim(1.0, worst)
    ax.xaxis.set_major_locator(_factors(worst))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda factor, _: f"{factor:g}×"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylim(-2, 102)


def performance_profile(rows: Sequence[Record] | pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Share of programs that each solver solves within a factor of the best solver's time.

    A program is one formulation on one instance with one seed; only those that some solver solved
    to optimality count. Source: Dolan and Moré (2002).

    Parameters
    ----------
    rows : sequence of Record or DataFrame
        Of a comparison.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        The factor on x, on a logarithmic scale; percent of the programs on y.
    """
    from ...plots.canvas import own_axes
    from ...plots.style import line_styles

    ax = own_axes(7.5, 4.8) if ax is None else ax
    times = _solving_times(records_of(rows))
    draw_profile(ax, times, line_styles(list(times)))
    ax.set_xlabel("time, as a multiple of the best solver's on the same program")
    ax.set_ylabel("programs solved to optimality (%)")
    ax.set_title(f"Performance profile over {len(finished(times))} programs")
    ax.grid(alpha=0.3)
    if len(times.columns):
        ax.legend(title="solver (programs solved)", loc="lower right")
    return ax


def _solving_times(records: Sequence[Record]) -> pd.DataFrame:
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


def _factors(worst: float) -> Locator:
    """Which factors are marked: several, whether the worst is 2 or 2000."""
    from matplotlib.ticker import LogLocator, MaxNLocator

    if worst < 4:
        return MaxNLocator(6, steps=[1, 2, 5, 10])
    return LogLocator(subs=(1, 2, 5) if worst < 1000 else (1,))
