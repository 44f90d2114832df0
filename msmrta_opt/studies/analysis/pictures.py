"""Pictures of comparisons: the performance profile, and what staging costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, Locator, LogLocator, MaxNLocator, NullFormatter

from ...plots.canvas import own_axes
from ...plots.legends import legend_below
from ..rows import Row, as_rows
from .staging import Loss

if TYPE_CHECKING:
    import pandas as pd

LINES = ("-", "--", "-.", ":")
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's palette, which colour-blind people can tell apart."""


def performance_profile(rows: Sequence[Row] | pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Share of programs that each solver solves within a factor of the best solver's time.

    A program is one formulation on one instance with one seed; only those that some solver solved
    to optimality count. Source: Dolan and Moré (2002).

    Parameters
    ----------
    rows : sequence of Row or DataFrame
        Of a comparison.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        The factor on x, on a logarithmic scale; percent of the programs on y.
    """
    ax = own_axes(7.5, 4.8) if ax is None else ax
    ratios, n_programs = _ratios(as_rows(rows))
    worst = max((max(values, default=1.0) for values in ratios.values()), default=1.0) * 1.3
    for i, (solver, values) in enumerate(ratios.items()):
        steps = np.sort(values)
        x = np.concatenate([[1.0], np.repeat(steps, 2), [worst]])
        share = np.arange(len(steps) + 1) / max(n_programs, 1)
        y = np.concatenate([[0.0], np.repeat(share, 2)[1:-1], [share[-1]]])
        ax.plot(
            x,
            100 * y,
            color=COLOURS[i % len(COLOURS)],
            linestyle=LINES[i // len(COLOURS) % len(LINES)],
            linewidth=2,
            label=f"{solver} ({len(steps)} of {n_programs})",
        )
    ax.set_xscale("log")
    ax.set_xlim(1.0, worst)
    ax.xaxis.set_major_locator(_factors(worst))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda factor, _: f"{factor:g}×"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylim(-2, 102)
    ax.set_xlabel("time, as a multiple of the best solver's on the same program")
    ax.set_ylabel("programs solved to optimality (%)")
    ax.set_title(f"Performance profile over {n_programs} programs")
    ax.grid(alpha=0.3)
    if ratios:
        ax.legend(title="solver (programs solved)", loc="lower right")
    return ax


def _factors(worst: float) -> Locator:
    """Which factors are marked: several, whether the worst is 2 or 2000."""
    if worst < 4:
        return MaxNLocator(6, steps=[1, 2, 5, 10])
    return LogLocator(subs=(1, 2, 5) if worst < 1000 else (1,))


def _ratios(rows: Sequence[Row]) -> tuple[dict[str, list[float]], int]:
    """Per solver the ratios of the programs that it solved, and the number of programs."""
    times: dict[tuple[str, str, int | None], dict[str, float]] = {}
    ratios: dict[str, list[float]] = {}
    for row in rows:
        if row.status == "skipped":
            continue
        ratios.setdefault(row.solver, [])
        if row.status == "optimal" and row.total_seconds is not None:
            program = (row.instance, row.model, row.seed)
            times.setdefault(program, {})[row.solver] = row.total_seconds
    for solved in times.values():
        best = min(solved.values())
        for solver, seconds in solved.items():
            ratios[solver].append(seconds / best)
    return ratios, len(times)


def staging_losses(
    priced: Mapping[str, Sequence[Loss]], objective: str, ax: Axes | None = None
) -> Axes:
    """Per mission a bar: what a staged plan needs at best, and what each stage adds.

    Parameters
    ----------
    priced : mapping of str to sequence of Loss
        What `price_of_staging` finds, by the mission's name.
    objective : str
        What was priced.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        The objective on x, in time units; a row per mission.
    """
    ax = own_axes(9, 1.9 + 0.35 * len(priced)) if ax is None else ax
    for row, losses in enumerate(priced.values()):
        left = losses[-1].after
        ax.barh(row, left, color="#D9D9D9", edgecolor="white", label="all free" if not row else "")
        for i, item in enumerate(reversed(losses)):
            label = f"lost by {item.stage}" if not row else ""
            ax.barh(row, item.loss, left=left, color=COLOURS[i], edgecolor="white", label=label)
            left += item.loss
        ax.text(left, row, f" {left:.1f}", va="center")
    ax.set_yticks(range(len(priced)), list(priced))
    ax.invert_yaxis()
    ax.set_xlabel(f"{objective.replace('_', ' ')} (time units)")
    ax.set_title("What each stage of the staged plan costs")
    ax.margins(x=0.12)
    legend_below(ax)
    return ax
