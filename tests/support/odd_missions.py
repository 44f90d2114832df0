"""Random missions with odd features, by number: what users hand in sooner or later.

One-cell maps, corridors and walled-in places; several victims on a cell and victims that need nothing;
speeds from 1e-9 to 1e9 and services from 0 to 1e9; ids far from positions; fifty kinds; pinned
clusters; scouts who see little. Small enough that all solutions can be tried.
"""

from __future__ import annotations

import random
from typing import Any

from msmrta_opt.mission.instance import Instance

Document = dict[str, Any]


def odd_mission(number: int) -> Instance:
    """The mission of that number."""
    return Instance.from_document(odd_document(number))


def odd_document(number: int) -> Document:
    """Its document."""
    chance = random.Random(f"mission {number}")
    rows, cells = _map(chance)
    n_kinds = chance.choice([1, 1, 2, 2, 3, 50])
    kinds = [f"k{k}" for k in range(n_kinds)]
    chance.shuffle(kinds)
    services = chance.choice(
        [[0.0], [1.0, 2.0], [0.5, 7.5, 20.0], [1e-9, 1.0], [1e9, 3.0], [0.1, 1 / 3]]
    )
    n_robots, n_victims = chance.randint(1, 3), chance.choice([0, 1, 2, 2, 3, 3, 4, 5])
    few = chance.sample(cells, min(len(cells), chance.randint(1, 4)))  # so that many share a cell
    victims = []
    left = 5  # requirements in all: more would be too many to try all solutions
    for ident in _ids(chance, n_victims):
        needs = chance.sample(kinds, min(n_kinds, chance.randint(0, 3), left))
        left -= len(needs)
        own = {kind: chance.choice(services) for kind in needs if chance.random() < 0.3}
        victims.append(
            {
                "id": ident,
                "cell": list(chance.choice(few if chance.random() < 0.5 else cells)),
                "requirements": needs,
                "service_time": own,
                "priority": chance.choice([0.0, 0.5, 1.0, 1.0, 3.0, 1e-6]),
            }
        )
    needed = [kind for victim in victims for kind in victim["requirements"]]
    document: Document = {
        "name": f"odd {number}",
        "map": {"rows": rows},
        "capabilities": kinds,
        "service_time": {kind: chance.choice(services) for kind in kinds},
        "robots": [
            {
                "id": ident,
                "start": list(chance.choice(cells)),
                "speed": _speed(chance),
                "capabilities": [
                    k for k in kinds if chance.random() < (0.7 if k in needed else 0.2)
                ],
            }
            for ident in _ids(chance, n_robots)
        ],
        "victims": victims,
    }
    if chance.random() < 0.3:
        document["scouts"] = [
            {"id": ident, "start": list(chance.choice(cells)), "visual_field_depth": depth}
            for ident, depth in zip(
                _ids(chance, chance.randint(1, 2)), chance.choices([0, 1, 2, 9], k=2), strict=False
            )
        ]
    if chance.random() < 0.3:
        document["clusters"] = [chance.choice([0, 0, 1, 2, 7]) for _ in victims]
    return document


def odd_options(number: int, planner: str) -> Document:
    """Options for a planner on the mission of that number."""
    chance = random.Random(f"options {number} {planner}")
    if planner == "msmrta":
        return {
            "preset": chance.choice(["paper", "authors"]),
            "cluster_model": chance.choice(
                ["cluster_printed", "cluster_one_to_one", "cluster_budgeted", "cluster_fair"]
            ),
            "victim_model": chance.choice(
                [
                    *("victim_printed", "victim_one_to_one", "victim_covering", "victim_balanced"),
                    *("victim_bottleneck", "victim_budgeted"),
                ]
            ),
            "clustering_model": chance.choice([None, None, None, "clustering_pmedian"]),
            "award": chance.choice(["sealed", "sequential"]),
            "through_centre": chance.random() < 0.5,
            "pinned_clusters": chance.random() < 0.7,
            "psi": chance.choice([0.0, 0.5, 0.95, 1.0]),
            "beta": chance.choice([0.0, 0.5, 1.0]),
            "seed": chance.randrange(5),
        }
    if planner == "exact":
        options: Document = {
            "objective": chance.choice(["total_time", "makespan", "latency"]),
            "seed": chance.randrange(5),
            "time_limit": chance.choice([0.0, 0.1, 2.0, 2.0]),
        }
        if chance.random() < 0.2:
            options["return_to_start"] = True
        if chance.random() < 0.15:
            options["longest_walk"] = chance.randint(0, 20)
        return options
    return {"seed": chance.randrange(5)}


def _map(chance: random.Random) -> tuple[list[str], list[tuple[int, int]]]:
    shape = chance.choice([(1, 1), (1, 2), (1, 7), (6, 1), (2, 2), (3, 4), (5, 5), (6, 8), (9, 9)])
    walls = chance.choice([0.0, 0.15, 0.35, 0.6])
    rows = [
        "".join("@" if chance.random() < walls else "." for _ in range(shape[1]))
        for _ in range(shape[0])
    ]
    cells = [(r, c) for r, row in enumerate(rows) for c, char in enumerate(row) if char == "."]
    return (rows, cells) if cells else (["."], [(0, 0)])


def _ids(chance: random.Random, n: int) -> list[int]:
    if chance.random() < 0.3:
        return list(range(n))
    return chance.sample([*range(20), 104, 999, 2**31 - 1, 2**53 + 1, 10**18], n)


def _speed(chance: random.Random) -> float:
    return chance.choice(
        [1.0, 1.0, 0.3, 0.4, 1 / 3, 0.7, 2.5, 1e-9, 1e9, 10 ** chance.uniform(-9, 9), 3e-7, 2e5]
    )
