"""Robot subsets are joint problems of their own, and improving them improves the whole."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from support.amounts import sample
from support.joint_oracle import minimum
from support.joint_random import first_come, limited, random_data
from support.searches import Told, closed_in

from msmrta_opt.routing.heuristics.robot_subsets import (
    Solve,
    improve_robot_subsets,
    put_back,
    subset_of,
)
from msmrta_opt.routing.heuristics.ruin_and_recreate import ruin_and_recreate
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.parameters import HeuristicsParameters
from msmrta_opt.routing.problem import Routes, RoutingData, faults, times
from msmrta_opt.routing.stop import (
    Interruption,
    MaximumIterations,
    MaximumRuntime,
    StoppingCriterion,
)

BOTH: tuple[str, ...] = ("total_time", "makespan")
LONG = MaximumRuntime(3600)


def searched(objective: str) -> Solve:
    return lambda subset, routes, stop: ruin_and_recreate(
        subset, routes, objective, stop=MaximumIterations(60)
    )


def proven(objective: str) -> Solve:
    return lambda subset, routes, stop: closed_in(subset, objective, routes)[0]


def alike(n: int) -> np.ndarray:
    return np.ones((n, n))


@pytest.mark.parametrize("seed", sample(range(5), 3))
def test_a_subset_is_what_its_robots_serve_together(seed: int) -> None:
    data = limited(random_data(seed, 5, 8, 14, back=True), 500.0, 300.0)
    routes = first_come(data)
    robots = [0, 2, 3]
    subset, own, victims = subset_of(data, routes, robots)
    assert faults(subset, own) == []
    assert [data.required[v].any() for v in victims] == [True] * len(victims)
    busy = times(data, routes).busy[robots]
    assert times(subset, own).busy.tolist() == pytest.approx(busy.tolist())
    served = {(v, k) for r in robots for v, kinds in routes[r] for k in kinds}
    assert {(victims[v], int(k)) for v, k in np.argwhere(subset.required)} == served
    assert (subset.able == data.able[np.ix_(robots, victims)] & subset.required).all()
    assert subset.endurance.tolist() == [500.0] * 3
    assert subset.longest_walk.tolist() == [300.0] * 3
    assert put_back(routes, robots, own, victims) == routes


@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", sample(range(4), 2))
def test_routes_get_no_worse_and_stay_feasible(seed: int, objective: str) -> None:
    data = random_data(seed, 7, 12, 20)
    routes = first_come(data)
    progress = Progress(data, objective, routes)
    improve_robot_subsets(progress, alike(7), searched(objective), stop=LONG, seed=seed)
    assert faults(data, progress.routes) == []
    assert progress.value <= value(data, routes, objective)


def test_bad_routes_get_better_step_by_step() -> None:
    data = random_data(1, 7, 12, 20)
    told: list[float] = []
    progress = Progress(
        data,
        "total_time",
        first_come(data),
        callbacks=Told(lambda state, _: told.append(state.value)),
    )
    values = [progress.value]
    improve_robot_subsets(progress, alike(7), proven("total_time"), stop=LONG)
    values += told
    assert len(values) > 1
    assert values == sorted(values, reverse=True)
    assert told[-1] == value(data, progress.routes, "total_time")


@pytest.mark.parametrize("seed", sample(range(4), 2))
def test_in_the_end_every_subset_is_best(seed: int) -> None:
    """Of three robots: all pairs, since so many failures leave none out."""
    data = random_data(seed, 3, 5, 9)
    progress = Progress(data, "total_time", first_come(data))
    pairs = HeuristicsParameters(smallest_subset=2, subset_failures=30)
    improve_robot_subsets(
        progress, alike(3), proven("total_time"), stop=LONG, seed=seed, parameters=pairs
    )
    for robots in combinations(range(3), 2):
        subset, own, _ = subset_of(data, progress.routes, list(robots))
        assert value(subset, own, "total_time") == pytest.approx(minimum(subset, "total_time"))


def test_subsets_grow_where_several_bring_nothing_and_none_comes_twice() -> None:
    data = random_data(3, 6, 10, 16)
    drawn: list[tuple[int, bytes]] = []

    def solve(subset: RoutingData, routes: Routes, stop: StoppingCriterion) -> Routes:
        drawn.append((subset.n_robots, subset.leave.tobytes()))
        return routes

    progress = Progress(data, "total_time", first_come(data))
    improve_robot_subsets(progress, alike(6), solve, stop=LONG)
    sizes = [size for size, _ in drawn]
    assert sizes == sorted(sizes)
    assert set(sizes) == {3, 4, 5}
    assert sizes.count(3) <= HeuristicsParameters().subset_failures
    assert len(drawn) == len(set(drawn))


def test_robots_that_have_much_to_share_are_drawn_together() -> None:
    data = random_data(4, 12, 12, 20)
    shared = np.zeros((12, 12))
    shared[:3, :3] = 1.0
    np.fill_diagonal(shared, 0.0)
    first: list[RoutingData] = []

    def solve(subset: RoutingData, routes: Routes, stop: StoppingCriterion) -> Routes:
        first.append(subset)
        return routes

    progress = Progress(data, "total_time", first_come(data))
    improve_robot_subsets(progress, shared, solve, stop=Interruption(lambda: bool(first)))
    expected, _, _ = subset_of(data, first_come(data), [0, 1, 2])
    assert np.array_equal(first[0].leave, expected.leave)


def test_the_busiest_robot_is_always_in_a_subset_for_the_makespan() -> None:
    data = random_data(5, 7, 12, 20)
    routes = first_come(data)
    busiest = times(data, routes).busy.max()
    seen: list[float] = []

    def solve(subset: RoutingData, own: Routes, stop: StoppingCriterion) -> Routes:
        seen.append(times(subset, own).busy.max())
        return own

    improve_robot_subsets(Progress(data, "makespan", routes), alike(7), solve, stop=LONG)
    assert set(seen) == {busiest}


def test_it_ends_when_asked_to_and_gives_every_subset_a_share_of_its_time() -> None:
    data = random_data(6, 8, 12, 20)
    progress = Progress(data, "total_time", first_come(data))
    improve_robot_subsets(
        progress, alike(8), searched("total_time"), stop=Interruption(lambda: True)
    )
    assert progress.routes == first_come(data)
    given: list[float] = []

    def solve(subset: RoutingData, own: Routes, stop: StoppingCriterion) -> Routes:
        given.append(stop.seconds_left())
        return own

    improve_robot_subsets(progress, alike(8), solve, stop=MaximumRuntime(20))
    assert 0 < max(given) <= 0.25 * 20


def test_few_robots_have_no_subsets() -> None:
    data = random_data(7, 3, 6, 9)
    progress = Progress(data, "total_time", first_come(data))
    improve_robot_subsets(progress, alike(3), proven("total_time"), stop=LONG)
    assert progress.routes == first_come(data)
