"""The staged planner's endurance is Eq. 2's: what other stages give a robot comes on top."""

from __future__ import annotations

from pathlib import Path

import pytest

import msmrta_opt as mo
from msmrta_opt.mission.errors import CheckError
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan


def test_a_staged_plan_may_keep_its_robots_busy_beyond_the_endurance_of_eq_2(
    instances_dir: Path,
) -> None:
    mission = mo.read(str(instances_dir / "paper.json"))
    plan = mo.plan(mission, victim_model="victim_generalized", endurance=400)
    assert plan.metrics.served_share == 1
    assert plan.metrics.makespan > 400


def two_robots(speed: float = 1.0, victims: int = 1, service: float = 10) -> Instance:
    """Two robots, each beside its victims, by hand.

    Robot 574 serves victim 952 where it stands, in 10, the service of B; then it walks 2 cells for the B
    of each victim 656, 657, …, another 10 each. Robot 522 stands beside these and serves their A.
    """
    return Instance(
        map=grid_from_rows([".", ".", "."]),
        capabilities=("A", "B"),
        service_time={"A": 1, "B": service},
        robots=(
            Robot(id=574, start=(2, 0), speed=speed, capabilities=("B",)),
            Robot(id=522, start=(0, 0), speed=speed, capabilities=("A",)),
        ),
        victims=(
            Victim(id=952, cell=(2, 0), requirements=("B",)),
            *(Victim(id=656 + n, cell=(0, 0), requirements=("A", "B")) for n in range(victims)),
        ),
    )


def within(endurance: float, mission: Instance) -> Plan:
    return mo.plan(mission, victim_model="victim_generalized", endurance=endurance)


@pytest.mark.parametrize(
    ("mission", "endurance", "needed"),
    [
        (two_robots(), 1, "22"),
        (two_robots(), 21.9, "22"),
        (two_robots(speed=0.5), 22, "24"),
        (two_robots(speed=3), 20, "20.6666666667"),
        (two_robots(speed=1e-9), 20, "2000000020"),
        (two_robots(service=1e9), 1, "2000000002"),
        (two_robots(service=0.25), 2, "2.5"),
    ],
)
def test_a_victim_for_whom_no_robot_has_the_time_is_named_with_the_time_that_is_needed(
    mission: Instance, endurance: float, needed: str
) -> None:
    with pytest.raises(CheckError) as refused:
        within(endurance, mission)
    assert str(refused.value) == (
        f"endurance: no robot has the time for victim 656 within {endurance:g}; "
        f"at least {needed} is needed"
    )
    assert within(float(needed), mission).metrics.served_share == 1


def test_several_victims_without_the_time_are_counted() -> None:
    with pytest.raises(CheckError, match=r"victim 656 .* 22 is needed, and more for 2 others$"):
        within(5, two_robots(victims=3))


def test_time_for_each_victim_but_not_for_all_is_said_so() -> None:
    """Both take 24 after the first 10."""
    with pytest.raises(CheckError, match=r"for each victim, but not for all; give more$"):
        within(33.9, two_robots(victims=2))
    assert within(34, two_robots(victims=2)).metrics.served_share == 1
