"""Improvement by parts: parts are joint problems of their own, and improving them improves the whole."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from support.joint_oracle import least
from support.searches import closed_in

from msmrta_opt.routing.branch_and_cut.search import _Run
from msmrta_opt.routing.heuristics import robot_subsets as parts
from msmrta_opt.routing.heuristics.robot_subsets import improve_by_parts, part_of, put_back
from msmrta_opt.routing.heuristics.ruin_and_recreate import ruin_and_recreate
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.parameters import Parameters
from msmrta_opt.routing.problem import Routes, RoutingData, faults, times
from msmrta_opt.routing.stop import MaximumIterations, MaximumRuntime

from .test_ruin_and_recreate import first_come, limited, random_data

BOTH: tuple[str, ...] = ("total_time", "makespan")


def searched(objective: str) -> parts.Solve:
    return lambda part, routes, seconds: ruin_and_recreate(
        part, routes, objective, stop=MaximumIterations(60)
    )


def proven(objective: str) -> parts.Solve:
    return lambda part, routes, seconds: closed_in(part, objective, routes)[0]


def alike(n: int) -> np.ndarray:
    return np.ones((n, n))


@pytest.mark.parametrize("seed", range(5))
def test_a_part_is_what_its_robots_serve_together(seed: int) -> None:
    data = limited(random_data(seed, 5, 8, 14, back=True), 500.0, 300.0)
    routes = first_come(data)
    robots = [0, 2, 3]
    part, own, victims = part_of(data, routes, robots)
    assert faults(part, own) == []
    assert [data.required[v].any() for v in victims] == [True] * len(victims)
    busy = times(data, routes).busy[robots]
    assert times(part, own).busy.tolist() == pytest.approx(busy.tolist())
    served = {(v, k) for r in robots for v, kinds in routes[r] for k in kinds}
    assert {(victims[v], int(k)) for v, k in np.argwhere(part.required)} == served
    assert (part.able == data.able[np.ix_(robots, victims)] & part.required).all()
    assert part.endurance.tolist() == [500.0] * 3
    assert part.longest_walk.tolist() == [300.0] * 3
    assert put_back(routes, robots, own, victims) == routes


@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", range(4))
def test_routes_get_no_worse_and_stay_feasible(seed: int, objective: str) -> None:
    data = random_data(seed, 7, 12, 20)
    routes = first_come(data)
    found = improve_by_parts(
        data, objective, routes, alike(7), searched(objective), seconds=0.5, seed=seed
    )
    assert faults(data, found) == []
    assert value(data, found, objective) <= value(data, routes, objective)


def test_bad_routes_get_better_step_by_step() -> None:
    data = random_data(1, 7, 12, 20)
    routes = first_come(data)
    told: list[Routes] = []
    found = improve_by_parts(
        data, "total_time", routes, alike(7), proven("total_time"), seconds=30, improved=told.append
    )
    values = [value(data, one, "total_time") for one in (routes, *told)]
    assert len(values) > 1
    assert values == sorted(values, reverse=True)
    assert told[-1] == found


@pytest.mark.parametrize("seed", range(4))
def test_in_the_end_every_part_is_best(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of three robots: all pairs, since so many draws in vain leave none out."""
    monkeypatch.setattr(parts, "FEWEST", 2)
    monkeypatch.setattr(parts, "IN_VAIN", 30)
    data = random_data(seed, 3, 5, 9)
    found = improve_by_parts(
        data, "total_time", first_come(data), alike(3), proven("total_time"), seconds=60, seed=seed
    )
    for robots in combinations(range(3), 2):
        part, own, _ = part_of(data, found, list(robots))
        assert value(part, own, "total_time") == pytest.approx(least(part, "total_time"))


def test_parts_grow_where_several_bring_nothing_and_none_comes_twice() -> None:
    data = random_data(3, 6, 10, 16)
    drawn: list[tuple[int, bytes]] = []

    def solve(part: RoutingData, routes: Routes, seconds: float) -> Routes:
        drawn.append((part.n_robots, part.leave.tobytes()))
        return routes

    routes = first_come(data)
    improve_by_parts(data, "total_time", routes, alike(6), solve, seconds=60)
    sizes = [size for size, _ in drawn]
    assert sizes == sorted(sizes)
    assert set(sizes) == {3, 4, 5}
    assert sizes.count(3) <= parts.IN_VAIN
    assert len(drawn) == len(set(drawn))


def test_robots_that_have_much_to_share_are_drawn_together() -> None:
    data = random_data(4, 12, 12, 20)
    split = np.zeros((12, 12))
    split[:3, :3] = 1.0
    np.fill_diagonal(split, 0.0)
    first: list[RoutingData] = []

    def solve(part: RoutingData, routes: Routes, seconds: float) -> Routes:
        first.append(part)
        return routes

    improve_by_parts(
        data,
        "total_time",
        first_come(data),
        split,
        solve,
        seconds=60,
        should_stop=lambda: bool(first),
    )
    expected, _, _ = part_of(data, first_come(data), [0, 1, 2])
    assert np.array_equal(first[0].leave, expected.leave)


def test_the_busiest_robot_is_always_in_a_part_for_the_makespan() -> None:
    data = random_data(5, 7, 12, 20)
    routes = first_come(data)
    busiest = times(data, routes).busy.max()
    seen: list[float] = []

    def solve(part: RoutingData, own: Routes, seconds: float) -> Routes:
        seen.append(times(part, own).busy.max())
        return own

    improve_by_parts(data, "makespan", routes, alike(7), solve, seconds=60)
    assert set(seen) == {busiest}


def test_it_ends_when_asked_to_and_at_its_limit() -> None:
    data = random_data(6, 8, 12, 20)
    routes = first_come(data)
    same = improve_by_parts(
        data,
        "total_time",
        routes,
        alike(8),
        searched("total_time"),
        seconds=60,
        should_stop=lambda: True,
    )
    assert same == routes
    began = time.monotonic()
    slow = searched("total_time")
    improve_by_parts(data, "total_time", routes, alike(8), slow, seconds=0.1)
    assert time.monotonic() - began < 5


def test_few_robots_have_no_parts() -> None:
    data = replace(random_data(7, 3, 6, 9))
    routes = first_come(data)
    assert (
        improve_by_parts(data, "total_time", routes, alike(3), proven("total_time"), seconds=9)
        == routes
    )


def test_a_point_a_hair_below_its_bounds_is_drawn_from_all_the_same() -> None:
    data = random_data(8, 7, 12, 20)
    routes = first_come(data)
    progress = Progress(data, "total_time", routes, stop=MaximumRuntime(20))
    run = _Run(progress, 0, Parameters())
    relaxed = run.relax()
    run.by_robots(replace(relaxed, point=relaxed.point - 1e-9), seconds=20.0)
    assert value(data, progress.routes, "total_time") < value(data, routes, "total_time")
