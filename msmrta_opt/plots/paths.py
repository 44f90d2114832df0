"""Who walks where, in which order: the right panel of the paper's Fig. 2."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..mission.plan import Plan
from .assignment import unserved_handles
from .canvas import Scale, is_large, map_axes, plot_map
from .legends import legend_below, mark_handle, robot_handles
from .lettering import as_written
from .marks import (
    MAX_KINDS,
    Group,
    clock_marker,
    draw_groups,
    fades,
    served_groups,
    short_number,
    start_of,
)
from .overview import TRAFFIC, draw_victims, draw_walks, draws_lines
from .style import FADED, INK, robot_styles
from .walks import draw_leg_mark, draw_walk, lanes


@as_written
def plot_paths(
    plan: Plan,
    ax: Axes | None = None,
    *,
    robot_key: bool = True,
    faded: Collection[tuple[int, str]] = (),
    tinted: Collection[int] = (),
    badges: Sequence[Group] = (),
) -> Axes:
    """Draw each robot's walk with arrowheads, and at each victim what it needs and who serves it.

    Walks are shifted a little, each robot's by its own amount, so that shared cells show them all,
    and a leg carries its robot's mark and number. Of a large mission victims are dots in the colour
    of the robot that served them last; walks are lines, or of very many robots a map of traffic.

    Parameters
    ----------
    plan : Plan
        Of any planner.
    ax : Axes, optional
        Where to draw; a figure of its own by default.
    robot_key : bool
        Whether the legend lists the robots.
    faded : collection of (int, str)
        Requirements, by victim's id and kind, that are drawn in grey; so are walks to visits that
        serve nothing else.
    tinted : collection of int
        Ids of victims that are marked as having turned up on the way.
    badges : sequence of Group
        What else stands at cells.

    Returns
    -------
    Axes
        Column on x and row on y, in cells.
    """
    instance = plan.instance
    ax = map_axes(instance, lines=9 + instance.n_robots // 3) if ax is None else ax
    plot_map(instance.map, ax)
    figures = plan.metrics
    ax.set_title(
        f"Paths\n{figures.distance} cells walked, makespan {figures.makespan:g} time units",
        fontsize=9.5,
    )
    scale = Scale.of(ax, instance.map)
    if is_large(instance):
        draw_walks(ax, plan, scale, faded)
        draw_victims(ax, plan, scale, faded=faded, tinted=tinted)
        draw_groups(ax, badges, instance.map.shape, scale)
    else:
        _draw_each(ax, plan, scale, faded, [*served_groups(plan, faded, tinted), *badges])
    legend_below(
        ax, [*(robot_handles(robot_styles(instance)) if robot_key else []), *paths_handles(plan)]
    )
    return ax


def _draw_each(
    ax: Axes,
    plan: Plan,
    scale: Scale,
    faded: Collection[tuple[int, str]],
    groups: Sequence[Group],
) -> None:
    instance, styles = plan.instance, robot_styles(plan.instance)
    starts = [start_of(r.start, r.id, styles[r.id]) for r in instance.robots]
    taken = draw_groups(ax, [*starts, *groups], instance.map.shape, scale)
    moving = [route for route in plan.routes if route.cells]
    shifts = lanes(len(moving), scale)
    for grey in (True, False) if faded else (False,):
        for route, shift in zip(moving, shifts, strict=True):
            style = styles[route.robot] if not grey else replace(styles[route.robot], colour=FADED)
            if not faded:
                draw_walk(ax, route.cells, shift, style, scale)
            legs = [(visit.cells, fades(visit, faded)) for visit in route.visits]
            for leg, grey_too in [*legs, (route.back, bool(faded))]:
                if faded and grey_too == grey:
                    draw_walk(ax, leg, shift, style, scale)
                if grey_too == grey:
                    draw_leg_mark(ax, leg, shift, short_number(route.robot), style, scale, taken)


def paths_handles(plan: Plan, *, unserved: bool = True) -> list[Artist]:
    """Legend entries of what the victims need, and of the walks of many robots."""
    instance, handles = plan.instance, list[Artist]()
    kinds = instance.capabilities
    if is_large(instance):
        handles.append(mark_handle("o", "victim, colour of the robot last there"))
        if not draws_lines(plan):
            handles.append(mark_handle("s", "start of a robot; colours repeat", edge="white"))
            handles.append(
                Line2D([], [], color=TRAFFIC(0.5), lw=5, label="cells walked; darker: more often")
            )
    elif instance.n_victims and len(kinds) <= MAX_KINDS:
        handles += [
            mark_handle(clock_marker(place, len(kinds)), f"needs {kind}", face=INK)
            for place, kind in enumerate(kinds)
        ]
    elif instance.n_victims:
        handles.append(
            mark_handle("o", "arcs: requirements, coloured by who serves them", face="white")
        )
    if len({victim.priority for victim in instance.victims}) > 1:
        handles.append(mark_handle("o", "larger: higher priority", face="white"))
    return handles + (unserved_handles(plan) if unserved else [])
