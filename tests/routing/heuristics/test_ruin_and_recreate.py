"""Ruin and recreate: never worse, always feasible, and the optimum where every solution can be tried."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from support.amounts import sample
from support.joint_random import first_come, limited, random_data

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan
from msmrta_opt.planners.support.improvement import routes_of
from msmrta_opt.routing.heuristics.ruin_and_recreate import ruin_and_recreate
from msmrta_opt.routing.objectives import OBJECTIVES, value
from msmrta_opt.routing.problem import Routes, RoutingData, faults
from msmrta_opt.routing.stop import Interruption, MaximumIterations, MaximumRuntime
from msmrta_opt.stages.joint_routing import routing_data
from msmrta_opt.stages.situation import Situation


def every_solution(data: RoutingData) -> Iterator[Routes]:
    """Every way to share out the requirements, in every order."""
    needs = [(int(v), int(k)) for v, k in np.argwhere(data.required)]
    for who in itertools.product(*(np.flatnonzero(data.able[:, v, k]) for v, k in needs)):
        visits: list[dict[int, tuple[int, ...]]] = [{} for _ in range(data.n_robots)]
        for (v, k), r in zip(needs, who, strict=True):
            visits[r][v] = (*visits[r].get(v, ()), k)
        yield from itertools.product(*(itertools.permutations(own.items()) for own in visits))


def worths(data: RoutingData, routes: Routes) -> tuple[dict[str, float], list[float]]:
    """Objectives, and travel of each robot, step by step; apart from the code under test."""
    ends, travels = [], []
    done = dict.fromkeys(range(data.n_victims), 0.0)
    for r, route in enumerate(routes):
        clock = travel = 0.0
        for i, (v, kinds) in enumerate(route):
            step = data.between[r, route[i - 1][0], v] if i else data.leave[r, v]
            travel += step
            clock += step + sum(data.service[v, k] for k in kinds)
            done[v] = max(done[v], clock)
        home = data.back[r, route[-1][0]] if route else 0.0
        ends.append(clock + home)
        travels.append(travel + home)
    latency = sum(data.priority[v] * clock for v, clock in done.items())
    return {"total_time": sum(ends), "makespan": max(ends), "latency": latency}, [
        *(max(0.0, end - data.endurance[r]) for r, end in enumerate(ends)),
        *(max(0.0, walk - data.longest_walk[r]) for r, walk in enumerate(travels)),
    ]


HEURISTICS = "msmrta_opt.routing.heuristics"


@pytest.fixture(autouse=True, params=["compiled", "without numba"])
def engine(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    if request.param == "without numba":
        monkeypatch.setitem(sys.modules, f"{HEURISTICS}.compiled_search", None)
    return str(request.param)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_the_optimum_of_tiny_missions_is_found_for_every_objective(seed: int, back: bool) -> None:
    data = random_data(seed, 2, 4, 6, back=back)
    solutions = [worths(data, routes)[0] for routes in every_solution(data)]
    for objective in OBJECTIVES:
        found = ruin_and_recreate(
            data, first_come(data), objective, stop=MaximumIterations(1500), seed=seed
        )
        best = min(solution[objective] for solution in solutions)
        assert worths(data, found)[0][objective] == pytest.approx(best)


@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_the_optimum_is_found_within_limits(seed: int) -> None:
    free = random_data(seed, 2, 4, 6, back=True)
    solutions = list(every_solution(free))
    # The least makespan is a limit that some solutions keep, and most do not.
    start = min(solutions, key=lambda routes: worths(free, routes)[0]["makespan"])
    makespan = worths(free, start)[0]["makespan"]
    data = limited(free, 1.1 * makespan, makespan)
    kept = [worth for worth, beyond in (worths(data, r) for r in solutions) if max(beyond) <= 1e-9]
    assert 0 < len(kept) < len(solutions)
    for objective in OBJECTIVES:
        found = ruin_and_recreate(data, start, objective, stop=MaximumIterations(1500), seed=seed)
        best = min(worth[objective] for worth in kept)
        worth, beyond = worths(data, found)
        assert max(beyond) <= 1e-6
        assert worth[objective] == pytest.approx(best)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("back", [False, True])
def test_routes_get_no_worse_and_stay_feasible(objective: str, back: bool) -> None:
    for seed in range(10):
        data = random_data(seed, 4, 12, 20, back=back)
        start = first_come(data)
        if seed % 2:
            before = worths(data, start)[0]["makespan"]
            data = limited(data, before, before)
        found = ruin_and_recreate(data, start, objective, stop=MaximumIterations(150), seed=seed)
        assert faults(data, found) == []
        assert value(data, found, objective) <= value(data, start, objective)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_same_seed_gives_the_same_routes(objective: str) -> None:
    data = random_data(1, 3, 10, 16)
    first, again = (
        ruin_and_recreate(data, first_come(data), objective, stop=MaximumIterations(200), seed=5)
        for _ in range(2)
    )
    assert first == again


def test_routes_that_are_optimal_come_back_as_they_are() -> None:
    data = random_data(0, 2, 4, 6)
    best = min(every_solution(data), key=lambda routes: worths(data, routes)[0]["total_time"])
    assert ruin_and_recreate(data, best, stop=MaximumIterations(100)) == best


def test_the_search_ends_when_asked_to() -> None:
    data = random_data(0, 3, 10, 16)
    start = first_come(data)
    assert ruin_and_recreate(data, start, stop=Interruption(lambda: True)) == start


def test_nothing_to_do_needs_no_search() -> None:
    data = random_data(0, 2, 3, 0)
    assert ruin_and_recreate(data, ((), ())) == ((), ())


def test_no_seconds_and_no_steps_change_nothing() -> None:
    data = random_data(0, 3, 10, 16)
    start = first_come(data)
    assert ruin_and_recreate(data, start, stop=MaximumRuntime(0)) == start
    assert ruin_and_recreate(data, start, stop=MaximumIterations(0)) == start


def test_a_start_that_is_not_feasible_is_refused() -> None:
    data = random_data(0, 2, 4, 6)
    with pytest.raises(InputError, match=r"^routes: .* is served 0 times"):
        ruin_and_recreate(data, ((), ()))
    start = first_come(data)
    makespan = worths(data, start)[0]["makespan"]
    with pytest.raises(InputError, match=r"^routes: .* beyond"):
        ruin_and_recreate(limited(data, makespan - 1, np.inf), start)


@pytest.mark.parametrize(
    ("objective", "published"),
    [("total_time", 193.0), ("makespan", 66.0)],
)
def test_the_papers_mission_in_plain_cells_has_the_values_published(
    objective: str, published: float, paper: Instance
) -> None:
    plain = paper.replace(
        scouts=(),
        robots=tuple(robot.model_copy(update={"speed": 1.0}) for robot in paper.robots),
        service_time=dict.fromkeys(paper.capabilities, 0.0),
    )
    data = routing_data(Situation.of(plain))
    start = routes_of(plan(plain, planner="greedy"))
    found = ruin_and_recreate(data, start, objective, stop=MaximumIterations(4000), seed=0)
    assert faults(data, found) == []
    assert value(data, found, objective) == published


def test_an_objective_that_is_not_compiled_is_searched_all_the_same() -> None:
    data = random_data(3, 3, 8, 12)
    own = replace(
        OBJECTIVES["total_time"],
        name="squares",
        is_compiled=False,
        of_times=lambda busy, completion, priority: sum(b * b for b in busy),
    )
    start = first_come(data)
    found = ruin_and_recreate(data, start, own, stop=MaximumIterations(300))
    assert faults(data, found) == []
    assert own.value(data, found) <= own.value(data, start)


def test_better_routes_are_told_while_the_search_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{HEURISTICS}.ruin_and_recreate.TELL_SECONDS", 0.0)
    data = random_data(3, 3, 8, 14)
    told: list[Routes] = []
    start = first_come(data)
    found = ruin_and_recreate(data, start, stop=MaximumIterations(1500), improved=told.append)
    assert not any(faults(data, routes) for routes in told)
    worth = [value(data, routes, "total_time") for routes in told]
    assert worth == sorted(set(worth), reverse=True)
    assert worth[-1] == pytest.approx(value(data, found, "total_time"))
