"""Bounds of exact plans proved again: honest ones pass, each forgery is refused for what it is."""

from __future__ import annotations

import copy
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.corridor import DUALS, Document, backwards
from support.joint_oracle import minimum

import msmrta_opt as mo
from msmrta_opt.certify.certificates import SMALL_PROOFS, Recheck, recheck
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.proof import PricingRound
from msmrta_opt.planners.support.explicit_model import problem_of

MAPS = Path(__file__).parents[2] / "instances" / "maps"

LIMITS: list[dict[str, Any]] = [
    {},
    {"return_to_start": True},
    {"endurance": 300},
    {"longest_walk": 90, "return_to_start": True},
]


@cache
def made(seed: int, objective: str, limit: int = 0) -> Plan:
    """A small mission's proven plan."""
    grid = read_map(MAPS / f"map{(0, 2, 3)[seed % 3]}.map")
    mission = generate_mission(grid, 3, 5, seed=seed, solvable=False)
    return mo.plan(mission, planner="exact", objective=objective, **LIMITS[limit])  # type: ignore[arg-type]


@pytest.mark.parametrize("limit", range(len(LIMITS)))
@pytest.mark.parametrize("objective", ["total_time", "makespan", "latency"])
@pytest.mark.parametrize("seed", range(3))
def test_what_is_proved_again_is_no_more_than_the_optimum(
    seed: int, objective: str, limit: int
) -> None:
    plan = made(seed, objective, limit)
    (found,) = recheck(plan)
    assert found.problems == ()
    optimum = minimum(problem_of(plan), objective)  # type: ignore[arg-type]
    assert found.proved is not None
    assert float(found.proved) <= optimum + 1e-6
    assert float(found.value) == pytest.approx(optimum)
    if plan.certificates[0].proof in SMALL_PROOFS:
        assert found.whole
        assert float(found.proved) == pytest.approx(optimum)


def test_some_of_these_plans_are_proved_by_dual_values_and_cuts() -> None:
    """Otherwise the tests above would be about nothing."""
    roots = [made(seed, objective).certificates[0].root for seed in range(3) for objective in BOTH]
    assert any(root is not None and root.n_cuts for root in roots)


BOTH = ("total_time", "makespan")


def test_a_plan_comes_back_from_its_file_with_its_proof(tmp_path: Path) -> None:
    plan = made(0, "total_time")
    plan.save(tmp_path / "plan.json")
    again = Plan.read(tmp_path / "plan.json")
    assert again.certificates == plan.certificates
    assert recheck(again)[0].whole


@pytest.mark.parametrize(("objective", "earlier"), [("makespan", "price"), ("latency", "reward")])
def test_a_file_whose_proof_has_the_earlier_names_is_read_and_proved_and_written_with_the_new(
    objective: str, earlier: str, tmp_path: Path
) -> None:
    file = Path(__file__).parents[1] / "data" / "earlier_plans" / f"{objective}.json"
    assert f'"{earlier}"' in file.read_text()
    plan = Plan.read(file)
    assert problems(plan) == []
    (found,) = recheck(plan)
    assert (found.problems, found.whole) == ((), True)
    plan.save(tmp_path / "plan.json")
    text = (tmp_path / "plan.json").read_text()
    assert '"dual"' in text
    assert f'"{earlier}"' not in text
    assert Plan.read(tmp_path / "plan.json") == plan


def test_every_field_of_a_round_may_have_its_earlier_name() -> None:
    task = {"victim": 3, "kinds": ["A"], "reward": 2, "charges": [1, 0]}
    steps = [{"victim": 3, "begin": [4]}]
    earlier = PricingRound.model_validate({"needs": [task], "steps": steps})
    assert (earlier.tasks[0].dual, earlier.tasks[0].densities) == (2, (1, 0))
    assert earlier.breakpoints[0].times == (4,)
    with pytest.raises(ValueError, match="reward"):
        PricingRound.model_validate({"tasks": [task | {"dual": 1}]})


def test_some_of_these_latencies_are_proved_by_dual_values_alone() -> None:
    """Otherwise the tests above would be about less."""
    proofs = [made(seed, "latency").certificates[0].proof for seed in range(3)]
    assert "column generation" in proofs


def test_a_latency_stopped_early_is_proved_again_as_far_as_it_got() -> None:
    mission = made(0, "total_time").instance
    for time_limit in (0.0, 0.2):
        plan = mo.plan(mission, planner="exact", objective="latency", time_limit=time_limit)
        assert recheck(plan)[0].problems == ()


def test_the_papers_latency_is_proved_again_whole(tmp_path: Path) -> None:
    plan = mo.plan(mo.read(str(MAPS.parent / "paper.json")), planner="exact", objective="latency")
    plan.save(tmp_path / "plan.json")
    (found,) = recheck(Plan.read(tmp_path / "plan.json"))
    assert (found.problems, found.whole) == ((), True)
    assert found.proved == Fraction(6190, 3)


def test_a_plan_without_a_bound_on_the_joint_problem_has_nothing_to_prove() -> None:
    plan = mo.plan(made(0, "total_time").instance, planner="greedy")
    with pytest.raises(InputError, match="'greedy' claims no bound on the joint problem"):
        recheck(plan)


# Forgeries.


@pytest.fixture(scope="module")
def corridor() -> Plan:
    instance = mo.read(str(MAPS.parent / "corridor.json"))
    return mo.plan(instance, planner="exact")


def forged(plan: Plan, edit: Callable[[Document], None]) -> Recheck:
    document = copy.deepcopy(plan.document())
    edit(document["certificates"][0])
    changed = Plan.model_validate(document)
    assert problems(changed) == []
    return recheck(changed)[0]


def with_root(**changes: Any) -> Callable[[Document], None]:
    return lambda certificate: certificate.update(root=DUALS | changes, proof="root LP")


def says(**changes: Any) -> Callable[[Document], None]:
    def edit(certificate: Document) -> None:
        with_root()(certificate)
        certificate.update(changes)

    return edit


def test_dual_values_by_hand_prove_the_corridor(corridor: Plan) -> None:
    found = forged(corridor, with_root())
    assert (found.problems, found.proved, found.whole) == ((), 9, True)


@pytest.mark.parametrize(
    ("edit", "problem"),
    [
        (with_root(bound=10), "the root bound is 10, but only 9 is proved"),
        (with_root(served=[], ends=[]), "the root bound is 9, but only 7 is proved"),
        (with_root(leaves=[{"robot": 0, "dual": -9}]), "the root bound is 9, but only 7 is"),
        (with_root(objective="makespan"), "the root bound is on the makespan"),
        (
            with_root(subtour=[{"robot": 0, "victims": [0], "victim": 1, "dual": -5}]),
            "cut subtour[0] holds only for a victim in its set, not 1",
        ),
        (says(root=None), "nothing is stored that proves a bound by root LP"),
        (says(proof="branch and cut", root=None), "nothing is stored that proves a bound by"),
        (says(proof="combinatorial", root=None), "bound is 9, but only 7 is proved"),
        (says(bound=10.0), "the bound 10 is above what the plan is worth, 9"),
        (says(objective=8.0), "the certificate says 8 for a plan worth 9"),
        (says(objective=None), "the certificate says nothing for a plan worth 9"),
        (says(bound=8.0, gap=1 / 9), "the plan is called optimal at 9, above its bound 8"),
        (says(bound=8.0, status="feasible"), "the gap is said to be 0.0, and is 0.111111"),
    ],
)
def test_a_forgery_is_refused_for_what_it_is(
    corridor: Plan, edit: Callable[[Document], None], problem: str
) -> None:
    found = forged(corridor, edit)
    assert problem in found.problems[0]
    assert "\n" not in found.problems[0]


def test_what_branch_and_cut_proved_is_named_and_not_proved_again(corridor: Plan) -> None:
    def edit(certificate: Document) -> None:
        weak = {"bound": 7, "degree": [], "leaves": [], "ends": [], "served": []}
        certificate.update(root=DUALS | weak, proof="branch and cut")

    found = forged(corridor, edit)
    assert (found.problems, found.proved, found.whole) == ((), 7, False)


def test_a_lower_bound_that_is_honest_holds(corridor: Plan) -> None:
    found = forged(corridor, says(bound=8.0, gap=1 / 9, status="feasible"))
    assert (found.problems, found.whole) == ((), True)


def test_a_worse_plan_does_not_make_the_bound_worse(corridor: Plan) -> None:
    """The same dual values, beside the plan that serves victim 1 first and is done at 3 + 2 + 4 + 2."""
    document = backwards(corridor.document())
    certificate = document["certificates"][0]
    certificate.update(root=DUALS, proof="root LP", gap=2 / 11, status="feasible")
    plan = Plan.model_validate(document)
    assert problems(plan) == []
    (found,) = recheck(plan)
    assert (found.problems, found.value, found.proved) == ((), 11, 9)
