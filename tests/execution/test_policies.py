"""Policies: what they do when something happens, and what a changed visit costs."""

from __future__ import annotations

import random
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import executions
from support.amounts import sample
from support.joint_oracle import minimum

from msmrta_opt.certify.run import problems
from msmrta_opt.execution.draw import draw_world
from msmrta_opt.execution.execute import execute
from msmrta_opt.execution.policies import replan
from msmrta_opt.execution.replanning import Remaining
from msmrta_opt.execution.simulation import Simulation
from msmrta_opt.execution.state import Situated, State
from msmrta_opt.mission.errors import InputError, NoPlanError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.mission.scenario import Scenario
from msmrta_opt.optimise.solve import solve
from msmrta_opt.planners import plan as make_plan
from msmrta_opt.routing.objectives import objective_of

PRICES = (0.0, 1.0, 10.0, 100.0, 1e4)


@pytest.fixture
def street() -> Plan:
    """Two robots of speed 1 at the ends of a street of nine cells, a victim near each."""
    mission = Instance.from_document(
        {
            "map": {"rows": ["........."]},
            "capabilities": ["Aid"],
            "service_time": {"Aid": 10.0},
            "robots": [
                {"id": 1, "start": [0, 0], "speed": 1.0, "capabilities": ["Aid"]},
                {"id": 2, "start": [0, 8], "speed": 1.0, "capabilities": ["Aid"]},
            ],
            "victims": [
                {"id": 7, "cell": [0, 1], "requirements": ["Aid"]},
                {"id": 8, "cell": [0, 7], "requirements": ["Aid"]},
            ],
        }
    )
    return make_plan(mission, planner="ssi")


LOST = {"lost": [{"robot": 1, "time": 5.0}]}
FOUND = {"victims": [{"id": 9, "cell": [0, 4], "requirements": ["Aid"], "announced": 6.0}]}


@pytest.mark.parametrize("policy", ["repair", "replan"])
def test_what_a_lost_robot_leaves_another_does(street: Plan, policy: str) -> None:
    # Robot 2 is done with victim 8 at 11, walks six cells, and serves victim 7 from 17 to 27.
    run = execute(street, LOST, policy)
    assert dict(run.metrics.completion) == {8: 11.0, 7: 27.0}
    assert (run.metrics.work_lost, run.metrics.changed_visits) == (4.0, 0)
    assert execute(street, LOST, "keep").metrics.n_served == 1


@pytest.mark.parametrize("policy", ["repair", "replan"])
def test_a_victim_that_turns_up_is_served_by_who_is_near(street: Plan, policy: str) -> None:
    # Both robots are done at 11, three cells off: served from 14 to 24.
    run = execute(street, FOUND, policy)
    assert run.metrics.completion[9] == 24.0
    assert (run.metrics.replans, run.metrics.changed_visits) == (1, 0)


def limited(street: Plan, **limits: Any) -> Plan:
    return make_plan(street.instance, planner="exact", time_limit=0, **limits)


@pytest.mark.parametrize("policy", ["repair", "replan"])
@pytest.mark.parametrize(
    ("limits", "served", "done"),
    [
        # Robot 2 is done with victim 8 at 11; victim 7 takes it 6 cells and 10 more, to 27 and cell 1.
        ({"endurance": 27.0}, 2, {1: 0, 2: 1}),
        ({"endurance": 26.5}, 1, {1: 0, 2: 7}),
        ({"longest_walk": 7}, 2, {1: 0, 2: 1}),
        ({"longest_walk": 6}, 1, {1: 0, 2: 7}),
        # And back: 7 cells to victim 7, and 7 home.
        ({"return_to_start": True}, 2, {1: 0, 2: 8}),
        ({"return_to_start": True, "longest_walk": 14}, 2, {1: 0, 2: 8}),
        ({"return_to_start": True, "longest_walk": 13}, 1, {1: 0, 2: 8}),
        ({"return_to_start": True, "endurance": 34.0}, 2, {1: 0, 2: 8}),
        ({"return_to_start": True, "endurance": 33.0}, 1, {1: 0, 2: 8}),
    ],
)
def test_what_a_lost_robot_leaves_is_done_within_the_limits_of_the_others(
    street: Plan, policy: str, limits: dict[str, Any], served: int, done: dict[int, int]
) -> None:
    run = execute(limited(street, **limits), {"lost": [{"robot": 1, "time": 0.5}]}, policy)
    assert run.metrics.n_served == served
    assert {track.robot: track.cells[-1][1] for track in run.tracks} == done


def test_a_robot_that_has_taken_longer_gives_up_what_no_longer_fits(street: Plan) -> None:
    alone = street.instance.replace(robots=street.instance.robots[1:])
    plan = make_plan(alone, planner="exact", time_limit=0, endurance=27.0)
    # Victim 8 is served until 16, not 11: 11 of the endurance are left, and victim 7 needs 6 + 10.
    news = {"id": 9, "cell": [0, 4], "requirements": [], "announced": 16.0}
    slow = {"service": [{"value": 1.5}], "victims": [news]}
    assert execute(plan, slow, "keep").metrics.n_served == 2
    assert execute(plan, slow, "repair").metrics.n_served == 1


@pytest.mark.parametrize("number", sample(range(600), quick=8))
def test_no_decision_goes_beyond_the_limits_of_the_plan(number: int) -> None:
    """The checker of runs says so, where what takes how long is known before."""
    given = executions.mission(number)
    free = make_plan(given, planner="ssi").metrics
    chance = random.Random(f"limits {number}")
    limits = {
        "endurance": free.makespan * chance.uniform(0.8, 1.5),
        "longest_walk": 1.0 + free.distance * chance.uniform(0.5, 1.0),
        "return_to_start": True,
    }
    chosen = dict(chance.sample(list(limits.items()), chance.randint(1, 3)))
    try:
        plan = make_plan(given, planner="exact", time_limit=0, **chosen)
    except NoPlanError:
        return
    scenario = executions.scenario(number, plan).model_copy(
        update={"speed": (), "service": (), "corridors": (), "until": None}
    )
    for policy in ("repair", "replan"):
        assert problems(execute(plan, scenario, policy, number)) == []


@pytest.mark.parametrize("policy", ["repair", "replan"])
@pytest.mark.parametrize(("blocked", "who"), [("wait", 1), ("skip", 2), ("detour", 2)])
def test_a_policy_decides_as_robots_are_to_do_before_a_blocked_cell(
    policy: str, blocked: str, who: int
) -> None:
    """A corridor, closed for a time between a robot and its victim; a slow robot is behind that."""
    mission = {
        "map": {"rows": ["......."]},
        "capabilities": ["Aid"],
        "service_time": {"Aid": 10.0},
        "robots": [
            {"id": 1, "start": [0, 0], "speed": 1.0, "capabilities": ["Aid"]},
            {"id": 2, "start": [0, 6], "speed": 0.1, "capabilities": ["Aid"]},
        ],
        "victims": [{"id": 7, "cell": [0, 3], "requirements": ["Aid"]}],
    }
    plan = make_plan(Instance.from_document(mission), planner="exact", time_limit=0)
    closed = {"corridors": [{"cells": [[0, 2]], "blocked": 0.5, "opened": 100.0}]}
    run = execute(plan, closed, policy, blocked=blocked)
    assert [service.robot for service in run.services] == [who]
    # Robot 1 stands in cell 1 from 1 to 100; or robot 2 sets out at 1, when that is known.
    assert run.metrics.stood_still == (99.0 if who == 1 else 1.0)


def test_a_robot_does_not_go_back_to_what_it_has_left_out() -> None:
    """There is a way round, which `skip` does not take, and nobody else."""
    mission = {
        "map": {"rows": [".....", "....."]},
        "capabilities": ["Aid"],
        "service_time": {"Aid": 1.0},
        "robots": [{"id": 1, "start": [0, 0], "speed": 1.0, "capabilities": ["Aid"]}],
        "victims": [{"id": 7, "cell": [0, 4], "requirements": ["Aid"]}],
    }
    plan = make_plan(Instance.from_document(mission), planner="ssi")
    route = [cell[0] for cell in plan.routes[0].cells]
    closed = {
        "corridors": [{"cells": [[route[2], 2]], "blocked": 0.5}],
        "victims": [{"id": 8, "cell": [1, 0], "requirements": ["Aid"], "announced": 2.5}],
    }
    served = {
        blocked: [s.victim for s in execute(plan, closed, "repair", blocked=blocked).services]
        for blocked in ("skip", "detour")
    }
    assert served["skip"] == [8]
    assert sorted(served["detour"]) == [7, 8]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"planner": "sssi"}, "planner: 'sssi' (did you mean 'ssi'?)"),
        ({"stability": -1}, "stability: -1; give a number from 0 to 1e+30"),
        (
            {"stability": 2e6, "model": "joint_replan"},
            "stability: 2000000.0; give a number from 0 to 1e+06",
        ),
        ({"seconds": "one"}, "seconds: 'one'; give a number from 0 to 1e+30"),
        ({"objective": "time"}, "objective: 'time'"),
        ({"model": "cluster_fair"}, "model: is of stage cluster; give one of stage routing"),
    ],
)
def test_wrong_options_are_told(street: Plan, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as error:
        execute(street, policy="replan", **options)
    assert str(error.value).startswith(message)


def planned_and_lost(mission: Instance, number: int) -> tuple[Plan, dict[str, Any]]:
    """A random plan, and a robot that is lost at its beginning, when all others are free."""
    plan = make_plan(mission, planner="random", seed=number)
    robots = plan.instance.robots
    scenario = {"lost": [{"robot": robots[0].id, "time": 0.0}]} if len(robots) > 1 else {}
    hidden = {"id": 10**6, "cell": list(robots[-1].start), "requirements": [], "announced": 0.0}
    return plan, {**scenario, "victims": [hidden]}


def left_of(plan: Plan, scenario: dict[str, Any]) -> Remaining | None:
    """What is left at the first decision."""
    states: list[State] = []
    given = Scenario.from_document(scenario)
    world = draw_world(plan, given, 0)
    Simulation(plan, given, world, lambda state: states.append(state), "detour").run()  # type: ignore[func-returns-value]
    return Remaining.of(states[0], Situated(plan, {"blocked": "detour"}, 0))


def remaining(number: int) -> Remaining:
    """What is left of a random plan at its beginning, with a robot fewer and all others free."""
    found = left_of(*planned_and_lost(executions.mission(3 * number), number))
    assert found is not None
    return found


@pytest.mark.parametrize("number", sample(range(100), quick=5))
def test_the_dearer_a_change_the_fewer_are_made(number: int) -> None:
    left, aim = remaining(number), objective_of("total_time")
    options = {"planner": "ssi", "objective": "total_time", "seconds": None}
    found = replan.candidates(left, options, seed=number)
    chosen = [
        min((left.worth(aim, x) + price * left.changes(x), left.changes(x)) for x in found)[1]
        for price in PRICES
    ]
    assert chosen == sorted(chosen, reverse=True)


@pytest.mark.parametrize("number", sample(range(40), quick=2))
@pytest.mark.parametrize("model", ["", "joint_replan"])
def test_the_dearer_visits_are_the_fewer_of_them_the_first_decision_of_a_run_changes(
    number: int, model: str
) -> None:
    """By the formulation the run is the optimum that brute force finds at each price."""
    given = executions.mission(3 * number)
    given = given.replace(victims=given.victims[:4])
    plan, lost = planned_and_lost(given, number)
    left = left_of(plan, lost)
    changed = []
    for price in PRICES:
        run = execute(plan, lost, "replan", model=model, stability=price)
        first = run.decisions[0].changed if run.decisions else 0
        changed.append(first)
        if left is not None and model:  # nothing else happens, and all robots are free
            best = minimum(left.data, "total_time", price)
            assert run.metrics.total_time + price * first == pytest.approx(best)
    assert changed == sorted(changed, reverse=True)


@pytest.mark.parametrize("number", sample([0, 2, 4, 6, 8, 10, 12, 14, 16, 18], quick=2))
def test_the_formulation_makes_as_few_changes_as_a_price_leaves(number: int) -> None:
    """As brute force has it: the objective of each price, and no fewer changes for a lower one."""
    left, aim = remaining(number), objective_of("total_time")
    few = np.arange(left.data.n_victims) < 4
    able = left.data.able & few[None, :, None]
    data = replace(left.data, able=able, planned=left.data.planned & few)
    changes = []
    for price in PRICES:
        solution = solve("joint_replan", data, stability=price)
        best = minimum(data, "total_time", price)
        assert solution.status == "optimal"
        assert solution.objective == pytest.approx(best)
        assert solution.bound == pytest.approx(best)
        made = solution.values["y"] > 0.5
        changes.append(int((data.planned & ~made).sum()))
        routes = replan.routes_of_solution(data, solution)
        assert aim.value(data, routes) + price * changes[-1] == pytest.approx(best)
    assert changes == sorted(changes, reverse=True)
    # At the highest price, a change counts more than all travel: there are as few as there can be.
    assert changes[-1] == int(minimum(data, "total_time", 1e9) / 1e9 + 0.5)


def test_replanning_by_the_formulation_is_never_dearer_than_by_a_planner(street: Plan) -> None:
    both = {**LOST, **FOUND}
    ours = execute(street, both, "replan", stability=2.0)
    proved = execute(street, both, "replan", model="joint_replan", stability=2.0)
    assert proved.metrics.n_served == ours.metrics.n_served
    assert proved.metrics.total_time <= ours.metrics.total_time


WATCH = """
import sys
import msmrta_opt as mo
from msmrta_opt.execution.simulation import Simulation

decide, found = Simulation._decide, []

def watched(simulation, now):
    before = set(sys.modules)
    decide(simulation, now)
    found.append(sorted(set(sys.modules) - before))

Simulation._decide = watched
plan = mo.Plan.read(sys.argv[1])
for policy in ("repair", "replan"):
    mo.execute(plan, {"lost": [{"robot": 1, "time": 5.0}]}, policy)
print(found)
"""


def test_deciding_imports_nothing_that_was_not_loaded_before_the_clock(
    street: Plan, tmp_path: Path
) -> None:
    street.save(tmp_path / "plan.json")
    command = [sys.executable, "-c", WATCH, str(tmp_path / "plan.json")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=True)
    assert done.stdout.split() == ["[[],", "[]]"]
