"""Whether a plan is for a mission, by small changes of the mission by hand; differences in ids."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import pytest

from msmrta_opt.certify.same_mission import differences
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan

Document = dict[str, Any]


def changed(mission: Instance, edit: Callable[[Document], object]) -> Instance:
    document = copy.deepcopy(mission.document())
    edit(document)
    return Instance.from_document(document)


def row(number: int, text: str) -> Callable[[Document], object]:
    return lambda document: document["map"]["rows"].__setitem__(number, text)


def of(group: str, position: int, **fields: object) -> Callable[[Document], object]:
    return lambda document: document[group][position].update(fields)


CASES: dict[str, tuple[Callable[[Document], object], list[str]]] = {
    "nothing": (lambda document: None, []),
    "another name": (lambda document: document.update(name="else"), []),
    "another order": (lambda document: document["victims"].reverse(), []),
    "kinds in another order": (lambda document: document["capabilities"].reverse(), []),
    "a wall less": (
        row(1, "..@.@@"),
        ["the map differs at (1, 1), blocked in the plan and free in the mission"],
    ),
    "two walls more": (
        row(2, "@@...."),
        [
            "the map differs at (2, 0), free in the plan and blocked in the mission (and 1 more cells)"
        ],
    ),
    "a larger map": (
        lambda document: document["map"]["rows"].append("......"),
        ["the map has another size, 3 × 6 in the plan and 4 × 6 in the mission"],
    ),
    "another service time": (
        lambda document: document["service_time"].update(B=5),
        ["serving B takes another time, 4.0 in the plan and 5.0 in the mission"],
    ),
    "a victim elsewhere": (
        of("victims", 1, cell=[2, 3]),
        ["victim 10 stands elsewhere, (2, 2) in the plan and (2, 3) in the mission"],
    ),
    "a victim that needs less": (
        of("victims", 0, requirements=["B"]),
        ["victim 20 needs something else, A, B in the plan and B in the mission"],
    ),
    "a victim of another priority": (
        of("victims", 1, priority=3),
        ["victim 10 has another priority, 2.0 in the plan and 3.0 in the mission"],
    ),
    "a victim of other times": (
        of("victims", 1, service_time={}),
        [
            "victim 10 has other service times, {'C': 1.0} in the plan and none of its own in the"
            " mission"
        ],
    ),
    "a victim of another number": (
        of("victims", 3, id=41),
        ["victim 40 is not in the mission", "victim 41 is not in the plan"],
    ),
    "a faster robot": (
        of("robots", 1, speed=2),
        ["robot 3 has another speed, 0.5 in the plan and 2.0 in the mission"],
    ),
    "a robot elsewhere that can do less": (
        of("robots", 0, start=[0, 1], capabilities=[]),
        [
            "robot 7 starts elsewhere, (0, 0) in the plan and (0, 1) in the mission",
            "robot 7 has other capabilities, A, B in the plan and none in the mission",
        ],
    ),
    "a scout that sees further": (
        of("scouts", 1, visual_field_depth=1),
        ["scout 6 sees another distance, 0 in the plan and 1 in the mission"],
    ),
    "no scouts": (
        lambda document: document.update(scouts=[]),
        ["scout 5 is not in the mission", "scout 6 is not in the mission"],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_difference_is_named_by_ids(name: str, plan: Plan) -> None:
    edit, expected = CASES[name]
    assert differences(plan, changed(plan.instance, edit)) == expected
