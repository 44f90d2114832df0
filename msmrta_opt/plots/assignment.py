"""Who serves whom, by stage: the middle panel of the paper's Fig. 2."""

from __future__ import annotations

from collections import Counter

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ..mission.plan import Plan
from .canvas import Scale, map_axes, plot_map
from .clusters import draw_centres, draw_outlines
from .legends import legend_below, mark_handle, robot_handles
from .lettering import as_written, shortened
from .marks import Stamp, captions_of, draw_stamps, start_stamp, visit_stamp
from .style import FAINT, INK, REASONS, STAGES, robot_styles, stage_shapes


@as_written
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
    if ax is None:
        lines = 8 + instance.n_robots * robot_key
        ax = map_axes(instance.map, crowded=instance.n_victims > 50, lines=lines)
    plot_map(instance.map, ax)
    ax.set_title(f"Assignment\n{_summary(plan)}", fontsize=10)
    scale, styles = Scale.of(ax, instance.map), robot_styles(instance)
    cell_of = {victim.id: victim.cell for victim in instance.victims}

    marks = _visits(plan) + _unserved(plan)
    marked = {mark.cell for mark in marks}
    idle = [Stamp(cell, "white", marker="o") for cell in cell_of.values() if cell not in marked]
    starts = [start_stamp(r.start, r.id, styles[r.id]) for r in instance.robots]
    draw_outlines(ax, plan)
    taken = draw_stamps(ax, [*starts, *marks, *idle], captions_of(cell_of), scale)
    draw_centres(ax, plan, scale, taken)
    deferred = [cell_of[victim] for cluster in plan.clusters for victim in cluster.deferred]
    for row, col in deferred:
        size = max(1.1 * scale.cell, 2.2 * scale.mark)
        ax.plot(col, row, "o", ms=size, mfc="none", mec=INK, mew=0.9, zorder=5)

    handles = _handles(plan, idle=bool(idle), deferred=bool(deferred))
    if robot_key:
        handles += robot_handles(styles)
    marked_by = "shape of a mark: stage; its colour and number: robot" if stage_shapes(plan) else ""
    legend_below(ax, handles, title=marked_by)
    return ax


def _summary(plan: Plan) -> str:
    figures = plan.metrics
    unavailable = figures.n_requirements - figures.n_available
    served = f"{figures.n_served} of {figures.n_available} available requirements served"
    return f"{served}, {unavailable} unavailable" if unavailable else served


def _visits(plan: Plan) -> list[Stamp]:
    """One mark per visit."""
    styles, shapes = robot_styles(plan.instance), stage_shapes(plan)
    cell_of = {victim.id: victim.cell for victim in plan.instance.victims}
    return [
        visit_stamp(cell_of[visit.victim], route.robot, styles[route.robot], shapes[visit.stage])
        for route in plan.routes
        for visit in route.visits
    ]


def _unserved(plan: Plan) -> list[Stamp]:
    """One mark per victim and reason for which a requirement of it stays unserved."""
    cell_of = {victim.id: victim.cell for victim in plan.instance.victims}
    pairs = dict.fromkeys((item.victim, item.reason) for item in plan.unserved)
    return [Stamp(cell_of[v], INK, marker=REASONS[reason]) for v, reason in pairs]


def _handles(plan: Plan, *, idle: bool, deferred: bool) -> list[Artist]:
    handles: list[Artist] = [
        mark_handle(shape, STAGES.get(name, shortened(name)))
        for name, shape in stage_shapes(plan).items()
    ]
    counts = Counter(item.reason for item in plan.unserved)
    handles += [
        mark_handle(marker, f"unserved: {reason} ({counts[reason]})", face=INK)
        for reason, marker in REASONS.items()
        if counts[reason]
    ]
    if deferred:
        handles.append(mark_handle("o", "ring: deferred by the wall check", face="none"))
    if idle:
        handles.append(mark_handle("o", "victim without a visit", face="white"))
    if plan.clusters:
        handles.append(Patch(fc="#E4E4E4", ec=FAINT, label="cluster → robot that took it"))
    return handles
