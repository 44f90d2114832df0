"""What the scouts did: the left panel of the paper's Fig. 2, and coverage over steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from ..mission.instance import Instance
from ..mission.plan import Plan, ScoutingReport, Track
from .canvas import Scale, map_axes, plot_map
from .figure import own_axes, size_of
from .legends import legend_below, mark_handle, robot_handles
from .lettering import as_written
from .marks import Stamp, draw_stamps, draw_walk, lanes, start_stamp
from .style import FAINT, FOUND, INK, MISSED, SIGHT, robot_styles

NAMES_PER_STEP = 3
"""Victims found at one step that are named; more are counted."""


@as_written
def plot_scouting(
    mission: Plan | Instance,
    ax: Axes | None = None,
    *,
    report: ScoutingReport | None = None,
    robot_key: bool = True,
) -> Axes:
    """Draw victims, scouts with their visual field, and the scouts' walks.

    The visual field is drawn where each scout ended. Without a report, all victims were known: the
    picture shows them and the robots' starts.

    Parameters
    ----------
    mission : Plan or Instance
        Whose map and victims are drawn.
    ax : Axes, optional
        Where to draw; a figure of its own by default.
    report : ScoutingReport, optional
        What the scouts did; by default that of the plan, if it has one.
    robot_key : bool
        Whether the legend lists the robots, where they are drawn.

    Returns
    -------
    Axes
        Column on x and row on y, in cells.
    """
    instance = mission.instance if isinstance(mission, Plan) else mission
    if report is None and isinstance(mission, Plan):
        report = mission.scouting
    ax = map_axes(instance.map, crowded=instance.n_victims > 50) if ax is None else ax
    plot_map(instance.map, ax)
    scale = Scale.of(ax, instance.map)
    missed = set(report.not_found) if report else set()
    stamps = [
        Stamp(v.cell, "white", str(v.id), "o", ink=MISSED, edge=MISSED)
        if v.id in missed
        else Stamp(v.cell, FOUND, str(v.id), "o")
        for v in instance.victims
    ]
    handles: list[Artist] = []
    if report is None:
        known = "all victims were known" if instance.victims else "there are no victims"
        ax.set_title(f"Mission\nno scouting: {known}", fontsize=10)
        styles = robot_styles(instance)
        stamps += [start_stamp(r.start, r.id, styles[r.id]) for r in instance.robots]
        if instance.victims:
            handles.append(mark_handle("o", "victim, by number", face=FOUND))
        if robot_key:
            handles += robot_handles(styles)
    else:
        ax.set_title(f"Scouting\n{_summary(report, instance.n_victims)}", fontsize=10)
        stamps += _draw_tracks(ax, report.tracks, scale)
        found = len(missed) < instance.n_victims
        handles += [mark_handle("o", "victim found, by number", face=FOUND)] if found else []
        if missed:
            handles.append(mark_handle("o", "victim not found", face="white", edge=MISSED))
        handles += _track_handles(report.tracks)
    draw_stamps(ax, stamps, {}, scale)
    legend_below(ax, handles)
    return ax


def _summary(report: ScoutingReport, n_victims: int) -> str:
    steps = max(len(report.coverage) - 1, 0)
    coverage = f"{100 * report.coverage[-1]:.0f} % covered" if report.coverage else "nothing seen"
    found = n_victims - len(report.not_found)
    return f"{coverage} in {steps} steps, {found} of {n_victims} victims found"


def _scout_colours(n_scouts: int) -> list[str]:
    browns = colormaps["YlOrBr"](np.linspace(0.5, 0.95, max(n_scouts, 2)))
    return [to_hex(colour) for colour in browns[:n_scouts]]


def _draw_tracks(ax: Axes, tracks: Sequence[Track], scale: Scale) -> list[Stamp]:
    """Draw walks and visual fields; the stamps that name the scouts are the caller's to draw."""
    stamps = []
    shifts = lanes(len(tracks), scale)
    for track, shift, colour in zip(tracks, shifts, _scout_colours(len(tracks)), strict=True):
        if not track.cells:
            continue
        depth = track.visual_field_depth
        row, col = track.cells[-1]
        corner, side = (col - depth - 0.5, row - depth - 0.5), 2 * depth + 1
        field = Rectangle(corner, side, side, fc=SIGHT, ec="none", alpha=0.25, zorder=1.5)
        border = Rectangle(corner, side, side, fc="none", ec=SIGHT, lw=0.9, zorder=2)
        ax.add_patch(field)
        ax.add_patch(border)
        draw_walk(ax, track.cells, shift, colour, "-", scale.line)
        start_row, start_col = track.cells[0]
        ax.plot(
            start_col + shift, start_row + shift, "s",
            ms=0.6 * scale.mark, mfc="white", mec=colour, mew=1.2, zorder=4,
        )  # fmt: skip
        stamps.append(Stamp((row, col), colour, f"S{track.scout}"))
    return stamps


def _track_handles(tracks: Sequence[Track]) -> list[Artist]:
    if not tracks:
        return []
    depths = sorted({track.visual_field_depth for track in tracks})
    deep = ", ".join(map(str, depths))
    handles: list[Artist] = [
        Patch(fc=(SIGHT, 0.25), ec=SIGHT, label=f"visual field at the end (depth {deep})"),
        mark_handle("s", "start of a scout", face="white"),
    ]
    for track, colour in zip(tracks, _scout_colours(len(tracks)), strict=True):
        handles.append(Line2D([], [], color=colour, lw=2, label=f"walk of scout S{track.scout}"))
    return handles


@as_written
def plot_coverage(report: ScoutingReport, ax: Axes | None = None) -> Axes:
    """Draw the share of cells seen after each step, and when each victim was found.

    Parameters
    ----------
    report : ScoutingReport
        What the scouts did.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        Steps on x, coverage on y in % of the cells that can be seen.
    """
    ax = own_axes(7.0, 3.6) if ax is None else ax
    percent = 100 * np.array(report.coverage)
    steps = np.arange(len(percent))
    last = max(len(percent) - 1, 1)
    ax.plot(steps, percent, color="#0072B2", lw=1.8, marker="o" if last < 3 else "")
    ax.fill_between(steps, percent, color="#0072B2", alpha=0.12, lw=0)
    ax.set(xlim=(-0.02 * last, 1.02 * last), ylim=(0, 124), yticks=range(0, 101, 20))
    handles: list[Artist] = [Line2D([], [], color="#0072B2", lw=1.8, label="cells seen so far")]
    if report.finds:
        _mark_finds(ax, report, last)
        handles.append(mark_handle("o", "victim found (v: its number)", face="#D55E00"))
    ax.set_xlabel("time (steps)", fontsize=8)
    ax.set_ylabel("coverage (% of the cells that can be seen)", fontsize=8)
    ax.tick_params(labelsize=7)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.grid(axis="y", color="#E5E5E5", lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    n_victims = len(report.finds) + len(report.not_found)
    ax.set_title(f"Coverage (ended: {report.ended})\n{_summary(report, n_victims)}", fontsize=10)
    legend_below(ax, handles)
    return ax


def _mark_finds(ax: Axes, report: ScoutingReport, last: int) -> None:
    found: dict[int, list[int]] = {}
    for find in sorted(report.finds, key=lambda find: (find.step, find.victim)):
        found.setdefault(find.step, []).append(find.victim)
    steps = list(found)
    heights = [100 * report.coverage[min(s, len(report.coverage) - 1)] for s in steps]
    font = 6.5 if len(steps) <= 40 else 5.0
    width, _ = size_of(ax)
    letters = spread(steps, 1.25 * font * last / width, 0.0, float(last))
    for step, height, x in zip(steps, heights, letters, strict=True):
        ax.plot([step, step, x], [height, 100, 105], color=FAINT, lw=0.5, zorder=2)
    ax.plot(steps, heights, "o", ms=4.5, mfc="#D55E00", mec=INK, mew=0.5, zorder=4)
    for victims, x in zip(found.values(), letters, strict=True):
        names = " ".join(f"v{victim}" for victim in victims)
        text = names if len(victims) <= NAMES_PER_STEP else f"{len(victims)} found"
        ax.text(x, 106, text, rotation=90, ha="center", va="bottom", fontsize=font)


def spread(positions: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Ascending `positions` moved as little as a sweep each way can to be `gap` apart.

    They stay between `low` and `high` as long as all fit there.
    """
    placed: list[float] = []
    for position in positions:
        placed.append(max(position, placed[-1] + gap) if placed else max(position, low))
    limit = high
    for i in reversed(range(len(placed))):
        placed[i] = min(placed[i], limit)
        limit = placed[i] - gap
    return placed
