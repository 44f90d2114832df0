"""The corridor, `instances/corridor.json`, by hand: what proves its optimum, and a worse plan.

Five cells in a row, a robot at 1, victims at 0 and 4, service 2 each. The way over victim 0 is
1 + 4 = 5, so the least time is 9; a plan that serves victim 1 first takes 3 + 4 moves and 4 of service,
which is 11. With dual values u of the degrees (1 and 3), w = -3 for leaving and z = 3 for as many ends
as starts, f, l, e and y all have a reduced cost of 0: 2 (1 + 3) - 3 = 5.
"""

from __future__ import annotations

import copy
from typing import Any

Document = dict[str, Any]

DUALS: Document = {
    "objective": "total_time",
    "bound": 9,
    "solver": "highs by hand",
    "degree": [{"robot": 0, "victim": 0, "dual": 1}, {"robot": 0, "victim": 1, "dual": 3}],
    "leaves": [{"robot": 0, "dual": -3}],
    "ends": [{"robot": 0, "dual": 3}],
    "served": [
        {"victim": 0, "kind": "FirstAids", "dual": 2},
        {"victim": 1, "kind": "FirstAids", "dual": 6},
    ],
}
"""They prove 9."""


def backwards(document: Document) -> Document:
    """The plan that serves victim 1 first, in place of another's document."""
    changed = copy.deepcopy(document)
    changed["routes"][0]["visits"] = [
        {
            "victim": victim,
            "served": ["FirstAids"],
            "stage": "exact",
            "cells": [[0, col] for col in cols],
            "arrival": arrival,
            "departure": arrival + 2,
        }
        for victim, cols, arrival in ((1, range(1, 5), 3), (0, range(4, -1, -1), 9))
    ]
    changed["certificates"][0]["objective"] = 11.0
    return changed
