"""Random maps, and their cells."""

from __future__ import annotations

from itertools import product

from hypothesis import strategies as st

from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.maps import grid_from_rows


@st.composite
def grids(draw: st.DrawFn, maximum: int = 5) -> GridMap:
    """Random maps of up to `maximum` rows and columns, of which walls may leave no free cell."""
    n_rows, n_cols = draw(st.integers(1, maximum)), draw(st.integers(1, maximum))
    row = st.text(".@", min_size=n_cols, max_size=n_cols)
    return grid_from_rows(draw(st.lists(row, min_size=n_rows, max_size=n_rows)))


def cells_of(grid: GridMap) -> list[Cell]:
    return list(product(*map(range, grid.shape)))


def free_cells(grid: GridMap) -> list[Cell]:
    return [(row, col) for row, col in cells_of(grid) if grid.rows[row][col] == "."]
