"""Convenient units: nothing is rounded, and searches end alike in any unit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.joint_cases import any_routes, on_a_line, small_mission
from support.searches import closed_in

from msmrta_opt.routing.objective_step import objective_step
from msmrta_opt.routing.objectives import OBJECTIVES, value
from msmrta_opt.routing.problem import RoutingData
from msmrta_opt.routing.scaling import in_convenient_units

TIMES = ("leave", "length", "back", "service", "endurance", "longest_walk")


def times_as_long(data: RoutingData, factor: float) -> RoutingData:
    return replace(data, **{name: getattr(data, name) * factor for name in TIMES})


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("seed", range(2))
def test_searches_end_alike_where_times_are_rounded_by_their_unit(
    seed: int, objective: str
) -> None:
    """A power of ten rounds the last digits of the data."""
    data = small_mission(seed, 3, 5)
    routes = any_routes(data)
    value = closed_in(data, objective, routes)[1].value
    for unit in (1e-7, 1e-2, 1e6):
        other = times_as_long(data, unit)
        _, bound = closed_in(other, objective, routes)
        assert bound.value == pytest.approx(value * unit, rel=2e-6)


@given(power=st.integers(-9, 9), seed=st.integers(0, 20))
@settings(max_examples=examples(30))
def test_the_step_of_an_objective_does_not_depend_on_the_unit(power: int, seed: int) -> None:
    data = small_mission(seed, 3, 5)
    other = times_as_long(data, 10.0**power)
    for objective in OBJECTIVES:
        here, there = objective_step(data, objective), objective_step(other, objective)
        assert here.step > 0
        assert there.step == pytest.approx(here.step * 10.0**power)
        convenient = in_convenient_units(other, OBJECTIVES[objective], any_routes(other))
        unit = OBJECTIVES[objective].unit_of(convenient)
        assert objective_step(convenient, objective).step * unit == there.step


@pytest.mark.parametrize(
    ("ordinary", "last", "step"), [(4, 6, 2), (4, 7, 1), (4, 4, 4), (1, 6.5, 0.5), (6, 10, 2)]
)
def test_the_step_is_that_of_the_last_way_too(ordinary: float, last: float, step: float) -> None:
    """100 victims that are all as far apart, but for the last two; all start as far as that."""
    length = np.full((100, 100), float(ordinary)) - ordinary * np.eye(100)
    length[98, 99] = length[99, 98] = last
    data = replace(
        on_a_line([0], [0] * 100, [[[True]] * 100]),
        leave=np.full((1, 100), float(ordinary)),
        length=length[None],
    )
    assert objective_step(data, "total_time").step == step


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_ordinary_missions_stay_as_they_are(objective: str) -> None:
    data = small_mission(1, 3, 5)
    assert in_convenient_units(data, OBJECTIVES[objective], any_routes(data)) is data


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("power", [-90, -20, 40, 90])
def test_units_are_powers_of_two_and_round_nothing(power: int, objective: str) -> None:
    data = small_mission(1, 3, 5)
    other, routes = times_as_long(data, 2.0**power), any_routes(data)
    found = in_convenient_units(other, OBJECTIVES[objective], routes)
    assert math.frexp(found.time_unit)[0] == 0.5
    for name in TIMES:
        assert np.array_equal(getattr(found, name) * found.time_unit, getattr(other, name))
    inside = value(found, routes, objective)
    assert 2**5 <= inside - objective_step(found, objective).offset < 2**24
    assert inside * OBJECTIVES[objective].unit_of(found) == value(other, routes, objective)


def test_priorities_have_a_unit_of_their_own() -> None:
    data = small_mission(1, 3, 5)
    heavy = replace(data, priority=data.priority * 1e12)
    found = in_convenient_units(heavy, OBJECTIVES["latency"], any_routes(data))
    assert found.time_unit == 1.0
    assert found.priority_unit > 1.0
    assert np.array_equal(found.priority * found.priority_unit, heavy.priority)
    assert in_convenient_units(heavy, OBJECTIVES["makespan"], any_routes(data)) is heavy


def test_legs_that_no_better_solution_has_are_shortened() -> None:
    """A fast robot at 0 beside one so slow that its leg says nothing but that it is too long."""
    data = on_a_line([0, 0], [3, 5], [[[True], [True]]] * 2)
    slow = replace(data, leave=data.leave * np.array([[1.0], [1e30]]))
    routes = (((0, (0,)), (1, (0,))), ())
    found = in_convenient_units(slow, OBJECTIVES["total_time"], routes)
    assert np.array_equal(found.leave[0] * found.time_unit, data.leave[0])
    assert (found.leave[1] * found.time_unit == 5 * 2**20).all()
    _, bound = closed_in(slow, "total_time", routes)
    assert bound.value == pytest.approx(5)
