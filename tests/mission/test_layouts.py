"""Generated maps, against a flood fill and counts of their own."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import find_objects, label
from support.amounts import examples

from msmrta_opt.mission import shipped as shipped_files
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.layouts import (
    cells_out_of_reach,
    largest_region,
    maze,
    rooms,
    rubble,
    share_of,
    with_pocket,
)
from msmrta_opt.mission.maps import grid_from_rows, write_map
from msmrta_opt.mission.named_maps import find_map, named_maps

SEEDS = st.integers(0, 2**32 - 1)
SHARES = st.sampled_from([0.0, 0.1, 0.25, 0.5, 1.0])
ODD = st.integers(1, 9).map(lambda half: 2 * half + 1)
Distances = Callable[[GridMap, Cell], dict[Cell, int]]


def is_connected(grid: GridMap, distances: Distances) -> bool:
    cells = free_cells(grid)
    return set(distances(grid, cells[0])) == set(cells)


def free_cells(grid: GridMap) -> list[Cell]:
    return [(int(row), int(col)) for row, col in np.argwhere(grid.free)]


def rim(grid: GridMap) -> list[bool]:
    free = grid.free
    return [*free[0], *free[-1], *free[:, 0], *free[:, -1]]


def without_doors(grid: GridMap) -> np.ndarray:
    """The free cells but those that lie between two blocked ones, left and right or up and down."""
    free = np.pad(grid.free, 1)
    beside = ~free[1:-1, :-2] & ~free[1:-1, 2:]
    above = ~free[:-2, 1:-1] & ~free[2:, 1:-1]
    return grid.free & ~beside & ~above


# Rooms


@settings(max_examples=examples(60))
@given(
    seed=SEEDS,
    n_rows=st.integers(6, 40),
    n_cols=st.integers(6, 40),
    room=st.integers(3, 4),
    openings=SHARES,
)
def test_a_building_is_connected_rooms_of_the_right_sides_and_corridors_of_two_cells(
    breadth_first: Distances, seed: int, n_rows: int, n_cols: int, room: int, openings: float
) -> None:
    grid = rooms(n_rows, n_cols, seed=seed, room=room, openings=openings)
    assert grid.shape == (n_rows, n_cols)
    assert not any(rim(grid))
    assert is_connected(grid, breadth_first)
    labels, _ = label(without_doors(grid))
    for number, box in enumerate(find_objects(labels), start=1):
        part = labels[box] == number
        if part.all() and min(part.shape) >= room:
            assert max(part.shape) <= 2 * room
        else:
            # Corridors that meet are one part: nowhere three cells wide.
            assert not any(
                part[r : r + 3, c : c + 3].all()
                for r in range(part.shape[0] - 2)
                for c in range(part.shape[1] - 2)
            )


def test_a_wide_building_has_a_corridor_along_it_and_a_door_to_it_from_each_room_beside_it() -> (
    None
):
    # Inside are 18 rows: 2 of corridor with 2 of wall leave 14, of which each side has at least 4;
    # with 9 or 10 of them, one side may be two rooms deep.
    for seed in range(10):
        grid = rooms(20, 40, seed=seed, room=4, openings=0)
        corridor = [r for r in range(20) if grid.free[r, 1:-1].all()]
        assert len(corridor) == 2
        for wall, inside in ((corridor[0] - 1, -1), (corridor[1] + 1, 1)):
            doors = np.flatnonzero(grid.free[wall])
            beyond = grid.free[wall + inside, 1:-1]
            # The rooms along the wall are runs of free cells in the row behind it.
            runs = np.flatnonzero(np.diff(np.concatenate([[0], beyond.astype(int), [0]])) == 1)
            assert len(doors) >= 1
            assert len(runs) >= 4


def test_openings_put_a_door_between_all_neighbouring_rooms_or_as_few_as_connect() -> None:
    # 6 inner rows of 8 hold one row of rooms; n rooms in a row need n - 1 doors, and have no others.
    for seed in range(10):
        row = rooms(8, 40, seed=seed, room=4, openings=0)
        walls = [c for c in range(1, 39) if row.free[1:-1, c].sum() <= 1]
        assert [int(row.free[1:-1, c].sum()) for c in walls] == [1] * len(walls)
        # With all walls opened there are more doors, with half of them a number between.
        few, some, all_ = (
            int(rooms(24, 24, seed=seed, openings=share).free.sum()) for share in (0, 0.5, 1)
        )
        assert few < some < all_
        assert some - few == share_of(0.5, all_ - few)


def test_one_room_needs_no_door() -> None:
    assert rooms(6, 6, seed=0).rows == ("@@@@@@", *("@....@",) * 4, "@@@@@@")


# Rubble


@settings(max_examples=examples(50))
@given(
    seed=SEEDS,
    n_rows=st.integers(1, 20),
    n_cols=st.integers(1, 20),
    percent=st.integers(0, 99),
)
def test_rubble_blocks_the_share_asked_for_to_the_nearest_cell(
    seed: int, n_rows: int, n_cols: int, percent: int
) -> None:
    cells = n_rows * n_cols
    blocked = (2 * percent * cells + 100) // 200  # whole numbers alone, halves up
    if blocked == cells:
        with pytest.raises(InputError, match=r"density: .* leaves no free cell"):
            rubble(n_rows, n_cols, seed=seed, density=percent / 100)
    else:
        grid = rubble(n_rows, n_cols, seed=seed, density=percent / 100)
        assert grid.shape == (n_rows, n_cols)
        assert int((~grid.free).sum()) == blocked


def test_rubble_falls_on_every_cell_about_as_often() -> None:
    n = 400
    counts = sum((~rubble(5, 5, seed=s, density=0.2).free).astype(int) for s in range(n))
    # Five standard deviations of a binomial count with share 1/5
    assert (np.abs(counts - n / 5) < 5 * (n * 0.2 * 0.8) ** 0.5).all()


# Mazes


@settings(max_examples=examples(50))
@given(seed=SEEDS, n_rows=ODD, n_cols=ODD)
def test_a_perfect_maze_is_a_tree_of_all_passages(
    breadth_first: Distances, seed: int, n_rows: int, n_cols: int
) -> None:
    grid = maze(n_rows, n_cols, seed=seed)
    assert grid.shape == (n_rows, n_cols)
    assert not any(rim(grid))
    assert grid.free[1::2, 1::2].all()
    assert not grid.free[::2, ::2].any()
    assert is_connected(grid, breadth_first)
    # A connected graph with one edge fewer than vertices is a tree.
    moves = (grid.free[1:] & grid.free[:-1]).sum() + (grid.free[:, 1:] & grid.free[:, :-1]).sum()
    assert moves == grid.free.sum() - 1


@settings(max_examples=examples(50))
@given(seed=SEEDS, n_rows=ODD, n_cols=ODD, percent=st.integers(0, 100))
def test_a_share_of_a_mazes_remaining_walls_is_opened(
    seed: int, n_rows: int, n_cols: int, percent: int
) -> None:
    high, wide = n_rows // 2, n_cols // 2
    passages = high * wide
    walls = high * (wide - 1) + wide * (high - 1)
    left = walls - (passages - 1)
    opened = (2 * percent * left + 100) // 200
    grid = maze(n_rows, n_cols, seed=seed, openings=percent / 100)
    assert grid.free.sum() == passages + (passages - 1) + opened


# Regions and pockets


@settings(max_examples=examples(50))
@given(
    seed=SEEDS,
    kind=st.sampled_from(["rooms", "rubble", "maze", "open"]),
    n_cells=st.integers(1, 12),
)
def test_a_pocket_is_a_part_of_its_size_cut_off_by_new_walls_alone(
    breadth_first: Distances, seed: int, kind: str, n_cells: int
) -> None:
    grid = {
        "rooms": lambda: rooms(15, 21, seed=seed),
        "rubble": lambda: rubble(15, 21, seed=seed, density=0.2),
        "maze": lambda: maze(15, 21, seed=seed),
        "open": lambda: rubble(15, 21, seed=seed, density=0),
    }[kind]()
    cut = with_pocket(grid, n_cells, seed=seed)
    assert not (cut.free & ~grid.free).any()
    assert cells_out_of_reach(cut) >= cells_out_of_reach(grid) + n_cells
    before, after = largest_region(grid), largest_region(cut)
    assert not (after & ~before).any()
    inside = set(map(tuple, np.argwhere(after).tolist()))
    (start, *_) = sorted(inside)
    assert set(breadth_first(cut, start)) == inside
    # At most a quarter is cut off, so what is left is the larger part.
    assert 2 * after.sum() > before.sum()


def test_a_pocket_of_a_perfect_maze_costs_one_cell() -> None:
    for seed in range(10):
        grid = maze(21, 21, seed=seed)
        assert grid.free.sum() - with_pocket(grid, 2, seed=seed).free.sum() == 1


def test_the_largest_region_is_the_first_of_equally_large_ones() -> None:
    grid = grid_from_rows(["@..@..", "@@@@@@", "..@.@@"])
    assert np.argwhere(largest_region(grid)).tolist() == [[0, 1], [0, 2]]
    assert cells_out_of_reach(grid) == 5
    assert not largest_region(grid_from_rows(["@@"])).any()


# Shares, names, seeds


@pytest.mark.parametrize(
    ("share", "count", "exactly"),
    # 0.29 × 50 = 14.5 and 0.035 × 100 = 3.5, which binary fractions miss
    [(0.29, 50, 15), (0.035, 100, 4), (0.1, 24, 2), (0.1, 4, 0), (0.5, 1, 1), (1, 7, 7), (0, 7, 0)],
)
def test_a_share_is_taken_as_written_and_halves_go_up(
    share: float, count: int, exactly: int
) -> None:
    assert share_of(share, count) == exactly


def test_the_papers_maps_are_found_by_name_and_others_by_file(
    instances_dir: Path, tmp_path: Path
) -> None:
    assert list(named_maps()) == ["map0", "map1", "map2", "map3"]
    assert find_map("map0").rows == ("." * 20,) * 20
    assert find_map("map2").source == (instances_dir / "maps" / "map2.map")
    write_map(grid_from_rows([".@", ".."]), tmp_path / "own.map")
    assert find_map(tmp_path / "own.map").rows == (".@", "..")
    assert find_map(str(tmp_path / "own.map")).name == "own"


def test_an_installed_package_finds_the_maps_that_it_was_shipped_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shipped = tmp_path / "msmrta_opt" / "_shipped" / "instances" / "maps"
    shipped.mkdir(parents=True)
    write_map(grid_from_rows(["..."]), shipped / "hall.map")
    monkeypatch.setattr(shipped_files, "_PACKAGE", tmp_path / "msmrta_opt")
    monkeypatch.setattr(shipped_files, "_CHECKOUT", tmp_path)
    assert named_maps() == {"hall": shipped / "hall.map"}
    assert find_map("hall").rows == ("...",)


def test_other_seeds_give_other_maps() -> None:
    for layout, sides in ((rooms, (30, 30)), (rubble, (9, 9)), (maze, (9, 9))):
        assert len({layout(*sides, seed=seed).rows for seed in range(10)}) == 10


# Recorded once: a change of these is a change of every map that was ever generated.
DIGESTS = {
    "rooms": "ea14c2bed1528525f25ede8164b5ce8378e0ce5c9e253360e2347d101d50e799",
    "rubble": "4d334ea893ac95f05056f9dccba03a7759c62cb6629413fed1340afabbd6f2d4",
    "maze": "52bcae9ecbde6d88ff4bbffaa29fa331301725bf000f63e1402b9e8122aa25ab",
    "pocket": "9650055cdcb540a4283442d210cb5288fe703eea09e4ec4ec3511dd934e4dbb2",
}


@pytest.mark.parametrize("name", DIGESTS)
def test_the_same_seed_gives_the_same_map_for_ever(name: str) -> None:
    grid = {
        "rooms": lambda: rooms(31, 47, seed=7, openings=0.3),
        "rubble": lambda: rubble(31, 47, seed=7, density=0.3),
        "maze": lambda: maze(31, 47, seed=7, openings=0.1),
        "pocket": lambda: with_pocket(rooms(31, 47, seed=7), 5, seed=7),
    }[name]()
    assert hashlib.sha256("\n".join(grid.rows).encode()).hexdigest() == DIGESTS[name]


# Refusals


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rooms(5, 9, seed=0), "size: 5x9; give 6 to 1000 rows"),
        (lambda: rooms(9, 1001, seed=0), "size: 9x1001; give 6 to 1000"),
        (lambda: rooms(9, 9, seed=0, room=2), "room: 2; give "),
        (lambda: rooms(9, 9, seed=0, openings=1.1), "openings: 1.1; give a number from 0 to 1"),
        (lambda: rubble(0, 4, seed=0), "size: 0x4; give 1 to 1000"),
        (lambda: rubble(4, 4, seed=0, density=-0.1), "density: -0.1; give a number from 0 to 1"),
        (lambda: rubble(4, 4, seed=0, density=float("nan")), "density: nan; give"),
        (lambda: rubble(4, 4, seed=2**32), "seed: 4294967296; give"),
        (lambda: maze(4, 7, seed=0), "size: 4x7; .* such as 5x7"),
        (lambda: maze(1, 7, seed=0), "size: 1x7; give 3 to 1000"),
        (lambda: maze(7, 7, seed=-1), "seed: -1; give"),
        (lambda: with_pocket(rubble(3, 4, seed=0, density=0), 4, seed=0), "pocket: 4 of 12 .* 3 "),
        (lambda: with_pocket(rubble(3, 4, seed=0, density=0), 0, seed=0), "pocket: 0 of 12"),
        (lambda: find_map("map9"), "map: 'map9' is no file .* known: map0, map1, map2, map3"),
        (lambda: find_map("."), "cannot be read"),
    ],
)
def test_what_cannot_be_is_refused_saying_what_would_be_right(
    make: Callable[[], GridMap], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        make()
