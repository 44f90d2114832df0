"""A mission and a plan for it that are worked out by hand, and a breadth-first oracle."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import pytest

from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan

# Ids differ from positions throughout, so that neither can pass for the other.
MISSION = {
    "name": "by hand",
    "map": {"rows": ["....@.", ".@@.@@", "......"]},
    "capabilities": ["A", "B", "C", "D"],
    "service_time": {"A": 2, "B": 4, "C": 6, "D": 8},
    "robots": [
        {"id": 7, "start": [0, 0], "speed": 1, "capabilities": ["A", "B"]},
        {"id": 3, "start": [2, 5], "speed": 0.5, "capabilities": ["B", "C"]},
    ],
    "victims": [
        {"id": 20, "cell": [0, 2], "requirements": ["A", "B"]},
        # Split over both robots; serving C takes 1 here, not 6.
        {
            "id": 10,
            "cell": [2, 2],
            "requirements": ["A", "C"],
            "service_time": {"C": 1},
            "priority": 2,
        },
        # Behind walls.
        {"id": 30, "cell": [0, 5], "requirements": ["A", "D"]},
        # Not found by the scouts, who see no further than their own cells and do not pass here.
        {"id": 40, "cell": [1, 3], "requirements": ["B", "D"]},
    ],
    "scouts": [
        {"id": 5, "start": [0, 2], "visual_field_depth": 0},
        {"id": 6, "start": [0, 5], "visual_field_depth": 0},
    ],
}

PLAN = {
    "format": "msmrta-plan/1",
    "planner": "by hand",
    "options": {"seed": 1},
    "versions": {},
    "routes": [
        {
            "robot": 7,
            "visits": [
                {  # 2 moves, then A and B take 6
                    "victim": 20,
                    "served": ["A", "B"],
                    "stage": "first",
                    "cells": [[0, 0], [0, 1], [0, 2]],
                    "arrival": 2,
                    "departure": 8,
                },
                {  # 4 moves, then A takes 2
                    "victim": 10,
                    "served": ["A"],
                    "stage": "second",
                    "cells": [[0, 2], [0, 3], [1, 3], [2, 3], [2, 2]],
                    "arrival": 12,
                    "departure": 14,
                },
            ],
            "back": [],
        },
        {
            "robot": 3,
            "visits": [
                {  # 3 moves at speed 0.5, then C takes 1
                    "victim": 10,
                    "served": ["C"],
                    "stage": "first",
                    "cells": [[2, 5], [2, 4], [2, 3], [2, 2]],
                    "arrival": 6,
                    "departure": 7,
                }
            ],
            "back": [],
        },
    ],
    "unserved": [
        {"victim": 30, "kind": "A", "reason": "no capable robot can reach it"},
        {"victim": 30, "kind": "D", "reason": "no robot has it"},
        {"victim": 40, "kind": "B", "reason": "not found by the scouts"},
        {"victim": 40, "kind": "D", "reason": "not found by the scouts"},
    ],
    "scouting": {
        "walk": "by hand",
        "shared_table": True,
        "seed": 0,
        "tracks": [
            {
                "scout": 5,
                "visual_field_depth": 0,
                "cells": [[0, 2], [0, 1], [0, 0], [1, 0], [2, 0], [2, 1], [2, 2]],
            },
            {"scout": 6, "visual_field_depth": 0, "cells": [[0, 5]] * 7},
        ],
        "finds": [
            {"victim": 20, "scout": 5, "step": 0},
            {"victim": 30, "scout": 6, "step": 0},
            {"victim": 10, "scout": 5, "step": 6},
        ],
        "not_found": [40],
        "coverage": [seen / 13 for seen in (2, 3, 4, 5, 6, 7, 8)],
        "ended": "step limit",
    },
    "clusters": [
        {
            "victims": [20, 10],
            "centre": [1, 2],
            "cell": [1, 3],
            "robots": [7],
            "deferred": [],
        },
        {"victims": [30], "centre": [0, 5], "cell": [0, 5], "robots": [], "deferred": []},
    ],
    "certificates": [],
    "planning_seconds": {"one": 0.25, "two": 0.5},
}


@pytest.fixture(scope="session")
def mission() -> Instance:
    """The mission worked out by hand."""
    return Instance.from_document(MISSION)


@pytest.fixture(scope="session")
def plan(mission: Instance) -> Plan:
    """A right plan for it."""
    return Plan.model_validate(PLAN | {"instance": mission})


Distances = Callable[[GridMap, Cell], dict[Cell, int]]


@pytest.fixture(scope="session")
def breadth_first() -> Distances:
    """An oracle: the free cells that can be reached from a free cell, with their distances."""

    def distances(grid: GridMap, start: Cell) -> dict[Cell, int]:
        free = {
            (r, c) for r, row in enumerate(grid.rows) for c, char in enumerate(row) if char == "."
        }
        found, border = {start: 0}, deque([start])
        while border:
            row, col = here = border.popleft()
            for cell in ((row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)):
                if cell in free and cell not in found:
                    found[cell] = found[here] + 1
                    border.append(cell)
        return found

    return distances
