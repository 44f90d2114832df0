"""Plans for robots and other programs: what is read back is what was planned."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.frame import Frame
from msmrta_opt.mission.grid import Cell
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.plan_export import plan_texts

TURNED = Frame(cell_size=0.4, origin=(-3.0, 12.5, 2.0), n_rows=3)


def framed(plan: Plan, frame: Frame | None) -> Plan:
    mission = plan.instance.replace(map=replace(plan.instance.map, frame=frame))
    return plan.model_copy(update={"instance": mission})


def texts(plan: Plan, name: str) -> dict[str, str]:
    return {path.name: text for path, text in plan_texts(plan, name).items()}


def as_the_panel_reads(text: str) -> list[tuple[list[float], list[float]]]:
    """Position and ``[w, x, y, z]`` of each waypoint, in the order of the file."""
    waypoints = yaml.safe_load(text)["waypoints"]
    return [(waypoints[name]["pose"], waypoints[name]["orientation"]) for name in waypoints]


def walked(positions: Iterable[tuple[float, float]], frame: Frame) -> list[Cell]:
    """The cells on the straight lines between positions, each once as long as it is not left."""
    cells = [frame.cell(x, y) for x, y in positions]
    return cells[:1] + [cell for two in pairwise(cells) for cell in line(*two)]


def line(start: Cell, end: Cell) -> Iterator[Cell]:
    steps = max(abs(end[0] - start[0]), abs(end[1] - start[1]))
    for step in range(1, steps + 1):
        yield (
            start[0] + (end[0] - start[0]) * step // steps,
            start[1] + (end[1] - start[1]) * step // steps,
        )


frames = st.builds(
    Frame,
    cell_size=st.floats(0.05, 5),
    origin=st.tuples(st.floats(-500, 500), st.floats(-500, 500), st.floats(-7, 7)),
    n_rows=st.just(3),
)


@st.composite
def any_frame(draw: st.DrawFn) -> Frame:
    """A frame with robots anywhere in their cells."""
    frame = draw(frames)
    within = st.floats(-0.499 * frame.cell_size, 0.499 * frame.cell_size)
    places = st.tuples(st.integers(0, 2), st.integers(0, 3), within, within)
    stands = draw(st.lists(places, unique_by=lambda entry: entry[:2]))
    return replace(frame, off_centre=tuple(stands))


@given(frame=any_frame())
def test_cells_become_poses_and_cells_again_in_any_frame(plan: Plan, frame: Frame) -> None:
    placed = framed(plan, frame)
    for robot in (7, 3):
        cells = plan.route(robot).cells
        found = as_the_panel_reads(texts(placed, "w.yaml")[f"w-{robot}.yaml"])
        assert walked([(x, y) for (x, y, _), _ in found], frame) == cells
    collection = json.loads(texts(placed, "w.geojson")["w.geojson"])
    lines = [f for f in collection["features"] if f["geometry"]["type"] == "LineString"]
    for feature in lines:
        cells = plan.route(feature["properties"]["robot"]).cells
        assert walked(feature["geometry"]["coordinates"], frame) == cells
    rows = list(csv.DictReader(texts(placed, "w.csv")["w.csv"].splitlines()))
    for robot in (7, 3):
        of = [row for row in rows if row["robot"] == str(robot)]
        cells = [frame.cell(float(row["x"]), float(row["y"])) for row in of]
        assert cells == [(int(row["row"]), int(row["col"])) for row in of]
        assert cells == plan.route(robot).cells


def test_waypoints_by_hand_are_as_nav2s_panel_has_them(plan: Plan) -> None:
    # Robot 7 goes right to column 2, on to column 3, down two rows, and left to column 2.
    written = yaml.safe_load(texts(plan, "w.yaml")["w-7.yaml"])
    assert written["header"] == {"frame_id": "map"}
    half = round(math.sqrt(0.5), 9)
    right, down, left = [1, 0, 0, 0], [half, 0, 0, -half], [0, 0, 0, 1]
    assert list(written["waypoints"].items()) == [
        ("waypoint0", {"pose": [0.5, 2.5, 0], "orientation": right}),
        (
            "waypoint1",
            {
                "pose": [2.5, 2.5, 0], "orientation": right,
                "pause": 6, "victim": 20, "serves": ["A", "B"],
            },
        ),
        ("waypoint2", {"pose": [3.5, 2.5, 0], "orientation": right}),
        ("waypoint3", {"pose": [3.5, 0.5, 0], "orientation": down}),
        (
            "waypoint4",
            {"pose": [2.5, 0.5, 0], "orientation": left, "pause": 2, "victim": 10, "serves": ["A"]},
        ),
    ]  # fmt: skip


def test_a_robot_beside_a_centre_turns_towards_it(plan: Plan) -> None:
    # Half a cell up in column 1 of row 0: there and on to column 2 at 0.4 up and down over 1 along.
    frame = Frame(1.0, (0, 0, 0), 3, ((0, 1, 0.0, 0.4),))
    found = list(csv.DictReader(texts(framed(plan, frame), "w.csv")["w.csv"].splitlines()))
    poses = [tuple(float(row[key]) for key in ("x", "y", "yaw")) for row in found[:3]]
    slope = math.atan(0.4)
    assert poses == [
        pytest.approx((0.5, 2.5, slope)),
        pytest.approx((1.5, 2.9, slope)),
        pytest.approx((2.5, 2.5, -slope)),
    ]
    written = as_the_panel_reads(texts(framed(plan, frame), "w.yaml")["w-7.yaml"])
    assert [pose[:2] for pose, _ in written[:3]] == [[0.5, 2.5], [1.5, 2.9], [2.5, 2.5]]


def test_the_rotation_of_the_frame_turns_the_robots(plan: Plan) -> None:
    # Robot 7 sets out along the map's x axis, so its yaw is that of the frame, 2 radians.
    _, (w, x, y, z) = as_the_panel_reads(texts(framed(plan, TURNED), "w.yaml")["w-7.yaml"])[0]
    assert (w, x, y, z) == pytest.approx((math.cos(1), 0, 0, math.sin(1)), abs=1e-8)


def test_every_cell_has_its_time(plan: Plan) -> None:
    rows = list(csv.DictReader(texts(plan, "w.csv")["w.csv"].splitlines()))
    times = [
        (float(row["arrival"]), float(row["departure"])) for row in rows if row["robot"] == "3"
    ]
    assert times == [(0, 0), (2, 2), (4, 4), (6, 7)]  # a cell takes 2, C takes 1
    assert [(row["victim"], row["serves"]) for row in rows if row["victim"]] == [
        ("20", "A+B"), ("10", "A"), ("10", "C"),
    ]  # fmt: skip


def test_geojson_says_what_its_coordinates_are(plan: Plan) -> None:
    cells, metres = (
        json.loads(texts(framed(plan, frame), "w.geojson")["w.geojson"]) for frame in (None, TURNED)
    )
    assert (cells["frame"]["unit"], metres["frame"]["unit"]) == ("cell", "metre")
    assert metres["frame"]["origin"] == [-3.0, 12.5, 2.0]
    assert "crs" not in metres
    visits = [f["properties"] for f in cells["features"] if f["geometry"]["type"] == "Point"]
    assert [(of["robot"], of["stop"], of["victim"]) for of in visits] == [
        (7, 1, 20), (7, 2, 10), (3, 1, 10),
    ]  # fmt: skip


def still(plan: Plan) -> Plan:
    """Robot 7 serves victim 20 where it stands, which takes no move; robot 3 stays."""
    document = plan.document()
    document["instance"]["robots"][0]["start"] = [0, 2]
    visit: dict[str, Any] = document["routes"][0]["visits"][0]
    visit |= {"cells": [[0, 2]], "arrival": 0, "departure": 6}
    document["routes"] = [{"robot": 7, "visits": [visit]}, {"robot": 3}]
    return Plan.model_validate(document)


def test_a_robot_that_serves_where_it_stands_has_no_line_but_a_pause(plan: Plan) -> None:
    written = texts(still(plan), "w.yaml")
    assert list(written) == ["w-7.yaml"]
    last = yaml.safe_load(written["w-7.yaml"])["waypoints"]["waypoint1"]
    assert (last["pose"], last["pause"]) == ([2.5, 2.5, 0], 6)
    features = json.loads(texts(still(plan), "w.geojson")["w.geojson"])["features"]
    assert [feature["geometry"]["type"] for feature in features] == ["Point"]


def test_another_suffix_is_refused_before_anything_is_written(plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"unknown format '.kml'; the suffix is one of .yaml"):
        plan.export(tmp_path / "w.kml")
    assert list(tmp_path.iterdir()) == []
