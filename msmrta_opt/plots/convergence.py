"""How searches closed in: incumbents from above, dual bounds from below, over time."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ..mission.convergence import Convergence, SearchRecord
from .figure import own_axes
from .legends import legend_below
from .lettering import as_written, told_apart
from .style import FAINT, line_styles

EARLIEST = 1e-3
"""Seconds; on a logarithmic axis nothing is at 0."""


@as_written
def plot_convergence(searches: Convergence, ax: Axes | None = None) -> Axes:
    """Draw the incumbent (solid) and the dual bound (dashed) of each search as steps over time.

    Parameters
    ----------
    searches : Convergence
        As ``plan.convergence()`` gives it, of one plan or of several.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        Seconds on x, on a logarithmic scale; the objective on y, in its unit.
    """
    records = searches.searches
    ax = own_axes(8, 4.6 + 0.2 * len(records)) if ax is None else ax
    first = min((step.seconds for one in records.values() for step in one.steps), default=EARLIEST)
    first = max(first, EARLIEST)
    said = told_apart(records)
    for name, look in line_styles(records).items():
        record, colour = records[name], look["color"]
        times = [max(step.seconds, first) for step in record.steps]
        worth = [step.incumbent for step in record.steps]
        bounds = [float("nan") if step.bound is None else step.bound for step in record.steps]
        ax.fill_between(times, bounds, worth, step="post", color=colour, alpha=0.08, linewidth=0)
        ax.step(
            times, worth, where="post", color=colour, linewidth=2,
            label=f"{said[name]}: {says_end(record)}",
        )  # fmt: skip
        ax.step(times, bounds, where="post", color=colour, linewidth=1.6, linestyle=(0, (4, 1.5)))
        ax.plot(
            times[-1], worth[-1], marker=look["marker"], color=colour, markersize=7,
            markeredgecolor="white", clip_on=False, zorder=5,
        )  # fmt: skip
    ax.set_xscale("log")
    last = max((one.seconds for one in records.values()), default=first)
    ax.set_xlim(first, 1.05 * max(last, 2 * first))
    ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if last < 1000 * first else (1,)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_xlabel("time (seconds)")
    for record in list(records.values())[:1]:
        ax.set_ylabel(f"{record.objective.replace('_', ' ')} ({record.unit})")
    ax.set_title("Incumbent and dual bound over time", fontsize=10)
    ax.grid(alpha=0.3)
    ax.spines[["top", "right"]].set_visible(False)
    line: dict[str, Any] = {"color": FAINT, "linewidth": 1.6}
    kinds = [
        Line2D([], [], label="incumbent: the best routes so far", **line),
        Line2D([], [], label="dual bound: no routes are worth less", linestyle="--", **line),
    ]
    legend_below(ax, [*ax.get_legend_handles_labels()[0], *kinds])
    return ax


def says_end(record: SearchRecord) -> str:
    """What a search ended with, in a few words."""
    end = record.steps[-1]
    if end.gap is None:
        return f"{end.incumbent:.6g} after {record.seconds:.3g} s, no bound"
    if not end.gap:
        return f"{end.incumbent:.6g}, optimal after {record.seconds:.3g} s"
    return f"{end.incumbent:.6g}, gap {end.gap:.2%} after {record.seconds:.3g} s"
