"""How far cells are apart, and which are joined at all: by flood fill, for the checks alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain

import numpy as np

from ..arrays import Ints
from ..mission.grid import Cell, GridMap


def steps_from(grid: GridMap, start: Cell, up_to: float = math.inf) -> dict[Cell, int]:
    """Moves from `start` to each cell that can be reached in no more than `up_to`."""
    free = grid.free.tolist()
    n_rows, n_cols = grid.shape
    steps = {start: 0}
    border = [start]
    while border and steps[border[0]] < up_to:
        onward = []
        for row, col in border:
            for cell in ((row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)):
                inside = 0 <= cell[0] < n_rows and 0 <= cell[1] < n_cols
                if inside and free[cell[0]][cell[1]] and cell not in steps:
                    steps[cell] = steps[row, col] + 1
                    onward.append(cell)
        border = onward
    return steps


def are_legal(grid: GridMap, walks: Sequence[Sequence[Cell]]) -> bool:
    """Whether all cells of `walks` are free, and each is one move from the next."""
    lengths = [len(walk) for walk in walks]
    try:
        flat = chain.from_iterable(chain.from_iterable(walks))
        cells = np.fromiter(flat, np.int64, 2 * sum(lengths)).reshape(-1, 2)
    except OverflowError:  # a number that is on no map
        return False
    if not len(cells):
        return True
    rows, cols = cells.T
    n_rows, n_cols = grid.shape
    if cells.min() < 0 or rows.max() >= n_rows or cols.max() >= n_cols:
        return False
    moves = np.abs(np.diff(cells, axis=0)).sum(axis=1)
    between = np.cumsum(lengths)[:-1] - 1  # from the end of a walk to the start of the next
    moves[between[(between >= 0) & (between < len(moves))]] = 1
    return bool(grid.free[rows, cols].all() and (moves == 1).all())


def components(grid: GridMap) -> Ints:
    """The number of each cell's connected component, from 1 on, and 0 in walls, ``(n_rows, n_cols)``."""
    walled = np.pad(grid.free, 1)
    width = walled.shape[1]
    label = (walled.astype(np.int64) - 1).ravel().tolist()  # 0 where it is open, -1 in walls
    n = 0
    for first in np.flatnonzero(walled).tolist():
        if label[first]:
            continue
        n += 1
        label[first] = n
        border = [first]
        while border:
            here = border.pop()
            for cell in (here + 1, here - 1, here + width, here - width):
                if label[cell] == 0:
                    label[cell] = n
                    border.append(cell)
    inside = np.array(label).reshape(walled.shape)[1:-1, 1:-1]
    return np.asarray(np.maximum(inside, 0))
