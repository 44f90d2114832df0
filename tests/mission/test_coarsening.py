"""A floor in pixels becomes cells that promise no walk that there is not."""

from __future__ import annotations

import itertools

import networkx as nx
import numpy as np
import pytest

from msmrta_opt.mission.coarsening import coarsen
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.frame import Frame
from msmrta_opt.mission.occupancy import FREE, OCCUPIED, UNKNOWN, Occupancy

WALL = {"#": OCCUPIED, ".": FREE, "?": UNKNOWN}


def floor(text: str, resolution: float = 1.0) -> Occupancy:
    rows = [[WALL[letter] for letter in line] for line in text.split()]
    return Occupancy(np.array(rows, np.uint8), resolution)


def cells(text: str, cell_size: float, **options: object) -> str:
    return " ".join(coarsen(floor(text), cell_size, **options).grid.rows)  # type: ignore[arg-type]


def test_a_cell_is_free_where_a_pixel_of_it_is() -> None:
    assert cells("...# ...# #### ####", 2) == ".. @@"


def test_cells_are_laid_from_the_lower_left_corner() -> None:
    # Three rows of two pixels: the upper cell has one row only.
    assert cells("## .. ..", 2) == "@ ."


def test_a_wall_between_two_cells_costs_one_of_them() -> None:
    # Both halves of the middle hold free pixels, and no pixel leads from one to the other.
    assert cells("..#... ..#... ..#...", 2) == ".@. .@."


def test_a_robot_too_wide_for_a_door_does_not_go_through_it() -> None:
    text = "####### #..#..# #.....# #..#..# #######"
    assert coarsen(floor(text), 1).grid.component.max() == 1
    assert coarsen(floor(text), 1, robot_radius=1).n_regions == 2


def test_a_disc_fits_where_all_occupied_pixels_are_farther_than_its_radius() -> None:
    # Centres one pixel from the wall are at distance 1, which a radius of 1 touches.
    fits = coarsen(floor("..... ..... ....#"), 1, robot_radius=1).fits
    assert fits.tolist() == [
        [False, False, False, False, False],
        [False, True, True, True, False],
        [False, False, False, False, False],
    ]


def test_beyond_the_image_nothing_is_free() -> None:
    fits = coarsen(floor("... ... ..."), 1, robot_radius=1).fits
    assert np.argwhere(fits).tolist() == [[1, 1]]


@pytest.mark.parametrize(("unknown", "rows"), [("blocked", ".@."), ("free", "...")])
def test_unknown_space_is_blocked_or_free_as_asked(unknown: str, rows: str) -> None:
    text = "#.?.#" if unknown == "blocked" else ".?."
    assert cells(text, 1, unknown=unknown).strip("@") == rows.strip("@")


def test_of_a_region_only_the_largest_connected_part_of_the_cells_is_kept() -> None:
    # One region of pixels; its narrow bend lies within cells that stand for other pixels.
    made = coarsen(floor("....## ....## ...... ####.. ####.. ####.."), 2)
    assert made.n_regions == 1
    assert made.grid.component.max() == 1
    assert made.left_out == made.area - sum(
        (made.fits[2 * r : 2 * r + 2, 2 * c : 2 * c + 2]).sum()
        for r, c in np.argwhere(made.grid.free)
    )


def test_a_cell_has_its_place_in_the_world() -> None:
    made = coarsen(Occupancy(np.zeros((4, 6), np.uint8), 0.5, (10.0, 20.0, np.pi / 2)), 1.0)
    frame = made.grid.frame
    assert frame is not None
    assert made.grid.shape == (2, 3)
    # The lower left cell's centre is half a metre along and up; turned by a right angle.
    assert frame.position((1, 0)) == pytest.approx((9.5, 20.5))
    assert frame.position((0, 2)) == pytest.approx((8.5, 22.5))


def test_every_cell_contains_the_position_that_it_is_given() -> None:
    random = np.random.default_rng(5)
    for _ in range(50):
        origin = tuple(random.uniform(-100, 100, 3).tolist())
        made = coarsen(Occupancy(np.zeros((7, 9), np.uint8), 0.05, origin), 0.12)
        frame = made.grid.frame
        assert frame is not None
        for cell in itertools.product(*map(range, made.grid.shape)):
            assert frame.cell(*frame.position(cell)) == cell


def test_where_the_robot_does_not_fit_at_the_centre_it_stands_on_the_nearest_pixel() -> None:
    # One cell of three pixels; its middle is a wall, and of the pixels beside it, half a metre away,
    # the first is on the left of it, 0.5 m along the map and none up.
    frame = coarsen(floor("... .#. ...", 0.5), 1.5).grid.frame
    assert frame is not None
    assert frame.off_centre == ((0, 0, 0.0, 0.5),)
    assert frame.position((0, 0)) == pytest.approx((0.75, 1.25))
    # A piece of its own in the upper right corner is smaller than that on the left.
    frame = coarsen(floor("..#. ..#. ..#. ..#.", 1.0), 4).grid.frame
    assert frame is not None
    assert frame.off_centre == ((0, 0, -0.5, 0.5),)
    # The centre of a free cell of two pixels a side is on the corner of all four.
    frame = coarsen(floor(".. ..", 1.0), 2).grid.frame
    assert frame is not None
    assert frame.off_centre == ()


@pytest.mark.parametrize("seed", range(4))
def test_every_free_cell_has_a_pose_that_fits_and_leads_back_to_it(seed: int) -> None:
    random = np.random.default_rng(seed)
    size = (0.2, 0.3, 0.17, 0.25)[seed]
    state = (random.random((40, 50)) < 0.06).astype(np.uint8)
    made = coarsen(Occupancy(state, 0.05, (3.0, -2.0, 0.7)), size, robot_radius=0.06)
    frame, pixels = made.grid.frame, Frame(0.05, (3.0, -2.0, 0.7), 40)
    assert frame is not None
    assert frame.off_centre
    for row, col in np.argwhere(made.grid.free).tolist():
        x, y = frame.position((row, col))
        assert made.fits[pixels.cell(x, y)]
        assert frame.cell(x, y) == (row, col)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"cell_size": 0.5}, "cell_size: 0.5; give metres, at least a pixel's 1"),
        ({"cell_size": float("nan")}, "cell_size: NaN; give metres, at least a pixel's 1"),
        ({"cell_size": "x"}, "cell_size: 'x'; give metres, at least a pixel's 1"),
        ({"robot_radius": None}, "robot_radius: null; give metres, 0 or more"),
        ({"robot_radius": -1.0}, "robot_radius: -1.0; give metres, 0 or more"),
        ({"robot_radius": 9.0}, "robot_radius: 9.0; no disc of this radius fits on the map"),
        ({"unknown": "red"}, "unknown: 'red'; give blocked or free"),
        (
            {"text": "?#??"},
            "unknown: blocked; no pixel is free (75.0% unknown, 25.0% occupied); give free",
        ),
        (
            {"text": "##", "unknown": "free"},
            "unknown: free; no pixel is free (0.0% unknown, 100.0% occupied); give a map that shows "
            "free space",
        ),
    ],
)
def test_what_is_out_of_range_is_refused_in_one_line(options: dict[str, object], said: str) -> None:
    text = str(options.pop("text", "... ..."))
    with pytest.raises(InputError) as refused:
        coarsen(floor(text), **{"cell_size": 1.0, **options})  # type: ignore[arg-type]
    assert str(refused.value) == said


@pytest.mark.parametrize("seed", range(12))
def test_cells_are_connected_exactly_as_their_pixels_are(seed: int) -> None:
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(4, 16, 2).tolist())
    occupied = random.random(shape) < random.uniform(0.1, 0.5)
    occupied[0, 0] = False
    size = int(random.integers(1, 5))
    made = coarsen(Occupancy(occupied.astype(np.uint8), 1.0), size)
    pixels = grid_graph(~occupied)
    height = shape[0]
    home = {
        (i, j): (made.grid.shape[0] - 1 - (height - 1 - i) // size, j // size) for i, j in pixels
    }
    # The largest connected piece of a cell stands for it; of equal ones the first, row by row.
    piece: dict[tuple[int, int], set[tuple[int, int]]] = {}
    for cell in map(tuple, np.argwhere(made.grid.free).tolist()):
        own = sorted(p for p in pixels if home[p] == cell)
        parts = sorted(
            nx.connected_components(pixels.subgraph(own)), key=lambda x: (-len(x), min(x))
        )
        piece[cell] = parts[0]
    moves = grid_graph(made.grid.free)
    for a, b in moves.edges:
        assert nx.is_connected(pixels.subgraph(piece[a] | piece[b]))
    region = {p: i for i, part in enumerate(nx.connected_components(pixels)) for p in part}
    for part in nx.connected_components(moves):
        # One region of pixels, and no other cell is in it.
        (own,) = {region[min(piece[cell])] for cell in part}
        assert {cell for cell in piece if region[min(piece[cell])] == own} == part
    assert made.left_out == (~occupied).sum() - sum(map(len, piece.values()))


def grid_graph(free: np.ndarray) -> nx.Graph:
    whole = nx.grid_2d_graph(*free.shape)
    return whole.subgraph(map(tuple, np.argwhere(free).tolist())).copy()
