"""Places in metres and by cell: in mission files, in CSV files, and typed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from msmrta_opt.mission.draft import VICTIM_FIELDS, draft_mission
from msmrta_opt.mission.errors import InputError, MistakesError
from msmrta_opt.mission.frame import Frame
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.places import cell_of, read_places, typed_place
from msmrta_opt.mission.scenario import Scenario

# Cells of half a metre; the wall is in the upper row's middle, x 10.5 to 11, y 20.5 to 21.
GRID = GridMap(
    np.array([[True, False, True], [True, True, True]]), frame=Frame(0.5, (10, 20, 0), 2)
)


HELP_AND_FOOD = {"help": 5, "food": 3}


def document(**changes: Any) -> dict[str, Any]:
    return {
        "format": "msmrta-instance/1",
        "map": {"rows": [".@.", "..."], "frame": {"cell_size": 0.5, "origin": [10, 20, 0]}},
        "capabilities": ["help"],
        "service_time": {"help": 5},
        "robots": [
            {"id": 0, "start": {"x": 10.1, "y": 20.1}, "speed": 1, "capabilities": ["help"]}
        ],
        "victims": [{"id": 4, "cell": {"x": 11.2, "y": 20.9}, "requirements": ["help"]}],
        **changes,
    }


def test_places_in_metres_become_cells() -> None:
    mission = Instance.from_document(document())
    assert mission.starts == [(1, 0)]
    assert mission.cells == [(0, 2)]


def test_a_saved_mission_keeps_the_place_of_its_map(tmp_path: Path) -> None:
    mission = Instance.from_document(document())
    mission.save(tmp_path / "mission.json")
    again = Instance.read(tmp_path / "mission.json")
    assert again == mission
    assert again.map.frame == Frame(0.5, (10, 20, 0), 2)


def test_a_saved_mission_keeps_where_robots_stand(tmp_path: Path) -> None:
    made = document()
    made["map"]["frame"]["off_centre"] = [[1, 0, 0.1, -0.2]]
    mission = Instance.from_document(made)
    assert mission.map.frame is not None
    # The centre is at 10.25, 20.25.
    assert mission.map.frame.position((1, 0)) == pytest.approx((10.35, 20.05))
    mission.save(tmp_path / "mission.json")
    assert Instance.read(tmp_path / "mission.json") == mission


def test_cells_of_a_scenario_may_be_given_in_metres(tmp_path: Path) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text(
        "[[victims]]\nid = 1\ncell = {x = 11.2, y = 20.1}\nrequirements = []\n"
        "[[corridors]]\ncells = [[1, 0], {x = 10.7, y = 20.7}]\nopened = 3\n",
        encoding="utf-8",
    )
    scenario = Scenario.read(path, GRID)
    assert scenario.victims[0].cell == (1, 2)
    assert scenario.corridors[0].cells == ((1, 0), (0, 1))  # a wall, which may be opened
    with pytest.raises(InputError) as refused:
        Scenario.read(path)
    assert str(refused.value) == (
        f'{path}: victims[0].cell: {{"x": 11.2, "y": 20.1}}; metres need the map of one mission, '
        "so give a cell, [row, col]"
    )


@pytest.mark.parametrize(
    ("corridor", "said"),
    [
        ({"x": 9, "y": 20.5}, "x 9, y 20.5 is outside the map of 2 rows × 3 columns; the nearest"),
        ({"x": 11}, "is missing; give it"),
    ],
)
def test_a_point_of_a_scenario_that_is_not_on_the_map_gets_one_line(
    corridor: dict[str, float], said: str
) -> None:
    with pytest.raises(InputError) as refused:
        Scenario.from_document({"corridors": [{"cells": [corridor], "blocked": 1}]}, GRID)
    assert refused.value.field.startswith("corridors[0].cells[0]")
    assert refused.value.problem.startswith(said)


def off_centre(*entries: Any) -> dict[str, Any]:
    frame = {"cell_size": 0.5, "origin": [10, 20, 0], "off_centre": list(entries)}
    return {"map": {"rows": [".@.", "..."], "frame": frame}}


def test_a_mission_may_name_a_floor(tmp_path: Path) -> None:
    Image.fromarray(np.full((10, 20), 255, np.uint8)).save(tmp_path / "floor.png")
    floor = {"file": "floor.png", "resolution": 0.1, "cell_size": 0.5, "robot_radius": 0.1}
    made = document(map=floor, victims=[])
    made["robots"][0]["start"] = {"x": 0.6, "y": 0.1}
    path = tmp_path / "mission.json"
    path.write_text(json.dumps(made), encoding="utf-8")
    mission = Instance.read(path)
    assert mission.map.shape == (2, 4)
    assert mission.starts == [(1, 1)]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"victims": [{"id": 1, "cell": {"x": 10.7, "y": 20.7}, "requirements": []}]},
            "victims[0].cell: x 10.7, y 20.7 is in a wall; the nearest free cell is [0, 0], "
            "at x 10.25, y 20.75",
        ),
        (
            {"victims": [{"id": 1, "cell": {"x": 99, "y": 20.1}, "requirements": []}]},
            "victims[0].cell: x 99, y 20.1 is outside the map of 2 rows × 3 columns; "
            "the nearest free cell",
        ),
        (
            {"victims": [{"id": 1, "cell": {"x": 10.1}, "requirements": []}]},
            "victims[0].cell.y: is missing",
        ),
        (
            {"map": {"rows": ["..."]}},
            'robots[0].start: {"x": 10.1, "y": 20.1}; this map has no frame, so give a cell',
        ),
        (
            {"map": {"rows": ["..."], "frame": {"cell_size": 0, "origin": [0, 0, 0]}}},
            "map.frame.cell_size: 0; give a number above 0",
        ),
        (off_centre([1, 0, 0.1]), "map.frame.off_centre[0]: [1, 0, 0.1]; give [row, col, along"),
        (
            off_centre([1, 0, 0.1, 0], [2, 0, 0.1, 0]),
            "map.frame.off_centre[1]: [2, 0] is outside the map of 2 rows × 3 columns",
        ),
        (
            off_centre([1, 0, 0.1, 0], [1, 0, 0.1, 0]),
            "map.frame.off_centre[1]: [1, 0] is given twice",
        ),
        (
            off_centre([1, 0, 0.1, -0.25]),
            "map.frame.off_centre[0]: [0.1, -0.25] is not in the cell; give less than half of "
            "cell_size, 0.5",
        ),
        ({"map": {"file": "gone.yaml"}}, "map.cell_size: is missing"),
        ({"map": {"file": "gone.yaml", "cell_size": 1}}, "map: gone.yaml: no such file"),
        ({"map": {"file": "gone.yaml", "cells": 1}}, "map: {"),
    ],
)
def test_a_place_or_map_that_cannot_be_taken_gets_one_line(
    changes: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as refused:
        Instance.from_document(document(**changes))
    assert str(refused.value).startswith(said)


@pytest.mark.parametrize(
    ("values", "cell"),
    [
        ({"x": "10.1", "y": "20.6"}, (0, 0)),
        ({"x": "10.6", "y": "20.1"}, (1, 1)),
        ({"row": "1", "col": "2"}, (1, 2)),
    ],
)
def test_a_place_is_a_cell_or_a_point(values: dict[str, str], cell: tuple[int, int]) -> None:
    assert cell_of(values, GRID) == cell


def test_a_point_in_a_wall_is_moved_as_far_as_allowed() -> None:
    # Its own cell's centre is half a metre from those beside and below, of which the first is taken.
    values = {"x": "10.75", "y": "20.75"}
    assert cell_of(values, GRID, snap=0.5) == (0, 0)
    with pytest.raises(InputError, match="is in a wall"):
        cell_of(values, GRID, snap=0.49)


def test_the_nearest_cell_is_that_nearest_to_the_point() -> None:
    # The wall's centre is at 10.75, 20.75; the point is nearer to the right, 0.4 from 11.25, 20.75.
    values = {"x": "10.85", "y": "20.75"}
    assert cell_of(values, GRID, snap=0.4001) == (0, 2)
    with pytest.raises(InputError, match=r"nearest free cell is \[0, 2\]"):
        cell_of(values, GRID)
    # A robot in the cell below stands higher up: at 10.75, 20.45, 0.3 from 10.75, 20.75.
    assert GRID.frame is not None
    raised = replace(GRID, frame=replace(GRID.frame, off_centre=((1, 1, 0.0, 0.2),)))
    assert cell_of({"x": "10.75", "y": "20.75"}, raised, snap=0.3001) == (1, 1)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({}, "has no place; give x and y, or row and col"),
        ({"x": "1"}, "has x; give x and y, or row and col"),
        ({"x": "1", "y": "1", "row": "1", "col": "1"}, "has x, y, row, col; give x and y, or"),
        ({"row": "-1", "col": "0"}, "row: '-1'; give a whole number, 0 or more"),
        ({"row": "0", "col": "1"}, "row 0, col 1 is in a wall; the nearest free cell is"),
        ({"x": "nan", "y": "0"}, "x nan, y 0.0; give finite numbers"),
        ({"x": "one", "y": "0"}, "x: 'one'; give a number"),
    ],
)
def test_a_place_that_is_none_gets_one_line(values: dict[str, str], said: str) -> None:
    with pytest.raises(InputError) as refused:
        cell_of(values, GRID)
    assert str(refused.value).startswith(said)


@pytest.mark.parametrize("mark", [",", ";"])
def test_places_are_read_from_a_csv_file(tmp_path: Path, mark: str) -> None:
    path = tmp_path / "victims.csv"
    lines = ["id,x,y,requirements,priority", "7,10.1,20.6,help+food,2", ",11.2,20.1,,", ""]
    path.write_text("\n".join(lines).replace(",", mark), encoding="utf-8-sig")
    rows = read_places(path, VICTIM_FIELDS)
    mission = draft_mission(GRID, [{"row": "1", "col": "1"}], rows, service_time=HELP_AND_FOOD)
    assert [(v.id, v.cell, v.requirements, v.priority) for v in mission.victims] == [
        (7, (0, 0), ("help", "food"), 2.0),
        (0, (1, 2), ("help",), 1.0),
    ]
    assert mission.robots[0].capabilities == ("help", "food")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("id,z\n", "line 1: unknown column 'z'; known: x, y, row, col, id"),
        ("id,id\n", "line 1: column 'id' is given twice"),
        ("row,col\n1,2,3\n", "line 2: 3 values for 2 columns"),
        ("", "no header; name the columns in the first line"),
        ("row,col\n\n", "no row below the header; give one for each place"),
        ('row,col\n1,"2\n', "line 2: broken CSV"),
        ('row,col\n1,"2"3\n', "line 2: broken CSV"),
    ],
)
def test_a_broken_csv_file_gets_one_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "victims.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        read_places(path, VICTIM_FIELDS)
    assert str(refused.value).startswith(f"{path}: {said}")


def test_values_in_quotes_may_hold_commas_and_follow_blanks(tmp_path: Path) -> None:
    path = tmp_path / "victims.csv"
    path.write_text('row, col, requirements\n1, 1, "help, food"\n', encoding="utf-8")
    rows = read_places(path, VICTIM_FIELDS)
    mission = draft_mission(GRID, [{"row": "1", "col": "1"}], rows, service_time=HELP_AND_FOOD)
    assert mission.victims[0].requirements == ("help", "food")


def test_every_mistake_of_a_csv_file_is_told_by_its_line_and_column(tmp_path: Path) -> None:
    path = tmp_path / "victims.csv"
    path.write_text(
        "id,x,y,priority\n1,10.1,20.1,high\n1,10.1,20.1,\n2,10.75,20.75,\n", encoding="utf-8"
    )
    with pytest.raises(MistakesError) as refused:
        draft_mission(GRID, 1, read_places(path, VICTIM_FIELDS))
    assert [str(error).removeprefix(f"{path}: ") for error in refused.value.each] == [
        "line 3, id: 1 is repeated; ids differ within a group",
        "line 2, priority: 'high'; give a number",
        "line 4: x 10.75, y 20.75 is in a wall; the nearest free cell is [0, 0], at x 10.25, y 20.75",
    ]
    path.write_text("row,col,requirements\n1,1,hlep\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"victims.csv: line 2, requirements: unknown kind 'hlep'"):
        draft_mission(GRID, 1, read_places(path, VICTIM_FIELDS), service_time=HELP_AND_FOOD)


def test_a_bad_row_is_named_by_its_place() -> None:
    rows = [{"row": "1", "col": "1"}, {"row": "0", "col": "1"}]
    with pytest.raises(InputError, match=r"^victims\[1\]: row 0, col 1 is in a wall"):
        draft_mission(GRID, 1, rows)
    with pytest.raises(InputError, match=r"^victims\[0\].priority: 'high'; give a number"):
        draft_mission(GRID, 1, [{"row": "1", "col": "1", "priority": "high"}])


def test_a_place_is_typed_as_names_with_values() -> None:
    typed = typed_place("x=1.5, y=2, requirements=help", VICTIM_FIELDS)
    assert typed == {"x": "1.5", "y": "2", "requirements": "help"}
    with pytest.raises(InputError, match=r"^'speed=1'; give name=value of x, y"):
        typed_place("x=1,speed=1", VICTIM_FIELDS)
    with pytest.raises(InputError, match=r"^'x' is given twice"):
        typed_place("x=1,x=2", VICTIM_FIELDS)


def test_places_at_random_are_the_same_for_a_seed() -> None:
    grid = GridMap(np.ones((8, 8), dtype=bool))
    first, again = (draft_mission(grid, 2, 5, service_time={"help": 1}, seed=3) for _ in range(2))
    assert first == again
    assert (first.n_robots, first.n_victims) == (2, 5)
    assert first.capabilities == ("help",)
