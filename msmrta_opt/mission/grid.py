"""The grid world: free cells, walking distances, and the cells of a walk.

Moves are 4-connected and cost 1. A cell is ``(row, col)``, 0-based from the upper left. Distances come
from one breadth-first field per source cell, in compiled code, each source computed once; the cells
of the legs that are really walked come from A* with the Manhattan heuristic (the path-planning line of
Algorithm 1) on a networkx graph.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import networkx as nx
    from scipy.sparse import csr_array

Cell = tuple[int, int]
"""``(row, col)``, 0-based from the upper left."""

UNREACHABLE = float("inf")
"""The distance between cells that no walk joins."""


def manhattan(a: Cell, b: Cell) -> int:
    """Distance in cells between `a` and `b` on a grid without walls."""
    return abs(a[0] - b[0]) + abs(a[1] - b[1])


@dataclass(frozen=True, eq=False)
class GridMap:
    """A rectangular map of free and blocked cells.

    Parameters
    ----------
    free : bool array, shape (n_rows, n_cols)
        Where a robot may stand. Copied, and read-only afterwards.
    name : str
        What to call the map in tables and pictures.
    source : Path, optional
        The file it was read from.
    """

    free: NDArray[np.bool_]
    name: str = ""
    source: Path | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        free = np.array(self.free, dtype=bool)
        if free.ndim != 2 or 0 in free.shape:
            raise ValueError(f"a map is a non-empty rectangle of cells, not shape {free.shape}")
        free.setflags(write=False)
        object.__setattr__(self, "free", free)

    @property
    def shape(self) -> tuple[int, int]:
        """``(n_rows, n_cols)``."""
        n_rows, n_cols = self.free.shape
        return n_rows, n_cols

    @cached_property
    def rows(self) -> tuple[str, ...]:
        """The map as text, one string per row: ``.`` free, ``@`` blocked."""
        return tuple("".join(row) for row in np.where(self.free, ".", "@").tolist())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, GridMap) and bool(np.array_equal(self.free, other.free))

    def __hash__(self) -> int:
        return hash((self.free.shape, self.free.tobytes()))

    def contains(self, cell: Cell) -> bool:
        """Whether `cell` lies on the map, free or blocked."""
        n_rows, n_cols = self.shape
        return 0 <= cell[0] < n_rows and 0 <= cell[1] < n_cols

    def is_free(self, cell: Cell) -> bool:
        """Whether `cell` lies on the map and is free."""
        return self.contains(cell) and bool(self.free[cell])

    @cached_property
    def adjacency(self) -> csr_array:
        """Neighbourhood of all cells, shape ``(n_rows * n_cols, n_rows * n_cols)``, row-major."""
        from scipy.sparse import csr_array

        n_rows, n_cols = self.shape
        index = np.arange(n_rows * n_cols).reshape(n_rows, n_cols)
        down = self.free[:-1] & self.free[1:]
        right = self.free[:, :-1] & self.free[:, 1:]
        a = np.concatenate([index[:-1][down], index[:, :-1][right]])
        b = np.concatenate([index[1:][down], index[:, 1:][right]])
        ends = (np.concatenate([a, b]), np.concatenate([b, a]))
        return csr_array((np.ones(2 * len(a)), ends), shape=(index.size, index.size))

    @cached_property
    def graph(self) -> nx.Graph:
        """The free cells as a networkx graph: nodes are cells, edges are moves."""
        import networkx as nx

        n_rows, n_cols = self.shape
        graph = nx.grid_2d_graph(n_rows, n_cols)
        graph.remove_nodes_from(map(tuple, np.argwhere(~self.free).tolist()))
        return graph

    def walk(self, start: Cell, goal: Cell) -> list[Cell]:
        """The cells of a shortest walk from `start` to `goal`, both included, by A*.

        Raises
        ------
        networkx.NetworkXNoPath
            If no walk joins the two.
        """
        import networkx as nx

        cells: list[Cell] = nx.astar_path(self.graph, start, goal, heuristic=manhattan, weight=None)
        return cells

    def fields(self, sources: Sequence[Cell]) -> NDArray[np.float64]:
        """Walking distance in cells from each source to every cell.

        Returns
        -------
        float array, shape (n_sources, n_rows, n_cols)
            `UNREACHABLE` where no walk leads, and everywhere for a blocked source.
        """
        from scipy.sparse.csgraph import dijkstra

        n_rows, n_cols = self.shape
        index = [row * n_cols + col for row, col in sources]
        if not index:
            return np.empty((0, n_rows, n_cols))
        # On unweighted edges this is a breadth-first search per source, in compiled code.
        found = dijkstra(self.adjacency, indices=index, unweighted=True)
        distances: NDArray[np.float64] = found.reshape(len(index), n_rows, n_cols)
        distances[:, ~self.free] = UNREACHABLE
        return distances


class DistanceTable:
    """Walking distances of one map, each source's field computed once and kept.

    Parameters
    ----------
    grid : GridMap
        The map walked on.
    sources : iterable of cells
        Cells whose fields are computed at once; others are added when first asked for.
    """

    def __init__(self, grid: GridMap, sources: Iterable[Cell] = ()) -> None:
        self.grid = grid
        self._fields: dict[Cell, NDArray[np.float64]] = {}
        self.add(sources)

    def add(self, sources: Iterable[Cell]) -> None:
        """Compute the fields of those `sources` that are not known yet, in one call."""
        new = [cell for cell in dict.fromkeys(sources) if cell not in self._fields]
        self._fields.update(zip(new, self.grid.fields(new), strict=True))

    def field(self, source: Cell) -> NDArray[np.float64]:
        """Distance in cells from `source` to every cell, shape ``(n_rows, n_cols)``."""
        if source not in self._fields:
            self.add([source])
        return self._fields[source]

    def __call__(self, a: Cell, b: Cell) -> float:
        """Walking distance from `a` to `b` in cells, `UNREACHABLE` if there is none."""
        # Walking is symmetric, so a field from either end will do.
        if a not in self._fields and b in self._fields:
            a, b = b, a
        return float(self.field(a)[b])

    def between(self, sources: Sequence[Cell], targets: Sequence[Cell]) -> NDArray[np.float64]:
        """Distances in cells, shape ``(len(sources), len(targets))``."""
        if not sources or not targets:
            return np.empty((len(sources), len(targets)))
        self.add(sources)
        rows, cols = np.array(targets).T
        return np.stack([self._fields[source][rows, cols] for source in sources])
