"""Plans executed: as planned where nothing happens, and by the rules where something does."""

from __future__ import annotations

import pytest
from support import executions
from support.amounts import sample

from msmrta_opt.certify.run import problems
from msmrta_opt.execution.execute import execute
from msmrta_opt.execution.policies import policies
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan, Reason
from msmrta_opt.mission.run import Run
from msmrta_opt.planners import plan as make_plan

FIGURES = (
    "n_served",
    "distance",
    "total_time",
    "makespan",
    "latency",
)


def assert_as_planned(plan: Plan, run: Run) -> None:
    """Every cell, every time and every figure are those of the plan, to the last bit."""
    services = {robot.id: [] for robot in plan.instance.robots}  # type: ignore[var-annotated]
    for service in run.services:
        services[service.robot].append(service)
    tracks = {track.robot: track for track in run.tracks}
    for route in plan.routes:
        track, mine = tracks[route.robot], iter(services[route.robot])
        assert list(track.cells) == (route.cells or [track.cells[0]])
        for visit in route.visits:
            serving = [next(mine) for _ in visit.served]
            assert [(s.victim, s.kind) for s in serving] == [
                (visit.victim, k) for k in visit.served
            ]
            if serving:
                assert (serving[0].began, serving[-1].ended) == (visit.arrival, visit.departure)
        assert next(mine, None) is None
    # Whom the scouts missed is there all the same, and can be served once a robot sees it.
    there = () if missed(plan) else ("n_available", "served_share")
    for name in (*FIGURES, *there):
        assert getattr(run.metrics, name) == getattr(plan.metrics, name), name


def missed(plan: Plan) -> bool:
    """Whether the scouts of a plan missed a victim."""
    return any(item.reason is Reason.NOT_FOUND for item in plan.unserved)


@pytest.mark.parametrize("number", sample(range(3000), quick=15))
def test_without_events_every_time_is_that_of_the_plan(number: int) -> None:
    plan = executions.plan(number)
    for policy in ["keep"] if missed(plan) else policies():
        assert_as_planned(plan, execute(plan, policy=policy, seed=number))


@pytest.mark.parametrize("options", [{"objective": "makespan"}, {"return_to_start": True}])
def test_plans_of_the_exact_planner_are_executed_as_they_are(options: dict[str, object]) -> None:
    plan = make_plan(executions.mission(3), planner="exact", time_limit=0, **options)  # type: ignore[arg-type]
    assert_as_planned(plan, execute(plan))


def test_an_improved_plan_is_executed_as_it_is(paper: Instance) -> None:
    plan = make_plan(paper, improve=True)
    assert_as_planned(plan, execute(plan))


UNDER_WAY = (1844, 2579)
"""Here a robot is lost within a move for which a decision has left it no reason; the run ends in one."""


@pytest.mark.parametrize("number", [*UNDER_WAY, *sample(range(1800), quick=15)])
def test_whatever_happens_the_run_keeps_to_the_rules_and_is_the_same_again(number: int) -> None:
    plan = executions.plan(number)
    scenario = executions.scenario(number, plan)
    names = list(policies())
    policy = names[number % len(names)]
    blocked = ("wait", "skip", "detour")[number % 3]
    run = execute(plan, scenario, policy, number, blocked=blocked)
    assert problems(run) == []
    assert run.same_as(execute(plan, scenario, policy, number, blocked=blocked))


@pytest.fixture
def corridor() -> Plan:
    """A plan for the corridor."""
    return make_plan(Instance.from_document(executions.CORRIDOR), planner="ssi")


def ended(run: Run) -> dict[int, float]:
    return {service.victim: service.ended for service in run.services if service.done}


def test_a_slow_robot_takes_longer_on_its_way_and_a_hard_service_longer_there(
    corridor: Plan,
) -> None:
    slow = {"speed": [{"value": 0.5}], "service": [{"kind": "Aid", "value": 2.0}]}
    # Two cells in 4, 20 of service, three cells in 6, 20 of service.
    assert ended(execute(corridor, slow)) == {7: 24.0, 8: 50.0}


def test_a_lost_robot_does_nothing_more_and_its_service_is_lost(corridor: Plan) -> None:
    run = execute(corridor, {"lost": [{"robot": 4, "time": 7.0}]})
    assert ended(run) == {}
    assert [str(event) for event in run.events] == [
        "cut short Aid at victim 7 by robot 4",
        "lost robot 4 in [0, 2]",
    ]
    assert (run.metrics.work_lost, run.metrics.robots_lost, run.metrics.makespan) == (5.0, 1, 7.0)


@pytest.mark.parametrize(
    ("blocked", "expected", "still"),
    [("wait", {7: 12.0, 8: 42.0}, 15.0), ("skip", {7: 12.0}, 0.0), ("detour", {7: 12.0}, 0.0)],
)
def test_before_a_blocked_cell_a_robot_waits_or_leaves_the_visit_out(
    corridor: Plan, blocked: str, expected: dict[int, float], still: float
) -> None:
    # Cell 4 is blocked from 13 to 30. The robot leaves cell 2 at 12, is at 3 at 13, and waits there
    # from 13 to 30 at the latest; then two cells and 10 of service: done at 42, 17 later than planned.
    closed = {"corridors": [{"cells": [[0, 4]], "blocked": 12.5, "opened": 30.0}]}
    run = execute(corridor, closed, blocked=blocked)
    assert ended(run) == expected
    if blocked == "wait":
        assert run.metrics.stood_still == 17.0


CLOSED = {"corridors": [{"cells": [[0, 4]], "blocked": 12.5}]}
STILL = "robot 4 still waits for a way to victim 8"


@pytest.mark.parametrize(
    ("more", "end", "told"),
    [
        # It stands at 3 from 13 on; nothing more can happen then.
        ({}, 13.0, [STILL]),
        ({"until": 100.0}, 100.0, [STILL]),
        # Of a robot that waits it matters when it is lost, and what has a time is waited for.
        ({"lost": [{"robot": 4, "time": 50.0}]}, 50.0, [STILL, "lost robot 4 in [0, 3]"]),
        ({"lost": [{"robot": 4, "time": 50.0}], "until": 30.0}, 30.0, [STILL]),
    ],
)
def test_a_robot_that_waits_for_ever_is_told_as_waiting_and_not_as_done(
    corridor: Plan, more: dict[str, object], end: float, told: list[str]
) -> None:
    run = execute(corridor, {**CLOSED, **more}, blocked="wait")
    assert [
        str(event) for event in run.events if event.time >= 13 and event.what != "noticed"
    ] == told
    assert (run.end, run.metrics.makespan, run.metrics.stood_still) == (end, end, end - 13)
    assert (run.metrics.still_waiting, run.metrics.total_time) == (1, 13.0)


def test_a_robot_that_waits_is_lost_at_its_rate(corridor: Plan) -> None:
    run = execute(corridor, {**CLOSED, "lost": [{"rate": 0.001}]}, seed=1, blocked="wait")
    (loss,) = run.world.lost
    assert loss.time > 25
    assert (run.end, run.metrics.robots_lost) == (loss.time, 1)
    # A robot that is done is not waited for: its loss is no part of the run.
    assert execute(corridor, {"lost": [{"rate": 0.001}]}, seed=1).metrics.robots_lost == 0


def test_all_that_has_a_time_happens_in_every_run(corridor: Plan) -> None:
    run = execute(corridor, {"lost": [{"robot": 4, "time": 500.0}]})
    assert (run.end, run.metrics.robots_lost, run.metrics.makespan) == (500.0, 1, 25.0)


@pytest.mark.parametrize(
    ("until", "served", "spent"), [(11.0, 0, 9.0), (12.0, 1, 0.0), (14.5, 1, 0.0), (25.0, 2, 0.0)]
)
def test_at_the_end_of_a_scenario_what_is_under_way_is_cut_short(
    corridor: Plan, until: float, served: int, spent: float
) -> None:
    # Victim 7 is served from 2 to 12, then three cells, and victim 8 from 15 to 25.
    run = execute(corridor, {"until": until})
    assert (run.metrics.n_served, run.metrics.work_lost, run.end) == (served, spent, until)
    assert run.tracks[0].times[-1] <= until


def test_a_robot_that_has_a_time_is_waited_for_though_a_rate_loses_it_before(
    corridor: Plan,
) -> None:
    tables = [{"rate": 0.001}, {"robot": 4, "time": 1e6}]
    run = execute(corridor, {"lost": tables}, seed=1)
    (loss,) = run.world.lost
    assert 25 < loss.time < 1e6
    assert (run.end, run.metrics.robots_lost, run.metrics.makespan) == (loss.time, 1, 25.0)


@pytest.mark.parametrize(("policy", "served"), [("keep", 1), ("repair", 2)])
def test_what_can_be_reached_once_a_wall_is_opened_is_available(policy: str, served: int) -> None:
    """No more is ever served than is available, whoever goes there; kinds that nobody has are not."""
    plan = make_plan(Instance.from_document(executions.WALLED), planner="ssi")
    assert plan.metrics.n_available == 1
    opened = {"notice": "at_once", "corridors": [{"cells": [[0, 3]], "opened": 10.0}]}
    of = execute(plan, opened, policy).metrics
    assert (of.n_served, of.n_available, of.served_share) == (served, 2, served / 2)
    # Behind the wall that stays, a victim that turns up is out of reach.
    hidden = {"victims": [{"id": 9, "cell": [0, 5], "requirements": ["Aid"], "announced": 1.0}]}
    assert execute(plan, hidden, policy).metrics.n_available == 1


def test_a_move_that_has_begun_is_completed(corridor: Plan) -> None:
    run = execute(corridor, {"corridors": [{"cells": [[0, 1]], "blocked": 0.5}]})
    assert ended(run) == {7: 12.0, 8: 25.0}


@pytest.mark.parametrize(("depth", "time"), [(0, None), (1, 2.0), (3, 2.0)])
def test_a_victim_is_found_as_far_as_robots_see(
    corridor: Plan, depth: int, time: float | None
) -> None:
    # Cell (1, 3) is diagonal to (0, 2), past the corner of one wall; from further left walls hide it.
    hidden = {"id": 9, "cell": [1, 3], "requirements": ["Aid"]}
    run = execute(corridor, {"visual_field_depth": depth, "victims": [hidden]})
    found = [event.time for event in run.events if event.what == "found"]
    assert found == ([] if time is None else [time])


def test_policies_on_one_seed_meet_one_world() -> None:
    plan = executions.plan(1)
    noise = {"speed": [{"distribution": "lognormal", "sigma": 0.5}], "lost": [{"rate": 0.01}]}
    worlds = [execute(plan, noise, policy, 5).world for policy in policies()]
    assert all(world == worlds[0] for world in worlds)
    assert execute(plan, noise, "keep", 6).world != worlds[0]


def test_a_draw_does_not_depend_on_the_others() -> None:
    plan = executions.plan(1)
    one = [{"distribution": "lognormal", "sigma": 0.5}]
    more = {"speed": one, "service": one, "lost": [{"rate": 0.01}]}
    assert execute(plan, {"speed": one}).world.speeds == execute(plan, more).world.speeds


def test_what_execute_is_given_must_be_right(corridor: Plan) -> None:
    wrong = [
        ({"policy": "kept"}, "policy: 'kept' (did you mean 'keep'?)"),
        ({"seed": -1}, "seed: -1; give a whole number, 0 or more"),
        ({"blocked": "fly"}, "blocked: 'fly'; give one of wait, skip, detour"),
        ({"blocket": "wait"}, "blocket: policy keep has no such option (did you mean 'blocked'?)"),
        ({"scenario": {"lost": [{"robot": 5, "time": 1.0}]}}, "lost[0].robot: 5; the mission has"),
        ({"scenario": 3}, "scenario: 3; give a scenario"),
    ]
    for options, message in wrong:
        with pytest.raises(InputError) as error:
            execute(corridor, **options)  # type: ignore[arg-type]
        assert str(error.value).startswith(message)
