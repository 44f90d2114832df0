"""Random plans and scenarios, by number, on missions plain and odd; and a mission by hand."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

from support.odd_missions import odd_mission

from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.scenario import Scenario
from msmrta_opt.planners import plan as make_plan

MAPS = [
    read_map(Path(__file__).parents[2] / "instances" / "maps" / f"map{i}.map") for i in range(4)
]
QUICK_PLANNERS = ("ssi", "greedy", "random", "mrga", "msmrta")
CORRIDOR: dict[str, Any] = {
    "map": {"rows": ["......", "@@@.@@"]},
    "capabilities": ["Aid"],
    "service_time": {"Aid": 10.0},
    "robots": [{"id": 4, "start": [0, 0], "speed": 1.0, "capabilities": ["Aid"]}],
    "victims": [
        {"id": 7, "cell": [0, 2], "requirements": ["Aid"]},
        {"id": 8, "cell": [0, 5], "requirements": ["Aid"]},
    ],
}
"""One robot, speed 1, in a corridor of six cells; victims at its cells 2 and 5, 10 each."""

WALLED: dict[str, Any] = {
    "map": {"rows": ["...@..."]},
    "capabilities": ["Aid"],
    "service_time": {"Aid": 5.0},
    "robots": [{"id": 0, "start": [0, 0], "speed": 1.0, "capabilities": ["Aid"]}],
    "victims": [
        {"id": 0, "cell": [0, 6], "requirements": ["Aid"]},
        {"id": 1, "cell": [0, 1], "requirements": ["Aid"]},
    ],
}
"""One robot in a corridor with a wall at its cell 3, behind which is one of two victims."""


def mission(number: int) -> Instance:
    """The mission of that number: a plain one, or every third time an odd one."""
    chance = random.Random(f"execution {number}")
    if number % 3 == 2:
        return odd_mission(number)
    return generate_mission(
        MAPS[number % 4],
        chance.randint(1, 6),
        chance.randint(1, 12),
        seed=number,
        per_robot=(1, 4),
        per_victim=(1, 3),
        solvable=False,
    )


def plan(number: int, planner: str | None = None) -> Plan:
    """A plan of that mission, by each planner in turn."""
    given = mission(number)
    return make_plan(given, planner=planner or QUICK_PLANNERS[number % len(QUICK_PLANNERS)])


def scenario(number: int, made: Plan) -> Scenario:
    """What may happen to a plan: something of everything."""
    chance = random.Random(f"scenario {number}")
    given = made.instance
    free = [(int(r), int(c)) for r, c in zip(*given.map.free.nonzero(), strict=True)]
    walked = [cell for route in made.routes for cell in route.cells] or free
    end = max((v.departure for route in made.routes for v in route.visits), default=1.0) or 1.0
    robots = [robot.id for robot in given.robots]

    def some_time() -> float:
        times = [v.arrival for route in made.routes for v in route.visits] or [0.0]
        return chance.choice([0.0, chance.random() * end, chance.choice(times)])

    document: dict[str, Any] = {
        "notice": chance.choice(["before", "at_once"]),
        "visual_field_depth": chance.choice([0, 1, 3]),
        "speed": [
            {**_distribution(chance), "robot": robot} for robot in robots if chance.random() < 0.5
        ]
        + ([_distribution(chance)] if chance.random() < 0.5 else []),
        "service": [
            {**_distribution(chance), "kind": kind}
            for kind in given.capabilities
            if chance.random() < 0.3
        ],
        "lost": [
            chance.choice([{"robot": robot, "time": some_time()}, {"rate": 1 / end}])
            for robot in robots
            if chance.random() < 0.3
        ],
        "victims": [
            {
                "id": 10**6 + i,
                "cell": chance.choice(free),
                "requirements": chance.sample(given.capabilities, 1),
                **({"announced": some_time()} if chance.random() < 0.7 else {}),
            }
            for i in range(chance.choice([0, 0, 1, 2]))
        ],
        "corridors": [
            chance.choice(
                [
                    {"cells": cells, "blocked": some_time()},
                    {"cells": cells, "opened": some_time()},
                    {"cells": cells, "blocked": end / 4, "opened": end / 4 + some_time() + end / 9},
                ]
            )
            for cells in ([chance.choice(walked) for _ in range(2)] for _ in range(3))
            if chance.random() < 0.5
        ],
    }
    if chance.random() < 0.25:
        until = end * chance.choice([0.3, 1.0, 2.0])
        tables = [*document["lost"], *document["victims"], *document["corridors"]]
        if not any(value == until for table in tables for value in table.values()):
            document["until"] = until
    return Scenario.from_document(document)


def _distribution(chance: random.Random) -> dict[str, Any]:
    return chance.choice(
        [
            {"distribution": "fixed", "value": chance.choice([0.5, 1.0, 2.0])},
            {"distribution": "lognormal", "sigma": chance.choice([0.0, 0.3, 1.0])},
            {"distribution": "triangular", "low": 0.5, "mode": 1.0, "high": 3.0},
        ]
    )
