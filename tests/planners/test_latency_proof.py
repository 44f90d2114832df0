"""Proofs of latencies: true by brute force, and nothing false passes their check."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.amounts import sample
from support.joint_cases import MAPS
from support.joint_oracle import minimum

from msmrta_opt.certify.latency_proof import check_latency_proof
from msmrta_opt.certify.plan_proof import check_plan_proof
from msmrta_opt.mission.errors import CheckError, InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.proof import LatencyProof, LatencyTree, PricingRound, TimeStep
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.planners.support.explicit_model import problem_of
from msmrta_opt.planners.support.plan_proof import prove_plan
from msmrta_opt.proofs.tree import Limits
from msmrta_opt.routing.proofs.latency import prove_latency

STEP = 5 / 6
"""Of time, of which walks at the speeds of the missions and services here are multiples."""


@cache
def optimum(seed: int) -> Plan:
    """A plan of the least latency of a mission of two or three robots."""
    grid = read_map(MAPS / "map2.map")
    mission = generate_mission(grid, 2 + seed % 2, 4, seed=seed, solvable=False)
    made = make_plan(mission, planner="exact", objective="latency", time_limit=60)
    assert made.certificates[0].status == "optimal"
    return made


def without_duals(plan: Plan) -> LatencyProof:
    """A root that proves next to nothing, so that all is left to lists of routes and to a tree."""
    steps = tuple(TimeStep(robot=robot.id, length=STEP) for robot in plan.known.robots)
    return LatencyProof(
        bound=0.0, solver="nobody", time_steps=steps, rounds=(PricingRound(tasks=()),)
    )


@cache
def tree(seed: int) -> LatencyTree:
    """The proof of `optimum`, without the root's help."""
    root = without_duals(optimum(seed))
    grown = prove_latency(optimum(seed), root, Limits())
    assert not grown.remark
    return LatencyTree(root=root, leaves=grown.leaves)


@pytest.mark.parametrize("seed", sample(range(25), 3))
def test_the_least_latency_is_proved_and_it_is_that_of_brute_force(
    seed: int, tmp_path: Path
) -> None:
    best = pytest.approx(minimum(problem_of(optimum(seed)), "latency"))
    path = tmp_path / "proof.json"
    proof = prove_plan(optimum(seed), path=path)
    assert proof.status == "proved", proof.summary
    assert proof.bound == best
    assert check_plan_proof(path, optimum(seed)).whole
    alone = check_latency_proof(tree(seed), optimum(seed))
    assert alone.whole
    assert float(alone.bound) == best


# What is tampered with.

BRANCHED = 4
"""A seed whose tree has several leaves."""


def changed(change: Callable[[dict[str, Any]], object]) -> LatencyTree:
    """The tree with branches after a change of its document."""
    document = json.loads(tree(BRANCHED).model_dump_json())
    change(document)
    return LatencyTree.model_validate(document)


def drop_the_last(tree: dict[str, Any]) -> None:
    del tree["leaves"][-1]


def drop_the_first(tree: dict[str, Any]) -> None:
    del tree["leaves"][0]


def twice(tree: dict[str, Any]) -> None:
    tree["leaves"].insert(1, tree["leaves"][0])


def one_more(tree: dict[str, Any]) -> None:
    tree["leaves"].append(tree["leaves"][-1])


def another_side(tree: dict[str, Any]) -> None:
    tree["leaves"][0]["branches"][-1]["high"] = True


def another_task(tree: dict[str, Any]) -> None:
    tree["leaves"][-1]["branches"][0]["victim"] += 100


def densities_beyond_the_priority(tree: dict[str, Any]) -> None:
    task = tree["leaves"][0]["duals"]["tasks"][0]
    task["densities"] = [2 * density + 1 for density in task["densities"]]


def a_dual_value_of_no_task(tree: dict[str, Any]) -> None:
    tree["leaves"][0]["duals"]["tasks"][0]["victim"] += 100


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (drop_the_last, "lacks the other side"),
        (drop_the_first, "leaf 0 does not follow"),
        (twice, "leaf 1 does not follow"),
        (one_more, "one too many"),
        (another_side, "leaf 0 does not follow"),
        (another_task, "leaf 2"),
        (densities_beyond_the_priority, "leaf 0 has densities"),
        (a_dual_value_of_no_task, "leaf 0 has a dual value"),
    ],
)
def test_a_tree_that_is_none_is_refused_with_the_leaf_at_which_it_fails(
    change: Callable[[dict[str, Any]], object], why: str
) -> None:
    with pytest.raises(CheckError, match=why):
        check_latency_proof(changed(change), optimum(BRANCHED))


def test_other_dual_values_prove_less_and_never_more() -> None:
    def change(tree: dict[str, Any]) -> None:
        for leaf in tree["leaves"]:
            for task in leaf["duals"]["tasks"]:
                task["dual"] *= 1.5

    found = check_latency_proof(changed(change), optimum(BRANCHED))
    assert found.bound < found.value
    assert "no plan has a latency below" in found.summary


@pytest.mark.parametrize("planner", ["greedy", "ssi"])
def test_of_a_worse_plan_only_what_is_true_is_proved(planner: str) -> None:
    best = optimum(BRANCHED)
    worse = make_plan(best.instance, planner=planner)
    found = check_latency_proof(tree(BRANCHED), worse)
    assert found.bound <= check_latency_proof(tree(BRANCHED), best).value < found.value


def test_the_longer_a_tree_grows_the_more_is_proved() -> None:
    plan = optimum(BRANCHED)
    root = without_duals(plan)
    whole = prove_latency(plan, root, Limits())
    bounds = []
    for nodes in range(whole.nodes + 1):
        grown = prove_latency(plan, root, Limits(nodes=nodes))
        assert (grown.remark == "") == (nodes >= whole.nodes)
        found = check_latency_proof(LatencyTree(root=root, leaves=grown.leaves), plan)
        assert found.bound <= found.value
        bounds.append(found.bound)
    assert bounds == sorted(bounds)
    assert len(set(bounds)) >= 3  # next to nothing, a part of the tree, all
    assert float(bounds[-1]) == pytest.approx(minimum(problem_of(plan), "latency"))


def test_a_proof_that_is_stopped_says_how_far_it_got(tmp_path: Path) -> None:
    plan = optimum(BRANCHED)
    (claimed,) = plan.certificates
    weak = claimed.model_copy(update={"pricing": without_duals(plan)})
    plan = plan.model_copy(update={"certificates": (weak,)})
    proof = prove_plan(plan, path=tmp_path / "proof.json", time_limit=0)
    assert proof.status == "partial"
    assert proof.remark == "time limit"
    assert "claimed by branch and price" in proof.summary
    with pytest.raises(InputError, match=r"of a latency the suffix is \.json"):
        prove_plan(plan, path=tmp_path / "proof.vipr")
