"""What came in between on the timeline of a run: marks over its rows, and on those of lost robots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..mission.run import Event, Run
from .placing import spread
from .style import INK, SERIES, TURNED_UP

SIZE = 6.5
"""Points of a mark."""
LANE = 11.0
"""Points, over the rows, of the lane in which marks stand that belong to no robot."""


class _Look(NamedTuple):
    marker: str
    face: str
    words: str


_LOOKS = {
    "lost": _Look("X", INK, "a robot is lost"),
    "blocked": _Look("s", INK, "a cell is blocked"),
    "opened": _Look("s", "white", "a cell is opened"),
    "turned up": _Look("o", TURNED_UP, "a victim turns up"),
}
_DECIDED: dict[str, Any] = {"color": SERIES[1], "lw": 1.1, "ls": (0, (1, 1.2))}


def lost_at(run: Run) -> dict[int, float]:
    """When robots were lost, by robot."""
    return {e.robot: e.time for e in run.events if e.what == "lost" and e.robot is not None}


def draw_moments(
    ax: Axes, run: Run, row_of: Mapping[int, int], points_per_time_unit: float, top: float
) -> None:
    """Mark what came in between.

    Parameters
    ----------
    ax : Axes
        A timeline, its limits set.
    run : Run
        What happened.
    row_of : mapping of int to int
        The row of each robot, by id.
    points_per_time_unit : float
        Points that a time unit takes.
    top : float
        The middle of the lane over the rows, in rows.
    """
    for event in run.events:
        if event.what == "decided":
            ax.axvline(event.time, zorder=3.5, **_DECIDED)
    for robot, time in lost_at(run).items():
        _mark(ax, time, row_of[robot], _LOOKS["lost"])
    gap = SIZE + 1.5
    found: list[tuple[float, str]] = []
    for event in run.events:
        name = _name(event)
        # What comes at once with its like is one mark.
        if name in _LOOKS and name != "lost":
            at = event.time * points_per_time_unit
            if not any(kind == name and at - place < gap for place, kind in found):
                found.append((at, name))
    wide = ax.get_xlim()[1] * points_per_time_unit
    places = spread([at for at, _ in found], min(gap, wide / max(len(found), 1)), 0.0, wide)
    for (_, name), place in zip(found, places, strict=True):
        _mark(ax, place / points_per_time_unit, top, _LOOKS[name])


def moment_handles(run: Run) -> Sequence[Artist]:
    """Legend entries of the marks that the timeline of a run has."""
    names = {_name(event) for event in run.events}
    handles: list[Artist] = [
        Line2D([], [], ls="", marker=look.marker, ms=SIZE, mfc=look.face, mec=INK, mew=0.8,
               label=look.words)
        for name, look in _LOOKS.items()
        if name in names
    ]  # fmt: skip
    if "decided" in names:
        handles.append(Line2D([], [], label="visits are decided anew", **_DECIDED))
    return handles


def _name(event: Event) -> str:
    return "turned up" if event.what in ("announced", "found") else event.what


def _mark(ax: Axes, time: float, row: float, look: _Look) -> None:
    ax.plot(
        [time], [row], look.marker, ms=SIZE, mfc=look.face, mew=0.8, zorder=6, clip_on=False,
        mec="white" if look.marker == "X" else INK,
    )  # fmt: skip
