"""The map that everything is drawn on, and the sizes that suit it.

Sizes of marks and letters follow from how many points a cell gets, so that small maps are not
drowned and large ones stay legible.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.ticker import MaxNLocator

from ..mission.grid import GridMap
from .figure import own_axes, size_of
from .lettering import as_written
from .style import WALL

LINE_INCHES = 0.16
"""Of a legend."""


def map_axes(grid: GridMap, *, crowded: bool = False, lines: int = 4) -> Axes:
    """Axes in a new figure that suits `grid`, with room for a legend of so many lines below."""
    width, height = panel_size(grid, crowded=crowded)
    return own_axes(width + 0.6, height + 1.0 + LINE_INCHES * lines)


def panel_size(grid: GridMap, *, crowded: bool = False) -> tuple[float, float]:
    """Inches, ``(width, height)``, in which `grid` is legible."""
    n_rows, n_cols = grid.shape
    longest = max(n_rows, n_cols)
    side = float(np.clip(0.25 * longest, 6.0 if crowded else 4.8, 7.0))
    # A strip of a map is not drawn thinner than titles and legends need.
    return max(side * n_cols / longest, 3.4), max(side * n_rows / longest, 1.2)


@dataclass(frozen=True)
class Scale:
    """Sizes, in points, that suit a map in the axes it is drawn in."""

    cell: float
    """Side of a cell."""
    mark: float
    """Diameter of a mark."""
    font: float
    """Letters beside marks."""
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
            mark=float(np.clip(0.48 * cell, 6.5, 10.0)),
            font=float(np.clip(0.36 * cell, 5.0, 7.5)),
            line=float(np.clip(0.09 * cell, 0.9, 1.8)),
        )


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
    ax = map_axes(grid) if ax is None else ax
    n_rows, n_cols = grid.shape
    ax.imshow(
        ~grid.free, cmap=ListedColormap(["white", WALL]), vmin=0, vmax=1, interpolation="none"
    )
    if Scale.of(ax, grid).cell > 6:
        for edges, lines in ((np.arange(1, n_rows), ax.hlines), (np.arange(1, n_cols), ax.vlines)):
            far = (n_cols if lines == ax.hlines else n_rows) - 0.5
            lines(edges - 0.5, -0.5, far, colors="#E9E9E9", linewidths=0.4, zorder=0.5)
    ax.set(xlim=(-0.5, n_cols - 0.5), ylim=(n_rows - 0.5, -0.5), aspect="equal")
    ax.set_xlabel("column (cells)", fontsize=8)
    ax.set_ylabel("row (cells)", fontsize=8)
    ax.tick_params(labelsize=7)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(nbins=10, integer=True, min_n_ticks=1))
    ax.set_title(f"Map {grid.name}".rstrip(), fontsize=10)
    return ax
