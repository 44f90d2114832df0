"""Who walks where, in which order: the right panel of the paper's Fig. 2."""

from __future__ import annotations

from matplotlib.artist import Artist
from matplotlib.axes import Axes

from ..mission.plan import Plan
from .canvas import Scale, map_axes, plot_map
from .clusters import draw_centres
from .legends import legend_below, mark_handle, robot_handles
from .lettering import as_written
from .marks import captions_of, draw_stamps, draw_walk, lanes, start_stamp, visit_stamp
from .style import robot_styles


@as_written
def plot_paths(plan: Plan, ax: Axes | None = None, *, robot_key: bool = True) -> Axes:
    """Draw each robot's path over the cells, and at each stop its place in the robot's order.

    Paths are shifted a little, each robot's by its own amount, so that shared cells show them all.

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
        lines = 2 + instance.n_robots * robot_key
        ax = map_axes(instance.map, crowded=instance.n_victims > 50, lines=lines)
    plot_map(instance.map, ax)
    figures = plan.metrics
    ax.set_title(
        f"Paths\n{figures.distance} cells walked, makespan {figures.makespan:g} time units",
        fontsize=10,
    )
    scale, styles = Scale.of(ax, instance.map), robot_styles(instance)
    cell_of = {victim.id: victim.cell for victim in instance.victims}

    moving = [route for route in plan.routes if route.cells]
    for route, shift in zip(moving, lanes(len(moving), scale), strict=True):
        style = styles[route.robot]
        draw_walk(ax, route.cells, shift, style.colour, style.line, scale.line)
    stamps = [start_stamp(r.start, r.id, styles[r.id]) for r in instance.robots]
    stamps += [
        visit_stamp(cell_of[visit.victim], order, styles[route.robot])
        for route in plan.routes
        for order, visit in enumerate(route.visits, start=1)
    ]
    taken = draw_stamps(ax, stamps, captions_of(cell_of), scale)
    draw_centres(ax, plan, scale, taken, faint=True)

    handles: list[Artist] = []
    if moving:
        handles.append(mark_handle("o", "visit, by its place in the robot's order"))
    if plan.clusters:
        handles.append(mark_handle("P", "centre of a cluster", edge="white"))
    if robot_key:
        handles += robot_handles(styles)
    legend_below(ax, handles)
    return ax
