"""The joint problem's answers: their times, values and faults, by hand.

Robot 0 starts at 0 with speed 1, robot 1 at 10 with speed 0.5, on a line; victims stand at 2, 5, 9.
Kind 0 takes 1 (victim 0), 2 (victim 1) and 3 (victim 2); victim 1 also needs kind 1, which takes 4
and which only robot 1 has.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.problem import Routes, RoutingData, faults, times

ROUTES: Routes = (((0, (0,)), (1, (0,))), ((2, (0,)), (1, (1,))))


def line(
    *, back: bool = False, endurance: float = np.inf, longest_walk: float = np.inf
) -> RoutingData:
    start, place, speed = np.array([0.0, 10.0]), np.array([2.0, 5.0, 9.0]), np.array([1.0, 0.5])
    leave = np.abs(start[:, None] - place) / speed[:, None]
    able = np.zeros((2, 3, 2), dtype=bool)
    able[:, :, 0] = True
    able[1, 1, 1] = True
    return RoutingData(
        leave=leave,
        length=np.abs(place[:, None] - place)[None] / speed[:, None, None],
        back=leave if back else np.zeros_like(leave),
        service=np.array([[1.0, 0.0], [2.0, 4.0], [3.0, 0.0]]),
        able=able,
        priority=np.array([1.0, 2.0, 0.5]),
        endurance=np.full(2, endurance),
        longest_walk=np.full(2, longest_walk),
    )


def test_times_follow_travel_and_service() -> None:
    # Robot 0: 2 to victim 0, done at 3; 3 to victim 1, done at 8.
    # Robot 1: 1 cell in 2, done at 5 with victim 2; 4 cells in 8, done at 17 with victim 1.
    at = times(line(), ROUTES)
    assert at.travel.tolist() == [5, 10]
    assert at.busy.tolist() == [8, 17]
    assert at.completion.tolist() == [3, 17, 5]


def test_the_way_back_counts_as_travel_and_not_for_victims() -> None:
    # From victim 1 at 5 both go back 5 cells, in 5 and in 10.
    at = times(line(back=True), ROUTES)
    assert at.travel.tolist() == [10, 20]
    assert at.busy.tolist() == [13, 27]
    assert at.completion.tolist() == [3, 17, 5]


def test_values_are_sums_the_last_and_weighted_completions() -> None:
    data = line()
    assert value(data, ROUTES, "total_time") == 8 + 17
    assert value(data, ROUTES, "makespan") == 17
    assert value(data, ROUTES, "latency") == 1 * 3 + 2 * 17 + 0.5 * 5


def test_robots_that_stay_at_home_take_no_time() -> None:
    at = times(line(back=True), ((), ()))
    assert at.travel.tolist() == at.busy.tolist() == [0, 0]
    assert at.completion.tolist() == [0, 0, 0]
    assert value(line(), ((), ()), "makespan") == 0


def test_what_is_required_is_what_somebody_can_do() -> None:
    data = line()
    assert data.required.tolist() == [[True, False], [True, True], [True, False]]
    assert data.can_visit.all()
    assert data.total_service == 1 + 2 + 4 + 3


def test_right_routes_have_no_faults() -> None:
    assert faults(line(), ROUTES) == []


def test_right_routes_within_their_limits_to_the_point_have_no_faults() -> None:
    assert faults(line(endurance=17, longest_walk=10), ROUTES) == []
    assert faults(line(back=True, endurance=27, longest_walk=20), ROUTES) == []


@pytest.mark.parametrize(
    ("routes", "wrong"),
    [
        ((), ["0 routes for 2 robots"]),
        (
            (((0, (0,)), (1, (0,)), (0, ())), ((2, (0,)), (1, (1,)))),
            ["robot 0 visits victim 0 2 times", "robot 0 visits victim 0 for nothing"],
        ),
        (
            (((0, (0,)), (1, (0, 1))), ((2, (0,)),)),
            ["robot 0 cannot serve kind 1 at victim 1"],
        ),
        (
            (((0, (0,)), (1, (0,))), ((1, (1,)),)),
            ["kind 0 at victim 2 is served 0 times"],
        ),
        (
            (((0, (0,)), (1, (0,))), ((2, (0,)), (1, (0, 1)))),
            ["kind 0 at victim 1 is served 2 times"],
        ),
    ],
)
def test_each_fault_is_named(routes: Routes, wrong: list[str]) -> None:
    assert faults(line(), routes) == wrong


def test_serving_what_is_not_needed_is_a_fault() -> None:
    routes: Routes = (((0, (0, 1)), (1, (0,))), ((2, (0,)), (1, (1,))))
    assert faults(line(), routes) == ["robot 0 cannot serve kind 1 at victim 0"]


def test_limits_are_kept_per_robot() -> None:
    assert faults(line(endurance=16), ROUTES) == ["robot 1 is busy for 17, beyond 16"]
    assert faults(line(longest_walk=9), ROUTES) == ["robot 1 travels for 10, beyond 9"]
    assert faults(line(back=True, endurance=26), ROUTES) == ["robot 1 is busy for 27, beyond 26"]


def test_faults_speak_in_ids() -> None:
    ids = {"r": [7, 3], "v": [104, 12, 9], "k": ["saw", "oxygen"]}
    data = replace(line(endurance=16), ids=ids)
    assert faults(data, ROUTES) == ["robot 3 is busy for 17, beyond 16"]
    routes: Routes = (((0, (0, 1)),), ((2, (0,)), (1, (1,))))
    assert faults(data, routes)[:2] == [
        "robot 7 cannot serve kind oxygen at victim 104",
        "kind saw at victim 12 is served 0 times",
    ]


def test_arrays_of_the_wrong_shape_are_refused() -> None:
    right = line()
    arrays = {item.name: getattr(right, item.name) for item in fields(RoutingData)}
    with pytest.raises(ValueError, match=r"leave has shape \(3, 2\); give \(2, 3\)"):
        RoutingData(**{**arrays, "leave": right.leave.T})


def test_one_table_of_ways_for_all_robots_says_what_one_for_each_does() -> None:
    each = line()
    shared = replace(each, length=each.length[:1] * 1.0, speed=np.array([1.0, 0.5]))
    assert np.array_equal(shared.between, each.between)
    assert np.array_equal(shared.travel, each.travel)
    assert shared.way(1, 0, 2) == each.way(1, 0, 2) == 14
    assert np.array_equal(shared.ways(1, np.array([0, 2])), each.ways(1, np.array([0, 2])))
    assert [x.tolist() for x in shared.nearest.values()] == [[0, 1, 2], [1, 0, 2], [2, 1, 0]]
    assert np.array_equal(times(shared, ROUTES).busy, times(each, ROUTES).busy)


def test_ways_of_a_wrong_shape_are_refused() -> None:
    with pytest.raises(ValueError, match=r"length has shape \(2, 3, 2\); give \(2, 3, 3\)"):
        replace(line(), length=line().length[:, :, :2])
