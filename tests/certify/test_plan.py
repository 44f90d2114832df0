"""The checker passes right plans and refuses wrong ones: each rule broken by one small change."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import pytest
from support.edited_plans import Document, edited, put, visit

from msmrta_opt.certify.plan import check_plan, problems
from msmrta_opt.mission.errors import CheckError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import (
    Plan,
    Reason,
    Route,
    Unserved,
)


def test_the_plan_by_hand_holds(plan: Plan) -> None:
    assert problems(plan) == []
    assert check_plan(plan) is plan


def test_a_plan_for_nobody_holds(mission: Instance) -> None:
    empty = mission.replace(victims=(), scouts=())
    assert problems(Plan(instance=empty, planner="none", routes=())) == []
    stays = (Route(robot=3), Route(robot=7))
    assert problems(Plan(instance=empty, planner="none", routes=stays)) == []


# One change each to the plan of `conftest.py`; robot 7's visits come first, then robot 3's one.


def jump(document: Document) -> None:
    visit(document, 0, 1)["cells"][2] = [0, 0]


def wait(document: Document) -> None:
    visit(document, 0, 1)["cells"][2] = [0, 3]


def serve_twice(document: Document) -> None:
    again = {
        "victim": 20,
        "served": ["B"],
        "stage": "second",
        "cells": [[2, 2], [2, 3], [1, 3], [0, 3], [0, 2]],
        "arrival": 15,
        "departure": 19,
    }
    document["routes"][1]["visits"].append(again)


def serve_without_having_it(document: Document) -> None:
    visit(document, 0, 1).update(served=[], departure=12)
    visit(document, 1).update(served=["A", "C"], departure=9)


def leave_b_of_20(document: Document) -> None:
    visit(document, 0).update(served=["A"], departure=4)
    visit(document, 0, 1).update(arrival=8, departure=10)


def leave_b_of_20_with_an_excuse(document: Document) -> None:
    leave_b_of_20(document)
    document["unserved"].append({"victim": 20, "kind": "B", "reason": "no robot has it"})


def serve_and_excuse(document: Document) -> None:
    document["unserved"].append({"victim": 20, "kind": "B", "reason": "no robot has it"})


def excuse(position: int, reason: str) -> Callable[[Document], None]:
    return lambda document: document["unserved"][position].update(reason=reason)


def forget_an_excuse(document: Document) -> None:
    del document["unserved"][1]


def excuse_twice(document: Document) -> None:
    document["unserved"].append(document["unserved"][1])


def excuse_what_is_not_needed(document: Document) -> None:
    document["unserved"].append({"victim": 20, "kind": "D", "reason": "no robot has it"})


def excuse_for_nobody(document: Document) -> None:
    document["unserved"].append({"victim": 2, "kind": "A", "reason": "no robot has it"})


def visit_the_hidden(document: Document) -> None:
    first, second = document["routes"][0]["visits"]
    passing = {
        "victim": 40,
        "served": [],
        "stage": "second",
        "cells": [[0, 2], [0, 3], [1, 3]],
        "arrival": 10,
        "departure": 10,
    }
    second["cells"] = [[1, 3], [2, 3], [2, 2]]
    document["routes"][0]["visits"] = [first, passing, second]


def hide_nobody(document: Document) -> None:
    document["scouting"]["not_found"].append(2)


def unknown_robot(document: Document) -> None:
    document["routes"].append({"robot": 0, "visits": [], "back": []})


def second_route(document: Document) -> None:
    document["routes"].append({"robot": 7, "visits": [], "back": []})


def back(*cells: list[int]) -> Callable[[Document], None]:
    return lambda document: document["routes"][1].update(back=list(cells))


MUTATIONS: dict[str, tuple[Callable[[Document], None], str]] = {
    # Moves
    "a jump": (jump, "robot 7 on its way to victim 10 jumps from"),
    "a move that stays": (wait, "robot 7 on its way to victim 10 jumps from"),
    "through a wall": (
        put(0, 1, cells=[[0, 2], [1, 2], [2, 2]], arrival=10, departure=12),
        "robot 7 on its way to victim 10 enters (1, 2), which is not a free cell",
    ),
    "off the map": (
        put(
            1,
            cells=[[2, 5], [3, 5], [3, 4], [3, 3], [3, 2], [2, 2]],
            arrival=10,
            departure=11,
        ),
        "which is not a free cell",
    ),
    "from elsewhere than the start": (
        put(1, cells=[[2, 4], [2, 3], [2, 2]], arrival=4, departure=5),
        "robot 3 on its way to victim 10 sets out from (2, 4), but is at (2, 5)",
    ),
    "from elsewhere than the last stop": (
        put(0, 1, cells=[[0, 3], [1, 3], [2, 3], [2, 2]], arrival=11, departure=13),
        "robot 7 on its way to victim 10 sets out from (0, 3), but is at (0, 2)",
    ),
    "not to the victim": (
        put(1, cells=[[2, 5], [2, 4], [2, 3]], arrival=4, departure=5),
        "robot 3 on its way to victim 10 ends at (2, 3), not at (2, 2)",
    ),
    "back from elsewhere": (
        back([2, 3], [2, 4], [2, 5]),
        "robot 3 on its way back sets out from (2, 3), but is at (2, 2)",
    ),
    "back to elsewhere": (
        back([2, 2], [2, 3], [2, 4]),
        "robot 3 on its way back ends at (2, 4), not at (2, 5)",
    ),
    # Times
    "arrival too early": (put(1, arrival=5), "arrives at 5, which should be 6"),
    "arrival too late": (put(1, arrival=6.001), "arrives at 6.001, which should be 6"),
    "departure too late": (put(1, departure=8), "leaves at 8, which should be 7"),
    "departure before service": (put(1, departure=6), "leaves at 6, which should be 7"),
    "the mission's time for the victim's own": (
        put(1, departure=12),
        "robot 3 on its way to victim 10 leaves at 12, which should be 7",
    ),
    # Services
    "without the capability": (serve_without_having_it, "robot 3 serves A without having it"),
    "what is not needed": (
        put(0, 1, served=["A", "B"], departure=18),
        "victim 10 is served B without needing it",
    ),
    "twice by two robots": (serve_twice, "B of victim 20 is served 2× and unserved 0×"),
    "twice in one visit": (
        put(1, served=["C", "C"], departure=8),
        "C of victim 10 is served 2× and unserved 0×",
    ),
    "left out": (leave_b_of_20, "B of victim 20 is served 0× and unserved 0×"),
    "served and excused": (serve_and_excuse, "B of victim 20 is "),
    "excused twice": (excuse_twice, "D of victim 30 is served 0× and unserved 2×"),
    "not excused": (forget_an_excuse, "D of victim 30 is served 0× and unserved 0×"),
    "available, but excused": (
        leave_b_of_20_with_an_excuse,
        "B of victim 20 is unserved for 'no robot has it'; in truth: available",
    ),
    # Reasons
    "reason: none has it, but some have": (
        excuse(0, "no robot has it"),
        "A of victim 30 is unserved for 'no robot has it'; in truth: no capable robot can reach it",
    ),
    "reason: none reaches, but none has it": (
        excuse(1, "no capable robot can reach it"),
        "D of victim 30 is unserved for 'no capable robot can reach it'; in truth: no robot has it",
    ),
    "reason: not found, but known": (
        excuse(1, "not found by the scouts"),
        "D of victim 30 is unserved for 'not found by the scouts'; in truth: no robot has it",
    ),
    "reason: none has it, but not found": (
        excuse(3, "no robot has it"),
        "D of victim 40 is unserved for 'no robot has it'; in truth: not found by the scouts",
    ),
    "reason: endurance, but out of reach": (
        excuse(0, "beyond the robots' endurance"),
        "in truth: no capable robot can reach it",
    ),
    # Names
    "unknown robot": (unknown_robot, "there is no robot 0"),
    "unknown victim": (
        put(0, victim=2),
        "robot 7 visits victim 2, which is not there",
    ),
    "two routes of a robot": (second_route, "robot 7 has 2 routes"),
    "excuse for what is not needed": (
        excuse_what_is_not_needed,
        "victim 20 is listed as unserved for D, which it does not need",
    ),
    "excuse for nobody": (
        excuse_for_nobody,
        "victim 2 is listed as unserved for A, which it does not need",
    ),
    "nobody not found": (hide_nobody, "victim 2 is listed as not found, and is not there"),
    # Scouting
    "not found, but visited": (visit_the_hidden, "victim 40 is visited, but was not found"),
}


@pytest.mark.parametrize("name", MUTATIONS)
def test_a_plan_with_one_rule_broken_is_refused_for_that_rule_alone(plan: Plan, name: str) -> None:
    edit, rule = MUTATIONS[name]
    wrong = problems(edited(plan, edit))
    assert wrong
    assert all(rule in problem for problem in wrong)


def test_a_refusal_says_what_is_wrong_first_and_how_much_more_there_is(plan: Plan) -> None:
    with pytest.raises(CheckError) as one:
        check_plan(edited(plan, put(1, departure=8)))
    assert str(one.value) == (
        "the plan of 'by hand' fails its check:"
        " robot 3 on its way to victim 10 leaves at 8, which should be 7"
    )
    with pytest.raises(CheckError, match=r"arrives at 5, which should be 6 \(and 1 more\)$"):
        check_plan(edited(plan, put(1, arrival=5, departure=8)))


def test_any_cell_of_any_leg_put_elsewhere_is_noticed(plan: Plan) -> None:
    # The legs of this plan are the only shortest ones, so no cell can be exchanged.
    for route, position in ((0, 0), (0, 1), (1, 0)):
        cells = plan.routes[route].visits[position].cells
        for i, elsewhere in product(range(len(cells)), product(range(4), range(7))):
            if elsewhere != cells[i]:
                moved = [*cells[:i], elsewhere, *cells[i + 1 :]]
                assert problems(edited(plan, put(route, position, cells=moved)))


def test_rounding_in_the_last_digits_is_no_mistake(plan: Plan) -> None:
    assert problems(edited(plan, put(1, arrival=6 + 1e-9, departure=7 - 1e-9))) == []


def test_a_way_back_to_the_start_holds(plan: Plan) -> None:
    assert problems(edited(plan, back([2, 2], [2, 3], [2, 4], [2, 5]))) == []


def test_a_robot_without_visits_does_not_walk(plan: Plan) -> None:
    def stroll(document: Document) -> None:
        document["instance"]["robots"].append(
            {"id": 9, "start": [2, 4], "speed": 1, "capabilities": []}
        )
        document["routes"].append({"robot": 9, "visits": [], "back": [[2, 4], [2, 5], [2, 4]]})

    (wrong,) = problems(edited(plan, stroll))
    assert "robot 9" in wrong


def test_a_detour_holds_if_its_time_is_counted(plan: Plan) -> None:
    cells = [[2, 5], [2, 4], [2, 3], [1, 3], [2, 3], [2, 2]]
    assert problems(edited(plan, put(1, cells=cells, arrival=10, departure=11))) == []
    assert problems(edited(plan, put(1, cells=cells)))


def test_a_robot_may_be_left_out_if_it_stays(plan: Plan) -> None:
    def without_robot_3(document: Document) -> None:
        del document["routes"][1]
        document["unserved"].append({"victim": 10, "kind": "C", "reason": "no robot has it"})

    (wrong,) = problems(edited(plan, without_robot_3))
    assert wrong == "C of victim 10 is unserved for 'no robot has it'; in truth: available"


def test_only_a_limit_on_endurance_excuses_an_available_requirement(plan: Plan) -> None:
    """Robot 7 would be done with B alone after 2 moves and 9 of service, robot 3 later."""

    def excused(document: Document) -> None:
        leave_b_of_20(document)
        item = {"victim": 20, "kind": "B", "reason": "beyond the robots' endurance"}
        document["unserved"].append(item)

    def under_a_limit(endurance: float) -> Callable[[Document], None]:
        def edit(document: Document) -> None:
            excused(document)
            document["options"]["endurance"] = endurance
            document["instance"]["service_time"]["B"] = 9

        return edit

    (wrong,) = problems(edited(plan, excused))
    assert "in truth: available" in wrong
    assert problems(edited(plan, under_a_limit(10.5))) == []
    (wrong,) = problems(edited(plan, under_a_limit(11)))
    assert wrong == "B of victim 20 is unserved, but is within some robot's limits"


U_TURNS = {
    "down and up": ["...", ".@.", ".@."],
    "up and down": [".@.", ".@.", "..."],
    "left and right": ["..", "@.", ".."],
    "right and left": ["..", ".@", ".."],
}


@pytest.mark.parametrize("name", U_TURNS)
def test_nobody_round_a_corner_can_be_excused_as_out_of_reach(name: str) -> None:
    grid = grid_from_rows(U_TURNS[name])
    ends = [(row, col) for row in (0, len(grid.rows) - 1) for col in (0, len(grid.rows[0]) - 1)]
    for start, cell in product(ends, repeat=2):
        instance = Instance.from_document(
            {
                "map": {"rows": U_TURNS[name]},
                "capabilities": ["A"],
                "service_time": {"A": 1},
                "robots": [{"id": 0, "start": start, "speed": 1, "capabilities": ["A"]}],
                "victims": [{"id": 0, "cell": cell, "requirements": ["A"]}],
            }
        )
        excuse = Unserved(victim=0, kind="A", reason=Reason.NO_CAPABLE_ROBOT_REACHES_IT)
        plan = Plan(instance=instance, planner="lazy", routes=(), unserved=(excuse,))
        (wrong,) = problems(plan)
        assert wrong.endswith("in truth: available")
