"""How far cells are apart, and which are joined at all: for the checks alone."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

import numpy as np

from ..arrays import Bools, Ints
from ..mission.grid import Cell, GridMap


def steps_from(grid: GridMap, start: Cell) -> dict[Cell, int]:
    """Moves from `start` to each cell that can be reached."""
    free = grid.free.tolist()
    n_rows, n_cols = grid.shape
    steps = {start: 0}
    border = [start]
    while border:
        onward = []
        for row, col in border:
            for cell in ((row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)):
                inside = 0 <= cell[0] < n_rows and 0 <= cell[1] < n_cols
                if inside and free[cell[0]][cell[1]] and cell not in steps:
                    steps[cell] = steps[row, col] + 1
                    onward.append(cell)
        border = onward
    return steps


class StraightWalks:
    """Which cells of a map are joined by a walk that is as short as without walls.

    Such a walk makes moves in no more than two directions. So it is looked for row by row, where a row
    of cells is the bits of a number, and to add the cells where it may begin to those that are free
    carries along all that are free in a run from there.
    """

    def __init__(self, grid: GridMap) -> None:
        self._n_cols = grid.shape[1]
        self._rows = {sign: _bits(grid.free[:, ::sign]) for sign in (1, -1)}

    def from_cell(self, start: Cell, goals: Iterable[Cell]) -> set[Cell]:
        """Those of `goals` to which such a walk leads from `start`."""
        ways: dict[tuple[int, int], list[Cell]] = {}
        for row, col in goals:
            way = (1 if row >= start[0] else -1, 1 if col >= start[1] else -1)
            ways.setdefault(way, []).append((row, col))
        return {cell for way, cells in ways.items() for cell in self._along(start, way, cells)}

    def _along(self, start: Cell, way: tuple[int, int], goals: list[Cell]) -> Iterator[Cell]:
        down, right = way
        free, at = self._rows[right], self._n_cols - 1 if right < 0 else 0
        here = 1 << abs(at - start[1])
        last, joined = max(goals, key=lambda cell: abs(cell[0] - start[0]))[0], {}
        for row in range(start[0], last + down, down):
            here &= free[row]
            here = (((free[row] + here) ^ free[row]) | here) & free[row]
            joined[row] = here
        for cell in goals:
            if joined[cell[0]] >> abs(at - cell[1]) & 1:
                yield cell


def _bits(free: Bools) -> list[int]:
    """The rows of a table, its first column the lowest bit."""
    packed = np.packbits(free, axis=1, bitorder="little")
    return [int.from_bytes(row.tobytes(), "little") for row in packed]


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
    width = n_cols + 1  # so that the end of a row is not beside the start of the next
    moves = np.abs(np.diff(rows * width + cols))
    between = np.cumsum(lengths)[:-1] - 1  # from the end of a walk to the start of the next
    moves[between[(between >= 0) & (between < len(moves))]] = 1
    return bool(grid.free[rows, cols].all() and ((moves == 1) | (moves == width)).all())


def components(grid: GridMap) -> Ints:
    """The number of each cell's connected component, from 1 on, and 0 in walls, ``(n_rows, n_cols)``.

    Free cells beside each other in a row are a run. Runs that touch take the number of the lower one,
    again and again, until all that touch have the same.
    """
    free = grid.free
    begins = free.copy()
    begins[:, 1:] &= ~free[:, :-1]
    run = np.cumsum(begins).reshape(free.shape)
    touch = free[1:] & free[:-1]
    touch[:, 1:] &= begins[1:, 1:] | begins[:-1, 1:]  # once is enough
    above, below = run[:-1][touch], run[1:][touch]
    label = np.arange(run[-1, -1] + 1)
    while (apart := label[above] != label[below]).any():
        above, below = above[apart], below[apart]
        pair = label[above], label[below]
        np.minimum.at(label, np.maximum(*pair), np.minimum(*pair))
        while (label[label] != label).any():
            label = label[label]
    _, number = np.unique(label, return_inverse=True)  # what stands before the first run is 0
    return np.asarray(np.where(free, number[run], 0))
