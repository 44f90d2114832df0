from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.stage_missions import small_missions

from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.optimise.data import VictimData
from msmrta_opt.stages.cluster_assignment import cluster_assignment
from msmrta_opt.stages.clustering import clustering
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.performance_analysis import performance_analysis
from msmrta_opt.stages.requirement_analysis import requirement_analysis
from msmrta_opt.stages.situation import Situation, Stop, without

# A corridor of eight cells, and a cell behind a wall. Nobody has C.
#
#   robot  at  speed   has          victim  at  needs
#   0      0   0.5     A D          0       2   A B D
#   1      7   1       A B          1       5   B C D
#   2      3   1       nothing      2       7   A B
#   3      9   1       A            3       9   B
A, B, C, D = 0, 1, 2, 3
INSTANCE = Instance(
    map=grid_from_rows(["........@."]),
    capabilities=("A", "B", "C", "D"),
    service_time={"A": 2.0, "B": 3.0, "C": 5.0, "D": 4.0},
    robots=(
        Robot(id=0, start=(0, 0), speed=0.5, capabilities=("A", "D")),
        Robot(id=1, start=(0, 7), speed=1.0, capabilities=("A", "B")),
        Robot(id=2, start=(0, 3), speed=1.0, capabilities=()),
        Robot(id=3, start=(0, 9), speed=1.0, capabilities=("A",)),
    ),
    victims=(
        Victim(id=0, cell=(0, 2), requirements=("A", "B", "D")),
        Victim(id=1, cell=(0, 5), requirements=("B", "C", "D")),
        Victim(id=2, cell=(0, 7), requirements=("A", "B")),
        Victim(id=3, cell=(0, 9), requirements=("B",)),
    ),
)
# Robot 0 passes a centre and serves A and D of victim 0, done after 2 cells / 0.5 + 2 + 4 = 10.
# It leaves B there to others: its record is 3. Robot 1 only goes to a centre, where it is at 1.
B2 = [Stop(0, (0, 1), "B2"), Stop(0, (0, 2), "B2", 0, (A, D)), Stop(1, (0, 6), "B2")]
# So B of victim 0, B and D of victim 1 and A and B of victim 2 remain; C of victim 1 is
# unavailable, as is B of victim 3, who is out of robot 1's reach.


def times(stops: Sequence[Stop], instance: Instance = INSTANCE, **options: Any) -> VictimData:
    situation = Situation.of(instance)
    remaining = without(situation.available, stops)
    return performance_analysis(situation, stops, remaining, StagedOptions.of(**options))


def test_who_can_serve_whom_is_a_matter_of_what_remains() -> None:
    # Robot 0 has done its part at victim 0; robot 3 could serve A, had it a way out.
    assert times(B2).can_serve.astype(int).tolist() == [
        [0, 1, 1, 0],
        [1, 1, 1, 0],
        [0, 0, 0, 0],
        [0, 0, 0, 0],
    ]


def test_success_is_the_busy_time_the_way_and_the_service_of_what_the_robot_can_do() -> None:
    assert times(B2).success.tolist() == [
        # From 2 at time 10: to 5 and D, to 7 and A.
        [0, 10 + 3 / 0.5 + 4, 10 + 5 / 0.5 + 2, 0],
        # From 6 at time 1: to 2 and B, to 5 and B, to 7 and A and B.
        [1 + 4 + 3, 1 + 1 + 3, 1 + 1 + 2 + 3, 0],
        [0, 0, 0, 0],
        [0, 0, 0, 0],
    ]


def test_failure_is_what_others_must_redo_over_the_number_of_capabilities() -> None:
    assert times(B2).failure.tolist() == [
        # Of two capabilities; on its record B 3, and at victims 1 and 2 it lacks B 3.
        [0, (3 + 3) / 2, (3 + 3) / 2, 0],
        # Of two capabilities, without a record; it lacks D 4 of victim 1.
        [0, 4 / 2, 0, 0],
        [0, 0, 0, 0],
        [0, 0, 0, 0],
    ]


def test_robots_are_busy_until_their_queues_of_stage_b2_end() -> None:
    assert times(B2).busy.tolist() == [10, 1, 0, 0]


def test_before_any_stop_robots_are_at_their_starts_without_a_record() -> None:
    data = times([])
    # Robot 0: to 2, A and D; to 5, D; to 7, A. Robot 1: to 2, A and B; to 5, B; there, A and B.
    assert data.success[0].tolist() == [2 / 0.5 + 6, 5 / 0.5 + 4, 7 / 0.5 + 2, 0]
    assert data.success[1].tolist() == [5 + 5, 2 + 3, 0 + 5, 0]
    assert data.failure[0].tolist() == [3 / 2, 3 / 2, 3 / 2, 0]
    assert data.failure[1].tolist() == [4 / 2, 4 / 2, 0, 0]
    assert data.busy.tolist() == [0, 0, 0, 0]


def test_what_nobody_can_serve_is_nobodys_failure() -> None:
    # Of victim 0, who needs A, B and C, robot 0 serves A. B is behind the wall and C nowhere.
    instance = INSTANCE.replace(
        robots=(INSTANCE.robots[0], INSTANCE.robots[3].model_copy(update={"capabilities": ("B",)})),
        victims=(
            Victim(id=0, cell=(0, 2), requirements=("A", "B", "C")),
            Victim(id=1, cell=(0, 5), requirements=("A",)),
        ),
    )
    assert times([Stop(0, (0, 2), "B2", 0, (A,))], instance).failure.tolist() == [[0, 0], [0, 0]]


def test_per_robot_success_is_its_largest_service_time_and_failure_its_record() -> None:
    # As in the authors' program. Robot 0 has served A 2 and D 4 and left B 3, of two capabilities.
    data = times(B2, performance="robot")
    assert data.can_serve.tolist() == times(B2).can_serve.tolist()
    assert data.success.tolist() == [[0, 4, 4, 0], [0] * 4, [0] * 4, [0] * 4]
    assert data.failure.tolist() == [[0, 3 / 2, 3 / 2, 0], [0] * 4, [0] * 4, [0] * 4]
    # Success does not include busy times here, so they do not count.
    assert data.busy.tolist() == [0, 0, 0, 0]


def test_a_victims_own_service_times_count() -> None:
    victim = INSTANCE.victims[2].model_copy(update={"service_time": {"A": 20.0}})
    data = times([], INSTANCE.replace(victims=(victim,)))
    assert data.success[:2].tolist() == [[7 / 0.5 + 20], [20 + 3]]
    assert data.failure[:2].tolist() == [[3 / 2], [0]]


@pytest.mark.parametrize("performance", ["pair", "robot"])
def test_limits_hold_for_every_robot(performance: str) -> None:
    limited = times(B2, performance=performance, budget=3, endurance=60)
    assert limited.budget.tolist() == [3] * 4
    assert limited.endurance.tolist() == [60] * 4
    assert times(B2, performance=performance).endurance.tolist() == [np.inf] * 4


@pytest.mark.parametrize("performance", ["pair", "robot"])
def test_without_victims_there_are_no_times(performance: str) -> None:
    data = times([], INSTANCE.replace(victims=()), performance=performance)
    assert data.success.shape == data.failure.shape == data.can_serve.shape == (4, 0)


# Against plain loops


@st.composite
def missions(draw: st.DrawFn) -> Instance:
    """Small missions with walls, and with own service times of some victims."""
    instance = draw(small_missions())
    own = st.integers(0, 9).map(float)
    victims = tuple(
        victim.model_copy(
            update={"service_time": {kind: draw(own) for kind in victim.requirements[:1]}}
        )
        for victim in instance.victims
    )
    return instance.replace(victims=victims)


@given(
    instance=missions(),
    performance=st.sampled_from(["pair", "robot"]),
    members=st.sampled_from(["all", "partial"]),
    through_centre=st.booleans(),
)
def test_times_are_those_that_plain_loops_work_out(
    instance: Instance, performance: str, members: str, through_centre: bool
) -> None:
    options = StagedOptions.of(
        performance=performance, members=members, through_centre=through_centre
    )
    situation = Situation.of(instance)
    stops = cluster_assignment(
        situation,
        requirement_analysis(instance.P, instance.Q),
        clustering(situation, options),
        options,
    ).stops
    data = performance_analysis(situation, stops, without(situation.available, stops), options)

    walk = dict(nx.all_pairs_shortest_path_length(instance.map.graph))
    kinds = instance.capabilities

    def service(v: int, needs: set[str]) -> float:
        victim = instance.victims[v]
        return sum(victim.service_time.get(kind, instance.service_time[kind]) for kind in needs)

    available = [
        {
            kind
            for kind in victim.requirements
            if any(kind in r.capabilities and victim.cell in walk[r.start] for r in instance.robots)
        }
        for victim in instance.victims
    ]
    remaining = [set(needs) for needs in available]
    for stop in stops:
        if stop.victim is not None:
            remaining[stop.victim] -= {kinds[k] for k in stop.kinds}

    for r, robot in enumerate(instance.robots):
        here, busy, largest, record = robot.start, 0.0, 0.0, 0.0
        for stop in (stop for stop in stops if stop.robot == r):
            busy += walk[here][stop.cell] / robot.speed
            here = stop.cell
            if stop.victim is not None:
                doing = {kinds[k] for k in stop.kinds}
                busy += service(stop.victim, doing)
                largest = max([largest, *(service(stop.victim, {kind}) for kind in doing)])
                record += service(stop.victim, available[stop.victim] - set(robot.capabilities))
        n_capabilities = max(len(robot.capabilities), 1)
        for v, victim in enumerate(instance.victims):
            does = remaining[v] & set(robot.capabilities)
            success = failure = 0.0
            can_serve = bool(does) and victim.cell in walk[here]
            if can_serve and performance == "pair":
                success = busy + walk[here][victim.cell] / robot.speed + service(v, does)
                lost = service(v, remaining[v] - does)
                failure = (lost + record) / n_capabilities
            elif can_serve:
                success, failure = largest, record / n_capabilities
            assert data.can_serve[r, v] == can_serve
            assert data.success[r, v] == pytest.approx(success)
            assert data.failure[r, v] == pytest.approx(failure)
        assert data.busy[r] == pytest.approx(busy if performance == "pair" else 0.0)
