"""What the scouts did: the left panel of the paper's Fig. 2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ..mission.grid import GridMap
from ..mission.instance import Instance
from ..mission.plan import Plan, ScoutingReport, Track
from ..mission.visibility import FieldOfView
from .canvas import Scale, borders, frame_map, is_large, map_axes, plot_map
from .legends import legend_below, mark_handle, robot_handles
from .lettering import as_written
from .marks import (
    Group,
    Mark,
    disc_of,
    draw_groups,
    number_of,
    short_number,
    start_of,
    unserved_victims,
)
from .placing import Box
from .style import (
    FOUND,
    INK,
    LINES,
    MARKS,
    MISSED,
    NEVER_SEEN,
    RobotStyle,
    readable_on,
    robot_styles,
)
from .walks import corners, draw_leg_mark, draw_walk, lanes

SEEN = LinearSegmentedColormap.from_list("seen", ["#F6CC73", "#FFF8E8"])
"""From what was seen first to what was seen last."""
SCOUTS = ("#3A3A3A", "#A0522D", "#5E3C99", "#00695C", "#8C8C00")
"""Colours of scouts, none of which is a robot's."""


@as_written
def plot_scouting(
    mission: Plan | Instance,
    ax: Axes | None = None,
    *,
    report: ScoutingReport | None = None,
    robot_key: bool = True,
) -> Axes:
    """Draw what the scouts saw, when, from where, and whom they found.

    Each cell that a scout saw, past walls only where its line of sight is free, is shaded by the
    step at which it was first seen; what nobody ever saw is violet. A scout's view at
    the end has its outline. Without a report, all victims were known: the picture shows them and the
    robots' starts.

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
    ax = map_axes(instance, lines=8) if ax is None else ax
    plot_map(instance.map, ax)
    scale = Scale.of(ax, instance.map)
    if report is None:
        known = "all victims were known" if instance.victims else "there are no victims"
        ax.set_title(f"Mission\nno scouting: {known}", fontsize=9.5)
    else:
        ax.set_title(f"Scouting\n{summary(report, instance.n_victims)}", fontsize=9.5)
        draw_seen(ax, instance.map, report.tracks)
    missed = set(report.not_found) if report else set()
    unserved = unserved_victims(mission) if isinstance(mission, Plan) else set()
    styles = robot_styles(instance)
    groups = [
        Group(v.cell, disc=disc_of(v, "white", MISSED, MISSED), ring=True)
        if v.id in missed
        else Group(v.cell, disc=disc_of(v, FOUND, "white", "white"), ring=v.id in unserved)
        for v in instance.victims
    ]
    if report is None:
        groups += [start_of(r.start, r.id, styles[r.id]) for r in instance.robots]
    taken: list[Box] = []
    if is_large(instance):
        _draw_dots(ax, instance, missed, scale)
        if report is not None:
            groups = _ends(report.tracks)
            taken = draw_groups(ax, groups, instance.map.shape, scale)
    else:
        groups += _ends(report.tracks) if report else []
        taken = draw_groups(ax, groups, instance.map.shape, scale)
    if report is not None:
        _draw_tracks(ax, instance.map, report.tracks, scale, taken)
    handles = scouting_handles(instance, report)
    if report is None and robot_key:
        handles += robot_handles(styles)
    legend_below(ax, handles)
    return ax


def summary(report: ScoutingReport, n_victims: int) -> str:
    """How much was covered, and how many were found."""
    steps = max(len(report.coverage) - 1, 0)
    coverage = f"{100 * report.coverage[-1]:.0f} % covered" if report.coverage else "nothing seen"
    found = n_victims - len(report.not_found)
    return f"{coverage} in {steps} steps, {found} of {n_victims} victims found"


def first_seen(grid: GridMap, tracks: Sequence[Track]) -> NDArray[np.float64]:
    """The step at which each cell was first seen by any scout, infinite where none ever did.

    Returns
    -------
    float array, shape (n_rows, n_cols)
    """
    step_of = np.full(grid.shape, np.inf)
    for depth in {track.visual_field_depth for track in tracks}:
        first: dict[tuple[int, int], int] = {}
        for track in tracks:
            if track.visual_field_depth == depth:
                for step, cell in enumerate(track.cells):
                    first[cell] = min(step, first.get(cell, step))
        view = FieldOfView(grid, depth)
        for cell, step in first.items():
            seen = view(cell)
            step_of[seen] = np.minimum(step_of[seen], step)
    return step_of


def draw_seen(ax: Axes, grid: GridMap, tracks: Sequence[Track]) -> None:
    """Shade what was seen by step, and mark what never was."""
    step_of = first_seen(grid, tracks)
    last = max((len(track.cells) for track in tracks), default=1)
    seen = np.ma.masked_array(step_of, ~np.isfinite(step_of))
    ax.imshow(
        seen, cmap=SEEN, norm=Normalize(0, max(last - 1, 1)), interpolation="none", zorder=0.2
    )
    never = grid.free & ~np.isfinite(step_of)
    if never.any():
        ax.imshow(
            np.ma.masked_equal(never, False), cmap=ListedColormap([NEVER_SEEN]),
            interpolation="none", zorder=0.3,
        )  # fmt: skip
        ax.add_collection(
            LineCollection(list(borders(never)), colors="#5B5397", linewidths=0.8, zorder=0.7),
            autolim=False,
        )
    frame_map(ax, grid)


def scout_style(place: int) -> RobotStyle:
    """How the scout at that place of its report is drawn."""
    line = "-" if place == 0 else LINES[3 + place % (len(LINES) - 3)]
    return RobotStyle(SCOUTS[place % len(SCOUTS)], line, MARKS[place % len(MARKS)], "")


def _ends(tracks: Sequence[Track]) -> list[Group]:
    """Where each scout ended, by name."""
    groups = []
    for place, track in enumerate(tracks):
        if track.cells:
            colour = scout_style(place).colour
            badge = Mark(f"S{number_of(track.scout)}", colour, readable_on(colour))
            groups.append(Group(track.cells[-1], (badge,)))
    return groups


def _draw_tracks(
    ax: Axes, grid: GridMap, tracks: Sequence[Track], scale: Scale, taken: list[Box]
) -> None:
    """Draw walks, starts and the views at the end."""
    thin = replace(scale, line=min(scale.line, 1.5))
    shifts = lanes(len(tracks), thin)
    for place, (track, shift) in enumerate(zip(tracks, shifts, strict=True)):
        if not track.cells:
            continue
        style = scout_style(place)
        view = FieldOfView(grid, track.visual_field_depth)(track.cells[-1])
        ax.add_collection(
            LineCollection(
                list(borders(np.pad(view, 1)) - 1 + 0.1 * shift), colors=style.colour, linewidths=1.6,
                zorder=2.5,
            ),
            autolim=False,
        )  # fmt: skip
        if is_walk_drawn_whole(track):
            draw_walk(ax, track.cells, shift, style, thin, apart=110)
        else:
            x, y = corners(track.cells, shift).T
            ax.plot(x, y, color=style.colour, lw=0.8, ls=style.line, alpha=0.8, zorder=3)
        row, col = track.cells[0]
        ax.plot(
            col + shift, row + shift, "s", ms=6, mfc="white", mec=style.colour, mew=1.6, zorder=4
        )
        for part in range(3):
            cells = track.cells[len(track.cells) * part // 3 : len(track.cells) * (part + 1) // 3]
            draw_leg_mark(ax, cells, shift, short_number(track.scout), style, scale, taken)


def is_walk_drawn_whole(track: Track) -> bool:
    """Whether a walk is short enough for arrowheads."""
    return len(track.cells) <= 400


def _draw_dots(ax: Axes, instance: Instance, missed: set[int], scale: Scale) -> None:
    side = float(np.clip(1.3 * scale.cell, 4.5, 7.0))
    found = [v.cell for v in instance.victims if v.id not in missed]
    hidden = [v.cell for v in instance.victims if v.id in missed]
    if found:
        rows, cols = zip(*found, strict=True)
        ax.scatter(cols, rows, s=side**2, c=FOUND, edgecolors="white", linewidths=0.6, zorder=5)
    if hidden:
        rows, cols = zip(*hidden, strict=True)
        ax.scatter(
            cols, rows, s=(side + 3) ** 2, c="white", edgecolors=MISSED, linewidths=2.2, zorder=6
        )


def scouting_handles(instance: Instance, report: ScoutingReport | None) -> list[Artist]:
    """Legend entries of what scouting shows."""
    if report is None:
        found = [mark_handle("o", "victim, by number", face=FOUND)]
        return list[Artist](found) if instance.victims else []
    handles: list[Artist] = []
    missed = len(report.not_found)
    if missed < instance.n_victims:
        handles.append(mark_handle("o", "victim found", face=FOUND))
    if missed:
        hidden = mark_handle("o", f"victim not found: {missed}", face="white", edge=MISSED)
        hidden.set(markeredgewidth=2)
        handles.append(hidden)
    handles += [
        Patch(fc=SEEN(0.0), ec="none", label="first seen early"),
        Patch(fc=SEEN(1.0), ec="#D9C89A", label="first seen late"),
    ]
    if report.coverage and report.coverage[-1] < 1:
        handles.append(Patch(fc=NEVER_SEEN, ec="#5B5397", label="never seen"))
    if report.tracks:
        handles.append(mark_handle("s", "start of a scout", face="white"))
        handles.append(Patch(fc="none", ec=INK, lw=1.4, label="in view at the end"))
    for place, track in enumerate(report.tracks):
        style = scout_style(place)
        handles.append(
            Line2D(
                [], [], color=style.colour, ls=style.line, lw=2, marker=style.mark, ms=7,
                mec="white", mew=0.6,
                label=f"scout S{number_of(track.scout)}, sees {track.visual_field_depth} cells far",
            )
        )  # fmt: skip
    return handles
