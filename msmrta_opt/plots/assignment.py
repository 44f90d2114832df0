"""Who serves whom, by stage: the middle panel of the paper's Fig. 2."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Polygon
from numpy.typing import NDArray

from ..mission.grid import Cell
from ..mission.plan import Cluster, Plan
from .canvas import (
    Scale,
    Stamp,
    captions_of,
    draw_stamps,
    free_spot,
    legend_below,
    map_axes,
    mark_handle,
    plot_map,
    robot_handles,
    robot_stamp,
)
from .style import (
    INK,
    NOBODY,
    REASONS,
    STAGES,
    RobotStyle,
    robot_style,
    robot_styles,
    stage_shapes,
)


def plot_assignment(plan: Plan, ax: Axes | None = None, *, robot_key: bool = True) -> Axes:
    """Draw the clusters and, at each victim, one mark per robot that serves it and stage.

    A mark's colour and number are the robot's, its shape is the stage's; what stays unserved is
    marked by its reason. Clusters have the colour of the robot that took them, grey if none did.

    Parameters
    ----------
    plan : Plan
        Of any planner.
    ax : Axes, optional
        Where to draw; a figure of its own by default.
    robot_key : bool
        Whether the legend lists the robots.

    Returns
    -------
    Axes
        Column on x and row on y, in cells.
    """
    instance = plan.instance
    ax = map_axes(instance.map, crowded=instance.n_victims > 50) if ax is None else ax
    plot_map(instance.map, ax)
    scale = Scale.of(ax, instance.map)
    styles, shapes = robot_styles(instance), stage_shapes(plan)
    cell_of = {victim.id: victim.cell for victim in instance.victims}

    starts = [robot_stamp(r.start, r.id, styles[r.id]) for r in instance.robots]
    marks = _marks(plan, styles, shapes)
    idle = [v.cell for v in instance.victims if v.cell not in {mark.cell for mark in marks}]
    marks += [Stamp(cell, "white", marker="o") for cell in idle]
    draw_stamps(ax, starts + marks, captions_of(cell_of), scale)

    draw_clusters(ax, plan, scale)
    deferred = [cell_of[victim] for cluster in plan.clusters for victim in cluster.deferred]
    for row, col in deferred:
        ax.plot(
            col, row, "o",
            ms=max(1.05 * scale.cell, 2.2 * scale.mark), mfc="none", mec=INK, mew=1.0, ls="",
            zorder=5,
        )[0].set_in_layout(False)  # fmt: skip

    handles = [mark_handle(shape, STAGES.get(name, name)) for name, shape in shapes.items()]
    reasons = Counter(item.reason for item in plan.unserved)
    handles += [
        mark_handle(REASONS[reason], f"unserved: {reason} ({reasons[reason]})", face=INK)
        for reason in REASONS
        if reasons[reason]
    ]
    if deferred:
        handles.append(mark_handle("o", "deferred by the wall check", face="none"))
    if idle:
        handles.append(mark_handle("o", "victim without a visit", face="white"))
    legend: list[Artist] = [*handles]
    if plan.clusters:
        legend.append(Patch(fc="#DDDDDD", ec=FAINT_EDGE, label="cluster → its robot (grey: none)"))
    if robot_key:
        legend += robot_handles(styles)
    ax.set_title(f"Assignment\n{_summary(plan)}", fontsize=10)
    legend_below(ax, legend)
    return ax


FAINT_EDGE = "#8A8A8A"


def _summary(plan: Plan) -> str:
    figures = plan.metrics
    served = f"{figures.n_served} of {figures.n_available} available requirements served"
    return f"{served}, {figures.n_requirements - figures.n_available} unavailable"


def _marks(
    plan: Plan, styles: Mapping[int, RobotStyle], shapes: Mapping[str, str]
) -> list[Stamp]:
    """One mark per visit and one per victim and reason of what stays unserved."""
    cell_of = {victim.id: victim.cell for victim in plan.instance.victims}
    visits = [
        robot_stamp(cell_of[visit.victim], route.robot, styles[route.robot], marker=shapes[visit.stage])
        for route in plan.routes
        for visit in route.visits
    ]
    open_ = dict.fromkeys((item.victim, item.reason) for item in plan.unserved)
    return visits + [Stamp(cell_of[v], INK, marker=REASONS[reason]) for v, reason in open_]
