"""Maps of ROS' map server, and images of floors, pixel by pixel."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from msmrta_opt.mission.errors import InputError, MistakesError
from msmrta_opt.mission.map_files import read_floor, read_map_file
from msmrta_opt.mission.occupancy import FREE, OCCUPIED, UNKNOWN, Occupancy
from msmrta_opt.mission.ros_map import read_ros_map

FIELDS = {
    "image": "floor.png",
    "resolution": "0.05",
    "origin": "[-10.0, 2.5, 0.3]",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
    "negate": "0",
}


def description(folder: Path, **changes: str | None) -> Path:
    fields = {key: x for key, x in {**FIELDS, **changes}.items() if x is not None}
    path = folder / "map.yaml"
    path.write_text("".join(f"{key}: {x}\n" for key, x in fields.items()), encoding="utf-8")
    return path


def image(folder: Path, pixels: object, mode: str = "L", name: str = "floor.png") -> None:
    array = np.array(pixels, np.uint8)
    Image.fromarray(array, mode).save(folder / name)


def states(folder: Path, **changes: str | None) -> list[list[int]]:
    found: list[list[int]] = read_ros_map(description(folder, **changes)).state.tolist()
    return found


def test_white_is_free_black_is_occupied_and_grey_is_unknown(tmp_path: Path) -> None:
    # Occupancies 0, 0.196078…, 0.2, 0.647…, 0.651… and 1, the second above free_thresh 0.196.
    image(tmp_path, [[255, 205, 204, 90, 89, 0]])
    assert states(tmp_path) == [[FREE, UNKNOWN, UNKNOWN, UNKNOWN, OCCUPIED, OCCUPIED]]
    assert states(tmp_path, free_thresh="0.197")[0][1] == FREE


def test_a_negated_map_has_black_as_free(tmp_path: Path) -> None:
    image(tmp_path, [[255, 128, 0]])
    assert states(tmp_path, negate="1") == [[OCCUPIED, UNKNOWN, FREE]]
    assert states(tmp_path, negate="true") == [[OCCUPIED, UNKNOWN, FREE]]


def test_channels_are_averaged_the_alpha_channel_in_trinary_too(tmp_path: Path) -> None:
    # Means 254 and 85; with alpha (254 * 3 + 0) / 4 = 190.5 and (255 * 3 + 255) / 4 = 255.
    image(tmp_path, [[[254, 254, 254], [255, 0, 0]]], "RGB")
    assert states(tmp_path) == [[FREE, OCCUPIED]]
    image(tmp_path, [[[254, 254, 254, 0], [255, 255, 255, 255]]], "RGBA")
    assert states(tmp_path) == [[UNKNOWN, FREE]]


def test_in_mode_scale_what_is_not_opaque_is_unknown(tmp_path: Path) -> None:
    image(tmp_path, [[[255, 255], [255, 254], [0, 255], [128, 255]]], "LA")
    assert states(tmp_path, mode="scale") == [[FREE, UNKNOWN, OCCUPIED, UNKNOWN]]


def test_in_mode_raw_values_up_to_100_are_percent_and_others_unknown(tmp_path: Path) -> None:
    image(tmp_path, [[0, 19, 20, 65, 66, 100, 101, 255]])
    expected = [FREE, FREE, UNKNOWN, UNKNOWN, OCCUPIED, OCCUPIED, UNKNOWN, UNKNOWN]
    assert states(tmp_path, mode="raw") == [expected]


@pytest.mark.parametrize("name", ["floor.pgm", "floor.png", "floor.bmp"])
def test_images_of_several_formats_are_read(tmp_path: Path, name: str) -> None:
    image(tmp_path, [[0, 255], [255, 255]], name=name)
    assert states(tmp_path, image=name) == [[OCCUPIED, FREE], [FREE, FREE]]


def test_one_bit_and_palette_images_are_read_by_their_colours(tmp_path: Path) -> None:
    Image.fromarray(np.array([[True, False]])).save(tmp_path / "floor.png")
    assert states(tmp_path) == [[FREE, OCCUPIED]]
    Image.fromarray(np.array([[255, 0]], np.uint8)).convert("P").save(tmp_path / "floor.png")
    assert states(tmp_path) == [[FREE, OCCUPIED]]


def test_a_map_has_its_resolution_and_origin(tmp_path: Path) -> None:
    image(tmp_path, [[255]])
    floor = read_ros_map(description(tmp_path))
    assert (floor.resolution, floor.origin) == (0.05, (-10.0, 2.5, 0.3))


def test_a_map_becomes_cells_with_their_place_in_the_world(tmp_path: Path) -> None:
    image(tmp_path, np.full((40, 60), 255))
    grid = read_map_file(description(tmp_path, origin="[1, 2, 0]"), cell_size=0.5)
    assert grid.shape == (4, 6)
    assert grid.frame is not None
    assert grid.frame.position((3, 0)) == pytest.approx((1.25, 2.25))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"image": "gone.png"}, "image: {folder}/gone.png: no such file"),
        ({"image": "map.yaml"}, "image: {folder}/map.yaml: not an image; give one of"),
        ({"image": "."}, "image: {folder}: cannot be read (a folder); give a regular file"),
        ({"image": None}, "image: is missing; give it"),
        ({"resolution": "0"}, "resolution: 0; give a number above 0"),
        ({"resolution": ".nan"}, "resolution: NaN; give a finite number"),
        ({"resolution": "fine"}, "resolution: 'fine'; give a finite number"),
        ({"origin": "[0, 0]"}, "origin: [0, 0]; give three numbers, [x, y, yaw]"),
        ({"origin": "[0, a, 0]"}, "origin[1]: 'a'; give a finite number"),
        ({"free_thresh": "0.7"}, "free_thresh: 0.7 is above occupied_thresh 0.65;"),
        ({"occupied_thresh": "65"}, "occupied_thresh: 65; give 1 or less"),
        ({"negate": "maybe"}, "negate: 'maybe'; give true or false"),
        ({"mode": "grey"}, "mode: 'grey'; give 'trinary', 'scale' or 'raw'"),
        ({"mode": "raw\nmode: raw"}, "mode: is given twice; give it once"),
        ({"mode": "&a raw\nother: *a"}, "line 8: an alias; write out what it stands for"),
        ({"mode": "[1"}, "line 8: broken YAML"),
    ],
)
def test_a_broken_description_gets_one_line(
    tmp_path: Path, changes: dict[str, str | None], said: str
) -> None:
    image(tmp_path, [[255]])
    path = description(tmp_path, **changes)
    with pytest.raises(InputError) as refused:
        read_ros_map(path)
    message = str(refused.value)
    assert message.startswith(f"{path}: {said.format(folder=tmp_path)}")
    assert "\n" not in message


def test_all_mistakes_of_a_description_are_told_at_once(tmp_path: Path) -> None:
    path = description(tmp_path, image="gone.png", resolution="-1", negate="5", mode="x")
    with pytest.raises(MistakesError) as refused:
        read_ros_map(path)
    assert [error.field for error in refused.value.each] == [
        "image",
        "resolution",
        "negate",
        "mode",
    ]
    assert all(str(error).startswith(f"{path}: ") for error in refused.value.each)


def test_an_image_of_16_bits_is_refused(tmp_path: Path) -> None:
    Image.fromarray(np.array([[0, 65535]], np.uint16)).save(tmp_path / "floor.png")
    with pytest.raises(InputError, match="give an image of 8 bits a channel"):
        states(tmp_path)


def test_an_image_too_large_is_refused_before_it_is_decoded(tmp_path: Path) -> None:
    (tmp_path / "floor.pgm").write_bytes(b"P5\n100000 100000\n255\n")
    with pytest.raises(
        InputError, match="100000 rows × 100000 columns; give at most 100,000,000 pixels"
    ):
        states(tmp_path, image="floor.pgm")


def test_an_image_cut_short_is_refused(tmp_path: Path) -> None:
    image(tmp_path, np.zeros((50, 50)), name="floor.pgm")
    path = tmp_path / "floor.pgm"
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(InputError, match="cannot be read"):
        states(tmp_path, image="floor.pgm")


def test_an_image_alone_needs_a_resolution(tmp_path: Path) -> None:
    image(tmp_path, [[255, 0]])
    with pytest.raises(InputError, match=r"^resolution: missing"):
        read_floor(tmp_path / "floor.png")
    assert read_floor(tmp_path / "floor.png", resolution=0.1).state.tolist() == [[FREE, OCCUPIED]]
    with pytest.raises(InputError, match=r"^resolution: not for a map.yaml"):
        read_floor(description(tmp_path), resolution=0.1)


def test_options_of_floors_are_refused_for_grids(instances_dir: Path) -> None:
    with pytest.raises(InputError, match=r"^cell_size: not for map0.map"):
        read_map_file(instances_dir / "maps" / "map0.map", cell_size=0.5)


@pytest.mark.parametrize("state", [[[3]], [1, 0], [[]]])
def test_an_array_that_is_no_floor_is_refused(state: object) -> None:
    with pytest.raises(InputError, match=r"^state: "):
        Occupancy(np.array(state), 0.1)


def test_an_array_of_percent_is_read_from_the_lower_row_upwards() -> None:
    floor = Occupancy.from_percent([[0, 19, 20], [65, 66, -1]], 0.1, (1, 2, 0))
    assert floor.state.tolist() == [[UNKNOWN, OCCUPIED, UNKNOWN], [FREE, FREE, UNKNOWN]]
    assert (floor.resolution, floor.origin) == (0.1, (1, 2, 0))


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ([[0, -2]], "values: -2; give 0 to 100, or -1 for unknown"),
        ([[0, 101]], "values: 101; give 0 to 100, or -1 for unknown"),
        ([0, 1], "values: shape (2,) of int64; give a rectangle of whole numbers"),
        ([[0.5]], "values: shape (1, 1) of float64; give a rectangle of whole numbers"),
    ],
)
def test_an_array_that_is_not_in_percent_is_refused(values: Any, said: str) -> None:
    with pytest.raises(InputError) as refused:
        Occupancy.from_percent(values, 0.1)
    assert str(refused.value) == said


def test_shares_of_free_occupied_and_unknown_sum_to_one() -> None:
    share = Occupancy(np.array([[FREE, FREE, OCCUPIED, UNKNOWN]]), 0.1).share
    assert share == {"free": 0.5, "occupied": 0.25, "unknown": 0.25}
