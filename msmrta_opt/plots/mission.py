"""A whole plan on one page: the three panels of the paper's Fig. 2, and the timeline below.

The page is nine inches wide, so that its letters can be read on a screen at 800 pixels and on paper.
A panel stands there only if it says something: scouting if there was any, assignment while its
stages say who serves whom. A large mission is one map and its timeline.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..mission.counting import counted
from ..mission.plan import Plan
from .assignment import assignment_handles, plot_assignment, served_text
from .canvas import SMALL_ROBOTS, is_large
from .figure import POINTS_PER_INCH, Page
from .gantt import gantt_height, plot_gantt, title_gantt
from .key import Section, columns_below, draw_key, key_height
from .legends import robot_handles
from .lettering import as_many_as_fit, as_written, fitted
from .overview import LINES_OF
from .paths import paths_handles, plot_paths
from .scouting import plot_scouting, scouting_handles
from .style import FAINT, STAGES, robot_styles
from .titles import name_of, says

NEEDS = "Victims (arc: colour of who serves it)"
WIDTH, MARGIN = 9.0, 0.15
TITLE, PANEL_TITLE, TICKS, GAP = 0.72, 0.42, 0.32, 0.12
"""Inches: above the panels; above, and left and below of, each; between parts."""
ROOMY_VICTIMS, ROOMY_SIDE = 16, 26
"""With more victims, or more cells a side, paths need all of the page's width."""


@as_written
def plot_mission(plan: Plan, *, gantt: bool = True) -> Figure:
    """Draw scouting, assignment and paths, when everything happens, and a key.

    Parameters
    ----------
    plan : Plan
        Of any planner.
    gantt : bool
        Whether to draw the timeline below the panels.

    Returns
    -------
    Figure
        Not known to pyplot; `save_figure` writes it, a notebook shows it.
    """
    panels, sections = _panels(plan), _sections(plan)
    inner = WIDTH - 2 * MARGIN
    rows = _rows(plan, panels)
    columns = columns_below(sections, inner)
    widths = [inner * share - GAP - TICKS for share, _ in rows]
    heights = [_map_height(plan, width) for width in widths]
    lines = [PANEL_TITLE + height + TICKS for height in heights]
    # The key stands where a panel would, if one is left over and it is not much longer than that.
    last_share, last = rows[-1]
    aside = inner * (1 - last_share) - 2 * GAP
    used = key_height(sections, aside, 1) if last_share < 1 and len(last) == 1 else np.inf
    if used < 1.6 * lines[-1]:
        lines[-1] = max(lines[-1], used)
        below = 0.0
    else:
        below = key_height(sections, inner, columns) + GAP
    upper = TITLE + sum(lines)
    bars = gantt_height(plan.instance.n_robots)
    page = Page(WIDTH, upper + below + (bars + 0.7 if gantt else 0.0) + MARGIN)
    _write_title(page, plan)
    top = TITLE
    for (_, row), line, width, height in zip(rows, lines, widths, heights, strict=True):
        for number, draw in enumerate(row):
            left = MARGIN + number * (width + TICKS + GAP) + TICKS
            ax = page.place(left, top + PANEL_TITLE, width, height)
            draw(ax)
            strip(ax)
        top += line
    if below:
        draw_key(page, sections, MARGIN, upper + GAP, inner, columns)
    else:
        draw_key(page, sections, WIDTH - MARGIN - aside, top - lines[-1] + 0.1, aside, 1)
    if gantt:
        ax = page.place(MARGIN + 0.55, upper + below + 0.3, inner - 0.65, bars)
        plot_gantt(plan, ax)
        strip(ax, keep="x")
        title_gantt(ax, "Timeline: high bars serve, low ones travel")
    return page


Panel = Callable[[Axes], object]


def _rows(plan: Plan, panels: list[Panel]) -> list[tuple[float, list[Panel]]]:
    """The panels by row, with the share of the page's width that each of a row has.

    A large mission, or one with much on its map, shows its paths in all of the page's width.
    """
    instance = plan.instance
    much = instance.n_victims > ROOMY_VICTIMS or max(instance.map.shape) > ROOMY_SIDE
    if len(panels) == 1:
        return [(1.0 if much else 0.6, panels)]
    if much:
        return [(1.0, [panels[-1]]), (0.5, panels[:-1])]
    return [(0.5, panels[i : i + 2]) for i in range(0, len(panels), 2)]


def _panels(plan: Plan) -> list[Panel]:
    """What draws each panel into its axes."""
    panels: list[Panel] = []
    if not is_large(plan.instance):
        if plan.scouting is not None:
            panels.append(lambda ax: plot_scouting(plan, ax, robot_key=False))
        if _is_staged(plan):
            panels.append(lambda ax: plot_assignment(plan, ax, robot_key=False))
    panels.append(lambda ax: plot_paths(plan, ax, robot_key=False))
    return panels


def _map_height(plan: Plan, width: float) -> float:
    n_rows, n_cols = plan.instance.map.shape
    return min(max(width * n_rows / n_cols, 1.0), 9.0 if is_large(plan.instance) else 6.2)


def _is_staged(plan: Plan) -> bool:
    return any(visit.stage in STAGES for route in plan.routes for visit in route.visits)


def strip(ax: Axes, keep: str = "") -> None:
    """Take off what the page says once for all its parts."""
    if legend := ax.get_legend():
        legend.remove()
    if keep != "x":
        ax.set_xlabel("")
    ax.set_ylabel("")


def _sections(plan: Plan) -> list[Section]:
    """The key."""
    instance, styles = plan.instance, robot_styles(plan.instance)
    words = {
        robot.id: ", ".join(robot.capabilities) or "no capability" for robot in instance.robots
    }
    robots: list[Artist] = []
    if instance.n_robots <= LINES_OF:
        robots += robot_handles(styles, words)
    victims = paths_handles(plan)
    served = assignment_handles(plan) if _is_staged(plan) and not is_large(instance) else []
    known = {str(handle.get_label()) for handle in served}
    victims = [handle for handle in victims if str(handle.get_label()) not in known]
    scouts = []
    if plan.scouting is not None and not is_large(instance):
        scouts = scouting_handles(instance, plan.scouting)
    n_each = -(-len(robots) // 2) if len(robots) > SMALL_ROBOTS else len(robots)
    return [
        *(
            Section(
                "(continued)" if first else "Robots and what they can do", robots[first:][:n_each]
            )
            for first in range(0, len(robots), n_each or 1)
        ),
        Section("Victims" if is_large(instance) else NEEDS, victims),
        Section("Assignment", served),
        Section("Scouting", scouts),
    ]


def _write_title(page: Page, plan: Plan) -> None:
    figures, instance = plan.metrics, plan.instance
    room = (WIDTH - 2 * MARGIN) * POINTS_PER_INCH
    size = f"{counted(instance.n_robots, 'robot')}, {counted(instance.n_victims, 'victim')}"
    made = f" · {size} · {says(plan)}"
    name = fitted(name_of(instance), 12, max(room - 6.9 * len(made), 0.3 * room), bold=True)
    page.write(MARGIN, 0.1, fitted(name + made, 12, room, bold=True), 12, fontweight="bold")
    told = [
        f"{served_text(plan)} · makespan {figures.makespan:g}",
        f"total time {figures.total_time:g}",
        f"mean completion {figures.mean_completion:.4g}",
    ]
    line = as_many_as_fit(told, 9, room, end=" time units")
    page.write(MARGIN, 0.36, line, 9, color=FAINT)
