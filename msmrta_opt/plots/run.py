"""A run beside its plan: what was to be walked, and what was walked; timelines on one axis."""

from __future__ import annotations

from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from ..mission.counting import counted
from ..mission.happened import What
from ..mission.plan import Plan
from ..mission.run import Run
from .assignment import ring_handle
from .canvas import is_large
from .figure import POINTS_PER_INCH, Page
from .gantt import cut_handle, gantt_height, plot_gantt, title_gantt
from .key import Section, columns_below, draw_key, key_height
from .legends import mark_handle
from .lettering import as_many_as_fit, as_written, fitted
from .marks import Group, Mark, number_of, unserved_victims
from .mission import MARGIN, WIDTH, strip
from .moments import LANE, moment_handles
from .style import FAINT, INK, TURNED_UP
from .titles import name_of, says
from .two_plans import Item, cost_of, draw_maps, maps_height, plans_key
from .walked import walked

TITLE = 0.75


@as_written
def plot_run(run: Run) -> Figure:
    """Draw what was planned and what was walked, side by side, and both timelines on one axis.

    Parameters
    ----------
    run : Run
        Of any policy. Where robots were lost, cells blocked or opened, and victims turned up is marked.

    Returns
    -------
    Figure
        Not known to pyplot; `save_figure` writes it, a notebook shows it.
    """
    plans = [run.plan, walked(run)]
    titles = [f"planned: {says(run.plan)}", f"walked: {says(run)}"]
    costs = [cost_of(run.plan.metrics), cost_of(run.metrics)]
    sections = plans_key(plans, unserved=False)
    sections += [
        Section("What was not served", _open(run)),
        Section("What happened, on the map", _came(run)),
        Section("What happened, on the timeline", [*moment_handles(run), *cut_handle(run)]),
    ]
    inner = WIDTH - 2 * MARGIN
    maps = maps_height(plans, inner)
    columns = columns_below(sections, inner)
    key = key_height(sections, inner, columns) + 0.12
    planned = gantt_height(run.plan.instance.n_robots)
    bars = (planned, planned + LANE / POINTS_PER_INCH)
    page = Page(WIDTH, TITLE + maps + key + sum(bars) + 2 * 0.8 + MARGIN)
    room = inner * POINTS_PER_INCH
    page.write(
        MARGIN, 0.1, fitted(f"{name_of(run.plan.instance)}: {says(run)}", 12, room, bold=True), 12,
        fontweight="bold",
    )  # fmt: skip
    page.write(MARGIN, 0.36, as_many_as_fit(_came_to(run), 9, room), 9, color=FAINT)
    looks = [{}, {"tinted": _turned_up(run), "badges": _losses(run)}]
    items = [Item(*item) for item in zip(titles, plans, costs, looks, strict=True)]
    _, ax = draw_maps(page, items, TITLE, inner)
    _draw_cells(run, ax)
    draw_key(page, sections, MARGIN, TITLE + maps + 0.05, inner, columns)
    top, until = TITLE + maps + key, max(run.plan.metrics.makespan, run.metrics.makespan)
    both: tuple[Plan | Run, ...] = (run.plan, run)
    for title, told, height in zip(titles, both, bars, strict=True):
        ax = page.place(MARGIN + 0.55, top + 0.35, inner - 0.65, height)
        plot_gantt(told, ax, until=until)
        strip(ax, keep="x")
        title_gantt(ax, title)
        top += height + 0.8
    return page


def _came_to(run: Run) -> list[str]:
    planned, done = run.plan.metrics, run.metrics
    parts = [
        f"{done.n_served} of {done.n_available} available requirements served",
        f"makespan {planned.makespan:.5g} planned, {done.makespan:.5g} in the end",
        f"total time {planned.total_time:.5g}, {done.total_time:.5g}",
    ]
    if done.replans:
        parts.append("replanned once" if done.replans == 1 else f"replanned {done.replans} times")
    return parts


_CELLS: dict[What, tuple[dict[str, Any], str]] = {
    "blocked": ({"hatch": "xxxxx", "lw": 0.8}, "a cell was blocked"),
    "opened": ({"lw": 1.6, "ls": (0, (2, 1.2))}, "a cell was opened"),
}
"""How cells are drawn, an outline each, so that one may be both."""


def _draw_cells(run: Run, ax: Axes) -> None:
    """Mark the cells that were blocked or opened, under the walks."""
    for what, (look, _) in _CELLS.items():
        found = {event.cell for event in run.events if event.what == what and event.cell}
        for row, col in sorted(found):
            ax.add_patch(
                Rectangle((col - 0.5, row - 0.5), 1, 1, fc="none", ec=INK, zorder=0.8, **look)
            )


def _turned_up(run: Run) -> set[int]:
    """The ids of the victims that were announced or found."""
    return {
        e.victim for e in run.events if e.what in ("announced", "found") and e.victim is not None
    }


def _losses(run: Run) -> list[Group]:
    """A badge where a robot was lost: a cross, with the robot's number if there is room for it."""
    short = is_large(run.plan.instance)
    return [
        Group(event.cell, (Mark("lost" if short else f"R{number_of(event.robot)} lost", INK),))
        for event in run.events
        if event.what == "lost" and event.cell is not None and event.robot is not None
    ]


def _open(run: Run) -> list[Artist]:
    """Legend entries of what was not served, beside what the plan left open."""
    planned, done = (len(unserved_victims(plan)) for plan in (run.plan, walked(run)))
    if not planned and not done:
        return []
    figures, needed = run.metrics, sum(len(victim.requirements) for victim in run.victims)
    counts = {
        "no robot can serve it": needed - figures.n_available,
        "available, but not served": figures.n_available - figures.n_served,
    }
    said = f"{counted(done, 'victim')} ({planned} in the plan)"
    lines = [f"{why}: {counted(count, 'requirement')}" for why, count in counts.items() if count]
    return [ring_handle(said), *(mark_handle("", line) for line in lines)]


def _came(run: Run) -> list[Artist]:
    """Legend entries of what came in between."""
    happened = {event.what for event in run.events}
    handles = list[Artist]()
    if "lost" in happened:
        handles.append(Patch(fc=INK, label="a robot was lost there"))
    handles += [
        Patch(fc="none", ec=INK, label=label, **look)
        for what, (look, label) in _CELLS.items()
        if what in happened
    ]
    if _turned_up(run):
        handles.append(mark_handle("o", "the victim turned up on the way", face=TURNED_UP))
    return handles
