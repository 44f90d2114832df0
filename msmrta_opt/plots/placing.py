"""Where marks and names go so that none lies on another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Box = tuple[float, float, float, float]
"""A box on the map in cells: ``(row, col)`` of its centre, height, width."""
Floats = NDArray[np.float64]
ROUNDS = 400
"""The maximum number of times that boxes are pushed apart."""


def apart(
    centres: Floats,
    sizes: Floats,
    room: tuple[float, float],
    margin: tuple[float, float] = (0.0, 0.0),
) -> Floats:
    """Move boxes as little as a relaxation needs until none overlaps another.

    Two boxes that overlap are pushed along the axis on which they overlap less, half each, and all
    at once, until none do or `ROUNDS` have passed.

    Parameters
    ----------
    centres, sizes : float arrays, shape (n, 2)
        ``(row, col)`` and height and width of each box, in cells.
    room : (n_rows, n_cols)
        The map, which boxes do not leave if they fit in it.
    margin : (rows, cols)
        Cells that are shown beyond each edge of the map, and are room, too.

    Returns
    -------
    float array, shape (n, 2)
        The new centres.
    """
    moved, n = centres.astype(float), len(centres)
    low = np.minimum(sizes / 2 - 0.5 - np.array(margin), (np.array(room) - 1) / 2)
    high = np.array(room) - 1 - low
    order = np.sign(np.subtract.outer(np.arange(n), np.arange(n)))[..., None]
    for _ in range(ROUNDS):
        between = moved[:, None] - moved[None]
        overlap = (sizes[:, None] + sizes[None]) / 2 - np.abs(between)
        overlap[np.arange(n), np.arange(n)] = 0
        meet = np.all(overlap > 1e-9, axis=2)
        if not meet.any():
            break
        along = overlap.argmin(axis=2)[..., None] == np.arange(2)
        way = np.where(between == 0, order, np.sign(between))
        push = np.where(along & meet[..., None], way * (overlap + 0.02), 0).sum(axis=1)
        moved = np.clip(moved + 0.5 * push, low, high)
    return moved


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
    cost += covered(rows, cols, size, taken)
    best = int(cost.argmin())
    return float(rows[best]), float(cols[best])


def covered(rows: Floats, cols: Floats, size: tuple[float, float], taken: Sequence[Box]) -> Floats:
    """How much of the boxes `taken`, in cells of area, a box of `size` covers at each place."""
    height, width = size
    area = np.zeros(len(rows))
    for row, col, box_height, box_width in taken:
        overlap_rows = np.maximum((height + box_height) / 2 - np.abs(rows - row), 0)
        overlap_cols = np.maximum((width + box_width) / 2 - np.abs(cols - col), 0)
        area += np.minimum(overlap_rows, height) * np.minimum(overlap_cols, width)
    return area
