"""Clusters of plans: right ones hold, each rule broken by one small change is refused."""

from __future__ import annotations

import copy
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan as make_plan

Document = dict[str, Any]

# The plan of `support.by_hand`: cluster 0 holds victims 20 at (0, 2) and 10 at (2, 2), and (1, 3)
# stands for its mean (1, 2), a wall; cluster 1 holds victim 30 at (0, 5), behind walls.


def put(number: int, **fields: object) -> Callable[[Document], None]:
    return lambda document: document["clusters"][number].update(fields)


def drop(document: Document) -> None:
    del document["clusters"][1]


CASES: dict[str, tuple[Callable[[Document], None], str]] = {
    "a robot that is not there": (put(0, robots=[7, 8]), "cluster 0 names robot 8, which is not"),
    "a robot twice": (put(0, robots=[7, 7]), "cluster 0 names a robot twice"),
    "a victim that is not there": (
        put(1, victims=[30, 31]),
        "victim 31 is in a cluster, and is not known",
    ),
    "a victim that was not found": (
        put(1, victims=[30, 40]),
        "victim 40 is in a cluster, and is not known",
    ),
    "a victim in two clusters": (
        put(1, victims=[30, 20], centre=[0, 3.5], cell=[0, 3], deferred=[30]),
        "victim 20 is in 2 clusters",
    ),
    "a victim in none": (drop, "victim 30 is in 0 clusters"),
    "nobody": (put(1, victims=[]), "victim 30 is in 0 clusters"),
    "another centre": (put(0, centre=[1, 2.01]), "cluster 0 has its centre at [1.0, 2.01], which"),
    "a wall": (put(0, cell=[1, 2]), "cluster 0 is stood for by (1, 2), from which no member"),
    "off the map": (put(0, cell=[9, 9]), "cluster 0 is stood for by (9, 9), from which no member"),
    "no cell": (put(0, cell=None), "cluster 0 is stood for by None, from which no member can be"),
    "out of reach": (put(1, cell=[0, 3]), "cluster 1 is stood for by (0, 3), from which no member"),
    "deferred for nothing": (
        put(0, deferred=[20]),
        "cluster 0 defers victim 20, whose walk is as short as without walls",
    ),
    "not deferred": (
        put(0, cell=[0, 2]),
        "cluster 0 does not defer victim 10, whose walk is longer than without walls",
    ),
    "deferred from elsewhere": (put(0, deferred=[30]), "cluster 0 defers victim 30, which is no"),
}


def edited(plan: Plan, edit: Callable[[Document], None]) -> Plan:
    document = copy.deepcopy(plan.document())
    edit(document)
    return Plan.model_validate(document)


@pytest.mark.parametrize("name", CASES)
def test_clusters_with_one_rule_broken_are_refused(name: str, plan: Plan) -> None:
    edit, problem = CASES[name]
    wrong = problems(edited(plan, edit))
    assert wrong
    assert problem in wrong[0]


def test_a_plan_without_clusters_says_nothing_of_them(plan: Plan) -> None:
    assert problems(edited(plan, lambda document: document.update(clusters=[]))) == []


@cache
def staged(instances: Path) -> Plan:
    return make_plan(Instance.read(instances / "paper.json"))


def test_the_staged_methods_cells_are_the_nearest(instances_dir: Path) -> None:
    plan = staged(instances_dir)
    row, col = plan.clusters[0].cell or (0, 0)
    beside = next(
        cell
        for cell in ((row, col + 1), (row + 1, col), (row, col - 1), (row - 1, col))
        if plan.instance.map.is_free(cell)
    )
    (wrong, *_) = problems(edited(plan, put(0, cell=list(beside))))
    assert wrong == f"cluster 0 is stood for by {beside}, which should be {(row, col)}"


def test_pinned_clusters_are_those_of_the_mission(instances_dir: Path) -> None:
    plan = staged(instances_dir)
    assert plan.instance.clusters is not None

    def swap(document: Document) -> None:
        labels = document["instance"]["clusters"]
        first, other = 0, next(i for i, label in enumerate(labels) if label != labels[0])
        labels[first], labels[other] = labels[other], labels[first]

    assert any("is none of those that the mission pins" in p for p in problems(edited(plan, swap)))
