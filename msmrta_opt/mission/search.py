"""Distances, walks and components of a map: by compiled searches, or without numba by scipy.

Both engines give the same. Distances are whole numbers of moves, negative where no walk leads.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import Bools, Int32s, Ints

if TYPE_CHECKING:
    import networkx as nx
    from scipy.sparse import csr_array

Cell = tuple[int, int]
"""``(row, col)``, 0-based from the upper left."""
Cells = Sequence[Cell] | Ints
"""Several, or an array of shape ``(n, 2)``."""

NONE = -1
"""The distance between cells that no walk joins."""
CHUNK = 1 << 23
"""Cells of the fields that scipy works out at a time."""


class Search(Protocol):
    """What an engine does for one map."""

    def fields(self, sources: Cells) -> Int32s:
        """Distances of each source from every cell, ``(n_sources, n_rows, n_cols)``."""

    def between(self, sources: Cells, targets: Cells) -> Int32s:
        """Distances of each source from each target, ``(n_sources, n_targets)``."""

    def lengths(self, starts: Cells, goals: Cells) -> Int32s:
        """Distance of each start from its goal, ``(n_walks,)``."""

    def nearest(self, sources: Cells, targets: Cells) -> Int32s:
        """Which source is nearest to each target, the first of several, ``(n_targets,)``."""

    def walks(self, starts: Cells, goals: Cells) -> list[list[Cell]]:
        """The cells of a shortest walk from each start to its goal, none where there is none.

        Of several next cells that are nearest to the goal the first is taken: up, down, left, right.
        """

    def components(self) -> Int32s:
        """The connected component of each free cell, by first cells from 1 on, ``(n_rows, n_cols)``."""


def search(free: Bools, *, compiled: bool = True) -> Search:
    """The engine for a map, given where it is free: compiled, if asked for and numba is there."""
    try:
        return _Compiled(free) if compiled else _WithoutNumba(free)
    except ImportError:
        return _WithoutNumba(free)


class _Compiled:
    """The functions of `breadth_first` and `a_star`, whose arrays have a blocked border."""

    def __init__(self, free: Bools) -> None:
        from . import a_star, breadth_first

        self.kernels, self.walker = breadth_first, a_star
        self.n_rows, n_cols = free.shape
        self.width = n_cols + 1
        flat = np.full((self.n_rows + 2) * self.width + 1, breadth_first.BLOCKED, np.int32)
        flat[-1] = breadth_first.UNSEEN
        self.inside(flat)[free] = breadth_first.UNSEEN
        self.cells = flat

    def inside(self, flat: Int32s) -> Int32s:
        """The map without its border in arrays of the kernels, ``(..., n_rows, n_cols)``."""
        bordered = flat[..., :-1].reshape(*flat.shape[:-1], self.n_rows + 2, self.width)
        return bordered[..., 1:-1, :-1]

    def index(self, cells: Cells) -> Ints:
        """Of each cell in those arrays."""
        rows, cols = _places(cells).T
        index: Ints = (rows + 1) * self.width + cols
        return index

    def fields(self, sources: Cells) -> Int32s:
        return self.inside(self.kernels.fields(self.cells, self.width, self.index(sources)))

    def between(self, sources: Cells, targets: Cells) -> Int32s:
        ends = self.index(sources), self.index(targets)
        return self.kernels.between(self.cells, self.width, *ends)

    def lengths(self, starts: Cells, goals: Cells) -> Int32s:
        return self.walker.lengths(self.cells, self.width, self.index(starts), self.index(goals))

    def nearest(self, sources: Cells, targets: Cells) -> Int32s:
        ends = self.index(sources), self.index(targets)
        return self.kernels.nearest(self.cells, self.width, *ends)

    def walks(self, starts: Cells, goals: Cells) -> list[list[Cell]]:
        ends = self.index(starts), self.index(goals)
        walked, last = self.walker.walks(self.cells, self.width, *ends)
        is_used = np.zeros(len(self.cells), bool)
        is_used[walked] = True
        used = np.flatnonzero(is_used)
        rows, cols = np.divmod(used, self.width)
        pairs = zip((rows - 1).tolist(), cols.tolist(), strict=True)
        # A cell is one object, however many walks lead over it.
        cell = np.empty(len(self.cells), object)
        cell[used] = np.fromiter(pairs, object, len(used))
        cells = cell[walked].tolist()
        bounds = [0, *last.tolist()]
        return [cells[a:b] for a, b in pairwise(bounds)]

    def components(self) -> Int32s:
        return self.inside(self.kernels.components(self.cells, self.width))


class _WithoutNumba:
    """Scipy's shortest paths and labels; walks by networkx' A*, each with the field of its goal."""

    def __init__(self, free: Bools) -> None:
        self.free = free

    @cached_property
    def adjacency(self) -> csr_array:
        """Neighbourhood of all cells, row by row, ``(n_rows * n_cols, n_rows * n_cols)``."""
        from scipy.sparse import csr_array

        index = np.arange(self.free.size).reshape(self.free.shape)
        down = self.free[:-1] & self.free[1:]
        right = self.free[:, :-1] & self.free[:, 1:]
        a = np.concatenate([index[:-1][down], index[:, :-1][right]])
        b = np.concatenate([index[1:][down], index[:, 1:][right]])
        ends = (np.concatenate([a, b]), np.concatenate([b, a]))
        return csr_array((np.ones(2 * len(a)), ends), shape=(index.size, index.size))

    def fields(self, sources: Cells) -> Int32s:
        from scipy.sparse.csgraph import dijkstra

        places = _places(sources)
        if not len(places):
            return np.empty((0, *self.free.shape), np.int32)
        index = places[:, 0] * self.free.shape[1] + places[:, 1]
        found: NDArray[np.float64] = dijkstra(self.adjacency, indices=index, unweighted=True)
        whole = np.where(np.isfinite(found), found, NONE).astype(np.int32)
        whole[~self.free.ravel()[index]] = NONE
        return whole.reshape(len(places), *self.free.shape)

    def between(self, sources: Cells, targets: Cells) -> Int32s:
        places = _places(sources)
        rows, cols = _places(targets).T
        found = np.empty((len(places), len(rows)), np.int32)
        step = max(CHUNK // self.free.size, 1)
        for i in range(0, len(places), step):
            found[i : i + step] = self.fields(places[i : i + step])[:, rows, cols]
        return found

    def lengths(self, starts: Cells, goals: Cells) -> Int32s:
        found = [
            self.between([start], [goal for _, goal in group])[0]
            for start, group in groupby(_pairs(starts, goals), key=lambda pair: pair[0])
        ]
        return np.concatenate([np.empty(0, np.int32), *found])

    def nearest(self, sources: Cells, targets: Cells) -> Int32s:
        found = self.between(sources, targets)
        if not len(found):
            return np.full(found.shape[1], NONE, np.int32)
        first = np.where(found < 0, np.iinfo(np.int32).max, found).argmin(axis=0).astype(np.int32)
        return np.where((found < 0).all(axis=0), np.int32(NONE), first)

    def walks(self, starts: Cells, goals: Cells) -> list[list[Cell]]:
        found = []
        for goal, group in groupby(_pairs(starts, goals), key=lambda pair: pair[1]):
            field = self.fields([goal])[0]
            found += [a_star(self.graph, start, goal, field) for start, _ in group]
        return found

    def components(self) -> Int32s:
        from scipy.ndimage import label

        labels: Int32s = label(self.free)[0]
        return labels

    @cached_property
    def graph(self) -> nx.Graph:
        """The free cells and the moves between them; a cell's neighbours: up, down, left, right."""
        return graph(self.free)


def graph(free: Bools) -> nx.Graph:
    """The free cells of a map as a networkx graph; a cell's neighbours: up, down, left, right."""
    import networkx as nx

    made = nx.grid_2d_graph(*free.shape)
    made.remove_nodes_from(map(tuple, np.argwhere(~free).tolist()))
    return made


def a_star(on: nx.Graph, start: Cell, goal: Cell, field: Int32s) -> list[Cell]:
    """A shortest walk by A*, whose heuristic is the `field` of distances from the goal.

    The heuristic is slightly more than those distances, so that the search goes straight to the goal,
    down the distances, and opens no other cell; what it finds is a shortest walk all the same.
    """
    import networkx as nx

    if field[start] < 0:
        return []
    more = 1 + 1e-6
    walk: list[Cell] = nx.astar_path(
        on, start, goal, heuristic=lambda cell, _: more * int(field[cell]), weight=None
    )
    return walk


def _pairs(starts: Cells, goals: Cells) -> list[tuple[Cell, Cell]]:
    ends = (_places(cells).tolist() for cells in (starts, goals))
    return [((a, b), (c, d)) for (a, b), (c, d) in zip(*ends, strict=True)]


def _places(cells: Cells) -> Ints:
    return np.asarray(cells, dtype=np.int64).reshape(-1, 2)
