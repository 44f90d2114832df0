"""Walks as short as without walls, and connected components, against flood fill."""

from __future__ import annotations

import numpy as np
import pytest

from msmrta_opt.certify.walking import StraightWalks, are_legal, components, steps_from
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.maps import grid_from_rows


def test_a_wall_in_the_way_takes_moves_off_the_straight() -> None:
    grid = grid_from_rows(["..@", ".@.", "..."])
    found = StraightWalks(grid).from_cell((0, 1), [(0, 1), (1, 0), (2, 0), (2, 2), (1, 2)])
    assert found == {(0, 1), (1, 0), (2, 0)}


@pytest.mark.parametrize("seed", range(12))
def test_straight_walks_are_those_whose_steps_are_no_more_than_without_walls(seed: int) -> None:
    random = np.random.default_rng(seed)
    grid = GridMap(random.random(random.integers(1, 13, 2)) < 0.75)
    free = [(int(row), int(col)) for row, col in np.argwhere(grid.free)]
    straight = StraightWalks(grid)
    for start in free[::5]:
        steps = steps_from(grid, start)
        near = {c for c in free if steps.get(c) == abs(c[0] - start[0]) + abs(c[1] - start[1])}
        assert straight.from_cell(start, free) == near


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.7, 1.0])
def test_cells_have_one_number_if_flood_fill_joins_them_from_1_on_by_first_cells(
    share: float,
) -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        grid = GridMap(random.random(random.integers(1, 20, 2)) < share)
        expected, n = np.zeros(grid.shape, np.int64), 0
        for row, col in np.argwhere(grid.free).tolist():
            if not expected[row, col]:
                n += 1
                expected[tuple(zip(*steps_from(grid, (row, col)), strict=True))] = n
        np.testing.assert_array_equal(components(grid), expected)


@pytest.mark.parametrize(
    ("walks", "legal"),
    [
        ([[(0, 0), (1, 0), (2, 0), (2, 1)], [], [(0, 1), (0, 0)], [(2, 2)]], True),
        ([[(0, 0), (0, 0)]], False),
        ([[(0, 0), (1, 1)]], False),
        ([[(0, 0), (2, 0)]], False),
        ([[(0, 1), (1, 0)], [(2, 2)]], False),  # the end of a row, and the start of the next
        ([[(0, 1), (0, 2)]], False),  # a wall
        ([[(2, 2), (2, 3)]], False),
        ([[(0, 0), (-1, 0)]], False),
        ([[(2, 0), (3, 0)]], False),
        ([[(0, 2**70)]], False),
        ([[], []], True),
    ],
)
def test_walks_are_legal_that_move_by_one_free_cell_at_a_time(
    walks: list[list[tuple[int, int]]], legal: bool
) -> None:
    assert are_legal(grid_from_rows(["..@", ".@.", "..."]), walks) is legal


def test_no_row_goes_on_in_the_next() -> None:
    grid = grid_from_rows(["..", ".."])
    assert not are_legal(grid, [[(0, 1), (1, 0)]])
    assert are_legal(grid_from_rows([".", "."]), [[(0, 0), (1, 0), (0, 0)]])
