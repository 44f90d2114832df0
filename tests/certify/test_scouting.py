"""Scouting replayed: sight against the planner's own, and each rule of a report broken by one change."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples

from msmrta_opt.certify.plan import problems
from msmrta_opt.certify.scouting import in_sight
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.instance import Instance, Scout
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.visibility import FieldOfView
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.stages.scouting import scouting

Document = dict[str, Any]


@st.composite
def grids(draw: st.DrawFn) -> GridMap:
    n_rows, n_cols = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    walls = draw(st.sampled_from([0.1, 0.3, 0.5]))
    chance = np.random.RandomState(draw(st.integers(0, 2**32 - 1)))
    free = chance.random_sample((n_rows, n_cols)) > walls
    free[0, 0] = True
    return GridMap(free)


@settings(max_examples=examples(80))
@given(grid=grids(), depth=st.integers(0, 10) | st.just(10**9))
def test_what_is_in_sight_is_what_the_scouts_see(grid: GridMap, depth: int) -> None:
    look = FieldOfView(grid, depth)
    for row, col in np.argwhere(grid.free).tolist():
        seen = np.zeros(grid.shape, dtype=bool)
        in_sight(grid, depth, (row, col), seen)
        assert seen.tolist() == look((row, col)).tolist()


def test_what_was_seen_before_stays_seen() -> None:
    grid = GridMap(np.ones((1, 5), dtype=bool))
    seen = np.zeros(grid.shape, dtype=bool)
    in_sight(grid, 1, (0, 0), seen)
    in_sight(grid, 1, (0, 4), seen)
    assert seen.tolist() == [[True, True, False, True, True]]


# One change each to the report of `support.by_hand`: scout 5 walks from (0, 2) to (2, 2) round the
# left in six moves, scout 6 is walled in at (0, 5); both see their own cells alone.


def report(**fields: object) -> Callable[[Document], None]:
    return lambda document: document["scouting"].update(fields)


def track(position: int, **fields: object) -> Callable[[Document], None]:
    return lambda document: document["scouting"]["tracks"][position].update(fields)


def cell(step: int, place: list[int]) -> Callable[[Document], None]:
    return lambda document: document["scouting"]["tracks"][0]["cells"].__setitem__(step, place)


def find(position: int, **fields: object) -> Callable[[Document], None]:
    return lambda document: document["scouting"]["finds"][position].update(fields)


def lose_a_track(document: Document) -> None:
    del document["scouting"]["tracks"][1]


def a_stranger(document: Document) -> None:
    document["scouting"]["tracks"].append(
        {"scout": 9, "visual_field_depth": 0, "cells": [[0, 5]] * 7}
    )


def no_scouts(document: Document) -> None:
    document["instance"]["scouts"] = []


def say_found(document: Document) -> None:
    """Victim 40, to be served by nobody, is listed as found."""
    document["scouting"]["not_found"] = []
    document["scouting"]["finds"].append({"victim": 40, "scout": 5, "step": 6})


def say_not_found(document: Document) -> None:
    document["scouting"]["not_found"] = [40, 30]
    del document["scouting"]["finds"][1]


def say_both(document: Document) -> None:
    document["scouting"]["not_found"] = [40, 30]


def say_nothing(document: Document) -> None:
    document["scouting"]["not_found"] = []


def find_twice(document: Document) -> None:
    document["scouting"]["finds"].append(document["scouting"]["finds"][0])


def go_shorter(document: Document) -> None:
    for own in document["scouting"]["tracks"]:
        own["cells"].pop()


CASES: dict[str, tuple[Callable[[Document], None], str]] = {
    "no scouts": (no_scouts, "scouting is reported, but the mission has no scouts"),
    "a scout without a track": (lose_a_track, "scout 6 has 0 tracks"),
    "a track of nobody": (a_stranger, "there is no scout 9"),
    "a track twice": (track(1, scout=5), "scout 5 has 2 tracks"),
    "sight too far": (
        track(1, visual_field_depth=3),
        "scout 6 is said to see 3 cells far, and sees 0",
    ),
    "a shorter track": (track(1, cells=[[0, 5]] * 6), "scout 6 has 6 cells, where others have 7"),
    "no cells": (track(1, cells=[]), "scout 6 has 0 cells, where others have 7"),
    "from elsewhere": (cell(0, [0, 0]), "scout 5 does not set out from its start (0, 2)"),
    "a jump": (cell(3, [0, 3]), "scout 5 jumps from (0, 0) to (0, 3) at step 3"),
    "into a wall": (cell(3, [1, 1]), "scout 5 is at (1, 1) at step 3, which is not a free cell"),
    "off the map": (cell(6, [3, 1]), "scout 5 is at (3, 1) at step 6, which is not a free cell"),
    "a step diagonally": (cell(1, [1, 3]), "scout 5 jumps from (0, 2) to (1, 3) at step 1"),
    "a stop": (cell(1, [0, 2]), "scout 5 stays at (0, 2) at step 1, though it can move"),
    "found by another": (
        find(0, scout=6),
        "victim 20 is found by scout 6 at step 0, which should be scout 5 at step 0",
    ),
    "found sooner": (
        find(2, step=5),
        "victim 10 is found by scout 5 at step 5, which should be scout 5 at step 6",
    ),
    "found, but not seen": (
        say_found,
        "victim 40 is found by scout 5 at step 6, but no scout sees it",
    ),
    "not found, but seen": (
        say_not_found,
        "victim 30 is listed as not found, but scout 6 sees it at step 0",
    ),
    "found and not found": (say_both, "victim 30 is listed 2 times as found or not found"),
    "neither": (say_nothing, "victim 40 is listed 0 times as found or not found"),
    "found twice": (find_twice, "victim 20 is listed 2 times as found or not found"),
    "more covered": (
        report(coverage=[seen / 13 for seen in (2, 3, 4, 5, 6, 7, 9)]),
        "coverage after step 6 is 0.692308, which should be 0.615385",
    ),
    "coverage of fewer steps": (
        report(coverage=[2 / 13]),
        "coverage is given for 1 steps of 7",
    ),
    "all covered": (report(ended="covered"), "ended by 'covered', which does not hold"),
    "all found": (
        report(ended="all victims found"),
        "ended by 'all victims found', which does not hold",
    ),
    "a walk cut short": (
        go_shorter,
        "victim 10 is found by scout 5 at step 6, but no scout sees it",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_report_with_one_rule_broken_is_refused(name: str, plan: Plan) -> None:
    edit, problem = CASES[name]
    document = copy.deepcopy(plan.document())
    edit(document)
    wrong = problems(Plan.model_validate(document))
    assert any(problem in line for line in wrong), wrong


@pytest.mark.parametrize("hidden", [[1], [0, 1]])
def test_victims_are_not_hidden_by_scouts_that_are_not_there(
    hidden: list[int], instances_dir: Path
) -> None:
    mission = Instance.read(instances_dir / "corridor.json")
    document = make_plan(mission, planner="exact").document()
    document["certificates"] = []
    document["routes"][0]["visits"] = document["routes"][0]["visits"][: -len(hidden)]
    document["unserved"] = [
        {"victim": v, "kind": "FirstAids", "reason": "not found by the scouts"} for v in hidden
    ]
    document["scouting"] = {
        "walk": "none",
        "shared_table": True,
        "seed": 0,
        "tracks": [],
        "finds": [],
        "not_found": hidden,
        "coverage": [1.0],
        "ended": "covered",
    }
    assert problems(Plan.model_validate(document)) == [
        "scouting is reported, but the mission has no scouts"
    ]


@settings(max_examples=examples(40))
@given(grid=grids(), seed=st.integers(0, 999), data=st.data())
def test_what_scouts_report_holds_and_no_victim_can_be_hidden_or_invented(
    grid: GridMap, seed: int, data: st.DataObject
) -> None:
    if grid.free.sum() < 2:
        return
    mission = generate_mission(grid, 1, 3, seed=seed, solvable=False)
    cells = [(row, col) for row, col in np.argwhere(grid.free).tolist()]
    starts = data.draw(st.lists(st.sampled_from(cells), min_size=1, max_size=3))
    depths = [data.draw(st.integers(0, 4)) for _ in starts]
    mission = mission.replace(
        scouts=tuple(
            Scout(id=10 * i, start=start, visual_field_depth=depth)
            for i, (start, depth) in enumerate(zip(starts, depths, strict=True))
        )
    )
    walk = data.draw(st.sampled_from(["ant_colony", "random"]))
    stop = data.draw(st.sampled_from(["covered", "covered_or_found"]))
    made = scouting(mission, walk=walk, seed=seed, max_steps=20, stop=stop)
    plan = Plan(instance=mission, planner="nobody", routes=(), scouting=made)

    def wrong(scouted: Plan) -> list[str]:
        return [p for p in problems(scouted) if "scout" in p or "cover" in p or "listed" in p]

    assert wrong(plan) == []
    for victim in mission.victims:
        changed = plan.document()
        listed = changed["scouting"]["not_found"]
        if victim.id in listed:
            listed.remove(victim.id)
        else:
            listed.append(victim.id)
        assert wrong(Plan.model_validate(changed))
