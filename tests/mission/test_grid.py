from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import FrozenInstanceError
from itertools import pairwise, product

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from support.amounts import examples
from support.maps import cells_of, free_cells, grids

from msmrta_opt.arrays import Int32s
from msmrta_opt.mission.grid import UNREACHABLE, Cell, DistanceTable, GridMap, manhattan
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.search import Search

Distances = Callable[[GridMap, Cell], dict[Cell, int]]

DETOUR = grid_from_rows(["..@..", ".@@..", "....."])
CLOSED = grid_from_rows(["..@.", "..@."])
SPIRAL = grid_from_rows([".....", "@@@@.", "...@.", ".@@@.", "....."])


# The map itself


def test_rows_read_from_the_upper_left() -> None:
    assert DETOUR.shape == (3, 5)
    assert not DETOUR.is_free((0, 2))
    assert DETOUR.is_free((2, 0))
    assert DETOUR.rows == ("..@..", ".@@..", ".....")


@pytest.mark.parametrize("cell", [(-1, 0), (0, -1), (3, 0), (0, 5)])
def test_no_cell_beyond_the_edge_is_on_the_map(cell: Cell) -> None:
    assert not DETOUR.contains(cell)
    assert not DETOUR.is_free(cell)


def test_a_wall_is_on_the_map_and_not_free() -> None:
    assert DETOUR.contains((0, 2))
    assert not DETOUR.is_free((0, 2))


def test_a_map_is_a_copy_and_cannot_be_changed() -> None:
    free = np.ones((2, 2), dtype=bool)
    grid = GridMap(free)
    free[0, 0] = False
    assert grid.is_free((0, 0))
    with pytest.raises(ValueError, match="read-only"):
        grid.free[0, 0] = False
    with pytest.raises(FrozenInstanceError):
        grid.free = free  # type: ignore[misc]


@pytest.mark.parametrize("shape", [(4,), (0, 3), (3, 0), (2, 2, 2)])
def test_what_is_not_a_rectangle_of_cells_is_no_map(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="non-empty rectangle"):
        GridMap(np.ones(shape, dtype=bool))


def test_maps_with_the_same_cells_are_equal_whatever_their_name() -> None:
    twin = GridMap(DETOUR.free, name="twin")
    assert twin == DETOUR
    assert hash(twin) == hash(DETOUR)
    assert DETOUR != CLOSED
    assert DETOUR != "..@../.@@../....."


def test_the_same_cells_in_another_shape_are_another_map() -> None:
    assert grid_from_rows(["...."]) != grid_from_rows(["..", ".."])


@given(grid=grids())
def test_the_graph_has_the_moves_between_free_cells(grid: GridMap) -> None:
    moves = {
        (a, b)
        for a, b in product(free_cells(grid), repeat=2)
        if abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1
    }
    assert set(grid.graph.nodes) == set(free_cells(grid))
    assert {move for a, b in grid.graph.edges for move in ((a, b), (b, a))} == moves


@pytest.mark.parametrize(
    ("a", "b", "distance"), [((0, 0), (0, 0), 0), ((0, 0), (2, 3), 5), ((2, 0), (0, 3), 5)]
)
def test_manhattan_distance_counts_rows_and_columns(a: Cell, b: Cell, distance: int) -> None:
    assert manhattan(a, b) == manhattan(b, a) == distance


# Walks


def test_a_walk_goes_round_a_wall() -> None:
    # 2 down, 3 right, 2 up: there is one shortest walk only.
    assert DETOUR.walk((0, 0), (0, 3)) == [
        (0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (2, 3), (1, 3), (0, 3),
    ]  # fmt: skip


def test_a_walk_that_ends_where_it_starts_is_that_cell() -> None:
    assert DETOUR.walk((1, 0), (1, 0)) == [(1, 0)]


def test_there_is_no_walk_through_walls() -> None:
    with pytest.raises(nx.NetworkXNoPath):
        CLOSED.walk((0, 0), (0, 3))


def assert_walks_are_shortest(grid: GridMap, breadth_first: Distances) -> None:
    for start in free_cells(grid):
        expected = breadth_first(grid, start)
        for goal in free_cells(grid):
            if goal not in expected:
                with pytest.raises(nx.NetworkXNoPath):
                    grid.walk(start, goal)
                continue
            walk = grid.walk(start, goal)
            assert (walk[0], walk[-1]) == (start, goal)
            assert len(walk) - 1 == expected[goal]
            assert all(grid.rows[row][col] == "." for row, col in walk)
            assert all(manhattan(a, b) == 1 for a, b in pairwise(walk))


@pytest.mark.parametrize("grid", [DETOUR, CLOSED, SPIRAL], ids=["detour", "closed", "spiral"])
def test_walks_by_a_star_are_as_short_as_breadth_first(
    grid: GridMap, breadth_first: Distances
) -> None:
    assert_walks_are_shortest(grid, breadth_first)


@settings(max_examples=examples(30))
@given(grid=grids(4))
def test_walks_by_a_star_are_as_short_as_breadth_first_on_random_maps(
    grid: GridMap, breadth_first: Distances
) -> None:
    assert_walks_are_shortest(grid, breadth_first)


# Distances


@given(grid=grids())
def test_fields_hold_the_breadth_first_distances(grid: GridMap, breadth_first: Distances) -> None:
    sources = free_cells(grid)
    fields = grid.fields(sources)
    assert fields.shape == (len(sources), *grid.shape)
    for source, field in zip(sources, fields, strict=True):
        found = {cell: field[cell] for cell in cells_of(grid) if np.isfinite(field[cell])}
        assert found == breadth_first(grid, source)


def test_the_fields_of_the_papers_starts_are_the_breadth_first_ones(
    paper: Instance, breadth_first: Distances
) -> None:
    for start, field in zip(paper.starts, paper.map.fields(paper.starts), strict=True):
        found = {cell: field[cell] for cell in cells_of(paper.map) if np.isfinite(field[cell])}
        assert found == breadth_first(paper.map, start)


def test_no_field_is_asked_for_and_none_is_given() -> None:
    assert DETOUR.fields([]).shape == (0, 3, 5)


def test_nothing_can_be_reached_from_a_wall_nor_the_wall_from_anywhere() -> None:
    from_wall, from_free = DETOUR.fields([(0, 2), (0, 0)])
    assert (from_wall == UNREACHABLE).all()
    assert from_free[0, 2] == UNREACHABLE


def test_cells_that_no_walk_joins_are_infinitely_far_both_ways() -> None:
    table = DistanceTable(CLOSED)
    assert table((0, 0), (1, 3)) == table((1, 3), (0, 0)) == UNREACHABLE
    assert table((0, 0), (1, 1)) == 2


@given(grid=grids(4))
def test_a_table_is_symmetric(grid: GridMap) -> None:
    cells = free_cells(grid)
    table = DistanceTable(grid, cells)
    distances = table.between(cells, cells)
    assert distances.shape == (len(cells), len(cells))
    np.testing.assert_array_equal(distances, distances.T)


def test_between_has_a_row_per_source_and_a_column_per_target() -> None:
    table = DistanceTable(DETOUR)
    distances = table.between([(0, 0), (2, 2)], [(0, 0), (0, 3), (2, 0)])
    np.testing.assert_array_equal(distances, [[0, 7, 2], [4, 3, 2]])


@pytest.mark.parametrize(("n_sources", "n_targets"), [(0, 2), (2, 0), (0, 0)])
def test_between_nothing_is_an_empty_table(n_sources: int, n_targets: int) -> None:
    cells = [(0, 0), (0, 1)]
    table = DistanceTable(DETOUR)
    assert table.between(cells[:n_sources], cells[:n_targets]).shape == (n_sources, n_targets)


class CountingMap(GridMap):
    """A map that takes note of each pair of cells between which distances are searched."""

    @property
    def search(self) -> CountingSearch:  # type: ignore[override]
        return self.__dict__.setdefault("counting", CountingSearch(super().search))

    @property
    def asked(self) -> list[tuple[Cell, Cell]]:
        return self.search.asked


class CountingSearch:
    def __init__(self, engine: Search) -> None:
        self.engine, self.asked = engine, list[tuple[Cell, Cell]]()

    def between(self, sources: Sequence[Cell], targets: Sequence[Cell]) -> Int32s:
        ends = ([(int(row), int(col)) for row, col in cells] for cells in (sources, targets))
        self.asked += product(*ends)
        return self.engine.between(sources, targets)

    def lengths(self, starts: Sequence[Cell], goals: Sequence[Cell]) -> Int32s:
        self.asked += zip(starts, goals, strict=True)
        return self.engine.lengths(starts, goals)


def test_each_distance_is_worked_out_once() -> None:
    grid = CountingMap(DETOUR.free)
    table = DistanceTable(grid, [(0, 0), (2, 4), (0, 0)])
    for _ in range(3):
        table.between([(0, 1), (2, 4)], [(0, 0), (2, 4)])
        table((2, 4), (0, 1))
        table.lengths([(2, 0), (2, 0), (0, 0)], [(1, 4), (1, 4), (2, 4)])
    assert sorted(grid.asked) == [
        ((0, 1), (0, 0)), ((0, 1), (2, 4)), ((2, 0), (1, 4)), ((2, 4), (0, 0)), ((2, 4), (2, 4)),
    ]  # fmt: skip


def test_many_searches_are_made_in_parts_between_which_ctrl_c_is_heeded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("msmrta_opt.mission.grid.AT_ONCE", 2)
    places = [(0, 0), (0, 1), (2, 0), (2, 2), (2, 4)]
    table = DistanceTable(DETOUR, places)
    np.testing.assert_array_equal(table.between(places, places), DETOUR.between(places, places))


def test_a_distance_known_from_either_end_will_do() -> None:
    grid = CountingMap(DETOUR.free)
    table = DistanceTable(grid, [(0, 0)])
    assert table.between([(0, 3)], [(0, 0)]) == 7
    assert table((0, 0), (0, 3)) == table((0, 3), (0, 0)) == 7
    assert table((0, 3), (2, 0)) == table((2, 0), (0, 3)) == 5
    assert grid.asked == [((0, 3), (0, 0)), ((0, 3), (2, 0))]


def test_a_distance_is_worked_out_when_first_asked_for() -> None:
    grid = CountingMap(DETOUR.free)
    table = DistanceTable(grid, [(2, 0)])
    assert grid.asked == []
    assert table((2, 0), (2, 4)) == 4
    assert grid.asked == [((2, 0), (2, 4))]


def test_distances_to_cells_that_are_no_places_are_the_same() -> None:
    places, others = [(0, 0), (2, 2)], [(0, 3), (2, 0)]
    table = DistanceTable(DETOUR, places)
    np.testing.assert_array_equal(table.between(places, others), [[7, 2], [3, 2]])
    np.testing.assert_array_equal(table.between(others, places), [[7, 3], [2, 2]])


def test_a_map_is_sent_to_other_processes_without_what_was_worked_out() -> None:
    fresh, used = (pickle.dumps(GridMap(DETOUR.free, "detour")) for _ in range(2))
    grid = GridMap(DETOUR.free, "detour")
    grid.component, grid.graph, grid.walks([(0, 0)], [(2, 2)])
    assert pickle.dumps(grid) == fresh == used
    assert (pickle.loads(fresh), pickle.loads(fresh).name) == (DETOUR, "detour")
