"""Plans side by side: what differs in colour, what both have in grey, timelines on one axis."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..mission.metrics import METRICS, Metrics
from ..mission.plan import Plan
from ..mission.run_metrics import RunMetrics
from .canvas import is_large
from .figure import POINTS_PER_INCH, Page
from .gantt import gantt_height, plot_gantt, title_gantt
from .key import Section, columns_below, draw_key, key_height
from .legends import mark_handle, robot_handles
from .lettering import as_many_as_fit, as_written, fitted
from .mission import GAP, MARGIN, PANEL_TITLE, TICKS, WIDTH, strip
from .overview import LINES_OF
from .paths import paths_handles, plot_paths
from .style import FADED, FAINT, robot_styles
from .titles import name_of, says

TITLE = 0.75
COMPARED = ("n_served", "makespan", "total_time", "distance", "mean_completion")
"""Metrics whose differences the title says."""


@as_written
def plot_two_plans(before: Plan, after: Plan, *, moved: Collection[tuple[int, str]] = ()) -> Figure:
    """Draw the paths of two plans side by side, and their timelines on one axis.

    Parameters
    ----------
    before, after : Plan
        Robots of the same id have the same colour where both plans are for one mission.
    moved : collection of (int, str)
        Requirements, by victim's id and kind, that another robot serves, or only one of the plans:
        they and the walks to them keep their colours, all else is grey. Without any, all is in
        colour.

    Returns
    -------
    Figure
        Not known to pyplot; `save_figure` writes it, a notebook shows it.
    """
    plans = (before, after)
    needed = {
        (v.id, kind) for plan in plans for v in plan.instance.victims for kind in v.requirements
    }
    faded = needed - set(moved) if moved else set()
    sections = plans_key(plans)
    if moved:
        grey = mark_handle("o", "served by the same robot in both plans", face=FADED)
        sections.append(Section("Differences", [grey]))
    inner = WIDTH - 2 * MARGIN
    maps = maps_height(plans, inner)
    columns = columns_below(sections, inner)
    key = key_height(sections, inner, columns) + GAP
    bars = [gantt_height(plan.instance.n_robots) for plan in plans]
    page = Page(WIDTH, TITLE + maps + key + sum(bars) + 0.75 * len(plans) + MARGIN)
    room = inner * POINTS_PER_INCH
    both = f"{name_of(before.instance)}: {says(before)} → {says(after)}"
    page.write(MARGIN, 0.1, fitted(both, 12, room, bold=True), 12, fontweight="bold")
    line = as_many_as_fit(_differences(before, after), 9, room)
    page.write(MARGIN, 0.36, line, 9, color=FAINT)
    titles = [says(plan) for plan in plans]
    looks = {"faded": faded}
    items = [Item(title, plan, options=looks) for title, plan in zip(titles, plans, strict=True)]
    draw_maps(page, items, TITLE, inner)
    draw_key(page, sections, MARGIN, TITLE + maps + 0.05, inner, columns)
    top = TITLE + maps + key
    until = max(plan.metrics.makespan for plan in plans)
    for title, plan, height in zip(titles, plans, bars, strict=True):
        ax = page.place(MARGIN + 0.55, top + 0.3, inner - 0.65, height)
        plot_gantt(plan, ax, until=until, faded=faded)
        strip(ax, keep="x")
        title_gantt(ax, title)
        top += height + 0.75
    return page


class Item(NamedTuple):
    """A plan under its title and what it costs, drawn with options of `plot_paths`."""

    title: str
    plan: Plan
    cost: str = ""
    options: Mapping[str, Any] = MappingProxyType({})


def cost_of(figures: Metrics | RunMetrics) -> str:
    """What a plan, or a run, comes to."""
    return (
        f"{figures.n_served} served, {figures.distance} cells walked, "
        f"makespan {figures.makespan:.6g}"
    )


def maps_height(plans: Sequence[Plan], width: float) -> float:
    """Inches that the maps of plans take, beside each other in so many inches."""
    across = _across(plans, width)
    return PANEL_TITLE + max(_height(plan, across) for plan in plans) + TICKS


def draw_maps(page: Page, items: Sequence[Item], top: float, width: float) -> list[Axes]:
    """Draw the paths of plans beside each other, each under its title and what it costs."""
    drawn = []
    across = _across([item.plan for item in items], width)
    for number, item in enumerate(items):
        left = MARGIN + TICKS + number * (across + TICKS + GAP)
        ax = page.place(left, top + PANEL_TITLE, across, _height(item.plan, across))
        plot_paths(item.plan, ax, robot_key=False, **item.options)
        strip(ax)
        lines = (item.title, item.cost or cost_of(item.plan.metrics))
        said = (fitted(line, 9.5, across * POINTS_PER_INCH) for line in lines)
        ax.set_title("\n".join(said), fontsize=9.5)
        drawn.append(ax)
    return drawn


def plans_key(plans: Sequence[Plan], *, unserved: bool = True) -> list[Section]:
    """What robots and victims look like in plans for one mission, or for several."""
    styles = {r: style for plan in plans for r, style in robot_styles(plan.instance).items()}
    words = {r.id: ", ".join(r.capabilities) for plan in plans for r in plan.instance.robots}
    words = {robot: said or "no capability" for robot, said in words.items()}
    victims = {
        str(h.get_label()): h for plan in plans for h in paths_handles(plan, unserved=unserved)
    }
    large = any(is_large(plan.instance) for plan in plans)
    return [
        Section("Robots", robot_handles(styles, words) if len(styles) <= LINES_OF else []),
        Section(
            "Victims" if large else "Victims (arc: colour of who serves it)", [*victims.values()]
        ),
    ]


def _across(plans: Sequence[Plan], width: float) -> float:
    """Inches of a map's axes."""
    return width / max(len(plans), 2) - TICKS - GAP


def _height(plan: Plan, across: float) -> float:
    n_rows, n_cols = plan.instance.map.shape
    return min(max(across * n_rows / n_cols, 1.0), 6.2)


def _differences(before: Plan, after: Plan) -> list[str]:
    said = []
    for name in COMPARED:
        entry = METRICS[name]
        old, new = (float(getattr(plan.metrics, name)) for plan in (before, after))
        if old == new and name == "n_served":
            continue
        change = f"{old:.6g} → {new:.6g} ({new - old:+.6g})" if new != old else f"{old:.6g} in both"
        said.append(f"{entry.heading} {change}")
    return said
