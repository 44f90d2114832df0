"""A run beside its plan: what was to be walked, and what was walked; timelines on one axis."""

from __future__ import annotations

from bisect import bisect_right
from itertools import groupby
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..mission.plan import Plan
from ..mission.route import Route, Visit
from ..mission.run import Run, Walked
from .figure import POINTS_PER_INCH, Page
from .gantt import gantt_height, plot_gantt
from .key import Section, columns_below, draw_key, key_height
from .legends import mark_handle
from .lettering import as_written, fitted
from .mission import MARGIN, WIDTH, strip
from .style import FAINT, INK, MISSED
from .titles import name_of, says
from .two_plans import draw_maps, maps_height, plans_key

TITLE = 0.75
TURNED_UP = "#E8940A"
"""Around victims that nobody knew of when it began."""


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
    sections = plans_key(plans)
    if events := events_handles(run):
        sections.append(Section("What happened", events))
    inner = WIDTH - 2 * MARGIN
    maps = maps_height(plans, inner)
    columns = columns_below(sections, inner)
    key = key_height(sections, inner, columns) + 0.12
    bars = gantt_height(run.plan.instance.n_robots)
    page = Page(WIDTH, TITLE + maps + key + 2 * (bars + 0.75) + MARGIN)
    room = inner * POINTS_PER_INCH
    page.write(
        MARGIN, 0.1, fitted(f"{name_of(run.plan.instance)}: {says(run)}", 12, room, bold=True), 12,
        fontweight="bold",
    )  # fmt: skip
    page.write(MARGIN, 0.36, fitted(_came_to(run), 9, room), 9, color=FAINT)
    _, ax = draw_maps(page, list(zip(titles, plans, strict=True)), TITLE, inner)
    draw_events(run, ax)
    draw_key(page, sections, MARGIN, TITLE + maps + 0.05, inner, columns)
    top, until = TITLE + maps + key, max(plan.metrics.makespan for plan in plans)
    for title, plan in zip(titles, plans, strict=True):
        ax = page.place(MARGIN + 0.55, top + 0.3, inner - 0.65, bars)
        plot_gantt(plan, ax, until=until)
        strip(ax, keep="x")
        ax.set_title("")
        ax.set_title(fitted(title, 9.5, 0.6 * room), fontsize=9.5, loc="left", y=1.0, pad=4)
        top += bars + 0.75
    return page


def walked(run: Run) -> Plan:
    """What was done, as a plan that pictures can draw: robots at the speeds that they had.

    It keeps to no plan's rules: robots have waited, and served what they did not finish.
    """
    speeds = {drawn.robot: drawn.speed for drawn in run.world.speeds}
    mission = run.plan.instance.replace(
        victims=run.victims,
        robots=[r.model_copy(update={"speed": speeds[r.id]}) for r in run.plan.instance.robots],
    )
    return run.plan.model_copy(
        update={
            "instance": mission,
            "planner": run.policy,
            "routes": tuple(_route(run, track) for track in run.tracks),
            "scouting": None,
            "clusters": (),
            "certificates": (),
        }
    )


def _route(run: Run, track: Walked) -> Route:
    own = sorted((s for s in run.services if s.robot == track.robot), key=lambda s: s.began)
    visits, here = [], 0
    for victim, found in groupby(own, key=lambda service: service.victim):
        services = list(found)
        there = bisect_right(track.times, services[0].began) - 1
        visits.append(
            Visit(
                victim=victim,
                served=tuple(service.kind for service in services if service.done),
                stage=run.policy,
                cells=track.cells[here : there + 1],
                arrival=services[0].began,
                departure=services[-1].ended,
            )
        )
        here = there
    rest = track.cells[here:]
    return Route(robot=track.robot, visits=tuple(visits), back=rest if len(rest) > 1 else ())


def _came_to(run: Run) -> str:
    planned, done = run.plan.metrics, run.metrics
    parts = [
        f"{done.n_served} of {done.n_available} available requirements served",
        f"makespan {planned.makespan:.5g} planned, {done.makespan:.5g} in the end",
        f"total time {planned.total_time:.5g}, {done.total_time:.5g}",
    ]
    if done.replans:
        parts.append("replanned once" if done.replans == 1 else f"replanned {done.replans} times")
    return " · ".join(parts)


_LOOKS: dict[str, tuple[dict[str, Any], str]] = {
    "lost": (
        {"marker": "X", "ms": 10, "mfc": MISSED, "mec": "white", "mew": 1},
        "a robot was lost",
    ),
    "blocked": ({"marker": "x", "ms": 8, "mec": MISSED, "mew": 2.2}, "a cell was blocked"),
    "opened": (
        {"marker": "s", "ms": 7, "mfc": "none", "mec": MISSED, "mew": 1.5},
        "a cell was opened",
    ),
    "turned up": (
        {"marker": "o", "ms": 17, "mfc": "none", "mec": TURNED_UP, "mew": 2.2},
        "turned up on the way",
    ),
}


def draw_events(run: Run, ax: Axes) -> None:
    """Mark where robots were lost, cells blocked or opened, and victims turned up."""
    for what, cells in _where(run).items():
        rows, cols = zip(*cells, strict=True)
        ax.plot(cols, rows, ls="none", zorder=8, **_LOOKS[what][0])


def events_handles(run: Run) -> list[Artist]:
    """Legend entries of what `draw_events` marks."""
    handles = list[Artist]()
    for what in _where(run):
        look, label = _LOOKS[what]
        handle = mark_handle(look["marker"], label, face=look.get("mfc", INK))
        handle.set(markeredgecolor=look["mec"], markeredgewidth=look["mew"])
        handles.append(handle)
    if run.metrics.n_served < run.metrics.n_available:
        handles.append(Patch(fc=MISSED, label="red arc: was not served"))
    return handles


def _where(run: Run) -> dict[str, list[tuple[int, int]]]:
    cells = {victim.id: victim.cell for victim in run.victims}
    found: dict[str, list[tuple[int, int]]] = {}
    for event in run.events:
        if event.what in ("lost", "blocked", "opened") and event.cell is not None:
            found.setdefault(event.what, []).append(event.cell)
        elif event.what in ("announced", "found") and event.victim is not None:
            found.setdefault("turned up", []).append(cells[event.victim])
    return {what: found[what] for what in _LOOKS if what in found}
