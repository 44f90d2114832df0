"""When each robot travels and serves: a Gantt chart of a plan."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch

from ..mission.instance import Robot
from ..mission.plan import Plan, Route
from .canvas import SMALL_ROBOTS
from .figure import own_axes, size_of
from .legends import legend_below
from .lettering import as_written, fitted, width_of
from .marks import number_of
from .style import FADED, FAINT, INK, RobotStyle, readable_on, robot_styles

BAR = 0.72
"""Height of a service bar, in rows."""
FONT = 7.5
TITLE_FONT, LABEL_FONT = 9.5, 8.0
MIN_PITCH = 9.0
"""Points from the name of one row to that of the next."""


def gantt_height(n_robots: int) -> float:
    """Inches that so many rows take: a line of letters each for some, less for many."""
    return 0.27 * n_robots if n_robots <= SMALL_ROBOTS else min(1.0 + 0.14 * n_robots, 5.0)


@as_written
def plot_gantt(
    plan: Plan,
    ax: Axes | None = None,
    *,
    until: float | None = None,
    faded: Collection[int] = (),
    ends: Mapping[int, float] | None = None,
) -> Axes:
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
    faded : collection of int
        Ids of victims whose visits are drawn in grey.
    ends : mapping of int to float, optional
        By robot id when it is done, in time units, where that is not what its route says.

    Returns
    -------
    Axes
        Time on x, in time units; one row per robot, empty for one that stays. The first robot is on
        top, or of more than eight the one that is done last.
    """
    robots = rows_of(plan, ends)
    ax = own_axes(9.0, gantt_height(len(robots)) + 1.4) if ax is None else ax
    makespan = max(ends.values(), default=0.0) if ends else plan.metrics.makespan
    horizon = 1.02 * max(makespan, until or 0.0) or 1.0
    draw_rows(ax, plan, robots, horizon, faded, ends)
    ax.axvline(makespan, color=INK, lw=1.2, ls=(0, (4, 2)), zorder=4)
    _name_makespan(ax, makespan)
    ax.set_title("Timeline", fontsize=9.5)
    handles: list[Artist] = [
        Patch(fc=FAINT, ec=INK, lw=0.5, label="service (v: the victim's number)"),
        Patch(fc=FAINT, alpha=0.35, label="travel"),
    ]
    legend_below(ax, handles)
    return ax


def title_gantt(ax: Axes, title: str) -> None:
    """Write the title of a timeline at its upper left: above the label of the makespan if they meet."""
    width, _ = size_of(ax)
    said = fitted(title, TITLE_FONT, width)
    right = min(
        place / ax.get_xlim()[1] * width - width_of(label.get_text(), LABEL_FONT)
        for upper in ax.child_axes
        for place, label in zip(upper.get_xticks(), upper.get_xticklabels(), strict=True)
    )
    pad = 4.0 if width_of(said, TITLE_FONT) + 10 <= right else 6.0 + 1.25 * LABEL_FONT
    ax.set_title("")
    ax.set_title(said, fontsize=TITLE_FONT, loc="left", y=1.0, pad=pad)


def rows_of(plan: Plan, ends: Mapping[int, float] | None = None) -> list[Robot]:
    """The robots in the order of rows: as in the mission, or of many the latest first."""
    robots = list(plan.instance.robots)
    if len(robots) <= SMALL_ROBOTS:
        return robots
    speed = {robot.id: robot.speed for robot in robots}
    done = ends or {route.robot: _end(route, speed[route.robot]) for route in plan.routes}
    return sorted(robots, key=lambda robot: -done.get(robot.id, 0.0))


def _end(route: Route, speed: float) -> float:
    served = route.visits[-1].departure if route.visits else 0.0
    return served + max(len(route.back) - 1, 0) / speed


def draw_rows(
    ax: Axes,
    plan: Plan,
    robots: Sequence[Robot],
    horizon: float,
    faded: Collection[int] = (),
    ends: Mapping[int, float] | None = None,
) -> None:
    """Draw a row for each of `robots`, up to `horizon` time units."""
    styles = robot_styles(plan.instance)
    row_of = {robot.id: row for row, robot in enumerate(robots)}
    speed = {robot.id: robot.speed for robot in robots}
    service: dict[str, list[tuple[float, float, int, str]]] = {}
    travel: list[tuple[float, float, int, str]] = []
    names = []
    for route in plan.routes:
        style, row, clock = styles[route.robot], row_of[route.robot], 0.0
        for visit in route.visits:
            colour = FADED if visit.victim in faded else style.colour
            travel.append((clock, visit.arrival, row, colour))
            bar = (visit.arrival, visit.departure, row, colour)
            service.setdefault(style.hatch, []).append(bar)
            names.append(
                (
                    visit.arrival,
                    visit.departure,
                    row,
                    f"v{number_of(visit.victim)}",
                    readable_on(colour),
                )
            )
            clock = visit.departure
        if route.back:
            end = ends[route.robot] if ends else _end(route, speed[route.robot])
            travel.append((clock, end, row, style.colour))
    size = size_of(ax)
    pitch = size[1] / max(len(robots), 1)
    edge = 0.5 if pitch > 6 else 0.25
    _bars(ax, travel, 0.4 * BAR, alpha=0.35, linewidths=0, zorder=2)
    for hatch, bars in service.items():
        _bars(
            ax,
            bars,
            BAR,
            edgecolors=INK,
            linewidths=edge,
            zorder=3,
            hatch=hatch if pitch > 16 else "",
        )
    if pitch > 1.2 * FONT:
        _name_bars(ax, names, size[0] / horizon, pitch)
    ax.set(xlim=(0, horizon), ylim=(len(robots) - 0.5, -0.5))
    ax.set_xlabel("time (time units)", fontsize=8)
    ax.tick_params(labelsize=7.5)
    _name_rows(ax, robots, styles, pitch)
    ax.tick_params(axis="y", length=0, pad=6)
    ax.grid(axis="x", color="#E5E5E5", lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)


def _bars(
    ax: Axes, bars: Sequence[tuple[float, float, int, str]], height: float, **look: Any
) -> None:
    if not bars:
        return
    start, end, row = np.array([bar[:3] for bar in bars], dtype=float).T
    low, high = row - height / 2, row + height / 2
    corners = np.stack([start, low, end, low, end, high, start, high], axis=1).reshape(-1, 4, 2)
    ax.add_collection(
        PolyCollection(list(corners), facecolors=[bar[3] for bar in bars], **look), autolim=False
    )


def _name_bars(
    ax: Axes,
    names: Sequence[tuple[float, float, int, str, str]],
    points_per_time_unit: float,
    pitch: float,
) -> None:
    """Write each victim's number on its bar, upright or turned, where one or the other fits."""
    for start, end, row, text, ink in names:
        room = (end - start) * points_per_time_unit - 1
        if room < 0.8 * FONT:
            continue
        width = width_of(text, FONT)
        flat = width <= room
        if flat or (room >= FONT and width <= BAR * pitch - 1):
            ax.text(
                (start + end) / 2, row, text, rotation=0 if flat else 90, ha="center",
                va="center_baseline" if flat else "center", fontsize=FONT, color=ink, zorder=5,
            ).set_in_layout(False)  # fmt: skip


def _name_rows(
    ax: Axes, robots: Sequence[Robot], styles: dict[int, RobotStyle], pitch: float
) -> None:
    """Name the rows, or as many of them as there is room for."""
    step = max(1, int(np.ceil(MIN_PITCH / pitch))) if robots else 1
    named = robots[::step]
    ax.set_yticks(range(0, len(robots), step), [f"R{number_of(robot.id)}" for robot in named])
    badge = pitch >= 1.9 * FONT
    for tick, robot in zip(ax.get_yticklabels(), named, strict=True):
        colour = styles[robot.id].colour
        if badge:
            tick.set(
                color=readable_on(colour),
                fontweight="bold",
                bbox={"boxstyle": "round,pad=0.2", "fc": colour, "ec": "white", "lw": 0.6},
            )
    ax.set_ylabel("robot" if step == 1 else f"robot (one in {step} named)", fontsize=8)


def _name_makespan(ax: Axes, makespan: float) -> None:
    """Write the makespan above its line: as a tick's label, which any title keeps clear of."""
    upper = ax.secondary_xaxis("top")
    upper.set_xticks([makespan], [f"makespan {makespan:g}"], fontsize=LABEL_FONT)
    upper.tick_params(length=0, pad=2)
    upper.spines["top"].set_visible(False)
    for label in upper.get_xticklabels():
        label.set_horizontalalignment("right" if makespan else "left")
