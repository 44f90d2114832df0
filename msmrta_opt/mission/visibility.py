"""What can be seen from a cell: the visual field of a scout, cut by walls.

The depth is the paper's VFD (visual field depth): a scout looks over the square of that depth
around its cell (Chebyshev distance), "adjusting to obstacles". The paper leaves open what an
obstacle hides. Here two free cells see each other iff the straight line between their centres

- enters the interior of no blocked cell, and
- does not squeeze between two blocked cells that touch at a corner.

A line that grazes the corner of a single wall passes. The relation is symmetric and decided in
integers, without rounding. Since sight thus passes only where walking does, every cell that is seen
can be walked to: what can be seen from anywhere in a connected area is that area itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .grid import Cell, GridMap


class FieldOfView:
    """The cells in sight of any cell of one map, at one depth.

    What the lines of sight cross is worked out once, for a quarter of the square; each look is then
    an array lookup. The table has ``2 * depth * (depth + 1)**2`` pairs of integers.

    Parameters
    ----------
    grid : GridMap
        The map.
    depth : int
        How far one sees in each direction, in cells; 0 shows the own cell alone.
    """

    def __init__(self, grid: GridMap, depth: int) -> None:
        self.grid = grid
        self.depth = min(depth, max(grid.shape) - 1)  # nothing lies further off on this map
        self._free = np.pad(grid.free, self.depth)  # walls all round, so that no look is clipped
        self._crossed = _crossed(self.depth)

    def __call__(self, cell: Cell) -> NDArray[np.bool_]:
        """Look around from `cell`: the free cells in sight, itself included.

        Parameters
        ----------
        cell : (row, col)
            A free cell.

        Returns
        -------
        bool array, shape (n_rows, n_cols)
        """
        depth, (n_rows, n_cols) = self.depth, self.grid.shape
        square = np.s_[cell[0] : cell[0] + 2 * depth + 1, cell[1] : cell[1] + 2 * depth + 1]
        outwards = (slice(depth, None), slice(depth, None, -1))
        seen = np.zeros_like(self._free)
        for rows in outwards:
            for cols in outwards:
                quarter = self._free[square][rows, cols]
                passes = np.any(quarter.ravel()[self._crossed], axis=2)
                seen[square][rows, cols] = np.all(passes, axis=1).reshape(quarter.shape)
        return seen[depth : depth + n_rows, depth : depth + n_cols]


def _crossed(depth: int) -> NDArray[np.intp]:
    """Tabulate what the lines from ``(0, 0)`` to each cell of a quarter square cross.

    Returns
    -------
    int array, shape ((depth + 1)**2, 2 * depth, 2)
        Per target, pairs of cells of which at least one must be free; cells are row-major indices
        into the quarter square. A line to ``(row, col)`` crosses ``col`` borders sideways and
        ``row`` downwards. Each crossing names the cell entered, twice; where both come together, in
        a corner, the one sideways names the cell entered and the one downwards the two cells beside
        the corner. The target fills up the list.
    """
    size = depth + 1
    row, col = (axis.reshape(-1, 1) for axis in np.indices((size, size)))
    target = row * size + col
    k = np.arange(depth)
    # Between columns k and k + 1 the line is (2k + 1) row / (2 col) below the centre of row 0;
    # adding ½ and rounding down gives the row it is in, or enters, there. Likewise between rows,
    # where no remainder means a corner.
    row_entered = ((2 * k + 1) * row + col) // np.maximum(2 * col, 1)
    col_entered, rest = np.divmod((2 * k + 1) * col + row, np.maximum(2 * row, 1))
    corner = rest == 0
    sideways = np.where(k < col, row_entered * size + k + 1, target)
    left = np.where(k < row, (k + 1) * size + col_entered - corner, target)
    right = np.where(k < row, (k + 1 - corner) * size + col_entered, target)
    return np.stack([np.hstack([sideways, left]), np.hstack([sideways, right])], axis=2)
