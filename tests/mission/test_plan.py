from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.plan import Plan, Route, Visit


def test_a_routes_cells_pass_each_stop_once(plan: Plan) -> None:
    assert plan.route(7).cells == [
        (0, 0), (0, 1), (0, 2), (0, 3), (1, 3), (2, 3), (2, 2),
    ]  # fmt: skip
    assert plan.route(3).cells == [(2, 5), (2, 4), (2, 3), (2, 2)]


def test_a_routes_distance_is_the_number_of_its_moves(plan: Plan) -> None:
    assert plan.route(7).distance == 6
    assert plan.route(3).distance == 3


def test_the_way_back_counts() -> None:
    visit = Visit(
        victim=0, served=(), stage="x", cells=((0, 0), (0, 1), (0, 2)), arrival=2, departure=2
    )
    route = Route(robot=0, visits=(visit,), back=((0, 2), (0, 1), (0, 0)))
    assert route.distance == 4
    assert route.cells == [(0, 0), (0, 1), (0, 2), (0, 1), (0, 0)]


def test_a_robot_already_at_its_victim_walks_nowhere() -> None:
    visit = Visit(victim=0, served=(), stage="x", cells=((4, 4),), arrival=0, departure=0)
    route = Route(robot=0, visits=(visit, visit))
    assert route.distance == 0
    assert route.cells == [(4, 4)]


def test_a_robot_that_stays_has_no_cells() -> None:
    assert Route(robot=0).cells == []
    assert Route(robot=0).distance == 0


def test_routes_are_found_by_the_robots_id(plan: Plan) -> None:
    assert plan.route(3).robot == 3
    with pytest.raises(InputError, match="no robot 0 in this plan; there are 7, 3"):
        plan.route(0)


def test_a_plan_cannot_be_changed(plan: Plan) -> None:
    with pytest.raises(ValidationError, match="frozen"):
        plan.routes = ()  # type: ignore[misc]
    with pytest.raises(ValidationError, match="frozen"):
        plan.routes[0].visits[0].arrival = 0.0  # type: ignore[misc]


# Files


def test_a_saved_plan_reads_back_the_same(plan: Plan, tmp_path: Path) -> None:
    plan.save(tmp_path / "plan.json")
    read = Plan.read(tmp_path / "plan.json")
    assert read.document() == plan.document()
    assert read == plan
    assert read.metrics == plan.metrics


def test_a_plan_file_needs_no_other_file(plan: Plan, instances_dir: Path, tmp_path: Path) -> None:
    # Its map was read from a file; the plan's file holds the rows.
    paper = type(plan.instance).read(instances_dir / "paper.json")
    idle = Plan(instance=paper, planner="none", routes=())
    idle.save(tmp_path / "plan.json")
    saved = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    assert saved["format"] == "msmrta-plan/1"
    assert saved["instance"]["map"] == {"rows": list(paper.map.rows)}
    assert Plan.read(tmp_path / "plan.json").instance == paper


def put(document: Any, path: list[str | int], value: object) -> None:
    for key in path[:-1]:
        document = document[key]
    document[path[-1]] = value


@pytest.mark.parametrize(
    ("path", "value", "problem"),
    [
        (["format"], "msmrta-instance/1", "format: 'msmrta-instance/1'; give 'msmrta-plan/1'"),
        (["colour"], "red", "colour: 'red'; there is no such field"),
        (["routes"], None, "routes: null; give a list"),
        (["routes", 0, "robot"], "7", "routes[0].robot: '7'; give a whole number"),
        (
            ["routes", 0, "visits", 1, "cells"],
            [],
            "routes[0].visits[1].cells: []; give a list of 1",
        ),
        (
            ["routes", 0, "visits", 1, "cells", 2],
            [1, 3, 0],
            "routes[0].visits[1].cells[2]: [1, 3, 0]; give two numbers, [row, col]",
        ),
        (
            ["routes", 0, "visits", 0, "arrival"],
            -1,
            "routes[0].visits[0].arrival: -1; give 0 or more",
        ),
        (
            ["routes", 0, "visits", 0, "departure"],
            float("inf"),
            "routes[0].visits[0].departure: Infinity; give a finite number",
        ),
        (
            ["unserved", 0, "reason"],
            "too far",
            "unserved[0].reason: 'too far'; give 'no robot has it', 'no capable robot can reach",
        ),
        (["instance", "robots", 0, "speed"], 0, "instance.robots[0].speed: 0; give a number above"),
        (
            ["instance", "victims", 1, "cell"],
            [0, 4],
            "instance.victims[1].cell: [0, 4] is in a wall; give a free cell",
        ),
        (["instance", "map"], {"rows": []}, "instance.map.rows: the map is empty"),
    ],
)
def test_a_broken_plan_is_refused_naming_file_field_value_and_what_is_right(
    plan: Plan, tmp_path: Path, path: list[str | int], value: object, problem: str
) -> None:
    document = plan.document()
    put(document, path, value)
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        Plan.read(file)
    assert str(caught.value).startswith(f"{file}: {problem}")
    assert str(caught.value).isprintable()


def test_a_plan_file_that_is_not_there_is_said_to_be_missing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"plan\.json: no such file"):
        Plan.read(tmp_path / "plan.json")


# Comparing


def test_plans_are_the_same_whatever_time_planning_took(plan: Plan) -> None:
    slower = plan.model_copy(update={"planning_seconds": {"one": 99.0}})
    assert plan.same_as(slower)
    assert slower != plan


@pytest.mark.parametrize(
    "update",
    [
        {"planner": "other"},
        {"options": {"seed": 2}},
        {"routes": ()},
        {"unserved": ()},
        {"scouting": None},
        {"clusters": ()},
    ],
    ids=lambda update: next(iter(update)),
)
def test_plans_that_differ_in_anything_else_are_not_the_same(
    plan: Plan, update: dict[str, Any]
) -> None:
    assert not plan.same_as(plan.model_copy(update=update))


# Limits, which a planner promises of every robot's whole route or does not.


def limited(plan: Plan, **said: object) -> dict[str, object]:
    document = plan.document()
    document["options"] = {"endurance": 5, "longest_walk": None, "return_to_start": False}
    document.update(said)
    return Plan.model_validate_json(json.dumps(document), strict=True).limits


def test_limits_are_the_options_that_are_promised(plan: Plan) -> None:
    assert limited(plan, promises=["endurance"]) == {"endurance": 5}
    assert limited(plan, promises=["longest_walk", "return_to_start"]) == {"return_to_start": False}
    assert limited(plan, promises=[]) == {}


def test_a_file_of_before_promises_all_its_limits_but_those_of_a_staged_plan(plan: Plan) -> None:
    assert limited(plan, promises=None) == {"endurance": 5, "return_to_start": False}
    staged = {"preset": "paper", "endurance": 5}
    assert limited(plan, promises=None, options=staged) == {}


def test_a_promise_of_no_limit_is_refused(plan: Plan) -> None:
    with pytest.raises(ValidationError, match="promises"):
        limited(plan, promises=["seed"])
