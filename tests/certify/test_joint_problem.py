"""The joint problem in exact numbers, by hand: distances, limits, and which values are possible."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from msmrta_opt.certify.joint_problem import Joint
from msmrta_opt.certify.walking import steps_from
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan


def test_steps_go_around_walls_and_not_through_them() -> None:
    grid = grid_from_rows(["..@.", ".@@.", "...."])
    assert steps_from(grid, (0, 1)) == {
        (0, 1): 0,
        (0, 0): 1,
        (1, 0): 2,
        (2, 0): 3,
        (2, 1): 4,
        (2, 2): 5,
        (2, 3): 6,
        (1, 3): 7,
        (0, 3): 8,
    }
    assert steps_from(grid_from_rows([".@."]), (0, 0)) == {(0, 0): 0}


@pytest.fixture
def corridor(instances_dir: Path) -> Instance:
    """A robot at 1 of five cells in a row, victims at 0 and 4, service 2 each, speed 1."""
    return Instance.read(instances_dir / "corridor.json")


def joint(instance: Instance, **options: object) -> Joint:
    return Joint.of(Plan(instance=instance, planner="none", options=options, routes=()))


def test_times_are_those_of_walking(corridor: Instance) -> None:
    found = joint(corridor)
    assert found.leave == {(0, 0): 1, (0, 1): 3}
    assert found.between == {(0, 0, 1): 4}
    assert found.total_service == 4
    assert [found.back(0, v) for v in (0, 1)] == [0, 0]
    assert [joint(corridor, return_to_start=True).back(0, v) for v in (0, 1)] == [1, 3]


@pytest.mark.parametrize(
    ("limits", "victims"),
    [
        ({}, {0, 1}),
        ({"endurance": 5}, {0, 1}),
        ({"endurance": 4.9}, {0}),
        ({"longest_walk": 3}, {0, 1}),
        ({"longest_walk": 2}, {0}),
        ({"longest_walk": 5, "return_to_start": True}, {0}),
        ({"endurance": 7, "return_to_start": True}, {0}),
        ({"longest_walk": 0}, set()),
    ],
)
def test_what_a_robot_cannot_serve_alone_within_its_limits_is_left_out(
    corridor: Instance, limits: dict[str, object], victims: set[int]
) -> None:
    assert {v for _, v, _ in joint(corridor, **limits).able} == victims


def test_bounds_are_rounded_up_to_possible_values(corridor: Instance) -> None:
    """Moves take 1: total time is 4 and a whole number more; of service 2 the makespan, too."""
    found = joint(corridor)
    assert found.up(Fraction(4), "total_time", Fraction(99)) == 4
    assert found.up(Fraction("8.001"), "total_time", Fraction(99)) == 9
    assert found.up(Fraction("8.001"), "makespan", Fraction(99)) == 9
    assert found.up(Fraction(-7), "total_time", Fraction(99)) == -7
    only = corridor.replace(victims=(corridor.victims[1],))
    # 2 of service, 3 of way or nothing.
    assert joint(only).up(Fraction("2.1"), "total_time", Fraction(99)) == 5


def test_times_that_are_too_long_for_plans_as_good_do_not_keep_bounds_from_being_rounded_up(
    corridor: Instance,
) -> None:
    """The slow robot moves a cell in 1000.3; plans worth 99 do not have it move."""
    slow = corridor.robots[0].model_copy(update={"id": 77, "speed": 1 / 1000.3})
    found = joint(corridor.replace(robots=(*corridor.robots, slow)))
    for objective in ("total_time", "makespan"):
        assert found.up(Fraction("8.001"), objective, Fraction(99)) == 9
        assert found.up(Fraction("8.95"), objective, Fraction(99)) == 9
        assert found.up(Fraction("8.001"), objective, Fraction(9999)) == Fraction("8.1")
    assert found.up(Fraction("8.95"), "makespan", Fraction("8.96")) == Fraction("8.96")


def test_tiny_times_do_not_keep_bounds_from_being_rounded_up(corridor: Instance) -> None:
    """Services of 1e-9: the makespan is a whole number of moves, and up to 2e-9 more."""
    tiny = joint(corridor.replace(service_time={"FirstAids": 1e-9}))
    assert tiny.step("makespan") == Fraction(1, 10**9)
    assert tiny.up(Fraction("4.3"), "makespan", Fraction(99)) == 5
    assert tiny.up(Fraction(5), "makespan", Fraction(99)) == 5
    assert tiny.up(Fraction("5.000000001"), "makespan", Fraction(99)) == Fraction("5.000000001")
    assert tiny.up(Fraction("5.0000000011"), "makespan", Fraction(99)) == Fraction("5.000000002")
    assert tiny.up(Fraction("5.0000000031"), "makespan", Fraction(99)) == 6
    # In latency, each of two victims is complete up to 2e-9 after a whole number.
    assert tiny.up(Fraction("5.0000000039"), "latency", Fraction(99)) == Fraction("5.000000004")
    assert tiny.up(Fraction("5.0000000041"), "latency", Fraction(99)) == 6


def test_each_requirement_alone_is_a_bound(corridor: Instance) -> None:
    """Victim 1 is 3 away; service takes 4 in all, 2 of it at victim 1."""
    assert joint(corridor).each_alone("total_time") == 7
    assert joint(corridor).each_alone("makespan") == 5
    assert joint(corridor.replace(victims=())).each_alone("makespan") == 0
