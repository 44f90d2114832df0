"""Coverage over the steps of a scouting, and when each victim was found."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..mission.plan import ScoutingReport
from .figure import own_axes, size_of
from .legends import legend_below, mark_handle
from .lettering import as_written
from .placing import spread
from .scouting import summary
from .style import FAINT, INK, SERIES

LINE, FIND = SERIES[1:]
NAMES_PER_STEP = 3
"""Victims found at one step that are named; more are counted."""


@as_written
def plot_coverage(report: ScoutingReport, ax: Axes | None = None) -> Axes:
    """Draw the share of cells seen after each step, and when each victim was found.

    Parameters
    ----------
    report : ScoutingReport
        What the scouts did.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        Steps on x, coverage on y in % of the cells that can be seen.
    """
    ax = own_axes(7.0, 3.6) if ax is None else ax
    percent = 100 * np.array(report.coverage)
    steps = np.arange(len(percent))
    last = max(len(percent) - 1, 1)
    ax.plot(steps, percent, color=LINE, lw=1.8, marker="o" if last < 3 else "")
    ax.fill_between(steps, percent, color=LINE, alpha=0.12, lw=0)
    ax.set(xlim=(-0.02 * last, 1.02 * last), ylim=(0, 124), yticks=range(0, 101, 20))
    handles: list[Artist] = [Line2D([], [], color=LINE, lw=1.8, label="cells seen so far")]
    if report.finds:
        _mark_finds(ax, report, last)
        handles.append(mark_handle("o", "victim found (v: its number)", face=FIND))
    ax.set_xlabel("time (steps)", fontsize=8)
    ax.set_ylabel("coverage (% of the cells that can be seen)", fontsize=8)
    ax.tick_params(labelsize=7)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.grid(axis="y", color="#E5E5E5", lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    n_victims = len(report.finds) + len(report.not_found)
    ax.set_title(f"Coverage (ended: {report.ended})\n{summary(report, n_victims)}", fontsize=10)
    legend_below(ax, handles)
    return ax


def _mark_finds(ax: Axes, report: ScoutingReport, last: int) -> None:
    found: dict[int, list[int]] = {}
    for find in sorted(report.finds, key=lambda find: (find.step, find.victim)):
        found.setdefault(find.step, []).append(find.victim)
    steps = list(found)
    heights = [100 * report.coverage[min(s, len(report.coverage) - 1)] for s in steps]
    font = 6.5 if len(steps) <= 40 else 5.0
    width, _ = size_of(ax)
    letters = spread(steps, 1.25 * font * last / width, 0.0, float(last))
    for step, height, x in zip(steps, heights, letters, strict=True):
        ax.plot([step, step, x], [height, 100, 105], color=FAINT, lw=0.5, zorder=2)
    ax.plot(steps, heights, "o", ms=4.5, mfc=FIND, mec=INK, mew=0.5, zorder=4)
    for victims, x in zip(found.values(), letters, strict=True):
        names = " ".join(f"v{victim}" for victim in victims)
        text = names if len(victims) <= NAMES_PER_STEP else f"{len(victims)} found"
        ax.text(x, 106, text, rotation=90, ha="center", va="bottom", fontsize=font)
