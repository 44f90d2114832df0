"""The checker holds a plan to the limits that its options name.

Of the plan by hand, robot 7 is done at 14 after 6 moves, and robot 3 at 7 after 3.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from support.edited_plans import Document, edited, visit

from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.plan import Plan


def under(**options: object) -> Callable[[Document], None]:
    return lambda document: document["options"].update(options)


@pytest.mark.parametrize(
    "limits",
    [
        {"endurance": 14},
        {"longest_walk": 6},
        {"endurance": 14.0, "longest_walk": 6.5},
        {"endurance": None, "longest_walk": None, "return_to_start": False},
        {"endurance": None, "return_to_start": None},
    ],
)
def test_a_plan_within_its_limits_holds(limits: dict[str, object], plan: Plan) -> None:
    assert problems(edited(plan, under(**limits))) == []


@pytest.mark.parametrize(
    ("limits", "wrong"),
    [
        ({"endurance": 13.9}, "robot 7 is busy for 14, beyond its 13.9"),
        ({"longest_walk": 5}, "robot 7 walks 6, beyond its 5"),
        ({"longest_walk": 5.5}, "robot 7 walks 6, beyond its 5.5"),
        ({"endurance": "long"}, "option endurance is 'long', which is no number from 0 on"),
        ({"endurance": True}, "option endurance is True, which is no number from 0 on"),
        ({"longest_walk": -1}, "option longest_walk is -1, which is no number from 0 on"),
        ({"longest_walk": [5]}, "option longest_walk is [5], which is no number from 0 on"),
        ({"return_to_start": "no"}, "option return_to_start is 'no', which is not true or false"),
    ],
)
def test_a_plan_beyond_a_limit_that_it_names_is_refused(
    limits: dict[str, object], wrong: str, plan: Plan
) -> None:
    assert problems(edited(plan, under(**limits))) == [wrong]


def home(document: Document) -> None:
    """Robot 7 walks back the way it came, 6 moves; robot 3 in 3 moves at speed 0.5."""
    document["options"]["return_to_start"] = True
    there = [cell for position in (0, 1) for cell in visit(document, 0, position)["cells"][:-1]]
    document["routes"][0]["back"] = [[2, 2], *reversed(there)]
    document["routes"][1]["back"] = visit(document, 1)["cells"][::-1]


def test_robots_that_are_to_return_must(plan: Plan) -> None:
    assert problems(edited(plan, under(return_to_start=True))) == [
        "robot 7 stays at (2, 2) instead of returning",
        "robot 3 stays at (2, 2) instead of returning",
    ]
    assert problems(edited(plan, home)) == []


@pytest.mark.parametrize(
    ("limits", "wrong"),
    [
        ({"endurance": 20, "longest_walk": 12}, None),
        ({"endurance": 19.5}, "robot 7 is busy for 20, beyond its 19.5"),
        ({"longest_walk": 11}, "robot 7 walks 12, beyond its 11"),
    ],
)
def test_the_way_back_counts_towards_the_limits(
    limits: dict[str, object], wrong: str | None, plan: Plan
) -> None:
    back = edited(edited(plan, home), under(**limits))
    assert problems(back) == ([] if wrong is None else [wrong])
