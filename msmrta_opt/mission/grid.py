"""The grid world: free cells, walking distances, and the cells of a walk.

Moves are 4-connected and cost 1. A cell is ``(row, col)``, 0-based from the upper left. Distances come
from one breadth-first search per source, as far as it is needed, the cells of walks from A* (`search`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Bools, Floats, Int32s
from .counting import rows_by_columns
from .errors import InputError
from .frame import Frame
from .search import Cell as Cell
from .search import Cells, Search, graph, search

if TYPE_CHECKING:
    import networkx as nx

UNREACHABLE = float("inf")
"""The distance between cells that no walk joins."""
AT_ONCE = 128
"""Searches between which Ctrl-C is heeded: compiled code does not look."""


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
    frame : Frame, optional
        Where the cells lie in the world, in metres.
    """

    free: Bools
    name: str = ""
    source: Path | None = field(default=None, repr=False)
    frame: Frame | None = None

    def __post_init__(self) -> None:
        free = np.array(self.free, dtype=bool)
        if free.ndim != 2 or 0 in free.shape:
            raise InputError(f"a map is a non-empty rectangle of cells, not shape {free.shape}")
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
        return (
            isinstance(other, GridMap)
            and self.frame == other.frame
            and bool(np.array_equal(self.free, other.free))
        )

    def __hash__(self) -> int:
        return hash((self.free.shape, self.free.tobytes()))

    def contains(self, cell: Cell) -> bool:
        """Whether `cell` lies on the map, free or blocked."""
        n_rows, n_cols = self.shape
        return 0 <= cell[0] < n_rows and 0 <= cell[1] < n_cols

    def is_free(self, cell: Cell) -> bool:
        """Whether `cell` lies on the map and is free."""
        return self.contains(cell) and bool(self.free[cell])

    def nearest_free(self, spot: tuple[float, float]) -> Cell | None:
        """The free cell nearest to `spot` as the crow flies; of equal ones the first, row by row.

        Parameters
        ----------
        spot : (row, col)
            A cell, or a point between centres of cells as `Frame.spot` has it. Distances are those to
            where robots stand.
        """
        if not self.free.any():
            return None
        stands = np.moveaxis(np.indices(self.shape, dtype=float), 0, -1).copy()
        if self.frame is not None and self.frame.off_centre:
            rows, cols, along, up = np.array(self.frame.off_centre).T
            moved = np.stack([-up, along], axis=-1) / self.frame.cell_size
            stands[rows.astype(int), cols.astype(int)] += moved
        # Rounded, so that equal distances stay equal.
        distances = ((stands[self.free] - spot) ** 2).sum(axis=1).round(9)
        row, col = np.argwhere(self.free)[distances.argmin()].tolist()
        return row, col

    def trouble(self, cell: Cell, spot: tuple[float, float] | None = None) -> str:
        """Where a cell lies that is not free, and which one near it, or `spot` in it, is, in words."""
        outside = f"outside the map of {rows_by_columns(self.shape)}"
        place = "in a wall" if self.contains(cell) else outside
        nearest = self.nearest_free(cell if spot is None else spot)
        if nearest is None:
            return place
        place += f"; the nearest free cell is {list(nearest)}"
        if self.frame is not None:
            x, y = self.frame.position(nearest)
            place += f", at x {x:g}, y {y:g}"
        return place

    def __reduce__(self) -> tuple[Any, ...]:
        # What has been worked out stays behind.
        return type(self), (self.free, self.name, self.source, self.frame)

    @cached_property
    def search(self) -> Search:
        """The engine that finds distances and walks."""
        return search(self.free)

    @cached_property
    def component(self) -> Int32s:
        """The connected component of each free cell, 1 and up, 0 if blocked, ``(n_rows, n_cols)``."""
        labels = self.search.components()
        labels.setflags(write=False)
        return labels

    @cached_property
    def graph(self) -> nx.Graph:
        """The free cells as a networkx graph: nodes are cells, edges are moves."""
        return graph(self.free)

    def walk(self, start: Cell, goal: Cell) -> list[Cell]:
        """The cells of a shortest walk from `start` to `goal`, both included, by A*.

        The heuristic is the Manhattan distance, as in the paper; see `walks` for many walks.

        Raises
        ------
        networkx.NetworkXNoPath
            If no walk joins the two.
        """
        import networkx as nx

        cells: list[Cell] = nx.astar_path(self.graph, start, goal, heuristic=manhattan, weight=None)
        return cells

    def walks(self, starts: Sequence[Cell], goals: Sequence[Cell]) -> list[list[Cell]]:
        """The cells of a shortest walk from each start to its goal, both included.

        What A* finds whose heuristic is the distance from the goal: of the next cells that are
        nearest to it, the first of up, down, left and right. A walk that there is not has no cells.
        """
        return self.search.walks(starts, goals)

    def fields(self, sources: Cells) -> Floats:
        """Walking distance in cells from each source to every cell.

        Returns
        -------
        float array, shape (n_sources, n_rows, n_cols)
            `UNREACHABLE` where no walk leads, and everywhere for a blocked source.
        """
        return _distances(self.search.fields(sources))

    def between(self, sources: Cells, targets: Cells) -> Floats:
        """Walking distance in cells from each source to each target, ``(n_sources, n_targets)``."""
        return _distances(self.search.between(sources, targets))

    def lengths(self, starts: Cells, goals: Cells) -> Floats:
        """Walking distance in cells from each start to its goal, ``(n_walks,)``."""
        return _distances(self.search.lengths(starts, goals))

    def nearest(self, sources: Cells, targets: Cells) -> Int32s:
        """Position of the source that is nearest to each target, ``(n_targets,)``; negative if none.

        Ties go to the first.
        """
        return self.search.nearest(sources, targets)


def _distances(whole: Int32s) -> Floats:
    return np.where(whole < 0, UNREACHABLE, whole)


class DistanceTable:
    """Walking distances of one map, each worked out once and kept; whole fields are not.

    Parameters
    ----------
    grid : GridMap
        The map walked on.
    places : iterable of cells
        Cells to which distances are asked for again and again: from any cell, those to all of them
        come from one search.
    """

    def __init__(self, grid: GridMap, places: Iterable[Cell] = ()) -> None:
        self.grid = grid
        self._index = {cell: i for i, cell in enumerate(dict.fromkeys(places))}
        self._places = np.array(list(self._index), dtype=np.int64).reshape(-1, 2)
        self._rows: dict[Cell, Int32s] = {}
        self._pairs: dict[tuple[Cell, Cell], float] = {}

    def field(self, source: Cell) -> Floats:
        """Distance in cells from `source` to every cell, shape ``(n_rows, n_cols)``; it is not kept."""
        (field,) = self.grid.fields([source])
        return np.asarray(field)

    def __call__(self, a: Cell, b: Cell) -> float:
        """Walking distance from `a` to `b` in cells, `UNREACHABLE` if there is none."""
        return self.lengths([a], [b])[0]

    def lengths(self, starts: Sequence[Cell], goals: Sequence[Cell]) -> list[float]:
        """Walking distance in cells from each start to its goal."""
        found = [self._known(a, b) for a, b in zip(starts, goals, strict=True)]
        missing = [i for i, length in enumerate(found) if length is None]
        new = dict.fromkeys((starts[i], goals[i]) for i in missing)
        if new:
            lengths = self.grid.lengths([a for a, _ in new], [b for _, b in new])
            self._pairs.update(zip(new, lengths.tolist(), strict=True))
        return [
            self._pairs[starts[i], goals[i]] if length is None else length
            for i, length in enumerate(found)
        ]

    def between(self, sources: Sequence[Cell], targets: Sequence[Cell]) -> Floats:
        """Distances in cells, shape ``(len(sources), len(targets))``."""
        try:
            columns = np.array([self._index[cell] for cell in targets], dtype=np.int64)
        except KeyError:
            return self.grid.between(sources, targets)
        new = [cell for cell in dict.fromkeys(sources) if cell not in self._rows]
        for first in range(0, len(new), AT_ONCE):
            some = new[first : first + AT_ONCE]
            found = self.grid.search.between(some, self._places)
            self._rows.update(zip(some, found, strict=True))
        rows = [self._rows[cell][columns] for cell in sources]
        return _distances(np.array(rows, np.int32).reshape(len(sources), len(columns)))

    def _known(self, a: Cell, b: Cell) -> float | None:
        # Walking is symmetric, so a row from either end will do.
        for one, other in ((a, b), (b, a)):
            if one in self._rows and other in self._index:
                length = int(self._rows[one][self._index[other]])
                return UNREACHABLE if length < 0 else float(length)
        return self._pairs.get((a, b), self._pairs.get((b, a)))
