"""The replay of a plan as data and as a page; `test_replay_page` plays it in a browser."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt import plots
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import Cell
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.layouts import rubble
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.plots.replay.data import document, walk_code, wall_runs

NASTY = '</script><b>"it\'s" & <!-- ${x} {{DATA}} \u2028'


def walked(start: Cell, code: str) -> list[Cell]:
    """The cells of a walk from its code, one after the other."""
    moves = {"R": (0, 1), "D": (1, 0), "L": (0, -1), "U": (-1, 0), "S": (0, 0)}
    cells = [start]
    for letter, count in re.findall(r"([A-Z])(\d*)", code):
        for _ in range(int(count or 1)):
            row, col = cells[-1]
            cells.append((row + moves[letter][0], col + moves[letter][1]))
    return cells


def data_of(page: str) -> list[dict[str, Any]]:
    (found,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    parsed: list[dict[str, Any]] = json.loads(found)
    return parsed


def named(plan: Plan, name: str) -> Plan:
    return plan.model_copy(update={"planner": name, "instance": plan.instance.replace(name=name)})


def test_a_walk_is_its_moves_with_their_counts() -> None:
    assert walk_code([(5, 5)]) == ""
    assert walk_code([(0, 0), (0, 1), (0, 2), (1, 2), (1, 1), (0, 1)]) == "R2DLU"
    assert walk_code([(3, 3), (3, 3), (3, 3)]) == "S2"


def test_a_walk_that_jumps_is_refused_with_its_place(plan: Plan) -> None:
    with pytest.raises(InputError, match=r"from \[0, 0\] to \[1, 1\] is not one move"):
        walk_code([(0, 0), (1, 1)])
    visit = plan.routes[0].visits[1].model_copy(update={"cells": ((0, 0), (0, 1))})
    visits = (plan.routes[0].visits[0], visit)
    route = plan.routes[0].model_copy(update={"visits": visits})
    jumping = plan.model_copy(update={"routes": (route, plan.routes[1])})
    with pytest.raises(InputError, match=r"routes\[0\]\.visits\[1\]\.cells: begins at \[0, 0\]"):
        plots.plot_replay(jumping)


def test_walls_are_runs_along_the_rows_free_cells_first() -> None:
    assert wall_runs(grid_from_rows(["..@", "@@."])) == [2, 3, 1]
    assert wall_runs(grid_from_rows(["@.", ".."])) == [0, 1, 3]
    assert wall_runs(grid_from_rows(["..", ".."])) == [4]


def test_the_data_says_what_the_plan_says(plan: Plan) -> None:
    data = document(plan)
    assert (data["makespan"], data["available"]) == (14.0, 4)
    robots = {robot["id"]: robot for robot in data["robots"]}
    assert set(robots) == {7, 3}
    for route in plan.routes:
        here: Cell = tuple(robots[route.robot]["start"])
        for visit, said in zip(route.visits, robots[route.robot]["visits"], strict=True):
            assert data["victims"][said["victim"]]["id"] == visit.victim
            assert [data["kinds"][k] for k in said["kinds"]] == list(visit.served)
            assert data["stages"][said["stage"]]["name"] == visit.stage
            assert walked(here, said["walk"]) == list(visit.cells)
            assert (said["arrival"], said["departure"]) == (visit.arrival, visit.departure)
            here = visit.cells[-1]
    reasons = {
        (victim["id"], data["kinds"][kind]): reason
        for victim in data["victims"]
        for kind, reason in victim["unserved"].items()
    }
    assert reasons == {(item.victim, item.kind): item.reason for item in plan.unserved}


def test_scouting_is_told_step_by_step(plan: Plan) -> None:
    scouting = document(plan)["scouting"]
    tracks = plan.scouting.tracks if plan.scouting else ()
    for track, scout in zip(tracks, scouting["scouts"], strict=True):
        assert walked(tuple(scout["start"]), scout["walk"]) == list(track.cells)
    assert scouting["finds"] == [[20, 5, 0], [30, 6, 0], [10, 5, 6]]
    assert scouting["missed"] == [40]


def test_a_robot_that_returns_is_home_when_it_has_walked_back(plan: Plan) -> None:
    back = ((2, 2), (2, 3), (2, 4), (2, 5))
    route = plan.routes[1].model_copy(update={"back": back})
    returning = plan.model_copy(update={"routes": (plan.routes[0], route)})
    robot = document(returning)["robots"][1]
    assert walked((2, 2), robot["back"]) == list(back)
    assert robot["home"] == 7 + 3 / 0.5


def test_robots_have_the_colours_of_the_pictures(plan: Plan) -> None:
    colours = [robot["colour"] for robot in document(plan)["robots"]]
    assert colours == [plots.robot_colour(0), plots.robot_colour(1)]


def test_names_cannot_break_out_of_the_page(plan: Plan) -> None:
    page = plots.plot_replay(named(plan, NASTY)).page
    assert data_of(page)[0]["name"] == NASTY
    assert NASTY not in page
    assert page.count("</script>") == 2
    assert "<b>" not in page
    assert html.escape(NASTY) in page


def test_the_page_names_nothing_on_a_network(plan: Plan) -> None:
    page = plots.plot_replay(plan).page
    assert "default-src 'none'" in page
    assert not re.search(r"https?:|//[a-z]+\.|<link|<img|@import|url\(", page)


def test_a_notebook_shows_the_page_in_a_frame_of_its_own(plan: Plan) -> None:
    replay = named(plan, NASTY).replay()
    (inside,) = re.findall(
        r'^<iframe srcdoc="([^"]*)" title="[^"]*" sandbox=', replay._repr_html_()
    )
    assert html.unescape(inside) == replay.page


def test_a_replay_is_written_as_its_suffix_says(plan: Plan, tmp_path: Path) -> None:
    replay = plan.replay()
    replay.save(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text(encoding="utf-8") == replay.page
    with pytest.raises(InputError, match=r"unknown format '\.pdf'"):
        replay.save(tmp_path / "a.pdf")


def test_two_plans_are_told_apart_and_three_refused(plan: Plan) -> None:
    both = data_of(plan.replay(plan).page)
    assert [data["label"] for data in both] == ["A: by hand", "B: by hand"]
    with pytest.raises(InputError, match="3 plans; give one or two"):
        plots.Replay([plan, plan, plan])


def test_the_same_plan_gives_the_same_page(plan: Plan) -> None:
    assert plan.replay().page == plan.replay().page


def test_a_mission_without_victims_or_name_has_a_replay(instances_dir: Path) -> None:
    mission = Instance.read(instances_dir / "no_victims.json").replace(name="")
    (data,) = data_of(make_plan(mission).replay().page)
    assert (data["name"], data["makespan"], data["victims"]) == ("unnamed mission", 0.0, [])


@pytest.mark.slow
def test_a_hundred_robots_and_a_thousand_victims_take_less_than_a_megabyte() -> None:
    grid = rubble(256, 256, seed=1)
    mission = generate_mission(grid, n_robots=100, n_victims=1000, seed=1)
    assert len(make_plan(mission).replay().page.encode()) < 1_000_000
