from __future__ import annotations

import numpy as np
import pytest

from msmrta_opt.mission.grid import Cell, DistanceTable
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.stages.situation import Situation, Stop, each_once, nearest_first, without

# Robot 0 (A) and robot 1 (A, B) share a corridor; the last two cells are behind a wall, with
# robot 2 (B) and victim 2. Nobody who reaches victim 2 has A.
A, B, C = 0, 1, 2
INSTANCE = Instance(
    map=grid_from_rows([".....@.."]),
    capabilities=("A", "B", "C"),
    service_time={"A": 2.0, "B": 3.0, "C": 5.0},
    robots=(
        Robot(id=30, start=(0, 0), speed=0.5, capabilities=("A",)),
        Robot(id=20, start=(0, 4), speed=2.0, capabilities=("A", "B")),
        Robot(id=10, start=(0, 7), speed=1.0, capabilities=("B",)),
    ),
    victims=(
        Victim(id=7, cell=(0, 2), requirements=("A", "B", "C"), service_time={"B": 7.0}),
        Victim(id=5, cell=(0, 3), requirements=("B",)),
        Victim(id=6, cell=(0, 6), requirements=("A", "B")),
    ),
)
SITUATION = Situation.of(INSTANCE)


def test_a_robot_reaches_the_victims_on_its_side_of_the_wall() -> None:
    assert SITUATION.reach.tolist() == [
        [True, True, False],
        [True, True, False],
        [False, False, True],
    ]


def test_a_robot_is_able_to_serve_what_it_has_the_victim_needs_and_it_can_reach() -> None:
    able = {(int(r), int(v), int(k)) for r, v, k in np.argwhere(SITUATION.able)}
    assert able == {(0, 0, A), (1, 0, A), (1, 0, B), (1, 1, B), (2, 2, B)}


def test_a_requirement_is_available_when_some_robot_is_able_to_serve_it() -> None:
    available = {(int(v), int(k)) for v, k in np.argwhere(SITUATION.available)}
    assert available == {(0, A), (0, B), (1, B), (2, B)}


def test_an_empty_queue_ends_at_the_start_at_time_0() -> None:
    cells, busy = SITUATION.after([])
    assert cells == [(0, 0), (0, 4), (0, 7)]
    assert busy.tolist() == [0, 0, 0]


def test_a_queue_ends_at_its_last_stop_when_its_walks_and_services_are_done() -> None:
    stops = [
        Stop(0, (0, 3), "B2"),
        Stop(1, (0, 2), "B2", 0, (A, B)),
        Stop(0, (0, 2), "B2", 0, (A,)),
    ]
    cells, busy = SITUATION.after(stops)
    assert cells == [(0, 2), (0, 2), (0, 7)]
    # Robot 0: 3 + 1 cells at 0.5, and A 2. Robot 1: 2 cells at 2, A 2 and this victim's own B 7.
    assert busy.tolist() == [4 / 0.5 + 2, 2 / 2 + 2 + 7, 0]


def test_stops_close_the_requirements_they_serve_and_passing_closes_none() -> None:
    stops = [Stop(0, (0, 2), "B2"), Stop(1, (0, 2), "B2", 0, (B,)), Stop(2, (0, 6), "B3", 2, (B,))]
    before = SITUATION.available
    left = without(before, stops)
    assert {(int(v), int(k)) for v, k in np.argwhere(left)} == {(0, A), (1, B)}
    assert before.sum() == 4  # the caller's table is as it was


def test_of_stops_that_serve_the_same_the_first_serves_it() -> None:
    stops = [
        Stop(0, (0, 2), "B3", 0, (A,)),
        Stop(1, (0, 3), "B3"),
        Stop(1, (0, 2), "B3", 0, (A, B)),
        Stop(1, (0, 3), "B3", 1, (B,)),
        Stop(2, (0, 2), "B3", 0, (B,)),
    ]
    assert each_once(stops) == [
        Stop(0, (0, 2), "B3", 0, (A,)),
        Stop(1, (0, 3), "B3"),  # a stop that only passes stays
        Stop(1, (0, 2), "B3", 0, (B,)),
        Stop(1, (0, 3), "B3", 1, (B,)),
    ]


@pytest.mark.parametrize(
    ("start", "cells", "order"),
    [
        ((0, 0), [], []),
        # From 3: 4 is 1 away; from there 1 is 3 away, and 0 comes last.
        ((0, 3), [(0, 0), (0, 1), (0, 4)], [2, 1, 0]),
        # After 3, it is 4 that is nearest, although 0 is as near to the start as 4.
        ((0, 2), [(0, 0), (0, 3), (0, 4)], [1, 2, 0]),
        # 2 is as far from 1 as from 3: the first.
        ((0, 2), [(0, 3), (0, 1)], [0, 1]),
        ((0, 2), [(0, 1), (0, 3)], [0, 1]),
    ],
)
def test_the_nearest_comes_first_and_ties_go_to_the_first(
    start: Cell, cells: list[Cell], order: list[int]
) -> None:
    assert nearest_first(DistanceTable(INSTANCE.map), start, cells) == order


def test_nearest_means_by_walking_not_as_the_crow_flies() -> None:
    # From (0, 0), (0, 2) is 2 away as the crow flies and 6 on foot; (2, 1) is 3 away.
    grid = grid_from_rows([".@.", ".@.", "..."])
    assert nearest_first(DistanceTable(grid), (0, 0), [(0, 2), (2, 1)]) == [1, 0]
