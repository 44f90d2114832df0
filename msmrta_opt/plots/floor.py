"""A floor in pixels, and the cells that were made of it, side by side."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from ..mission.coarsening import Coarsening
from ..mission.counting import rows_by_columns
from .figure import Picture
from .lettering import as_written

FREE, OCCUPIED, UNKNOWN, TIGHT, LEFT_OUT = "#ffffff", "#3b4252", "#c9ced8", "#f2d9a6", "#e0a493"
PIXELS = 1200
"""Along the longer side of a panel; of a larger image every so-many-th pixel is drawn."""


@as_written
def plot_floor(made: Coarsening) -> Figure:
    """Draw what was read, and the cells that robots can use.

    Parameters
    ----------
    made : Coarsening
        A floor, and what became of it.

    Returns
    -------
    Figure
        Not known to pyplot; `save_figure` writes it, a notebook shows it.
    """
    floor = made.floor
    n_rows, n_cols = floor.state.shape
    height = float(np.clip(5.5 * n_rows / n_cols, 2.0, 8.0))
    figure = Picture(figsize=(12, height + 1.5), layout="constrained")
    left, right = figure.subplots(1, 2)
    side = floor.resolution
    step = max(1, -(-max(n_rows, n_cols) // PIXELS))
    before = floor.state.copy()
    before[(before == 0) & ~made.fits] = 3
    left.imshow(
        before[::step, ::step],
        cmap=ListedColormap([FREE, OCCUPIED, UNKNOWN, TIGHT]),
        vmin=-0.5,
        vmax=3.5,
        interpolation="nearest",
        extent=(0, n_cols * side, 0, n_rows * side),
    )
    left.set_title(f"{rows_by_columns((n_rows, n_cols))}: pixels of {side:g} m")
    _draw_cells(made, right)
    for panel in (left, right):
        panel.set_xlabel("metres from the lower left corner")
        panel.set_aspect("equal")
    names = {
        "free": FREE,
        "too near to a wall": TIGHT,
        "occupied or blocked": OCCUPIED,
        "unknown": UNKNOWN,
        "fits, but in no free cell": LEFT_OUT,
    }
    handles = [
        left.plot([], [], "s", color=c, mec="#3b4252", mew=0.5, ms=9)[0] for c in names.values()
    ]
    figure.legend(handles, list(names), loc="outside lower center", ncols=5, frameon=False)
    return figure


def _draw_cells(made: Coarsening, ax: Axes) -> None:
    grid = made.grid
    assert grid.frame is not None
    side = grid.frame.cell_size
    n_rows, n_cols = grid.shape
    state = np.where(grid.free, 0, 1)
    state[~grid.free & made.fits_somewhere] = 2
    ax.imshow(
        state,
        cmap=ListedColormap([FREE, OCCUPIED, LEFT_OUT]),
        vmin=-0.5,
        vmax=2.5,
        interpolation="nearest",
        extent=(0, n_cols * side, 0, n_rows * side),
    )
    if max(n_rows, n_cols) <= 100:
        ax.vlines(np.arange(n_cols + 1) * side, 0, n_rows * side, color="#e5e9f0", lw=0.5)
        ax.hlines(np.arange(n_rows + 1) * side, 0, n_cols * side, color="#e5e9f0", lw=0.5)
    ax.set_title(f"{rows_by_columns(grid.shape)}: cells of {side:g} m, {int(grid.free.sum())} free")
