"""Who serves whom, by stage: the middle panel of the paper's Fig. 2."""

from __future__ import annotations

from collections import Counter

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ..mission.counting import counted
from ..mission.plan import Plan
from .canvas import Scale, is_large, map_axes, plot_map
from .clusters import draw_centres, draw_outlines, govern
from .legends import legend_below, mark_handle, robot_handles
from .lettering import as_written, shortened
from .marks import Group, disc_of, draw_groups, start_of, unserved_victims, visit_badges, weights_of
from .overview import draw_victims
from .style import DEFERRED, FAINT, MISSED, REASONS, STAGES, robot_styles, stage_shapes


@as_written
def plot_assignment(plan: Plan, ax: Axes | None = None, *, robot_key: bool = True) -> Axes:
    """Draw each victim with a badge per robot that serves it and stage, and the clusters.

    A badge's colour and number are the robot's, its shape is the stage's. Clusters are outlined in
    the colour of the robot that took them, grey if none did, as long as they say who serves whom. A
    red ring is around each victim of whom something stays unserved.

    Parameters
    ----------
    plan : Plan
        Of any planner.
    ax : Axes, optional
        Where to draw; a figure of its own by default.
    robot_key : bool
        Whether the legend lists the robots and what else is said of the mission in other panels.

    Returns
    -------
    Axes
        Column on x and row on y, in cells.
    """
    instance, large = plan.instance, is_large(plan.instance)
    if ax is None:
        ax = map_axes(instance, lines=10 + instance.n_robots // 3)
    plot_map(instance.map, ax)
    ax.set_title(f"Assignment\n{served_text(plan)}", fontsize=9.5)
    scale, styles, shapes = Scale.of(ax, instance.map), robot_styles(instance), stage_shapes(plan)
    if govern(plan):
        draw_outlines(ax, plan)
    if large:
        draw_victims(ax, plan, scale, shapes)
    else:
        badges, weights = visit_badges(plan, shapes, styles), weights_of(instance)
        unserved = unserved_victims(plan)
        deferred = {victim for cluster in plan.clusters for victim in cluster.deferred}
        groups = [start_of(r.start, r.id, styles[r.id]) for r in instance.robots]
        groups += [
            Group(
                v.cell,
                badges.get(v.id, ()),
                disc_of(v, face=DEFERRED if v.id in deferred else "white"),
                ring=v.id in unserved,
                weight=weights[v.id],
            )
            for v in instance.victims
        ]
        taken = draw_groups(ax, groups, instance.map.shape, scale)
        if govern(plan):
            draw_centres(ax, plan, scale, taken)
    handles = assignment_handles(plan)
    if robot_key:
        handles += robot_handles(styles)
    legend_below(ax, handles)
    return ax


def served_text(plan: Plan) -> str:
    """How much is served, and how much of what could not be is open."""
    figures = plan.metrics
    served = f"{figures.n_served} of {figures.n_available} available requirements served"
    unserved = len(plan.unserved)
    return f"{served}, {unserved} unserved" if unserved else served


def unserved_handles(plan: Plan) -> list[Artist]:
    """What the red ring is, with how many victims and requirements it stands for, by reason."""
    n_victims = len(unserved_victims(plan))
    counts = Counter(item.reason for item in plan.unserved)
    reasons = [
        mark_handle("", f"{reason}: {counted(counts[reason], 'requirement')}")
        for reason in REASONS
        if counts[reason]
    ]
    return [ring_handle(counted(n_victims, "victim")), *reasons] if n_victims else []


def ring_handle(count: str) -> Artist:
    """The red ring, with how many victims it stands for."""
    ring = mark_handle("o", f"not all served: {count}", face="white")
    ring.set(markeredgecolor=MISSED, markeredgewidth=2)
    return ring


def assignment_handles(plan: Plan) -> list[Artist]:
    """Legend entries of the stages and the clusters, and of what stays unserved."""
    handles: list[Artist] = [
        mark_handle(shape, STAGES.get(name, shortened(name)))
        for name, shape in stage_shapes(plan).items()
    ]
    if any(cluster.deferred for cluster in plan.clusters) and not is_large(plan.instance):
        handles.append(mark_handle("o", "deferred by the wall check", face=DEFERRED))
    if govern(plan):
        handles.append(Patch(fc="#E4E4E4", ec=FAINT, label="cluster → robot that took it"))
    return handles + unserved_handles(plan)
