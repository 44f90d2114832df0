"""The figures of the plan of `conftest.py`, worked out by hand from its comments."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.metrics import METRICS
from msmrta_opt.mission.plan import Plan, Reason, Route, Unserved

BY_HAND = {
    "n_requirements": 8,
    "n_available": 4,  # 8, less the 4 unserved, none of which could be served
    "n_served": 4,
    "served_share": 1,
    "victims_fully_served": 2,  # 20 and 10
    "distance": 9,
    "distance_of": {7: 6, 3: 3},
    "total_time": 21,  # robot 7 is done at 14, robot 3 at 7
    "makespan": 14,
    "latency": 36,  # victim 20 at 8 × 1, victim 10 at 14 × 2
    "mean_completion": 11,  # of 8 and 14
    "weighted_completion": 12,  # 36 / (1 + 2)
    "planning_seconds": 0.75,
}


def test_every_figure_is_as_worked_out_by_hand(plan: Plan) -> None:
    assert plan.metrics.as_dict() == BY_HAND


def variant(plan: Plan, **updates: Any) -> Plan:
    """`plan` with some fields changed, and nothing that was computed from the old ones."""
    return Plan.model_validate({name: getattr(plan, name) for name in Plan.model_fields} | updates)


def changed(plan: Plan, **updates: Any) -> dict[str, object]:
    """The figures that are not those of the plan by hand, after some changes to it."""
    figures = variant(plan, **updates).metrics.as_dict()
    return {name: value for name, value in figures.items() if value != BY_HAND[name]}


def test_the_way_back_counts_as_distance_and_time_but_completes_nobody_later(plan: Plan) -> None:
    back = ((2, 2), (2, 3), (2, 4), (2, 5))
    routes = (plan.route(7), plan.route(3).model_copy(update={"back": back}))
    # 3 moves more, at speed 0.5: robot 3 is home at 7 + 6.
    assert changed(plan, routes=routes) == {
        "distance": 12,
        "distance_of": {7: 6, 3: 6},
        "total_time": 27,
    }


def test_a_victim_completes_with_its_last_service_whichever_robot_gives_it(plan: Plan) -> None:
    late = plan.route(3).visits[0].model_copy(update={"departure": 30.0})
    routes = (plan.route(7), plan.route(3).model_copy(update={"visits": (late,)}))
    assert changed(plan, routes=routes) == {
        "total_time": 44,  # 14 + 30
        "makespan": 30,
        "latency": 68,  # 8 + 2 × 30
        "mean_completion": 19,
        "weighted_completion": pytest.approx(68 / 3),
    }


def test_a_visit_that_serves_nothing_completes_nobody(plan: Plan) -> None:
    first, second = plan.route(7).visits
    passing = second.model_copy(update={"served": (), "departure": 12.0})
    routes = (plan.route(7).model_copy(update={"visits": (first, passing)}), plan.route(3))
    assert changed(plan, routes=routes) == {
        "n_served": 3,
        "served_share": 0.75,
        "victims_fully_served": 1,
        "total_time": 19,  # 12 + 7
        "makespan": 12,
        "latency": 22,  # 8 + 2 × 7
        "mean_completion": 7.5,
        "weighted_completion": pytest.approx(22 / 3),
    }


def test_a_victim_served_at_once_completes_at_time_zero(plan: Plan) -> None:
    at_once = plan.route(3).visits[0].model_copy(update={"arrival": 0.0, "departure": 0.0})
    routes = (Route(robot=7), plan.route(3).model_copy(update={"visits": (at_once,)}))
    figures = variant(plan, routes=routes).metrics
    assert figures.latency == figures.mean_completion == figures.weighted_completion == 0


def test_robots_that_stay_have_walked_nothing(plan: Plan) -> None:
    figures = changed(plan, routes=(Route(robot=7), Route(robot=3)))
    assert figures == {
        "n_served": 0,
        "served_share": 0,
        "victims_fully_served": 0,
        "distance": 0,
        "distance_of": {7: 0, 3: 0},
        "total_time": 0,
        "makespan": 0,
        "latency": 0,
        "mean_completion": 0,
        "weighted_completion": 0,
    }


def test_what_is_beyond_the_robots_endurance_is_available_and_not_served(plan: Plan) -> None:
    first, _ = plan.route(7).visits
    left = Unserved(victim=10, kind="A", reason=Reason.BEYOND_ENDURANCE)
    figures = variant(
        plan,
        routes=(plan.route(7).model_copy(update={"visits": (first,)}), plan.route(3)),
        unserved=(*plan.unserved, left),
    ).metrics
    assert (figures.n_available, figures.n_served, figures.served_share) == (4, 3, 0.75)


def test_without_victims_nothing_is_left_undone(mission: Instance) -> None:
    empty = mission.replace(victims=(), scouts=())
    figures = Plan(instance=empty, planner="none", routes=()).metrics
    assert figures.served_share == 1
    assert figures.n_requirements == figures.n_available == figures.victims_fully_served == 0
    assert figures.total_time == figures.makespan == figures.mean_completion == 0


def test_priorities_of_zero_do_not_divide_by_zero(mission: Instance, plan: Plan) -> None:
    victims = tuple(victim.model_copy(update={"priority": 0.0}) for victim in mission.victims)
    assert changed(plan, instance=mission.replace(victims=victims)) == {
        "latency": 0,
        "weighted_completion": 0,
    }


def test_each_robots_distance_is_told_of_a_few_robots(plan: Plan) -> None:
    assert METRICS["distance"].text(plan.metrics) == "9 cells (7: 6, 3: 3)"
    many = dict.fromkeys(range(11), 1)
    assert METRICS["distance"].text(SimpleNamespace(distance=11, distance_of=many)) == "11 cells"
