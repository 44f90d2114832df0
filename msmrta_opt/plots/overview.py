"""Missions too large for a mark and a name each: victims as one scatter, walks as lines or traffic."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from numpy.typing import NDArray

from ..mission.instance import Victim
from ..mission.plan import Plan
from .canvas import Scale, frame_map
from .marks import draw_groups, fades, start_of, unserved_victims
from .style import FADED, INK, MISSED, TURNED_UP, robot_styles
from .walks import corners, lanes

LINES_OF = 24
"""Up to so many robots each have a line of their own; the walks of more are drawn as traffic."""
TRAFFIC = LinearSegmentedColormap.from_list("traffic", ["#FBEFD5", "#C9A66B", "#54401C"])
"""Warm, so that no cell looks like a wall."""


def draws_lines(plan: Plan) -> bool:
    """Whether each robot's walk is drawn."""
    return plan.instance.n_robots <= LINES_OF


def draw_walks(ax: Axes, plan: Plan, scale: Scale, faded: Collection[tuple[int, str]] = ()) -> None:
    """Draw each robot's walk as a line in its colour, or of many robots how often cells are passed."""
    moving = [route for route in plan.routes if route.cells]
    if not moving:
        return
    if not draws_lines(plan):
        passes = traffic(plan)
        ax.imshow(
            np.ma.masked_equal(passes, 0), cmap=TRAFFIC, interpolation="none", zorder=1,
            norm=LogNorm(1, max(2.0, float(passes.max()))),
        )  # fmt: skip
        frame_map(ax, plan.instance.map)
        return
    styles = robot_styles(plan.instance)
    shifts = lanes(len(moving), scale)
    lines, looks = [], []
    for route, shift in zip(moving, shifts, strict=True):
        style = styles[route.robot]
        legs = [(visit.cells, fades(visit, faded)) for visit in route.visits]
        for leg, grey in [*legs, (route.back, True)] if faded else [(route.cells, False)]:
            if len(leg) > 1:
                lines.append(corners(leg, shift))
                looks.append(replace(style, colour=FADED) if grey else style)
    ax.add_collection(
        LineCollection(lines, colors="white", linewidths=scale.line + 1.0, zorder=3),
        autolim=False,
    )
    ax.add_collection(
        LineCollection(
            lines, colors=[look.colour for look in looks], zorder=3.1,
            linestyles=[look.line for look in looks], linewidths=0.8 * scale.line,
        ),
        autolim=False,
    )  # fmt: skip


def traffic(plan: Plan) -> NDArray[np.int64]:
    """How often robots enter each cell, all walks together, shape ``(n_rows, n_cols)``."""
    passes = np.zeros(plan.instance.map.shape, dtype=np.int64)
    for route in plan.routes:
        legs = [
            leg for leg in (*(visit.cells for visit in route.visits), route.back) if len(leg) > 1
        ]
        for leg in legs:
            rows, cols = np.array(leg[1:]).T
            np.add.at(passes, (rows, cols), 1)
    return passes


def draw_victims(
    ax: Axes,
    plan: Plan,
    scale: Scale,
    shapes: Mapping[str, str] | None = None,
    faded: Collection[tuple[int, str]] = (),
    tinted: Collection[int] = (),
) -> None:
    """Draw all victims in the colour of the robot that serves them last, and the robots' starts.

    Of those of whom something is not `faded` it is the last robot of that; all else is grey.
    With shapes, a victim has that of the stage of this visit. Size grows with priority, and a red
    ring is around each of whom something stays unserved. Around those `tinted` is the colour of those
    who turned up on the way.
    """
    instance, styles = plan.instance, robot_styles(plan.instance)
    last: dict[int, tuple[bool, float, int, str]] = {}
    for route in plan.routes:
        for visit in route.visits:
            own = (not fades(visit, faded), visit.departure, route.robot, visit.stage)
            if visit.victim not in last or own[:2] >= last[visit.victim][:2]:
                last[visit.victim] = own
    top = max((victim.priority for victim in instance.victims), default=1.0) or 1.0
    side = float(np.clip(1.3 * scale.cell, 4.5, 7.0))
    kinds = shapes or {"": "o"}
    for stage, shape in kinds.items():
        found = [
            v for v in instance.victims if v.id in last and (not shapes or last[v.id][3] == stage)
        ]
        if found:
            ax.scatter(
                [v.cell[1] for v in found], [v.cell[0] for v in found], marker=shape,
                s=[side**2 * (0.5 + 0.5 * v.priority / top) for v in found],
                c=[styles[last[v.id][2]].colour if last[v.id][0] else FADED for v in found],
                edgecolors=INK, linewidths=0.5, zorder=5,
            )  # fmt: skip
    unserved, idle = unserved_victims(plan), [v for v in instance.victims if v.id not in last]
    if idle:
        ax.scatter(
            *_places(idle), s=0.7 * side**2, c="white", edgecolors=INK, linewidths=0.5, zorder=5
        )
    found = [v for v in instance.victims if v.id in tinted]
    if found:
        ax.scatter(*_places(found), s=(side + 11) ** 2, c=TURNED_UP, edgecolors="white",
                   linewidths=0.8, zorder=4.5)  # fmt: skip
    rings = [v for v in instance.victims if v.id in unserved]
    if rings:
        ax.scatter(
            *_places(rings), s=(side + 6) ** 2, facecolors="none", edgecolors=MISSED,
            linewidths=2.2, zorder=6,
        )  # fmt: skip
    if draws_lines(plan):
        starts = [start_of(robot.start, robot.id, styles[robot.id]) for robot in instance.robots]
        draw_groups(ax, starts, instance.map.shape, scale)
        return
    ax.scatter(
        [robot.start[1] for robot in instance.robots],
        [robot.start[0] for robot in instance.robots],
        marker="s",
        s=(side + 2.5) ** 2,
        c=[styles[robot.id].colour for robot in instance.robots],
        edgecolors="white",
        linewidths=1.2,
        zorder=5.5,
    )


def _places(victims: list[Victim]) -> tuple[list[int], list[int]]:
    return [v.cell[1] for v in victims], [v.cell[0] for v in victims]
