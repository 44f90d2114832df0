"""Hindsight: what a run could have been at best, and what not knowing cost."""

from __future__ import annotations

import pytest
from support import executions
from support.amounts import sample

from msmrta_opt.execution.execute import execute
from msmrta_opt.execution.hindsight import hindsight
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan as make_plan


@pytest.fixture
def street() -> Plan:
    """Two robots of speed 1 at the ends of a street of nine cells, a victim near each."""
    robots = [
        {"id": i, "start": [0, col], "speed": 1.0, "capabilities": ["Aid"]}
        for i, col in ((1, 0), (2, 8))
    ]
    victims = [{"id": i, "cell": [0, col], "requirements": ["Aid"]} for i, col in ((7, 1), (8, 7))]
    mission = Instance.from_document(
        {
            "map": {"rows": ["........."]},
            "capabilities": ["Aid"],
            "service_time": {"Aid": 10.0},
            "robots": robots,
            "victims": victims,
        }
    )
    return make_plan(mission, planner="ssi")


def test_what_a_lost_robot_did_in_vain_is_regretted(street: Plan) -> None:
    # Robot 1 walks a cell and serves for 4 in vain. Robot 2 serves both: 1 + 10 + 6 + 10.
    run = execute(street, {"lost": [{"robot": 1, "time": 5.0}]}, "repair")
    found = hindsight(run)
    assert (found.run, found.best, found.bound, found.proved) == (32.0, 27.0, 27.0, True)
    assert found.regret == (5.0, 5.0)
    assert str(found) == ("total_time 32; with all known from the beginning 27 (optimal); regret 5")


def test_a_plan_that_is_optimal_is_not_regretted_where_nothing_happens(street: Plan) -> None:
    assert hindsight(execute(street)).regret == (0.0, 0.0)
    assert hindsight(execute(street), objective="makespan").regret == (0.0, 0.0)


@pytest.mark.parametrize("number", sample([i for i in range(200) if i % 3 != 2], quick=5))
def test_no_run_is_better_than_the_bound(number: int) -> None:
    plan = executions.plan(number)
    run = execute(plan, executions.scenario(number, plan), "repair", number)
    found = hindsight(run, time_limit=1.0)
    assert found.bound <= found.best * (1 + 1e-9)
    assert found.best <= found.run * (1 + 1e-9)


def test_limits_of_the_plan_are_part_of_what_is_regretted() -> None:
    """Five cells and two services of 10 are enough, where the robot walks back as well."""
    mission = Instance.from_document(executions.CORRIDOR)
    run = execute(make_plan(mission, planner="exact", return_to_start=True))
    found = hindsight(run)
    assert (found.run, found.best, found.proved) == (30, 25, True)
