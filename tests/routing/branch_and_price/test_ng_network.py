"""Networks of paths: against every order of visits, tried one by one."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations, product

import numpy as np
import pytest
from support.joint_cases import small_mission

from msmrta_opt.routing.branch_and_price.duals import Duals, time_in_intervals
from msmrta_opt.routing.branch_and_price.enumeration import enumerate_routes
from msmrta_opt.routing.branch_and_price.ng_network import Network, Stops
from msmrta_opt.routing.branch_and_price.pricing import CheapestPaths, costs_to_go, reduced_costs
from msmrta_opt.routing.branch_and_price.reduced_cost_fixing import fix
from msmrta_opt.routing.branch_and_price.tasks import Tasks
from msmrta_opt.routing.parameters import BranchAndPriceParameters
from msmrta_opt.routing.problem import RoutingData

SEEDS = range(6)
DEFAULT = BranchAndPriceParameters(maximum_labels=100_000)


def made(seed: int) -> tuple[RoutingData, Tasks, Network]:
    """The network of the robot that can visit most, remembering everything."""
    data = small_mission(seed, 3, 5, map_number=(0, 2, 3)[seed % 3])
    tasks = Tasks.from_data(data)
    robot = int(data.can_visit.sum(axis=1).argmax())
    network = Network(data, tasks, robot, np.full(data.n_victims, np.inf), 4000)
    network.remember(np.ones((network.m, network.m), dtype=bool))
    return data, tasks, network


def priced(seed: int, tasks: Tasks, network: Network) -> tuple[np.ndarray, Duals]:
    """Dual values and densities at random."""
    random = np.random.RandomState(seed)
    breaks = tuple(np.array([0.0, 20.0 + 30.0 * random.rand()]) for _ in tasks.of)
    duals = Duals(
        150.0 * random.rand(len(tasks)),
        tuple(random.rand(2) for _ in tasks.victim),
        breaks,
        tasks.victim,
    )
    return reduced_costs(network, duals), duals


def every_route(data: RoutingData, tasks: Tasks, network: Network) -> Iterator[Stops]:
    """All routes of a robot, every victim and option."""
    r = network.robot
    for n in range(1, network.m + 1):
        for order in permutations(range(network.m), n):
            for chosen in product(*(network.options[i] for i in order)):
                clock, stops, before = 0.0, [], -1
                for i, own in zip(order, chosen, strict=True):
                    v = int(network.victims[i])
                    clock += data.leave[r, v] if before < 0 else data.between[r, before, v]
                    clock += sum(tasks.service[g] for g in own)
                    stops.append((v, own, float(clock)))
                    before = v
                yield tuple(stops)


def worth(duals: Duals, stops: Stops) -> float:
    return float(sum(duals.reduced_cost(g, np.array(t)) for _, own, t in stops for g in own))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_cheapest_path_is_the_cheapest_route(seed: int) -> None:
    data, tasks, network = made(seed)
    cost, duals = priced(seed, tasks, network)
    there = CheapestPaths(network, cost)
    expected = min(worth(duals, stops) for stops in every_route(data, tasks, network))
    assert there.minimum() == pytest.approx(expected)
    cheapest = min(there.paths(np.inf, 10), key=lambda stops: worth(duals, stops))
    assert worth(duals, cheapest) == pytest.approx(expected)
    assert network.allows(cheapest)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_to_go_from_the_start_is_the_cheapest_path(seed: int) -> None:
    _, tasks, network = made(seed)
    cost, _ = priced(seed, tasks, network)
    after, _ = costs_to_go(network, cost)
    assert after[-1, 0] == pytest.approx(min(CheapestPaths(network, cost).minimum(), 0.0))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("size", [1, 2, 3])
def test_forgetting_makes_paths_cost_no_more(seed: int, size: int) -> None:
    _, tasks, network = made(seed)
    cost, _ = priced(seed, tasks, network)
    exact = CheapestPaths(network, cost).minimum()
    network.remember(network.nearest(size))
    assert CheapestPaths(network, cost).minimum() <= exact + 1e-9


@pytest.mark.parametrize("seed", SEEDS)
def test_no_route_that_is_cheap_enough_is_ruled_out(seed: int) -> None:
    data, tasks, network = made(seed)
    cost, duals = priced(seed, tasks, network)
    routes = [(worth(duals, stops), stops) for stops in every_route(data, tasks, network)]
    maximum = sorted(cost for cost, _ in routes)[len(routes) // 20]
    fix(network, cost, maximum + 1e-6)
    assert all(network.allows(stops) for cost, stops in routes if cost <= maximum)
    assert not all(network.allows(stops) for _, stops in routes)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_list_has_for_every_cheap_route_one_that_is_no_later(seed: int) -> None:
    data, tasks, network = made(seed)
    cost, duals = priced(seed, tasks, network)
    routes = [(worth(duals, stops), stops) for stops in every_route(data, tasks, network)]
    maximum = sorted(cost for cost, _ in routes)[len(routes) // 10]
    listed = enumerate_routes(data, tasks, network, cost, maximum + 1e-6, DEFAULT)
    assert listed is not None
    real = {frozenset(stops) for _, stops in routes}
    for _, stops in listed:
        assert worth(duals, stops) <= maximum + 1e-6
        assert min(
            max(abs(t - u) for (_, _, t), (_, _, u) in zip(sorted(stops), sorted(one), strict=True))
            for one in real
            if {(v, own) for v, own, _ in one} == {(v, own) for v, own, _ in stops}
        ) == pytest.approx(0.0, abs=1e-6)
    done = [{(v, own): t for v, own, t in stops} for _, stops in listed]
    for cost_of_it, stops in routes:
        if cost_of_it <= maximum:
            mine = {(v, own): t for v, own, t in stops}
            assert any(
                one.keys() == mine.keys() and all(one[key] <= mine[key] + 1e-6 for key in one)
                for one in done
            )


def test_a_list_that_grows_too_long_is_given_up() -> None:
    data, tasks, network = made(0)
    cost, _ = priced(0, tasks, network)
    few = BranchAndPriceParameters(maximum_labels=3)
    assert enumerate_routes(data, tasks, network, cost, np.inf, few) is None


def test_tasks_that_one_robot_alone_can_serve_are_one() -> None:
    """Kinds 0 and 1 only by robot 0, kind 2 by both: two tasks, and three options for robot 0."""
    able = [[[True, True, True]], [[False, False, True]]]
    from support.joint_cases import on_a_line

    data = on_a_line([0.0, 5.0], [1.0], able, service=2.0)
    tasks = Tasks.from_data(data)
    assert tasks.kinds == ((0, 1), (2,))
    assert tasks.service == (4.0, 2.0)
    network = Network(data, tasks, 0, np.array([np.inf]), 4000)
    assert sorted(network.options[0]) == [(0,), (0, 1), (1,)]


def test_densities_of_tasks_never_cost_more_than_the_last() -> None:
    """Densities that add up to the priority at every time, whatever they are."""
    random = np.random.RandomState(3)
    breaks, priority = np.array([0.0, 3.0, 7.5]), 2.0
    first = priority * random.rand(3)
    duals = Duals(np.zeros(2), (first, priority - first), (breaks,), (0, 0))
    for a, b in 12.0 * random.rand(200, 2):
        charged = duals.reduced_cost(0, np.array(a)) + duals.reduced_cost(1, np.array(b))
        assert charged <= priority * max(a, b) + 1e-9
    together = duals.reduced_cost(0, np.array(9.0)) + duals.reduced_cost(1, np.array(9.0))
    assert together == pytest.approx(priority * 9.0)


def test_intervals_of_time_add_up_to_it() -> None:
    parts = time_in_intervals(np.array([0.0, 3.0, 7.5]), np.array([0.0, 2.0, 5.0, 20.0]))
    assert parts.tolist() == [[0, 0, 0], [2, 0, 0], [3, 2, 0], [3, 4.5, 12.5]]


def test_without_time_states_are_neither_built_nor_priced() -> None:
    data, tasks, network = made(0)
    cost, _ = priced(0, tasks, network)
    network.left = lambda: 0.0
    with pytest.raises(TimeoutError):
        network.rebuild()
    with pytest.raises(TimeoutError):
        CheapestPaths(network, cost)
    with pytest.raises(TimeoutError):
        costs_to_go(network, cost)
    with pytest.raises(TimeoutError):
        Network(data, tasks, network.robot, np.full(data.n_victims, np.inf), 4000, lambda: 0.0)
