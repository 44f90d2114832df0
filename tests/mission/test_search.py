"""The two engines: what each finds, and that both find the same."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise, product
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.maps import cells_of, free_cells, grids

from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.layouts import maze, rooms, rubble
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.search import Search, search

Distances = Callable[[GridMap, Cell], dict[Cell, int]]
ROOT = Path(__file__).parents[2]
FORK = grid_from_rows(["...", ".@.", "..."])


def engines(grid: GridMap) -> tuple[Search, Search]:
    return search(grid.free), search(grid.free, compiled=False)


@pytest.fixture(params=[True, False], ids=["compiled", "scipy"])
def compiled(request: pytest.FixtureRequest) -> bool:
    return bool(request.param)


def test_the_engines_are_two() -> None:
    one, other = engines(FORK)
    assert type(one) is not type(other)


@settings(max_examples=examples(200))
@given(grid=grids(6), data=st.data())
def test_both_engines_find_the_same(grid: GridMap, data: st.DataObject) -> None:
    # Blocked cells, too.
    some = st.lists(st.sampled_from(cells_of(grid)), max_size=12)
    sources, targets = data.draw(some), data.draw(some)
    starts, goals = (
        zip(*product(sources, targets), strict=True) if sources and targets else ([], [])
    )
    one, other = engines(grid)
    for name, given_cells in {
        "fields": (sources,),
        "between": (sources, targets),
        "lengths": (starts, goals),
        "nearest": (sources, targets),
        "components": (),
    }.items():
        found, again = (getattr(engine, name)(*given_cells) for engine in (one, other))
        assert found.dtype == again.dtype == np.int32
        # Where no walk leads, any negative number says so.
        np.testing.assert_array_equal(np.maximum(found, -1), np.maximum(again, -1), err_msg=name)
    assert one.walks(starts, goals) == other.walks(starts, goals)


@pytest.mark.parametrize(
    "grid", [rooms(24, 31, seed=3), maze(21, 21, seed=1), rubble(20, 40, seed=2)]
)
def test_both_engines_find_the_same_on_large_maps(grid: GridMap) -> None:
    free = np.argwhere(grid.free)
    random = np.random.RandomState(0)
    starts, goals = (free[random.randint(len(free), size=60)] for _ in range(2))
    one, other = engines(grid)
    np.testing.assert_array_equal(one.between(starts, goals), other.between(starts, goals))
    np.testing.assert_array_equal(one.lengths(starts, goals), other.lengths(starts, goals))
    np.testing.assert_array_equal(one.nearest(starts[:9], goals), other.nearest(starts[:9], goals))
    assert one.walks(starts, goals) == other.walks(starts, goals)


@given(grid=grids(), compiled=st.booleans())
def test_distances_are_those_of_breadth_first_search_by_hand(
    grid: GridMap, compiled: bool, breadth_first: Distances
) -> None:
    engine, cells = search(grid.free, compiled=compiled), cells_of(grid)
    expected = np.full((len(cells), len(cells)), -1)
    for i, cell in enumerate(cells):
        if grid.is_free(cell):
            for other, length in breadth_first(grid, cell).items():
                expected[i, cells.index(other)] = length
    pairs = list(product(cells, cells))
    for found in (
        engine.between(cells, cells),
        engine.fields(cells),
        engine.lengths([a for a, _ in pairs], [b for _, b in pairs]),
    ):
        np.testing.assert_array_equal(np.maximum(found, -1).ravel(), expected.ravel())


@given(grid=grids(), compiled=st.booleans())
def test_walks_are_shortest_and_go_the_first_way_that_leads_to_the_goal(
    grid: GridMap, compiled: bool, breadth_first: Distances
) -> None:
    cells = free_cells(grid)
    pairs = list(product(cells, cells))
    engine = search(grid.free, compiled=compiled)
    for (start, goal), walk in zip(
        pairs, engine.walks([a for a, _ in pairs], [b for _, b in pairs]), strict=True
    ):
        left = breadth_first(grid, goal)
        if start not in left:
            assert walk == []
            continue
        assert (walk[0], walk[-1], len(walk)) == (start, goal, left[start] + 1)
        for (row, col), after in pairwise(walk):
            around = [(row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)]
            assert after == next(c for c in around if left.get(c) == left[row, col] - 1)


@given(grid=grids(), compiled=st.booleans(), data=st.data())
def test_the_nearest_of_several_is_the_first_that_has_the_least_way(
    grid: GridMap, compiled: bool, breadth_first: Distances, data: st.DataObject
) -> None:
    cells = free_cells(grid)
    sources = data.draw(st.lists(st.sampled_from(cells), max_size=6)) if cells else []
    found = search(grid.free, compiled=compiled).nearest(sources, cells)
    for cell, nearest in zip(cells, found.tolist(), strict=True):
        way = breadth_first(grid, cell)
        reached = [i for i, source in enumerate(sources) if source in way]
        if reached:
            assert nearest == min(reached, key=lambda i: (way[sources[i]], i))
        else:
            assert nearest < 0


def test_of_two_ways_down_comes_before_right(compiled: bool) -> None:
    (walk,) = search(FORK.free, compiled=compiled).walks([(0, 0)], [(2, 2)])
    assert walk == [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2)]


@given(grid=grids(), compiled=st.booleans())
def test_components_are_those_of_networkx_in_the_order_of_their_first_cells(
    grid: GridMap, compiled: bool
) -> None:
    label = search(grid.free, compiled=compiled).components()
    parts = sorted(map(sorted, nx.connected_components(grid.graph)))
    assert label.shape == grid.shape
    assert not label[~grid.free].any()
    assert [
        sorted(map(tuple, np.argwhere(label == i + 1).tolist())) for i in range(len(parts))
    ] == parts
    assert label.max() == len(parts)


# Without numba


CALL = """
import os, sys
{before}
from msmrta_opt.mission.maps import grid_from_rows
grid = grid_from_rows(["...", ".@.", "..."])
print(grid.lengths([(0, 0)], [(2, 2)])[0], type(grid.search).__name__)
"""


def said(code: str) -> str:
    """What a new process prints."""
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", code]
    run = subprocess.run(command, env=variables, cwd=ROOT, capture_output=True, check=True)
    return run.stdout.decode()


@pytest.mark.parametrize(
    "before", ["sys.modules['numba'] = None", "os.environ['NUMBA_DISABLE_JIT'] = '1'"]
)
def test_without_numba_scipy_takes_its_place(before: str) -> None:
    assert said(CALL.format(before=before)) == "4.0 _WithoutNumba\n"


def test_numba_is_not_imported_before_the_first_search() -> None:
    code = (
        "import sys, msmrta_opt as mo; from msmrta_opt.cli import main;"
        "mo.read('instances/paper.json'); mo.plan; print('numba' in sys.modules)"
    )
    assert said(code) == "False\n"
