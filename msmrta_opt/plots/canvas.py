"""The map that everything is drawn on, and the sizes that suit it.

Sizes of marks and letters follow from how many points a cell gets, so that small maps are not
drowned and large ones stay legible.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.ticker import FixedLocator, MaxNLocator
from numpy.typing import NDArray

from ..mission.grid import GridMap
from ..mission.instance import Instance
from .figure import own_axes, size_of
from .lettering import as_written
from .style import FAINT, WALL, WALL_EDGE

LINE_INCHES = 0.16
"""Of a legend."""
SMALL_ROBOTS, SMALL_VICTIMS = 8, 40
"""Up to so many robots and victims, each has marks and names of its own."""
MAX_SIDE = 220
"""Cells a side up to which a cell of a map is at least two points wide on a page, so can be seen."""


def is_large(instance: Instance) -> bool:
    """Whether a mission is drawn as a whole, for its density, and not mark by mark."""
    n_rows, n_cols = instance.map.shape
    crowded = instance.n_victims > 0.25 * n_rows * n_cols + 8
    return (
        crowded
        or instance.n_robots > SMALL_ROBOTS
        or instance.n_victims > SMALL_VICTIMS
        or max(n_rows, n_cols) > MAX_SIDE
    )


def map_axes(instance: Instance, *, lines: int = 4) -> Axes:
    """Axes in a new figure that suits a mission's map, with room for a legend below."""
    width, height = panel_size(instance.map, 8.0 if is_large(instance) else 6.2)
    return own_axes(width + 0.6, height + 1.0 + LINE_INCHES * lines)


def panel_size(grid: GridMap, side: float = 5.6) -> tuple[float, float]:
    """Inches, ``(width, height)``, of axes that hold `grid`, the longer side `side` long."""
    n_rows, n_cols = grid.shape
    longest = max(n_rows, n_cols)
    # A strip of a map is not drawn thinner than titles and legends need.
    return max(side * n_cols / longest, 3.4), max(side * n_rows / longest, 1.2)


THINNEST = 40.0
"""Points across a map that is drawn with marks on it, at the minimum."""


@dataclass(frozen=True)
class Scale:
    """Sizes, in points, that suit a map in the axes it is drawn in."""

    cell: float
    """Side of a cell."""
    mark: float
    """Diameter of a victim's disc."""
    font: float
    """Letters in and beside marks."""
    line: float
    """Width of a walked line."""

    @classmethod
    def of(cls, ax: Axes, grid: GridMap) -> Scale:
        """The scale of `grid` drawn in `ax`."""
        width, height = size_of(ax)
        n_rows, n_cols = grid.shape
        cell = max(min(width / n_cols, height / n_rows), 0.1)
        return cls(
            cell=cell,
            mark=float(np.clip(0.75 * cell, 11.5, 15.0)),
            font=float(np.clip(0.45 * cell, 7.5, 9.0)),
            line=float(np.clip(0.14 * cell, 1.5, 2.4)),
        )

    def margin(self, shape: tuple[int, int]) -> tuple[float, float]:
        """Cells shown beyond the edges of a map, above and below, and on either side."""
        n_rows, n_cols = (max(THINNEST / self.cell - n, 0.0) / 2 for n in shape)
        return n_rows, n_cols


@as_written
def plot_map(grid: GridMap, ax: Axes | None = None) -> Axes:
    """Draw the walls of `grid`, row 0 on top.

    Parameters
    ----------
    grid : GridMap
        The map.
    ax : Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    Axes
        Column on x and row on y, in cells; the cell ``(row, col)`` is centred on ``(col, row)``.
    """
    if ax is None:
        width, height = panel_size(grid)
        ax = own_axes(width + 0.6, height + 1.0)
    n_rows, n_cols = grid.shape
    ax.imshow(
        ~grid.free, cmap=ListedColormap(["white", WALL]), vmin=0, vmax=1, interpolation="none"
    )
    if Scale.of(ax, grid).cell > 2:
        ax.add_collection(
            LineCollection(list(borders(grid.free)), colors=WALL_EDGE, linewidths=0.7, zorder=0.6),
            autolim=False,
        )
    frame_map(ax, grid)
    ax.set_xlabel("column (cells)", fontsize=8)
    ax.set_ylabel("row (cells)", fontsize=8)
    ax.tick_params(labelsize=7.5, length=2, color=FAINT)
    for axis, n in ((ax.xaxis, n_cols), (ax.yaxis, n_rows)):
        places = MaxNLocator(nbins=8, integer=True, min_n_ticks=1).tick_values(-0.5, n - 0.5)
        axis.set_major_locator(FixedLocator([place for place in places if 0 <= place < n]))
    ax.spines[:].set(color=WALL_EDGE, linewidth=0.8)
    ax.set_title(f"Map {grid.name}".rstrip(), fontsize=10)
    return ax


def frame_map(ax: Axes, grid: GridMap) -> None:
    """Show all of `grid`; around a corridor as much of the walls beside it as its marks need."""
    n_rows, n_cols = grid.shape
    down, across = Scale.of(ax, grid).margin(grid.shape)
    ax.set(
        xlim=(-0.5 - across, n_cols - 0.5 + across),
        ylim=(n_rows - 0.5 + down, -0.5 - down),
        aspect="equal",
        facecolor=WALL,
    )


def borders(mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """The borders between cells that are in `mask` and cells of the map that are not.

    Parameters
    ----------
    mask : bool array, shape (n_rows, n_cols)

    Returns
    -------
    float array, shape (n, 2, 2)
        Segments, each of two points ``(col, row)``, as long as they are straight.
    """
    across = _runs(mask[1:] != mask[:-1])
    down = _runs((mask[:, 1:] != mask[:, :-1]).T)[..., ::-1]
    return np.concatenate([across, down])


def _runs(steps: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Segments ``(along, between)`` of the runs of true entries in each row of `steps`."""
    edges = np.diff(np.pad(steps, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    (rows, first), (_, last) = np.nonzero(edges == 1), np.nonzero(edges == -1)
    between = rows + 0.5
    ends = [np.column_stack([along - 0.5, between]) for along in (first, last)]
    return np.stack(ends, axis=1)
