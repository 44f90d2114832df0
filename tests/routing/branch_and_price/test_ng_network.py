"""Networks of paths: against every order of visits, tried one by one."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations, product

import numpy as np
import pytest
from support.joint_cases import small_mission

from msmrta_opt.routing.branch_and_price.duals import Prices, portions
from msmrta_opt.routing.branch_and_price.enumeration import all_paths
from msmrta_opt.routing.branch_and_price.ng_network import Network, Stops
from msmrta_opt.routing.branch_and_price.tasks import Needs
from msmrta_opt.routing.problem import RoutingData

SEEDS = range(6)
LIMIT = 100_000


def made(seed: int) -> tuple[RoutingData, Needs, Network]:
    """The network of the robot that can visit most, remembering everything."""
    data = small_mission(seed, 3, 5, map_number=(0, 2, 3)[seed % 3])
    needs = Needs.from_data(data)
    robot = int(data.can_visit.sum(axis=1).argmax())
    network = Network(data, needs, robot, np.full(data.n_victims, np.inf))
    network.remember(np.ones((network.m, network.m), dtype=bool))
    return data, needs, network


def priced(seed: int, needs: Needs, network: Network) -> tuple[np.ndarray, Prices]:
    """Rewards and steps of charges at random."""
    random = np.random.RandomState(seed)
    breaks = tuple(np.array([0.0, 20.0 + 30.0 * random.rand()]) for _ in needs.of)
    prices = Prices(
        150.0 * random.rand(len(needs)),
        tuple(random.rand(2) for _ in needs.victim),
        breaks,
        needs.victim,
    )
    cost = np.full(network.open.shape, np.inf)
    for i, options in enumerate(network.options):
        for j, own in enumerate(options):
            cost[i, j] = sum(prices.charge(g, network.times) for g in own)
    return cost, prices


def every_route(data: RoutingData, needs: Needs, network: Network) -> Iterator[Stops]:
    """All routes of a robot, every victim and option."""
    r = network.robot
    for n in range(1, network.m + 1):
        for order in permutations(range(network.m), n):
            for chosen in product(*(network.options[i] for i in order)):
                clock, stops, before = 0.0, [], -1
                for i, own in zip(order, chosen, strict=True):
                    v = int(network.victims[i])
                    clock += data.leave[r, v] if before < 0 else data.between[r, before, v]
                    clock += sum(needs.service[g] for g in own)
                    stops.append((v, own, float(clock)))
                    before = v
                yield tuple(stops)


def worth(prices: Prices, stops: Stops) -> float:
    return float(sum(prices.charge(g, np.array(t)) for _, own, t in stops for g in own))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_cheapest_path_is_the_cheapest_route(seed: int) -> None:
    data, needs, network = made(seed)
    cost, prices = priced(seed, needs, network)
    there = network.forward(cost)
    expected = min(worth(prices, stops) for stops in every_route(data, needs, network))
    assert there.least() == pytest.approx(expected)
    cheapest = min(there.paths(np.inf), key=lambda stops: worth(prices, stops))
    assert worth(prices, cheapest) == pytest.approx(expected)
    assert network.allows(cheapest)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_to_go_from_the_start_is_the_cheapest_path(seed: int) -> None:
    _, needs, network = made(seed)
    cost, _ = priced(seed, needs, network)
    after, _ = network.to_go(cost)
    assert after[-1, 0] == pytest.approx(min(network.forward(cost).least(), 0.0))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("size", [1, 2, 3])
def test_forgetting_makes_paths_no_dearer(seed: int, size: int) -> None:
    _, needs, network = made(seed)
    cost, _ = priced(seed, needs, network)
    exact = network.forward(cost).least()
    network.remember(network.nearest(size))
    assert network.forward(cost).least() <= exact + 1e-9


@pytest.mark.parametrize("seed", SEEDS)
def test_no_route_that_is_cheap_enough_is_ruled_out(seed: int) -> None:
    data, needs, network = made(seed)
    cost, prices = priced(seed, needs, network)
    routes = [(worth(prices, stops), stops) for stops in every_route(data, needs, network)]
    most = sorted(cost for cost, _ in routes)[len(routes) // 20]
    network.fix(cost, most + 1e-6)
    assert all(network.allows(stops) for cost, stops in routes if cost <= most)
    assert not all(network.allows(stops) for _, stops in routes)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_list_has_for_every_cheap_route_one_that_is_no_later(seed: int) -> None:
    data, needs, network = made(seed)
    cost, prices = priced(seed, needs, network)
    routes = [(worth(prices, stops), stops) for stops in every_route(data, needs, network)]
    most = sorted(cost for cost, _ in routes)[len(routes) // 10]
    listed = all_paths(data, needs, network, cost, most + 1e-6, LIMIT)
    assert listed is not None
    real = {frozenset(stops) for _, stops in routes}
    for _, stops in listed:
        assert worth(prices, stops) <= most + 1e-6
        assert min(
            max(abs(t - u) for (_, _, t), (_, _, u) in zip(sorted(stops), sorted(one), strict=True))
            for one in real
            if {(v, own) for v, own, _ in one} == {(v, own) for v, own, _ in stops}
        ) == pytest.approx(0.0, abs=1e-6)
    done = [{(v, own): t for v, own, t in stops} for _, stops in listed]
    for cost_of_it, stops in routes:
        if cost_of_it <= most:
            mine = {(v, own): t for v, own, t in stops}
            assert any(
                one.keys() == mine.keys() and all(one[key] <= mine[key] + 1e-6 for key in one)
                for one in done
            )


def test_a_list_that_grows_too_long_is_given_up() -> None:
    data, needs, network = made(0)
    cost, _ = priced(0, needs, network)
    assert all_paths(data, needs, network, cost, np.inf, 3) is None


def test_needs_that_one_robot_alone_can_serve_are_one() -> None:
    """Kinds 0 and 1 only by robot 0, kind 2 by both: two needs, and three options for robot 0."""
    able = [[[True, True, True]], [[False, False, True]]]
    from support.joint_cases import on_a_line

    data = on_a_line([0.0, 5.0], [1.0], able, service=2.0)
    needs = Needs.from_data(data)
    assert needs.kinds == ((0, 1), (2,))
    assert needs.service == (4.0, 2.0)
    network = Network(data, needs, 0, np.array([np.inf]))
    assert sorted(network.options[0]) == [(0,), (0, 1), (1,)]


def test_charges_of_needs_never_exceed_that_of_the_last() -> None:
    """Densities that add up to the priority at every time, whatever they are."""
    random = np.random.RandomState(3)
    breaks, priority = np.array([0.0, 3.0, 7.5]), 2.0
    first = priority * random.rand(3)
    prices = Prices(np.zeros(2), (first, priority - first), (breaks,), (0, 0))
    for a, b in 12.0 * random.rand(200, 2):
        charged = prices.charge(0, np.array(a)) + prices.charge(1, np.array(b))
        assert charged <= priority * max(a, b) + 1e-9
    together = prices.charge(0, np.array(9.0)) + prices.charge(1, np.array(9.0))
    assert together == pytest.approx(priority * 9.0)


def test_portions_of_time_add_up_to_it() -> None:
    parts = portions(np.array([0.0, 3.0, 7.5]), np.array([0.0, 2.0, 5.0, 20.0]))
    assert parts.tolist() == [[0, 0, 0], [2, 0, 0], [3, 2, 0], [3, 4.5, 12.5]]
