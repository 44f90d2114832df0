"""How the work is shared out: for each robot its time of service and its time of travel."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ..mission.plan import Plan
from ..mission.plan_tables import robots as robot_rows
from .figure import own_axes
from .legends import legend_below
from .lettering import as_written
from .marks import number_of
from .style import FAINT, INK, SERIES, robot_styles

MAX_TOLD = 24
"""Robots beside whose bars the share of service is written."""


@as_written
def plot_workload(plan: Plan, ax: Axes | None = None) -> Axes:
    """Draw a bar for each robot, as long as it is busy: service, then travel.

    Parameters
    ----------
    plan : Plan
        Of any planner.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        Time units on x; a row per robot, in the mission's order, empty for one that stays.
    """
    rows = robot_rows(plan)
    styles = robot_styles(plan.instance)
    tall = 1.9 + max(0.24 * min(len(rows), 30), 0.09 * len(rows), 0.8)
    ax = own_axes(8.0, tall) if ax is None else ax
    service = np.array([row["service"] for row in rows])
    travel = np.array([row["travel"] for row in rows])
    colours = [styles[row["robot"]].colour for row in rows]
    places = range(len(rows))
    look: dict[str, Any] = {"height": 0.72, "edgecolor": INK, "linewidth": 0.4}
    ax.barh(places, service, color=colours, label="service", **look)
    ax.barh(places, travel, left=service, color=colours, alpha=0.35, label="travel", **look)
    busy = service + travel
    mean = float(busy.mean()) if len(rows) else 0.0
    ax.axvline(mean, color=SERIES[1], linewidth=1.2, linestyle=(0, (4, 2)), zorder=3)
    if len(rows) <= MAX_TOLD:
        for place, row in enumerate(rows):
            n = row["visits"]
            said = f" {n} visit{'' if n == 1 else 's'}" if n else " stays"
            ax.text(busy[place], place, said, va="center_baseline", fontsize=7, color=INK)
    step = max(1, len(rows) // 40)
    named = range(0, len(rows), step)
    ax.set_yticks(named, [f"R{number_of(rows[i]['robot'])}" for i in named], fontsize=7.5)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set_xlim(0, 1.14 * max(float(busy.max(initial=0.0)), 1e-9))
    ax.set_xlabel("time (time units)", fontsize=8)
    ax.tick_params(axis="x", labelsize=7.5)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_title(f"Workload: {_balance(busy)}", fontsize=10)
    legend_below(
        ax,
        [
            Patch(fc=FAINT, ec=INK, lw=0.4, label="service"),
            Patch(fc=FAINT, ec=INK, lw=0.4, alpha=0.35, label="travel"),
            Patch(fc="none", ec=SERIES[1], ls="--", label=f"mean {mean:.6g}"),
        ],
    )
    return ax


def _balance(busy: np.ndarray) -> str:
    """The makespan against the mean, in words."""
    mean = float(busy.mean()) if len(busy) else 0.0
    if not mean:
        return "nobody is busy"
    return f"the busiest robot {busy.max():.6g}, {busy.max() / mean:.3g} times the mean"
