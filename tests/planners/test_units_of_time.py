"""The same mission in another unit of time is planned, proved and checked alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.joint_cases import any_routes, small_mission
from support.searches import closed_in

from msmrta_opt.certify.certificates import recheck
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan
from msmrta_opt.routing.objective_step import objective_step

OBJECTIVES = ("total_time", "makespan", "latency")
POWERS = (-9, -4, -1, 0, 3, 9)


def in_unit(mission: Instance, power: int) -> Instance:
    """With all times 10 to the `power` times as long, as a person would write them."""

    def times(number: float, power: int) -> float:
        return float(f"{number!r}e{power}")

    robots, victims = (
        tuple(
            item.model_copy(update={field: change(getattr(item, field))})
            for item in getattr(mission, group)
        )
        for group, field, change in (
            ("robots", "speed", lambda speed: times(speed, -power)),
            (
                "victims",
                "service_time",
                lambda own: {kind: times(time, power) for kind, time in own.items()},
            ),
        )
    )
    service = {kind: times(time, power) for kind, time in mission.service_time.items()}
    return mission.replace(
        robots=robots, victims=victims, service_time=service, clusters=mission.clusters
    )


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_optimum_is_found_proved_and_checked_in_every_unit(
    objective: str, instances_dir: Path
) -> None:
    mission = Instance.read(instances_dir / "two_rooms.json")
    values, wholes = [], set()
    for power in POWERS:
        made = plan(in_unit(mission, power), planner="exact", objective=objective)
        (certificate,) = made.certificates
        assert certificate.status == "optimal"
        assert problems(made) == []
        (found,) = recheck(made)
        assert found.problems == ()
        values.append(float(certificate.objective or 0.0) / 10.0**power)
        wholes.add((certificate.proof, found.whole))
    assert values == pytest.approx([values[0]] * len(POWERS), rel=1e-9)
    assert len(wholes) == 1


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
        names = ("leave", "between", "back", "service", "endurance", "longest_walk")
        other = replace(data, **{name: getattr(data, name) * unit for name in names})
        _, bound = closed_in(other, objective, routes)
        assert bound.value == pytest.approx(value * unit, rel=2e-6)


@given(power=st.integers(-9, 9), seed=st.integers(0, 20))
@settings(max_examples=30)
def test_the_step_of_an_objective_does_not_depend_on_the_unit(power: int, seed: int) -> None:
    data = small_mission(seed, 3, 5)
    names = ("leave", "between", "back", "service", "endurance", "longest_walk")
    other = replace(data, **{name: getattr(data, name) * 10.0**power for name in names})
    for objective in OBJECTIVES:
        here, there = objective_step(data, objective), objective_step(other, objective)
        assert here.step > 0
        assert there.step == pytest.approx(here.step * 10.0**power)
        convenient = other.in_convenient_units()
        assert objective_step(convenient, objective).step * convenient.time_unit == there.step


def test_convenient_units_round_nothing() -> None:
    data = small_mission(1, 3, 5)
    assert data.in_convenient_units() is data
    small = replace(data, leave=data.leave * 2.0**-90, service=data.service * 2.0**-90)
    found = small.in_convenient_units()
    assert found.time_unit == 1024.0**-9
    assert np.array_equal(found.leave * found.time_unit, small.leave)
    assert found.service.max() == data.service.max()
    heavy = replace(data, priority=data.priority * 1e9).in_convenient_units()
    assert heavy.priority_unit == 1024.0**3


def test_a_service_of_next_to_nothing_is_not_nothing(instances_dir: Path) -> None:
    """With services of 1 and of 1e-9, no step but 1e-9 is common: nothing is rounded up to wholes."""
    mission = Instance.read(instances_dir / "corridor.json")
    first = mission.victims[0].model_copy(update={"service_time": {"FirstAids": 1e-9}})
    mission = mission.replace(victims=(first, mission.victims[1]))
    for objective in OBJECTIVES:
        made = plan(mission, planner="exact", objective=objective)
        (found,) = recheck(made)
        assert found.problems == ()
        assert made.certificates[0].status == "optimal"
