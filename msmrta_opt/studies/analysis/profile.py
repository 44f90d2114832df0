"""The performance profile, drawn: of solvers in a comparison, of contenders in a report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, Locator, LogLocator, MaxNLocator, NullFormatter

from ...plots.figure import own_axes
from ...plots.lettering import as_written, told_apart
from ...plots.style import line_styles
from ..record import Record
from ..solves import records_of
from .times import finished, profile, solving_times

if TYPE_CHECKING:
    import pandas as pd


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
    steps, tried = profile(times), finished(times)
    worst = max(1.3 * steps["factor"].max(), 1.3) if len(steps) else 1.3
    said = told_apart(map(str, times))
    for who in times:
        mine = steps[steps["who"] == who]
        share = mine["share (%)"].to_numpy(float)
        x = np.concatenate([[1.0], mine["factor"].to_numpy(float), [worst]])
        y = np.concatenate([[0.0], share, share[-1:] if len(share) else [0.0]])
        label = f"{said[str(who)]} ({int(tried[who].notna().sum())} of {len(tried)})"
        look = {name: value for name, value in looks[who].items() if name != "marker"}
        ax.plot(x, y, **look, drawstyle="steps-post", linewidth=2, label=label)
    ax.set_xscale("log")
    ax.set_xlim(1.0, worst)
    ax.xaxis.set_major_locator(_factors(worst))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda factor, _: f"{factor:g}×"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylim(-2, 102)


@as_written
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
    ax = own_axes(7.5, 4.8) if ax is None else ax
    times = solving_times(records_of(rows))
    draw_profile(ax, times, line_styles(list(times)))
    ax.set_xlabel("time, as a multiple of the best solver's on the same program")
    ax.set_ylabel("programs solved to optimality (%)")
    ax.set_title(f"Performance profile over {len(finished(times))} programs")
    ax.grid(alpha=0.3)
    if len(times.columns):
        ax.legend(title="solver (programs solved)", loc="lower right")
    return ax


def _factors(worst: float) -> Locator:
    """Which factors are marked: several, whether the worst is 2 or 2000."""
    if worst < 4:
        return MaxNLocator(6, steps=[1, 2, 5, 10])
    return LogLocator(subs=(1, 2, 5) if worst < 1000 else (1,))
