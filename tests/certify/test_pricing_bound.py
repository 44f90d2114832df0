"""What dual values prove about latency: by hand, by listing all routes, and never above the optimum."""

from __future__ import annotations

import json
import random
from fractions import Fraction
from functools import cache
from itertools import combinations, permutations, product
from pathlib import Path
from typing import Any

import pytest
from support.amounts import sample
from support.joint_oracle import minimum

from msmrta_opt.certify.certificates import recheck, worth
from msmrta_opt.certify.joint_problem import Joint
from msmrta_opt.certify.ng_routes import Network
from msmrta_opt.certify.plan import problems
from msmrta_opt.certify.pricing_bound import pricing_bound
from msmrta_opt.certify.scheduling_bound import scheduling_bound
from msmrta_opt.mission.errors import CheckError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.proof import LatencyProof
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.planners.support.explicit_model import problem_of
from msmrta_opt.routing.combinatorial_bounds import latency_bound

MAPS = Path(__file__).parents[2] / "instances" / "maps"
KIND = "FirstAids"
Document = dict[str, Any]

# By hand: a corridor of five cells, a robot at 1, victims at 0 and 4, service 2 each. Victim 0 first
# is done at 3 and 9, which is best; alone, the victims are done at 3 and 5. With dual values 7 and 9 no
# route costs less than -4 (either alone, or both in this order), so 7 + 9 - 4 = 12 is proved.

ROUND: Document = {
    "tasks": [
        {"victim": 0, "kinds": [KIND], "dual": 7, "densities": [1]},
        {"victim": 1, "kinds": [KIND], "dual": 9, "densities": [1]},
    ],
}
STEP = [{"robot": 0, "length": 1}]


@pytest.fixture
def corridor(instances_dir: Path) -> Joint:
    instance = Instance.read(instances_dir / "corridor.json")
    return Joint.of(Plan(instance=instance, planner="none", routes=()))


def by_hand(joint: Joint, *rounds: Document, worth: int = 12, **changes: Any) -> Fraction:
    document = {"bound": 12, "solver": "by hand", "time_steps": STEP}
    proof = LatencyProof.model_validate(document | {"rounds": rounds or (ROUND,)} | changes)
    return pricing_bound(joint, proof, Fraction(worth))


def changed(*tasks: Document, **changes: Any) -> Document:
    """The round with other dual values of some tasks."""
    old = [item | new for item, new in zip(ROUND["tasks"], tasks, strict=True)]
    return ROUND | {"tasks": old} | changes


def test_good_dual_values_prove_the_minimum_latency(corridor: Joint) -> None:
    assert by_hand(corridor) == 12


def test_beside_a_worse_plan_they_prove_as_much(corridor: Joint) -> None:
    assert by_hand(corridor, worth=16) == 12


def test_dual_values_that_are_off_prove_less(corridor: Joint) -> None:
    """With a dual value of 10 for victim 1, it alone and both cost -5: 7 + 10 - 5 = 12; with 11, 11."""
    assert by_hand(corridor, changed({}, {"dual": 10}), worth=20) == 12
    assert by_hand(corridor, changed({"dual": 8}, {}), worth=20) == 12
    assert by_hand(corridor, changed({"dual": 4}, {}), worth=20) == 9
    assert by_hand(corridor, changed({"densities": [0]}, {"densities": [0]}), worth=20) == 0


def test_no_dual_values_prove_nothing(corridor: Joint) -> None:
    assert by_hand(corridor, {"tasks": []}, worth=20) == 0


def test_long_time_steps_prove_less_and_never_more(corridor: Joint) -> None:
    """In steps of 2 the legs of 1, 3 and 4 are 0, 1 and 2 steps: done at 2 and 2 + 4 + 2 = 8."""
    slow = [{"robot": 0, "length": 2}]
    assert by_hand(corridor, time_steps=slow, worth=20) <= 10


@pytest.mark.parametrize("length", [5e-324, 1e-300, 1e-9, 1e-5])
def test_steps_without_end_are_counted_in_longer_ones(length: float, corridor: Joint) -> None:
    """No more than is true is proved, and in as many steps as a search may have."""
    deadlines = {0: Fraction(7), 1: Fraction(16)}
    tasks = {v: ((v, (KIND,)),) for v in (0, 1)}
    network = Network(corridor, tasks, 0, Fraction(length), deadlines)
    assert network.last <= 20_000
    assert network.last * network.step <= 16
    assert by_hand(corridor, time_steps=[{"robot": 0, "length": length}], worth=20) <= 12


@pytest.mark.parametrize("number", [1e-300, 1e17, 1e30, 1e300, 1.7e308])
def test_numbers_of_any_size_prove_no_more_than_is_true(number: float, corridor: Joint) -> None:
    late = {"breakpoints": [{"victim": 0, "times": [number]}]}
    for forged in (
        changed({"dual": number}, {}),
        changed({"dual": -number}, {"dual": number}),
        changed({"densities": [0, 1]}, {}, **late),
        changed({"densities": [1, 0]}, {}, **late),
    ):
        assert by_hand(corridor, forged, worth=20) <= 12
    if number > 1:
        with pytest.raises(CheckError, match="a leg takes no step"):
            by_hand(corridor, time_steps=[{"robot": 0, "length": number}], worth=20)


FORGED_STEPS: dict[str, dict[int, float]] = {
    # The time steps of the robots of a plan of the planner, of which one was changed in the file.
    "as it is": {},
    "mended": {2: 10 / 7},
    "one without end": {2: 1e-300},
    "all without end": dict.fromkeys(range(4), 5e-324),
    "a hundredth": {1: 0.0016, 3: 0.0077},
}


@pytest.mark.parametrize("name", FORGED_STEPS)
def test_a_bound_beside_changed_time_steps_is_refused_for_what_is_proved(name: str) -> None:
    file = Path(__file__).parents[1] / "data" / "earlier_plans" / "tampered_step.json"
    document = json.loads(file.read_text())
    for robot, length in FORGED_STEPS[name].items():
        document["certificates"][0]["pricing"]["clocks"][robot]["length"] = length
    plan = Plan.model_validate(document)
    assert problems(plan) == []
    (found,) = recheck(plan)
    assert found.proved is not None
    assert float(found.proved) <= minimum(problem_of(plan), "latency") + 1e-6
    (problem,) = found.problems
    assert problem.startswith("the root bound is 344.431753, but only ")


def test_what_one_round_rules_out_the_next_does_not_see(corridor: Joint) -> None:
    """Alone, the second round's dual values let victim 1 be served twice over."""
    weak = changed({"dual": 3}, {"dual": 9})
    assert by_hand(corridor, weak, worth=13) == 8
    assert by_hand(corridor, ROUND, weak, worth=13) == 12


@pytest.mark.parametrize(
    ("forged", "problem"),
    [
        (
            changed({"densities": [2]}, {}),
            "round 0 has densities at victim 0 that exceed its priority",
        ),
        (
            changed({"victim": 7}, {}),
            "round 0 has a dual value of FirstAids at victim 7, which is no task",
        ),
        (
            changed({"kinds": ["Defuser"]}, {}),
            "round 0 has a dual value of Defuser at victim 0, which is no task",
        ),
        (changed({}, {"victim": 0}), "round 0 has two dual values of FirstAids at victim 0"),
        (
            changed({"densities": [1, 1]}, {}),
            "has 2 densities of FirstAids at victim 0 for 1 intervals of time",
        ),
        (
            changed({"densities": [1, 1, 1]}, {}, breakpoints=[{"victim": 0, "times": [4, 3]}]),
            "round 0 has breakpoints of victim 0 that are out of order",
        ),
        (
            ROUND | {"neighbourhoods": [{"robot": 0, "victim": 0, "remembers": [1, 9]}]},
            "round 0 has robot 0 remember victim 9, which it cannot serve",
        ),
    ],
)
def test_what_does_not_hold_is_refused(corridor: Joint, forged: Document, problem: str) -> None:
    with pytest.raises(CheckError) as refused:
        by_hand(corridor, forged, worth=20)
    assert problem in str(refused.value)
    assert "\n" not in str(refused.value)


def test_every_robot_needs_a_time_step_that_orders_its_services(corridor: Joint) -> None:
    with pytest.raises(CheckError, match="robot 0 has no time step"):
        by_hand(corridor, time_steps=[])
    with pytest.raises(CheckError, match="a leg takes no step"):
        by_hand(corridor, time_steps=[{"robot": 0, "length": 4}], worth=20)


def test_fifty_tasks_in_one_visit_are_too_many_to_count_with(corridor: Joint) -> None:
    kinds = [f"k{k}" for k in range(50)]
    mission = Instance.from_document(
        {
            "map": {"rows": ["..."]},
            "capabilities": kinds,
            "service_time": dict.fromkeys(kinds, 1),
            "robots": [
                {"id": r, "start": [0, r], "speed": 1, "capabilities": kinds} for r in (0, 1)
            ],
            "victims": [{"id": 5, "cell": [0, 2], "requirements": kinds}],
        }
    )
    joint = Joint.of(Plan(instance=mission, planner="none", routes=()))
    steps = [{"robot": r, "length": 1} for r in (0, 1)]
    with pytest.raises(CheckError, match="robot 0 has too many tasks at victim 5 to count with"):
        by_hand(joint, {"tasks": []}, time_steps=steps, worth=1000)


# On random missions, with dual values at random.


@cache
def mission(seed: int, limit: int = 0) -> tuple[Joint, float, Fraction]:
    """A joint problem, its least latency, and what another plan is worth."""
    grid = read_map(MAPS / f"map{(0, 2, 3)[seed % 3]}.map")
    made = generate_mission(
        grid, 2, 4, seed=seed, per_robot=(2, 4), per_victim=(1, 3), solvable=False
    )
    priority = {v.id: (0.0, 0.5, 1.0, 3.0)[(v.id + seed) % 4] for v in made.victims}
    made = made.replace(
        victims=tuple(v.model_copy(update={"priority": priority[v.id]}) for v in made.victims)
    )
    options: Document = ({}, {"endurance": 900, "return_to_start": True})[limit]
    plan = make_plan(made, planner="exact", objective="latency", time_limit=0, **options)
    return Joint.of(plan), minimum(problem_of(plan), "latency"), worth(plan, "latency")


def tasks_of(joint: Joint) -> list[tuple[int, tuple[str, ...]]]:
    """What one robot will serve in one visit anyway is one task."""
    groups: dict[tuple[int, int | str], tuple[str, ...]] = {}
    for v, k in sorted(joint.service):
        able = [r for r in joint.robots if (r, v, k) in joint.able]
        key = (v, able[0] if len(able) == 1 else k)
        groups[key] = (*groups.get(key, ()), k)
    return [(v, kinds) for (v, _), kinds in groups.items()]


def at_random(joint: Joint, rng: random.Random, *, all_remembered: bool = False) -> Document:
    """A round of dual values; densities add up to no more than the priorities."""
    begin = {v: sorted(rng.randint(1, 300) for _ in range(rng.randint(0, 2))) for v in range(9)}
    tasks = tasks_of(joint)
    items = []
    for v, kinds in tasks:
        many = sum(w == v for w, _ in tasks)
        charges = [
            rng.random() ** 0.2 * float(joint.priority[v]) / many for _ in range(len(begin[v]) + 1)
        ]
        reward = rng.uniform(0, 2) * float(joint.priority[v] * 150) / many
        items.append({"victim": v, "kinds": kinds, "dual": reward, "densities": charges})
    return {
        "tasks": items,
        "breakpoints": [{"victim": v, "times": own} for v, own in begin.items()],
        "neighbourhoods": [
            {
                "robot": r,
                "victim": v,
                "remembers": [w for w in own if all_remembered or rng.random() < 0.5],
            }
            for r, own in joint.victims_of.items()
            for v in own
        ],
    }


def exact_steps(joint: Joint) -> list[Document]:
    return [{"robot": r, "length": float(joint.step("makespan"))} for r in joint.robots]


@pytest.mark.parametrize("limit", range(2))
@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_no_dual_values_prove_more_than_the_optimum(seed: int, limit: int) -> None:
    joint, optimum, value = mission(seed, limit)
    rng = random.Random(seed)
    for n in range(6):
        length = rng.choice([1.0, 0.3, 1.7]) * rng.choice([1, 2])
        steps = (
            exact_steps(joint) if n % 2 else [{"robot": r, "length": length} for r in joint.robots]
        )
        document = {"bound": 0, "solver": "chance", "time_steps": steps}
        rounds = [at_random(joint, rng) for _ in range(rng.randint(1, 4))]
        proof = LatencyProof.model_validate(document | {"rounds": rounds})
        assert float(pricing_bound(joint, proof, value)) <= optimum + 1e-6


@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_the_cheapest_route_is_that_of_all_routes(seed: int) -> None:
    """With everything remembered and exact time steps, nothing is relaxed but splitting."""
    joint, _, _ = mission(seed)
    far = Fraction(6000)
    part = at_random(joint, random.Random(seed), all_remembered=True)
    document = {"bound": 0, "solver": "chance", "rounds": [part]}
    proof = LatencyProof.model_validate(document | {"time_steps": exact_steps(joint)})
    reward = sum(item["dual"] for item in part["tasks"])
    cheapest = [min(route_costs(joint, part, r)) for r in joint.robots]
    assert float(pricing_bound(joint, proof, far)) == pytest.approx(
        max(reward + sum(cheapest), 0), abs=1e-4
    )


def route_costs(joint: Joint, part: Document, robot: int) -> list[float]:
    """Of all routes of a robot, at the dual values; staying at home costs nothing."""
    begin = {item["victim"]: [0.0, *item["times"]] for item in part["breakpoints"]}
    dual = {(item["victim"], item["kinds"]): item for item in part["tasks"]}
    own = {
        v: [task for task in dual if task[0] == v and (robot, v, task[1][0]) in joint.able]
        for v in joint.victims_of[robot]
    }
    costs = [0.0]
    for n in range(1, len(own) + 1):
        for order in permutations(own, n):
            choices = [
                [some for m in range(1, len(own[v]) + 1) for some in combinations(own[v], m)]
                for v in order
            ]
            for chosen in product(*choices):
                clock, cost, before = Fraction(0), 0.0, None
                for v, some in zip(order, chosen, strict=True):
                    clock += (
                        joint.leave[robot, v] if before is None else joint.travel(robot, before, v)
                    )
                    clock += sum(joint.service[v, k] for _, kinds in some for k in kinds)
                    for task in some:
                        cost += charge(begin[v], dual[task]["densities"], float(clock))
                        cost -= dual[task]["dual"]
                    before = v
                costs.append(cost)
    return costs


def charge(begin: list[float], charges: list[float], time: float) -> float:
    ends = [*begin[1:], float("inf")]
    return sum(
        mu * max(0.0, min(time, end) - start)
        for mu, start, end in zip(charges, begin, ends, strict=True)
    )


@pytest.mark.parametrize("limit", range(2))
@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_the_scheduling_bound_is_none_above_the_optimum(seed: int, limit: int) -> None:
    joint, optimum, _ = mission(seed, limit)
    assert float(scheduling_bound(joint)) <= optimum + 1e-6
    assert float(joint.each_alone("latency")) <= optimum + 1e-6


@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_the_bound_at_once_is_the_planners(seed: int) -> None:
    made = generate_mission(read_map(MAPS / "map2.map"), 4, 9, seed=seed, solvable=False)
    plan = make_plan(made, planner="greedy")
    joint = Joint.of(plan)
    ours = max(scheduling_bound(joint), joint.each_alone("latency"))
    assert float(ours) == pytest.approx(latency_bound(problem_of(plan)), rel=1e-9)


@pytest.mark.parametrize("power", [0, 9, 20, 30])
def test_a_robot_of_another_scale_takes_no_digits_from_the_scheduling_bound(power: int) -> None:
    """Robot 0 needs 2 and 3 for its victims: done at 2 and 5. Robot 1 needs 10^power more for each."""
    slow = Fraction(10) ** power
    joint = Joint(
        robots=(0, 1),
        able=frozenset((r, v, "aid") for r in (0, 1) for v in (0, 1)),
        leave={(0, 0): Fraction(0), (0, 1): Fraction(0), (1, 0): slow, (1, 1): slow},
        between={(0, 0, 1): Fraction(0), (1, 0, 1): slow},
        returns=False,
        service={(0, "aid"): Fraction(2), (1, "aid"): Fraction(3)},
        priority={0: Fraction(1), 1: Fraction(1)},
        endurance=None,
        walk={},
    )
    # Beside one that is hardly slower: 2 on robot 0 and 3 + 1 on robot 1 is 6.
    assert scheduling_bound(joint) == (6 if power == 0 else 7)
