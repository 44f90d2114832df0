"""What dual values prove, by hand; and every row that is written out holds on every route."""

from __future__ import annotations

import random
from collections import Counter
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from support.corridor import DUALS

from msmrta_opt.certify.joint_problem import Joint
from msmrta_opt.certify.linear_relaxation import Column, relaxation
from msmrta_opt.mission.errors import CheckError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.proof import RootProof

MAPS = Path(__file__).parents[2] / "instances" / "maps"
KIND = "FirstAids"

MAKESPAN: dict[str, Any] = DUALS | {
    "objective": "makespan",
    "served": [
        {"victim": 0, "kind": KIND, "dual": 4},
        {"victim": 1, "kind": KIND, "dual": 8},
    ],
    "present": [
        {"robot": 0, "victim": 0, "kind": KIND, "dual": -2},
        {"robot": 0, "victim": 1, "kind": KIND, "dual": -6},
    ],
    "makespan": [{"robot": 0, "dual": -1}],
}


@pytest.fixture
def corridor(instances_dir: Path) -> Joint:
    instance = Instance.read(instances_dir / "corridor.json")
    return Joint.of(Plan(instance=instance, planner="none", routes=()))


def proved(joint: Joint, document: dict[str, Any], worth: int = 9) -> Fraction:
    proof = RootProof.model_validate(document)
    return relaxation(joint, proof, Fraction(worth)).bound()


@pytest.mark.parametrize("document", [DUALS, MAKESPAN], ids=lambda d: str(d["objective"]))
def test_good_dual_values_prove_the_minimum(corridor: Joint, document: dict[str, Any]) -> None:
    assert proved(corridor, document) == 9


def test_dual_values_that_are_off_prove_less(corridor: Joint) -> None:
    """A dual value of 4 for the degree: e, f and l of victim 1 have a reduced cost of -1 each."""
    off = DUALS | {"degree": [DUALS["degree"][0], DUALS["degree"][1] | {"dual": 4}]}
    assert proved(corridor, off) == 6


def test_no_dual_values_prove_what_all_plans_cost(corridor: Joint) -> None:
    nothing = {"bound": 0, "solver": "nobody"}
    assert proved(corridor, nothing | {"objective": "total_time"}) == 4
    assert proved(corridor, nothing | {"objective": "makespan"}) == 0


def test_a_makespan_above_the_plan_at_hand_is_none_to_look_at(corridor: Joint) -> None:
    """At twice the dual values, T has a reduced cost of -1, and is at most what the plan is worth."""
    twice = MAKESPAN | {
        name: [item | {"dual": 2 * item["dual"]} for item in MAKESPAN[name]]
        for name in ("degree", "leaves", "ends", "served", "present", "makespan")
    }
    assert proved(corridor, twice, worth=9) == 2 * 9 - 9
    assert proved(corridor, twice, worth=10) == 2 * 9 - 10


SUBTOUR = {"robot": 0, "victims": [0, 1], "victim": 0, "dual": -1}


@pytest.mark.parametrize(
    ("forged", "problem"),
    [
        ({"leaves": [{"robot": 0, "dual": 3}]}, None),  # a row with two sides takes any sign
        (
            {"served": [{"victim": 0, "kind": KIND, "dual": -2}]},
            "row served[0, FirstAids] has the",
        ),
        ({"subtour": [SUBTOUR | {"dual": 1}]}, "cut subtour[0] has the wrong sign"),
        ({"leaves": [{"robot": 7, "dual": -1}]}, "row leaves[7], which is no row"),
        ({"degree": [{"robot": 0, "victim": 9, "dual": 1}]}, "degree[0, 9], which is no row"),
        ({"served": [{"victim": 0, "kind": "Defuser", "dual": 1}]}, "Defuser], which is no row"),
        ({"makespan": [{"robot": 0, "dual": -1}]}, "makespan[0], which is no row"),
        ({"walk": [{"robot": 0, "dual": -1}]}, "walk[0], which is no row"),
        ({"leaves": [{"robot": 0, "dual": -1}] * 2}, "row leaves[0] is given twice"),
        ({"subtour": [SUBTOUR | {"victims": [1]}]}, "only for a victim in its set, not 0"),
        ({"outside": [SUBTOUR]}, "only for a victim outside its set, not 0"),
        ({"subtour": [SUBTOUR | {"victims": [0, 1, 1]}]}, "holds a victim twice"),
        ({"subtour": [SUBTOUR | {"victims": [0, 5]}]}, "victim 5, which robot 0 cannot serve"),
        ({"subtour": [SUBTOUR | {"robot": 4}]}, "robot 4, which is not there"),
        ({"first": [{"robot": 0, "victims": [3], "dual": -1}]}, "victim 3, which robot 0 cannot"),
    ],
)
def test_what_does_not_hold_is_refused(
    corridor: Joint, forged: dict[str, Any], problem: str | None
) -> None:
    document = {"objective": "total_time", "bound": 9, "solver": "a forger", **forged}
    if problem is None:
        assert proved(corridor, document) <= 9
        return
    with pytest.raises(CheckError) as refused:
        proved(corridor, document)
    assert problem in str(refused.value)
    assert "\n" not in str(refused.value)


# On random missions: rows and cuts at random, and routes at random.


def some_cuts(joint: Joint, rng: random.Random) -> dict[str, list[dict[str, Any]]]:
    cuts: dict[str, list[dict[str, Any]]] = {k: [] for k in ("subtour", "outside", "first", "last")}
    for r, own in joint.victims_of.items():
        for _ in range(8):
            inside = sorted(rng.sample(own, rng.randint(0, len(own))))
            outside = sorted(set(own) - set(inside))
            cut = {"robot": r, "victims": inside, "dual": -1.0}
            cuts["first"].append(cut)
            cuts["last"].append(cut)
            if inside:
                cuts["subtour"].append(cut | {"victim": rng.choice(inside)})
            if outside:
                cuts["outside"].append(cut | {"victim": rng.choice(outside)})
    return cuts


def some_plan(joint: Joint, rng: random.Random) -> Counter[Column]:
    """Each requirement to any robot able of it, victims in any order; its columns."""
    order: dict[int, list[int]] = {r: [] for r in joint.robots}
    x: Counter[Column] = Counter()
    for v, k in sorted(joint.service):
        r = rng.choice(sorted(r for r, u, kind in joint.able if (u, kind) == (v, k)))
        x["a", r, v, k] = 1
        if v not in order[r]:
            order[r].insert(rng.randint(0, len(order[r])), v)
    for r, route in order.items():
        for v in route:
            x["y", r, v] = 1
        for i, j in pairwise(route):
            x["e", r, min(i, j), max(i, j)] = 1
        if route:
            x["f", r, route[0]] = x["l", r, route[-1]] = 1
    return x


@pytest.mark.parametrize("returns", [False, True])
@pytest.mark.parametrize("objective", ["total_time", "makespan"])
@pytest.mark.parametrize("seed", range(4))
def test_every_row_holds_on_every_plan_and_costs_are_its_value(
    seed: int, objective: str, returns: bool
) -> None:
    rng = random.Random(seed)
    mission = generate_mission(read_map(MAPS / "map2.map"), 3, 6, seed=seed, solvable=False)
    options = {"return_to_start": returns, "endurance": 10_000, "longest_walk": 10_000}
    joint = Joint.of(Plan(instance=mission, planner="none", options=options, routes=()))
    head = {"objective": objective, "bound": 0, "solver": "nobody"}
    proof = RootProof.model_validate(head | some_cuts(joint, rng))
    written = relaxation(joint, proof, Fraction(10_000))
    for _ in range(30):
        x = some_plan(joint, rng)
        way = {c: joint.leave[c[1:]] for c in x if c[0] == "f"}  # type: ignore[index]
        way |= {c: joint.between[c[1:]] for c in x if c[0] == "e"}  # type: ignore[index]
        way |= {c: joint.back(*c[1:]) for c in x if c[0] == "l"}  # type: ignore[arg-type]
        way |= {c: joint.service[c[2:]] for c in x if c[0] == "a"}  # type: ignore[index]
        busy = {r: sum(t for c, t in way.items() if c[1] == r) for r in joint.robots}
        value = sum(busy.values()) if objective == "total_time" else max(busy.values())
        if objective == "makespan":
            x["T",] = value  # type: ignore[assignment]
        cost = sum(x[column] * cost for column, cost in written.cost.items())
        assert written.offset + cost == value
        for row in written.rows:
            activity = sum(weight * x[column] for column, weight in row.entries.items())
            assert row.lower is None or row.lower <= activity, row.name
            assert row.upper is None or row.upper >= activity, row.name
