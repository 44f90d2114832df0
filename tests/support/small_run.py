"""A run worked out by hand, of a plan worked out by hand.

Two rows of six free cells. Robot 1, at [0, 0], goes three cells to victim 10 at [0, 3] and serves A for
2, from 3 to 5. Robot 2, at [1, 5], goes for victim 20 at [1, 1], four cells, but is lost at 2.5, on its
way from [1, 3] to [1, 2]. Victim 30, at [0, 5], turns up at 1.5, and [1, 0] is blocked at 4, which robot
1, at [0, 3], does not see. Both keep to the plan, so victims 20 and 30 are not served.
"""

from __future__ import annotations

from msmrta_opt.execution.execute import execute
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.run import Run

MISSION = {
    "name": "small",
    "map": {"rows": ["......", "......"]},
    "capabilities": ["A"],
    "service_time": {"A": 2},
    "robots": [
        {"id": 1, "start": [0, 0], "speed": 1, "capabilities": ["A"]},
        {"id": 2, "start": [1, 5], "speed": 1, "capabilities": ["A"]},
    ],
    "victims": [
        {"id": 10, "cell": [0, 3], "requirements": ["A"]},
        {"id": 20, "cell": [1, 1], "requirements": ["A"]},
    ],
}
SCENARIO = {
    "lost": [{"robot": 2, "time": 2.5}],
    "victims": [{"id": 30, "cell": [0, 5], "requirements": ["A"], "announced": 1.5}],
    "corridors": [{"cells": [[1, 0]], "blocked": 4}],
}


def small_plan() -> Plan:
    return Plan.model_validate(
        {
            "instance": MISSION,
            "planner": "by hand",
            "routes": [
                _route(1, 10, [[0, col] for col in range(4)], 3),
                _route(2, 20, [[1, col] for col in range(5, 0, -1)], 4),
            ],
        }
    )


def _route(robot: int, victim: int, cells: list[list[int]], arrival: float) -> dict[str, object]:
    visit = {
        "victim": victim, "served": ["A"], "stage": "by hand", "cells": cells,
        "arrival": arrival, "departure": arrival + 2,
    }  # fmt: skip
    return {"robot": robot, "visits": [visit]}


def small_run() -> Run:
    return execute(small_plan(), SCENARIO)
