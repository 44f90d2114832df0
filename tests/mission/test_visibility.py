from __future__ import annotations

from fractions import Fraction
from itertools import pairwise, product
from math import floor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples

from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.visibility import FieldOfView

HALF = Fraction(1, 2)


def view(rows: list[str], cell: Cell, depth: int) -> list[str]:
    """The map with the cells in sight marked by x."""
    seen = FieldOfView(grid_from_rows(rows), depth)(cell)
    return [
        "".join("x" if seen[i, j] else char for j, char in enumerate(row))
        for i, row in enumerate(rows)
    ]


def line_is_clear(free: list[list[bool]], a: Cell, b: Cell) -> bool:
    """The definition, by following the line from border to border in exact fractions."""

    def at(t: Fraction) -> tuple[Fraction, Fraction]:
        return a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])

    def cell_at(t: Fraction) -> Cell:
        row, col = at(t)
        return floor(row + HALF), floor(col + HALF)

    borders = {Fraction(0), Fraction(1)}
    for start, end in zip(a, b, strict=True):
        for line in range(min(start, end), max(start, end)):
            borders.add((line + HALF - start) / Fraction(end - start))
    times = sorted(borders)
    inside = [cell_at((t + u) / 2) for t, u in pairwise(times)]
    if not all(free[row][col] for row, col in (*inside, b)):
        return False
    for (r, c), (s, d) in pairwise(inside):
        if r != s and c != d and not free[r][d] and not free[s][c]:
            return False
    return True


def oracle(grid: GridMap, cell: Cell, depth: int) -> list[list[bool]]:
    free = grid.free.tolist()
    n_rows, n_cols = grid.shape
    return [
        [
            max(abs(row - cell[0]), abs(col - cell[1])) <= depth
            and line_is_clear(free, cell, (row, col))
            for col in range(n_cols)
        ]
        for row in range(n_rows)
    ]


@st.composite
def maps(draw: st.DrawFn, largest: int = 7) -> GridMap:
    n_rows, n_cols = draw(st.integers(1, largest)), draw(st.integers(1, largest))
    # More free cells than walls, so that there are long lines of sight to cut.
    walls = st.sampled_from([True, True, True, False])
    row = st.lists(walls, min_size=n_cols, max_size=n_cols)
    free = np.array(draw(st.lists(row, min_size=n_rows, max_size=n_rows)))
    free[0, 0] = True
    return GridMap(free)


def test_depth_zero_shows_the_own_cell_alone() -> None:
    assert view(["...", "...", "..."], (1, 1), 0) == ["...", ".x.", "..."]


def test_an_open_field_is_the_square_of_that_depth() -> None:
    rows = ["....."] * 5
    assert view(rows, (2, 2), 1) == [".....", ".xxx.", ".xxx.", ".xxx.", "....."]
    assert view(rows, (0, 0), 2) == ["xxx..", "xxx..", "xxx..", ".....", "....."]
    assert view(rows, (4, 1), 3) == [".....", "xxxxx", "xxxxx", "xxxxx", "xxxxx"]


def test_a_wall_hides_what_lies_straight_behind_it() -> None:
    assert view(["..@.."], (0, 0), 4) == ["xx@.."]
    assert view([".", ".", "@", "."], (3, 0), 3) == [".", ".", "@", "x"]


def test_a_pillar_hides_what_its_interior_shadows() -> None:
    rows = ["...", ".@.", "..."]
    assert view(rows, (0, 0), 2) == ["xxx", "x@.", "x.."]
    assert view(rows, (0, 1), 2) == ["xxx", "x@x", "..."]


def test_sight_grazes_the_corner_of_a_single_wall() -> None:
    assert view([".@", ".."], (0, 0), 1) == ["x@", "xx"]
    assert view(["..", "@."], (0, 0), 1) == ["xx", "@x"]


def test_sight_does_not_squeeze_between_walls_that_touch_at_a_corner() -> None:
    assert view([".@", "@."], (0, 0), 1) == ["x@", "@."]
    # The line from (0, 0) to (2, 2) meets the touching walls at its second corner only.
    assert view(["...", "..@", ".@."], (0, 0), 2) == ["xxx", "xx@", "x@."]


def test_a_door_shows_the_part_of_the_room_behind_it() -> None:
    rows = [".....", ".....", "@@.@@", ".....", "....."]
    # Even the line to (0, 1) leaves column 2 half-way, at row 2, into the wall (2, 1).
    assert view(rows, (4, 2), 4) == ["..x..", "..x..", "@@x@@", "xxxxx", "xxxxx"]
    # From (3, 2), the line to (0, 1) leaves column 2 half-way, at row 1.5: it grazes the corner of
    # the wall (2, 1). The line to (1, 1) leaves it at row 2, and the one to (0, 0) at row 2.25.
    assert view(rows, (3, 2), 4) == [".xxx.", "..x..", "@@x@@", "xxxxx", "xxxxx"]


def test_a_depth_beyond_the_map_shows_what_the_map_has() -> None:
    rows = ["..@", "..."]
    assert view(rows, (1, 0), 10**9) == view(rows, (1, 0), 2) == ["xx@", "xxx"]


@pytest.mark.parametrize("depth", [1, 2])
def test_every_map_of_three_by_three_cells_agrees_with_following_each_line(depth: int) -> None:
    for bits in product([False, True], repeat=9):
        grid = GridMap(np.array(bits).reshape(3, 3))
        look = FieldOfView(grid, depth)
        for row, col in np.argwhere(grid.free).tolist():
            assert look((row, col)).tolist() == oracle(grid, (row, col), depth)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(maps(), st.integers(0, 8))
def test_sight_agrees_with_following_each_line(grid: GridMap, depth: int) -> None:
    look = FieldOfView(grid, depth)
    for row, col in np.argwhere(grid.free).tolist()[::3]:
        assert look((row, col)).tolist() == oracle(grid, (row, col), depth)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(maps(largest=9), st.integers(0, 9))
def test_sight_is_symmetric_and_passes_only_where_walking_does(grid: GridMap, depth: int) -> None:
    look = FieldOfView(grid, depth)
    cells = [(row, col) for row, col in np.argwhere(grid.free).tolist()]
    views = {cell: look(cell) for cell in cells}
    within_reach = np.isfinite(grid.fields(cells))
    for cell, reachable in zip(cells, within_reach, strict=True):
        assert not np.any(views[cell] & ~reachable)
        assert all(views[cell][other] == views[other][cell] for other in cells)
