"""A whole plan on one page: the three panels of the paper's Fig. 2, and the timeline below."""

from __future__ import annotations

import textwrap
from typing import Any

from matplotlib.figure import Figure

from ..mission.plan import Plan
from .assignment import plot_assignment
from .canvas import panel_size
from .figure import Picture
from .gantt import gantt_height, plot_gantt
from .legends import LEGEND_FONT, robot_handles
from .lettering import as_written, shortened
from .paths import plot_paths
from .scouting import plot_scouting
from .style import robot_styles

LEGENDS = 2.7
"""Inches that the panels' titles, axes and legends take."""


@as_written
def plot_mission(plan: Plan, *, gantt: bool = True) -> Figure:
    """Draw scouting, assignment and paths side by side, and when everything happens.

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
    styles = robot_styles(plan.instance)
    width, height = panel_size(plan.instance.map, crowded=plan.instance.n_victims > 50)
    key_columns = min(len(styles), 4)
    upper = height + LEGENDS + 0.2 * -(-len(styles) // key_columns)
    lower = gantt_height(plan) + 0.3
    figure = Picture(
        figsize=(3 * (width + 0.7), upper + (lower if gantt else 0) + 0.6), layout="constrained"
    )
    figure.suptitle(_title(plan), fontsize=12)
    if gantt:
        parts: Any = figure.subfigures(2, 1, height_ratios=(upper, lower))
        top, bottom = parts
        timeline = plot_gantt(plan, bottom.subplots())
        # At the left, where the makespan of a whole plan never is, so that it needs no height.
        timeline.set_title("")
        timeline.set_title("Timeline", fontsize=10, loc="left", y=1.0)
    else:
        top = figure.subfigures(1, 1)
    scouting, assignment, paths = top.subplots(1, 3)
    for panel in (scouting, assignment, paths):
        panel.set_anchor("N")  # what height is left over belongs to the legends below
    plot_scouting(plan, scouting, robot_key=False)
    plot_assignment(plan, assignment, robot_key=False)
    plot_paths(plan, paths, robot_key=False)
    words = {
        robot.id: textwrap.shorten(", ".join(robot.capabilities) or "no capability", 60)
        for robot in plan.instance.robots
    }
    top.legend(
        handles=robot_handles(styles, words),
        loc="outside lower center",
        ncols=key_columns,
        title="robots and what they can do",
        title_fontsize=LEGEND_FONT + 0.5,
        fontsize=LEGEND_FONT + 0.5,
        frameon=False,
    )
    return figure


def _title(plan: Plan) -> str:
    figures = plan.metrics
    instance = plan.instance
    name = shortened(instance.name, 80) or "unnamed mission"
    size = f"{_count(instance.n_robots, 'robot')}, {_count(instance.n_victims, 'victim')}"
    return (
        f"{name}: {size}, planned by {shortened(plan.planner)}\n"
        f"{figures.n_served} of {figures.n_available} available requirements served · "
        f"{figures.distance} cells walked · makespan {figures.makespan:g} · "
        f"total time {figures.total_time:g} · "
        f"mean completion {figures.mean_completion:.4g} time units"
    )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")
