"""Walks on a map: a white casing, the robot's line, arrowheads along it, and its mark on each leg."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

from ..mission.grid import Cell
from .canvas import Scale
from .placing import Box, covered
from .style import RobotStyle

CASING = 1.8
"""Points by which white stands out under a line, so that lines that cross are told apart."""
ARROW, APART = 7.5, 45.0
"""Points: length of an arrowhead, and the minimum from one to the next."""
Floats = NDArray[np.float64]


def lanes(count: int, scale: Scale) -> Floats:
    """Sideways shifts, in cells, that keep `count` walks over the same cells apart."""
    step = min(0.7 / max(count - 1, 1), (scale.line + 1.2) / scale.cell)
    return np.asarray((np.arange(count) - (count - 1) / 2) * step, dtype=np.float64)


def corners(cells: Sequence[Cell], shift: float = 0.0) -> Floats:
    """The ends and turns of a walk as ``(col, row)``, moved down and right, shape ``(n, 2)``."""
    points = np.array(cells, dtype=float).reshape(-1, 2)[:, ::-1]
    steps = np.diff(points, axis=0)
    moving = np.any(steps != 0, axis=1)
    points = points[np.concatenate([[True], moving])]
    steps = steps[moving]
    turns = np.any(steps[1:] != steps[:-1], axis=1)
    keep = np.concatenate([[True], turns, [True]]) if len(steps) else np.array([True])
    corner: Floats = points[keep] + shift
    return corner


def draw_walk(
    ax: Axes, cells: Sequence[Cell], shift: float, style: RobotStyle, scale: Scale,
    apart: float = APART,
) -> None:  # fmt: skip
    """Draw a walk over `cells`, shifted by `shift` cells, its arrowheads `apart` points or more."""
    if len(cells) < 2:
        return
    points = corners(cells, shift)
    ends: dict[str, Any] = {"solid_joinstyle": "round", "dash_joinstyle": "round"}
    ax.plot(*points.T, color="white", lw=scale.line + CASING, zorder=3, **ends)
    ax.plot(*points.T, color=style.colour, lw=scale.line, ls=style.line, zorder=3.1, **ends)
    heads = _arrowheads(points, scale, apart)
    if len(heads):
        ax.add_collection(
            PolyCollection(
                list(heads), facecolors=style.colour, edgecolors="white", linewidths=0.6, zorder=3.2
            ),
            autolim=False,
        )


def _arrowheads(points: Floats, scale: Scale, apart: float) -> Floats:
    """Triangles on the straights of a walk that are long enough, shape ``(n, 3, 2)``."""
    size, gap = ARROW / scale.cell, apart / scale.cell
    triangles, since = [], 0.7 * gap
    for start, end in pairwise(points):
        length = float(np.abs(end - start).sum())
        along = (end - start) / length
        aside = along[::-1] * (1, -1)
        count = int((since + length / 2) // gap) if length >= 1.6 * size else 0
        count = min(count, max(1, round(length / gap)))
        for place in (np.arange(count) + 0.5) / max(count, 1):
            tip = start + along * (place * length + size / 2)
            back = tip - along * size
            triangles.append([tip, back + 0.5 * size * aside, back - 0.5 * size * aside])
        since = length * 0.5 / count if count else since + length
    return np.array(triangles)


def draw_leg_mark(
    ax: Axes, cells: Sequence[Cell], shift: float, text: str, style: RobotStyle, scale: Scale,
    taken: list[Box],
) -> None:  # fmt: skip
    """Put a robot's mark and number on a leg of its walk, where it covers nothing; else nowhere."""
    size = 1.8 * scale.font / scale.cell
    places = np.array(cells, dtype=float)
    if len(places) < max(4, 4 * size):
        return
    places = places[1:-1]
    middle = len(places) / 2
    cost = covered(places[:, 0], places[:, 1], (size, size), taken)
    if cost.min() > 0:
        return
    free = np.flatnonzero(cost == cost.min())
    row, col = places[free[np.abs(free - middle).argmin()]]
    x, y = col + shift, row + shift
    taken.append((row, col, 2 * size, 2 * size))
    (mark,) = ax.plot(
        [x], [y], style.mark, ms=scale.font * (1.65 if style.mark not in "^v" else 1.95),
        mfc=style.colour, mec="white", mew=0.9, zorder=4,
    )  # fmt: skip
    mark.set_in_layout(False)
    letters = scale.font * (0.85 if len(text) < 3 else 0.62)
    lift = 0.14 * scale.font / scale.cell if style.mark == "^" else 0.0
    ax.text(
        x, y + lift, text, ha="center", va="center_baseline",
        fontsize=letters, fontweight="bold", color=style.ink, zorder=4.1,
    ).set_in_layout(False)  # fmt: skip
