"""When each robot travels and serves: a Gantt chart of a plan."""

from __future__ import annotations

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ..mission.plan import Plan, Route
from .figure import own_axes, size_of
from .legends import legend_below
from .lettering import as_written
from .style import FAINT, INK, RobotStyle, robot_styles

BAR = 0.72
"""Height of a service bar, in rows."""
FONT = 6.5


def gantt_height(plan: Plan) -> float:
    """Inches in which the rows of `plan` are legible, title and axis included."""
    return 1.0 + 0.27 * plan.instance.n_robots


@as_written
def plot_gantt(plan: Plan, ax: Axes | None = None, *, until: float | None = None) -> Axes:
    """Draw travel and service of each robot over time, and the makespan.

    Parameters
    ----------
    plan : Plan
        Of any planner.
    ax : Axes, optional
        Where to draw; a figure of its own by default.
    until : float, optional
        Where the time axis ends, in time units, so that several timelines have one scale; by
        default, or if that is later, at this plan's makespan.

    Returns
    -------
    Axes
        Time on x, in time units; one row per robot, the first on top, empty for one that stays.
    """
    ax = own_axes(11.0, gantt_height(plan) + 0.4) if ax is None else ax
    styles = robot_styles(plan.instance)
    makespan = plan.metrics.makespan
    horizon = 1.02 * max(makespan, until or 0.0) or 1.0
    points_per_time_unit = size_of(ax)[0] / horizon
    for row, robot in enumerate(plan.instance.robots):
        routes = [route for route in plan.routes if route.robot == robot.id]
        for route in routes:
            _row(ax, row, route, robot.speed, styles[robot.id], points_per_time_unit)
    ax.axvline(makespan, color=INK, lw=1.2, ls=(0, (4, 2)), zorder=4)
    _name_makespan(ax, makespan)
    ax.set(xlim=(0, horizon), ylim=(plan.instance.n_robots - 0.5, -0.5))
    ax.set_xlabel("time (time units)", fontsize=8)
    ax.set_ylabel("robot", fontsize=8)
    ax.set_yticks(range(plan.instance.n_robots), [f"R{r.id}" for r in plan.instance.robots])
    ax.tick_params(labelsize=7)
    for tick, style in zip(ax.get_yticklabels(), styles.values(), strict=True):
        tick.set(
            color=style.ink,
            fontweight="bold",
            bbox={"boxstyle": "round,pad=0.22", "fc": style.colour, "ec": INK, "lw": 0.6},
        )
    ax.tick_params(axis="y", length=0, pad=6)
    ax.grid(axis="x", color="#E5E5E5", lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_title("Timeline", fontsize=10)
    handles: list[Artist] = [
        Patch(fc=FAINT, ec=INK, lw=0.5, label="service (v: the victim's number)"),
        Patch(fc=FAINT, alpha=0.35, label="travel"),
    ]
    legend_below(ax, handles)
    return ax


def _name_makespan(ax: Axes, makespan: float) -> None:
    """Write the makespan above its line: as a tick's label, which any title keeps clear of."""
    upper = ax.secondary_xaxis("top")
    upper.set_xticks([makespan], [f"makespan {makespan:g}"], fontsize=8)
    upper.tick_params(length=0, pad=2)
    upper.spines["top"].set_visible(False)
    for label in upper.get_xticklabels():
        label.set_horizontalalignment("right" if makespan else "left")


def _row(
    ax: Axes, row: int, route: Route, speed: float, style: RobotStyle, points_per_time_unit: float
) -> None:
    clock = 0.0
    for visit in route.visits:
        _travel(ax, row, clock, visit.arrival, style)
        busy = visit.departure - visit.arrival
        ax.barh(
            row, busy, left=visit.arrival, height=BAR,
            color=style.colour, edgecolor=INK, linewidth=0.5, hatch=style.hatch, zorder=3,
        )  # fmt: skip
        text = f"v{visit.victim}"
        narrow = busy * points_per_time_unit < 0.62 * FONT * len(text)
        label = ax.text(
            visit.arrival + busy / 2,
            row,
            text,
            rotation=90 if narrow else 0,
            ha="center",
            va="center",
            fontsize=FONT if not narrow else FONT - 1,
            color=style.ink,
            zorder=5,
        )
        label.set_in_layout(False)
        clock = visit.departure
    if route.back:
        _travel(ax, row, clock, clock + (len(route.back) - 1) / speed, style)


def _travel(ax: Axes, row: int, start: float, end: float, style: RobotStyle) -> None:
    ax.barh(
        row, end - start, left=start, height=0.4 * BAR, color=style.colour, alpha=0.35, zorder=2
    )
