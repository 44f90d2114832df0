"""The commands map and new-mission."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def building(tmp_path: Path) -> Path:
    """Two rooms of 2 m with a door of 1 m, at 0.05 m a pixel, turned by a right angle."""
    pixels = np.full((50, 90), 255, np.uint8)
    pixels[:5] = pixels[-5:] = pixels[:, :5] = pixels[:, -5:] = pixels[:, 43:47] = 0
    pixels[15:35, 43:47] = 255
    Image.fromarray(pixels).save(tmp_path / "floor.pgm")
    path = tmp_path / "map.yaml"
    path.write_text(
        "image: floor.pgm\nresolution: 0.05\norigin: [10, 20, 1.5707963267948966]\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0\n",
        encoding="utf-8",
    )
    return path


def test_a_map_is_told_in_numbers_and_drawn(
    msmrta: Run, building: Path, tmp_path: Path, capsys: Capture
) -> None:
    cells, picture = tmp_path / "cells.map", tmp_path / "map.png"
    options = ["--cell-size", 0.5, "--robot-radius", 0.2]
    assert msmrta("map", building, *options, "-o", cells, "--figure", picture) == 0
    out = capsys.readouterr().out
    # 40 × 76 pixels, and the door's 20 × 4.
    assert "free pixels" in out
    assert f"{(40 * 76 + 20 * 4) / (50 * 90):.1%}" in out
    assert "in 1 region " in out
    assert read_map(cells).shape == (5, 9)
    assert Image.open(picture).size[0] > 1000


def test_a_grid_is_told_in_numbers_too(
    msmrta: Run, instances_dir: Path, tmp_path: Path, capsys: Capture
) -> None:
    picture = tmp_path / "map.png"
    assert msmrta("map", instances_dir / "maps" / "map0.map", "--figure", picture) == 0
    assert "20 rows × 20 columns" in capsys.readouterr().out
    assert picture.exists()


def test_a_mission_on_a_floor_is_written_and_planned(
    msmrta: Run, building: Path, tmp_path: Path, capsys: Capture
) -> None:
    victims = tmp_path / "victims.csv"
    # A quarter turn: the map's x axis points along the world's y axis.
    victims.write_text("id,x,y,requirements\n3,8.8,23.8,FirstAids\n", encoding="utf-8")
    mission = tmp_path / "mission.json"
    status = msmrta(
        *("new-mission", "--map", building, "--cell-size", 0.5, "--robot-radius", 0.2),
        *("--robot", "x=8.8,y=20.8,speed=0.4,capabilities=FirstAids", "--victims", victims),
        *("-o", mission),
    )
    assert status == 0
    read = Instance.read(mission)
    assert read.starts == [(2, 1)]
    assert read.cells == [(2, 7)]
    assert msmrta("plan", mission) == 0
    assert "1 of 1" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--robots", "2", "--robot", "row=1,col=1"], "--robots: a number beside --robot"),
        (["--robot", "row=1"], "robots[0]: has row; give x and y, or row and col"),
        (["--robot", "row=one,col=1"], "robots[0].row: 'one'; give a whole number"),
        (["--robot", "size=1"], "--robot: 'size=1'; give name=value of x, y, row, col, id, speed"),
        (["--robots", "gone.csv"], "gone.csv: no such file"),
        (["--robots", "-1"], "--robots: -1; give a whole number, 1 or more, or a CSV file"),
        (["--robots", "0"], "--robots: 0; give a whole number, 1 or more, or a CSV file"),
        (["--victims", "2.5"], "--victims: 2.5; give a whole number, 0 or more, or a CSV file"),
        (["--kind", "help"], "--kind: 'help'; give NAME=TIME"),
        (["--kind", "help=soon"], "--kind: 'soon'; give a number"),
        (["--cell-size", "0.5"], "cell_size: not for map0.map"),
        (["--robot", "row=1,col=1,capabilities=magic"], "robots[0].capabilities: unknown kind"),
    ],
)
def test_what_cannot_be_taken_gets_one_line_and_writes_nothing(
    msmrta: Run,
    instances_dir: Path,
    tmp_path: Path,
    capsys: Capture,
    arguments: list[str],
    said: str,
) -> None:
    map_ = instances_dir / "maps" / "map0.map"
    output = tmp_path / "mission.json"
    assert msmrta("new-mission", "--map", map_, *arguments, "-o", output) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"error: {said}")
    assert error.count("\n") == 1
    assert not output.exists()
