"""When each robot travels and serves: a Gantt chart of a plan."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch

from ..mission.instance import Robot
from ..mission.plan import Plan, Route, Visit
from ..mission.run import Run
from .canvas import SMALL_ROBOTS
from .figure import own_axes, size_of
from .legends import legend_below
from .lettering import as_written, fitted, width_of
from .marks import number_of
from .moments import LANE, SIZE, draw_moments, lost_at, moment_handles
from .style import FADED, FAINT, INK, RobotStyle, readable_on, robot_styles
from .walked import walked

CUT = (0, (2.2, 1.4))
"""Dashes around a service that was cut short."""
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
    plan: Plan | Run,
    ax: Axes | None = None,
    *,
    until: float | None = None,
    faded: Collection[tuple[int, str]] = (),
) -> Axes:
    """Draw travel and service of each robot over time, and the makespan.

    Of a run it is what was done: services that were cut short are pale, marks say what came in
    between.

    Parameters
    ----------
    plan : Plan or Run
        Of any planner, or policy.
    ax : Axes, optional
        Where to draw; a figure of its own by default.
    until : float, optional
        Where the time axis ends, in time units, so that several timelines have one scale; by
        default, or if that is later, at this plan's makespan.
    faded : collection of (int, str)
        Requirements, by victim's id and kind, whose service is drawn in grey.

    Returns
    -------
    Axes
        Time on x, in time units; one row per robot, empty for one that stays. The first robot is on
        top, or of more than eight the one that is done last.
    """
    run = plan if isinstance(plan, Run) else None
    drawn = walked(plan) if isinstance(plan, Run) else plan
    makespan = plan.metrics.makespan
    robots = rows_of(drawn, run)
    ax = own_axes(9.0, gantt_height(len(robots)) + 1.4) if ax is None else ax
    horizon = 1.02 * max(makespan, until or 0.0) or 1.0
    _draw_rows(ax, drawn, robots, horizon, faded, run)
    ax.axvline(makespan, color=INK, lw=1.2, ls=(0, (4, 2)), zorder=4)
    _name_makespan(ax, makespan)
    ax.set_title("Timeline", fontsize=9.5)
    handles: list[Artist] = [
        Patch(fc=FAINT, ec=INK, lw=0.5, label="service (v: the victim's number)"),
        Patch(fc=FAINT, alpha=0.35, label="travel"),
        *(() if run is None else (*cut_handle(run), *moment_handles(run))),
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


def cut_handle(run: Run) -> list[Artist]:
    """A legend entry of services that were cut short, if any were."""
    cut = not all(service.done for service in run.services)
    return [Patch(fc="white", ec=INK, lw=0.8, ls=CUT, label="service cut short")] if cut else []


def rows_of(plan: Plan, run: Run | None = None) -> list[Robot]:
    """The robots in the order of rows: as in the mission, or of many the latest first."""
    robots = list(plan.instance.robots)
    if len(robots) <= SMALL_ROBOTS:
        return robots
    done = _ends(plan, run)
    return sorted(robots, key=lambda robot: -done.get(robot.id, 0.0))


def _ends(plan: Plan, run: Run | None) -> Mapping[int, float]:
    """By robot's id when it is done, in time units."""
    if run is not None:
        return run.metrics.done_of
    speed = {robot.id: robot.speed for robot in plan.instance.robots}
    return {route.robot: _end(route, speed[route.robot]) for route in plan.routes}


def _end(route: Route, speed: float) -> float:
    served = route.visits[-1].departure if route.visits else 0.0
    return served + max(len(route.back) - 1, 0) / speed


class Bar(NamedTuple):
    """A stretch of time in a row, in a colour; of a service perhaps one that was cut short."""

    start: float
    end: float
    row: int
    colour: str
    cut: bool = False


class Name(NamedTuple):
    """What is said of a visit: within the bar from `start` to `end`, or else beside `whole`."""

    text: str
    start: float
    end: float
    whole: tuple[float, float]
    colour: str


def _draw_rows(
    ax: Axes,
    plan: Plan,
    robots: Sequence[Robot],
    horizon: float,
    faded: Collection[tuple[int, str]],
    run: Run | None,
) -> None:
    """Draw a row for each of `robots`, up to `horizon` time units."""
    styles, ends = robot_styles(plan.instance), _ends(plan, run)
    row_of = {robot.id: row for row, robot in enumerate(robots)}
    cut = {(s.robot, s.ended): s.began for s in run.services if not s.done} if run else {}
    lost = lost_at(run) if run else {}
    service: dict[tuple[str, bool], list[Bar]] = {}
    travel: list[Bar] = []
    names: dict[int, list[Name]] = {}
    for route in plan.routes:
        style, row, clock = styles[route.robot], row_of[route.robot], 0.0
        for visit in route.visits:
            began = cut.get((route.robot, visit.departure), visit.departure)
            parts = [
                Bar(start, end, row, FADED if grey else style.colour)
                for start, end, grey in _parts(plan, visit, began, faded)
            ]
            if began < visit.departure:
                parts.append(Bar(began, visit.departure, row, style.colour, cut=True))
            for part in parts:
                service.setdefault((style.hatch, part.cut), []).append(part)
            grey = all(part.colour == FADED for part in parts)
            travel.append(Bar(clock, visit.arrival, row, FADED if grey else style.colour))
            longest = max(parts, key=lambda part: part.end - part.start)
            names.setdefault(row, []).append(
                Name(
                    f"v{number_of(visit.victim)}",
                    longest.start,
                    longest.end,
                    (visit.arrival, visit.departure),
                    "white" if longest.cut else longest.colour,
                )
            )
            clock = visit.departure
        if route.back:
            travel.append(Bar(clock, ends[route.robot], row, style.colour))
    wide, tall = size_of(ax)
    lane = LANE if run is not None else 0.0
    pitch = (tall - lane) / max(len(robots), 1)
    edge = 0.5 if pitch > 6 else 0.25
    _bars(ax, travel, 0.4 * BAR, alpha=0.35, linewidths=0, zorder=2)
    for (hatch, is_cut), bars in service.items():
        look: dict[str, Any] = {"edgecolors": INK, "linewidths": edge}
        look["hatch"] = hatch if pitch > 16 else ""
        if is_cut:
            look = {"edgecolors": [bar.colour for bar in bars], "linewidths": 2 * edge}
            look["linestyles"] = [CUT]
            bars = [bar._replace(colour="white") for bar in bars]
        _bars(ax, bars, BAR, zorder=3, **look)
    if pitch > 1.2 * FONT:
        scale = wide / horizon
        marked = {row_of[robot]: time for robot, time in lost.items()}
        for row, found in names.items():
            _name_bars(ax, row, found, scale, pitch, wide, marked.get(row))
    ax.set(xlim=(0, horizon), ylim=(len(robots) - 0.5, -0.5 - lane / pitch))
    if run is not None:
        draw_moments(ax, run, row_of, wide / horizon, -0.5 - 0.5 * lane / pitch)
    ax.set_xlabel("time (time units)", fontsize=8)
    ax.tick_params(labelsize=7.5)
    _name_rows(ax, robots, styles, pitch)
    ax.tick_params(axis="y", length=0, pad=6)
    ax.grid(axis="x", color="#E5E5E5", lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)


def _parts(
    plan: Plan, visit: Visit, until: float, faded: Collection[tuple[int, str]]
) -> Iterator[tuple[float, float, bool]]:
    """From when to when a visit serves what is grey, and what is not; kinds in their order."""
    grey = [(visit.victim, kind) in faded for kind in visit.served]
    if len(set(grey)) < 2:
        if until > visit.arrival or until == visit.departure:
            yield visit.arrival, until, bool(faded) and all(grey)
        return
    victim = next(v for v in plan.instance.victims if v.id == visit.victim)
    times = plan.instance.service_time | victim.service_time
    share = [0.0, *accumulate(times[kind] for kind in visit.served)]
    long = (until - visit.arrival) / (share[-1] or 1.0)
    for first, last, is_grey in zip(share, share[1:], grey, strict=False):
        yield visit.arrival + long * first, visit.arrival + long * last, is_grey


def _bars(ax: Axes, bars: Sequence[Bar], height: float, **look: Any) -> None:
    if not bars:
        return
    start, end, row = np.array([bar[:3] for bar in bars], dtype=float).T
    low, high = row - height / 2, row + height / 2
    corners = np.stack([start, low, end, low, end, high, start, high], axis=1).reshape(-1, 4, 2)
    ax.add_collection(
        PolyCollection(list(corners), facecolors=[bar.colour for bar in bars], **look),
        autolim=False,
    )


def _name_bars(
    ax: Axes,
    row: int,
    names: Sequence[Name],
    points_per_time_unit: float,
    pitch: float,
    wide: float,
    lost: float | None,
) -> None:
    """Write each victim's number on its bar, upright or turned, or else beside it, where it fits."""
    taken = [(a * points_per_time_unit, b * points_per_time_unit) for *_, (a, b), _ in names]
    if lost is not None:
        mark = lost * points_per_time_unit
        taken.append((mark - 0.5 * SIZE, mark + 0.5 * SIZE))
    for name, (low, high) in zip(names, list(taken), strict=False):
        start, end = name.start * points_per_time_unit, name.end * points_per_time_unit
        width, room = width_of(name.text, FONT), end - start - 1
        if lost is not None and start < mark + 0.5 * SIZE and mark - 0.5 * SIZE < end:
            room, end = room - 0.5 * SIZE, end - 0.5 * SIZE
        flat = width <= room
        ink, at = readable_on(name.colour), (start + end) / 2
        if not flat and not (room >= FONT and width <= BAR * pitch - 1):
            flat, ink = True, INK
            beside = [(high + 1.5, high + 2.5 + width), (low - 2.5 - width, low - 1.5)]
            free = [
                (a, b)
                for a, b in beside
                if a >= 0 and b <= wide and not any(a < d and c < b for c, d in taken)
            ]
            if not free:
                continue
            taken.append(free[0])
            at = sum(free[0]) / 2
        ax.text(
            at / points_per_time_unit, row, name.text, rotation=0 if flat else 90, ha="center",
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
