"""Missions in other units of time: the same decisions and proofs, all times multiplied."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples

import msmrta_opt as mo
from msmrta_opt.certify.certificates import recheck
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.generate import random_mission
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows, read_map
from msmrta_opt.mission.plan import Plan
from msmrta_opt.routing.objectives import OBJECTIVES

MAPS = Path(__file__).parents[2] / "instances" / "maps"


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


@cache
def small(seed: int) -> Instance:
    """Two robots of different speeds among walls, four victims of different priorities."""
    return random_mission(read_map(MAPS / "map2.map"), 2, 4, seed=seed)


@cache
def solved(seed: int, objective: str) -> Plan:
    return mo.plan(small(seed), planner="exact", objective=objective)


def decisions(made: Plan) -> list[list[tuple[int, tuple[str, ...]]]]:
    return [[(visit.victim, visit.served) for visit in route.visits] for route in made.routes]


@settings(max_examples=examples(25), deadline=None)
@given(
    seed=st.integers(0, 5),
    objective=st.sampled_from(sorted(OBJECTIVES)),
    power=st.integers(-9, 9),
)
def test_times_a_power_of_ten_as_long_are_solved_and_proved_alike(
    seed: int, objective: str, power: int
) -> None:
    factor = 10.0**power
    made = mo.plan(in_unit(small(seed), power), planner="exact", objective=objective)
    (certificate,), (expected,) = made.certificates, solved(seed, objective).certificates
    assert expected.status == certificate.status == "optimal"
    assert expected.objective is not None
    assert certificate.objective == pytest.approx(expected.objective * factor, rel=1e-9)
    assert all(not found.problems for found in recheck(made))


def times_as_long(mission: Instance, factor: float) -> Instance:
    """With all times `factor` times as long."""
    service = {kind: time * factor for kind, time in mission.service_time.items()}
    robots = (r.model_copy(update={"speed": r.speed / factor}) for r in mission.robots)
    assert not any(victim.service_time for victim in mission.victims)
    return mission.replace(robots=tuple(robots), service_time=service, clusters=mission.clusters)


@pytest.mark.parametrize("power", [-40, -7, 5, 60])
@pytest.mark.parametrize("planner", ["ssi", "random"])
def test_local_search_decides_alike_in_units_that_differ_by_a_power_of_two(
    planner: str, power: int
) -> None:
    mission = random_mission(read_map(MAPS / "map0.map"), 3, 8, seed=2)
    briefly = {"improve": True, "parameters": {"heuristics": {"default_iterations": 300}}}
    for objective in OBJECTIVES:
        plans = [
            mo.plan(one, planner=planner, objective=objective, **briefly)
            for one in (mission, times_as_long(mission, 2.0**power))
        ]
        assert decisions(plans[0]) == decisions(plans[1])


POWERS = (-9, -4, -1, 0, 3, 9)


def corridor(speed: float, service: float) -> Instance:
    """A robot at 1 of a corridor of five cells, victims at 0 and 4."""
    return Instance(
        map=grid_from_rows(["....."]),
        capabilities=("A",),
        service_time={"A": service},
        robots=(Robot(id=0, start=(0, 1), speed=speed, capabilities=("A",)),),
        victims=tuple(Victim(id=v, cell=(0, 4 * v), requirements=("A",)) for v in (0, 1)),
    )


# By hand: five moves; the near victim first is the best order for all but latency of long services,
# where both orders come to the same but for the walk.
Expected = Callable[[float, float], float]
BY_HAND: dict[str, Expected] = {
    "total_time": lambda move, service: 5 * move + 2 * service,
    "makespan": lambda move, service: 5 * move + 2 * service,
    "latency": lambda move, service: 6 * move + 3 * service,
}


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(
    ("speed", "service"),
    [
        (86400.0, 2 / 86400),  # in days
        (31557600.0, 2 / 31557600),  # in years
        (1e-9, 2e9),
        (1e9, 2e-9),
        (1e-29, 2e29),
        (1e9, 0.0),
        (1.0, 1e-9),  # services that hardly count
        (1.0, 1e9),  # walks that hardly count
    ],
)
def test_a_corridor_is_proved_by_hand_in_any_unit(
    objective: str, speed: float, service: float
) -> None:
    made = mo.plan(corridor(speed, service), planner="exact", objective=objective)
    certificate = made.certificates[0]
    assert certificate.status == "optimal"
    assert certificate.objective == pytest.approx(BY_HAND[objective](1 / speed, service), rel=1e-9)
    assert all(not found.problems for found in recheck(made))


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_slow_robot_beside_a_fast_one_serves_only_where_it_stands(objective: str) -> None:
    """Speeds 18 orders of magnitude apart: the slow one stands at 0, the fast one walks 3 to 4."""
    slow = Robot(id=7, start=(0, 0), speed=1e-9, capabilities=("A",))
    mission = corridor(1e9, 0.0)
    mission = mission.replace(robots=(*mission.robots, slow))
    made = mo.plan(mission, planner="exact", objective=objective)
    certificate = made.certificates[0]
    assert certificate.status == "optimal"
    assert certificate.objective == pytest.approx(3e-9)
    assert all(not found.problems for found in recheck(made))


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_optimum_is_found_proved_and_checked_in_every_unit(
    objective: str, instances_dir: Path
) -> None:
    mission = Instance.read(instances_dir / "two_rooms.json")
    values, wholes = [], set()
    for power in POWERS:
        made = mo.plan(in_unit(mission, power), planner="exact", objective=objective)
        (certificate,) = made.certificates
        assert certificate.status == "optimal"
        assert problems(made) == []
        (found,) = recheck(made)
        assert found.problems == ()
        values.append(float(certificate.objective or 0.0) / 10.0**power)
        wholes.add((certificate.proof, found.whole))
    assert values == pytest.approx([values[0]] * len(POWERS), rel=1e-9)
    assert len(wholes) == 1


def test_a_service_of_next_to_nothing_is_not_nothing(instances_dir: Path) -> None:
    """With services of 1 and of 1e-9, no step but 1e-9 is common: nothing is rounded up to wholes."""
    mission = Instance.read(instances_dir / "corridor.json")
    first = mission.victims[0].model_copy(update={"service_time": {"FirstAids": 1e-9}})
    mission = mission.replace(victims=(first, mission.victims[1]))
    for objective in OBJECTIVES:
        made = mo.plan(mission, planner="exact", objective=objective)
        (found,) = recheck(made)
        assert found.problems == ()
        assert made.certificates[0].status == "optimal"


@pytest.mark.parametrize("power", [-9, 0, 9])
def test_first_routes_within_limits_do_not_depend_on_the_unit_of_time(power: int) -> None:
    """The quick planners' routes take longer than 65, in which all can be served."""
    limit = float(f"65.1e{power}")
    made = mo.plan(in_unit(small(1), power), planner="exact", endurance=limit)
    (certificate,) = made.certificates
    assert certificate.status == "optimal"
    assert certificate.objective == pytest.approx(107.5 * 10.0**power, rel=1e-9)
    assert problems(made) == []


DAY, YEAR = 86400.0, 31557600.0


@pytest.mark.parametrize("unit", [1e-9, 60.0, DAY, YEAR, 1e8, 1e9])
@pytest.mark.parametrize("solver", ["auto", "highs", "scip"])
@pytest.mark.parametrize(
    ("name", "model", "least"),
    [
        # Robot 0 alone: 2 moves + 1, 1 move + 1; the paper's by its baselines of four solvers.
        ("sum_or_max", "joint_routing_mtz", 5),
        ("sum_or_max", "joint_routing_flow", 5),
        ("paper", "victim_balanced", 530 / 3),
    ],
)
def test_a_formulation_has_the_same_optimum_in_every_unit(
    name: str, model: str, least: float, solver: str, unit: float, instances_dir: Path
) -> None:
    mission = times_as_long(Instance.read(instances_dir / f"{name}.json"), 1 / unit)
    data = mo.stage_data(mission, "routing" if model.startswith("joint") else "victim")
    found = mo.solve(model, data, solver=solver)
    assert found.status in ("optimal", "claimed")
    assert found.objective == pytest.approx(least / unit, rel=1e-6)
    assert found.bound == pytest.approx(least / unit, rel=1e-6)


@pytest.mark.parametrize("unit", [1e-9, DAY, YEAR, 1e9])
def test_the_papers_mission_is_proved_in_every_unit(unit: float, paper: Instance) -> None:
    """The docs' certified value, 3655 / 3."""
    made = mo.plan(times_as_long(paper, 1 / unit), planner="exact")
    (certificate,) = made.certificates
    assert certificate.status == "optimal"
    assert certificate.objective == pytest.approx(3655 / 3 / unit, rel=1e-9)
    assert all(not found.problems for found in recheck(made))


@pytest.mark.parametrize(
    ("objective", "least"),
    [
        # 5 moves to either victim, 2 between them.
        ("makespan", lambda one, other: 7 + one + other),
        ("total_time", lambda one, other: 7 + one + other),
        ("latency", lambda one, other: min(12 + 2 * one + other, 12 + one + 2 * other)),
    ],
)
@pytest.mark.parametrize("services", [(1, 1e-9), (1e-9, 1), (1, 1e-6), (1e-9, 1e-9), (1, 0)])
def test_an_honest_bound_beside_a_service_of_next_to_nothing_is_proved_again(
    services: tuple[float, float], objective: str, least: Expected
) -> None:
    rows = [".@@.@...@..@", "........@@@@", ".@.@...@.@..", "@........@.@", "..@...@.@..."]
    mission = Instance(
        map=grid_from_rows(rows),
        capabilities=("k1", "k2"),
        service_time=dict(zip(("k1", "k2"), services, strict=True)),
        robots=(
            Robot(id=532, start=(0, 6), speed=1, capabilities=()),
            Robot(id=574, start=(2, 2), speed=1, capabilities=("k1", "k2")),
        ),
        victims=(
            Victim(id=1, cell=(2, 5), requirements=("k2",)),
            Victim(id=2**31 - 1, cell=(4, 5), requirements=("k1",)),
        ),
    )
    made = mo.plan(mission, planner="exact", objective=objective)
    (certificate,) = made.certificates
    assert certificate.status == "optimal"
    assert certificate.objective == pytest.approx(least(*services), rel=1e-12)
    assert problems(made) == []
    assert all(not found.problems for found in recheck(made))
