"""What is drawn on a map: marks on cells, walks over them, and labels where there is room.

What stands on one cell shares it: see `draw_stamps`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from ..mission.grid import Cell
from .canvas import Scale
from .figure import POINTS_PER_INCH
from .style import INK, RobotStyle

HALO = withStroke(linewidth=1.6, foreground="white")
Box = tuple[float, float, float, float]
"""A box on the map in cells: ``(row, col)`` of its centre, height, width."""
CASING = 0.7
"""Points by which a dark line stands out under a coloured one, so that pale colours read too."""


@dataclass(frozen=True)
class Stamp:
    """One mark on a cell, with a word inside; without a marker, the word in a rounded box."""

    cell: Cell
    face: str
    text: str = ""
    marker: str = ""
    ink: str = "white"
    edge: str = INK


def start_stamp(cell: Cell, robot: int, style: RobotStyle) -> Stamp:
    """The start of a robot."""
    return Stamp(cell, style.colour, f"R{robot}", ink=style.ink)


def visit_stamp(cell: Cell, number: int, style: RobotStyle, marker: str = "o") -> Stamp:
    """A visit by the robot of that style."""
    return Stamp(cell, style.colour, str(number), marker, ink=style.ink)


def draw_stamps(
    ax: Axes, stamps: Iterable[Stamp], captions: Mapping[Cell, str], scale: Scale
) -> list[Box]:
    """Draw marks on cells, those of one cell side by side below the cell's caption.

    Returns the boxes that they cover.
    """
    covered: list[Box] = []
    by_cell: dict[Cell, list[Stamp]] = {cell: [] for cell in captions}
    for stamp in stamps:
        by_cell.setdefault(stamp.cell, []).append(stamp)
    for cell, group in by_cell.items():
        caption = captions.get(cell, "")
        offsets = side_by_side(len(group), scale.mark * 1.08)
        if caption:
            offsets -= (0, 0.28 * scale.font + 0.05 * scale.mark)
            top = offsets[:, 1].max(initial=0) + 0.5 * scale.mark
            _write(ax, cell, caption, (0, top + 0.5 * scale.font), scale.font, INK, bold=True)
        for stamp, offset in zip(group, offsets, strict=True):
            _stamp(ax, stamp, offset, scale)
        across, down = np.ptp(offsets, axis=0) + scale.mark if group else (0.0, 0.0)
        height = (down + (scale.font if caption else 0)) / scale.cell
        covered.append((*cell, max(height, 1.0), max(across / scale.cell, 1.0)))
    return covered


def side_by_side(count: int, pitch: float) -> NDArray[np.float64]:
    """Offsets of `count` marks around a cell's centre, in points, shape ``(count, 2)``."""
    columns = max(int(np.ceil(np.sqrt(count))), min(count, 2))
    offsets = np.zeros((count, 2))
    n_lines = -(-count // columns) if count else 0
    for i in range(count):
        line, position = divmod(i, columns)
        in_line = min(columns, count - line * columns)
        offsets[i] = position - (in_line - 1) / 2, (n_lines - 1) / 2 - line
    return offsets * pitch


def _stamp(ax: Axes, stamp: Stamp, offset: NDArray[np.float64], scale: Scale) -> None:
    row, col = stamp.cell
    if not stamp.marker:
        _pill(ax, stamp, offset, scale)
        return
    dx, dy = offset / POINTS_PER_INCH
    shifted = ax.transData + ScaledTranslation(dx, dy, ax.figure.dpi_scale_trans)
    drawn_by_stroke = stamp.marker in ("x", "+")
    (mark,) = ax.plot(
        [col],
        [row],
        linestyle="",
        marker=stamp.marker,
        markersize=scale.mark * (0.75 if drawn_by_stroke else 1),
        markerfacecolor=stamp.face,
        markeredgecolor=stamp.face if drawn_by_stroke else stamp.edge,
        markeredgewidth=1.5 if drawn_by_stroke else 0.5,
        transform=shifted,
        zorder=6,
    )
    # Marks lie inside the axes: leaving them out spares the layout hundreds of measurements.
    mark.set_in_layout(False)
    if stamp.text:
        # The middle of a triangle lies off the middle of its box.
        lift = {"^": -0.1, "v": 0.1}.get(stamp.marker, 0.0) * scale.mark
        size = scale.mark * (0.68 if len(stamp.text) < 2 else 0.54)
        _write(ax, stamp.cell, stamp.text, (offset[0], offset[1] + lift), size, stamp.ink)


def _pill(ax: Axes, stamp: Stamp, offset: NDArray[np.float64], scale: Scale) -> None:
    row, col = stamp.cell
    text = ax.annotate(
        stamp.text,
        (col, row),
        xytext=(float(offset[0]), float(offset[1])),
        textcoords="offset points",
        ha="center",
        va="center_baseline",
        fontsize=scale.mark * 0.62,
        fontweight="bold",
        color=stamp.ink,
        bbox={"boxstyle": "round,pad=0.22", "fc": stamp.face, "ec": stamp.edge, "lw": 0.7},
        zorder=5.5,
    )
    text.set_in_layout(False)


def _write(
    ax: Axes,
    cell: tuple[float, float],
    text: str,
    offset: tuple[float, float],
    size: float,
    ink: str,
    *,
    bold: bool = False,
) -> None:
    row, col = cell
    artist = ax.annotate(
        text,
        (col, row),
        xytext=offset,
        textcoords="offset points",
        ha="center",
        va="center_baseline",
        fontsize=size,
        color=ink,
        fontweight="bold" if bold else "normal",
        path_effects=[HALO] if bold else [],
        zorder=7,
    )
    artist.set_in_layout(False)


def captions_of(cells: Mapping[int, Cell]) -> dict[Cell, str]:
    """What to write on the cells of victims, given by id: ``v3``, or ``v3,7`` for two on one."""
    on_cell: dict[Cell, list[int]] = {}
    for victim, cell in cells.items():
        on_cell.setdefault(cell, []).append(victim)
    return {cell: "v" + ",".join(map(str, victims)) for cell, victims in on_cell.items()}


# Walks


def lanes(count: int, scale: Scale) -> NDArray[np.float64]:
    """Sideways shifts, in cells, that keep `count` walks over the same cells apart."""
    step = min(0.6 / max(count - 1, 1), 2.2 * scale.line / scale.cell)
    return np.asarray((np.arange(count) - (count - 1) / 2) * step, dtype=np.float64)


def draw_walk(
    ax: Axes, cells: Sequence[Cell], shift: float, colour: str, line: Any, width: float
) -> None:
    """Draw a walk over `cells`, shifted down and right by `shift` cells."""
    if len(cells) < 2:
        return
    rows, cols = np.array(cells, dtype=float).T + shift
    ends: dict[str, Any] = {
        "solid_joinstyle": "round",
        "solid_capstyle": "round",
        "dash_capstyle": "butt",
    }
    ax.plot(cols, rows, color=INK, lw=width + CASING, ls=line, zorder=3, **ends)
    ax.plot(cols, rows, color=colour, lw=width, ls=line, zorder=3.1, **ends)


# Labels


def free_spot(
    near: tuple[float, float],
    size: tuple[float, float],
    taken: Sequence[Box],
    shape: tuple[int, int],
) -> tuple[float, float]:
    """Where a label covers least, and among such places the nearest to where it belongs.

    Parameters
    ----------
    near : (row, col)
        Where the label belongs, in cells.
    size : (height, width)
        Of the label, in cells.
    taken : sequence of Box
        Boxes that should stay visible.
    shape : (n_rows, n_cols)
        The map, which the label should not leave.

    Returns
    -------
    (row, col)
        The label's centre.
    """
    height, width = size
    reach = 2.0 + 2 * max(size)
    steps = np.linspace(-reach, reach, 81)
    rows, cols = (axis.ravel() for axis in np.meshgrid(near[0] + steps, near[1] + steps))
    cost = 1e-3 * np.hypot(rows - near[0], cols - near[1])
    for centres, extent, n in ((rows, height, shape[0]), (cols, width, shape[1])):
        outside = np.maximum(centres + extent / 2 - (n - 0.5), -0.5 - (centres - extent / 2))
        cost += 10 * np.maximum(outside, 0)
    for row, col, box_height, box_width in taken:
        overlap_rows = np.maximum((height + box_height) / 2 - np.abs(rows - row), 0)
        overlap_cols = np.maximum((width + box_width) / 2 - np.abs(cols - col), 0)
        cost += np.minimum(overlap_rows, height) * np.minimum(overlap_cols, width)
    best = int(cost.argmin())
    return float(rows[best]), float(cols[best])
