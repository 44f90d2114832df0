"""Rows that leave out solutions no better than others leave a best one, against brute force."""

from __future__ import annotations

import numpy as np
import pytest
from support.joint_cases import any_routes, on_a_line
from support.joint_oracle import minimum
from support.searches import closed_in

from msmrta_opt.routing.branch_and_cut import tree
from msmrta_opt.routing.branch_and_cut.edge_formulation import EdgeFormulation, Row
from msmrta_opt.routing.branch_and_cut.points import point_of
from msmrta_opt.routing.branch_and_cut.symmetry import in_order, own_visits
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.problem import RoutingData, faults


def equal_robots(
    seed: int, *, kinds: int, returns: bool, detours: bool, n_robots: int = 3, n_victims: int = 5
) -> RoutingData:
    """Equal robots, and lengths on a grid or drawn freely, so that detours can be shorter."""
    random = np.random.RandomState(seed)
    n = n_victims + 1
    at = random.randint(0, 9, size=(n, 2))
    length = np.abs(at[:, None] - at[None]).sum(axis=2).astype(float)
    if detours:
        length = np.triu(random.randint(1, 30, size=(n, n)), 1).astype(float)
        length += length.T
    leave = np.tile(length[0, 1:], (n_robots, 1))
    return RoutingData(
        leave=leave,
        length=np.tile(length[1:, 1:], (n_robots, 1, 1)),
        back=leave if returns else np.zeros_like(leave),
        service=random.randint(0, 6, size=(n_victims, kinds)).astype(float),
        able=np.tile(random.random_sample((n_victims, kinds)) < 0.8, (n_robots, 1, 1)),
        priority=np.ones(n_victims),
        endurance=np.full(n_robots, np.inf),
        longest_walk=np.full(n_robots, np.inf),
    )


CASES = [
    (seed, kinds, returns, detours)
    for seed in range(3)
    for kinds in (1, 2)
    for returns in (False, True)
    for detours in (False, True)
]


@pytest.mark.parametrize("has_scip", [True, False], ids=["SCIP", "HiGHS"])
@pytest.mark.parametrize(("seed", "kinds", "returns", "detours"), CASES)
def test_the_longest_walk_of_equal_robots_is_proven_even_where_detours_are_shorter(
    seed: int,
    kinds: int,
    returns: bool,
    detours: bool,
    has_scip: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(tree, "has_scip", lambda: has_scip)
    data = equal_robots(seed, kinds=kinds, returns=returns, detours=detours)
    routes, bound = closed_in(data, "makespan", any_routes(data))
    assert faults(data, routes) == []
    assert value(data, routes, "makespan") == pytest.approx(minimum(data, "makespan"))
    assert bound.value == pytest.approx(minimum(data, "makespan"))


@pytest.mark.parametrize(("seed", "kinds", "returns", "detours"), CASES)
def test_the_total_time_of_equal_robots_is_bounded_and_met_where_one_kind_is_needed(
    seed: int, kinds: int, returns: bool, detours: bool
) -> None:
    data = equal_robots(seed, kinds=kinds, returns=returns, detours=detours)
    routes, bound = closed_in(data, "total_time", any_routes(data))
    optimum = minimum(data, "total_time")
    assert bound.value <= optimum + 1e-6
    assert value(data, routes, "total_time") >= optimum - 1e-6
    if kinds == 1 or not detours:
        assert bound.value == pytest.approx(optimum)


def kept(rows: list[Row], x: np.ndarray) -> bool:
    return all(weight @ x[column] <= maximum + 1e-9 for column, weight, maximum in rows)


def line(objective: str = "makespan") -> EdgeFormulation:
    """Two equal robots at 0 that return, victims at 1, 2 and 4, one kind."""
    data = on_a_line([0, 0], [1, 2, 4], [[[True]] * 3] * 2, returns=True)
    return EdgeFormulation.of(data, objective, 100.0)


def test_of_two_equal_robots_the_first_takes_the_farthest_victim() -> None:
    formulation = line()
    first = point_of(formulation, (((2, (0,)),), ((0, (0,)), (1, (0,)))))
    second = point_of(formulation, (((0, (0,)), (1, (0,))), ((2, (0,)),)))
    rows = in_order(formulation)
    assert not kept(rows, second)
    assert kept(rows, first) or kept(
        rows, point_of(formulation, (((2, (0,)),), ((1, (0,)), (0, (0,)))))
    )


def test_of_two_directions_the_one_that_begins_farther_away_is_kept() -> None:
    formulation = line()
    there = point_of(formulation, (((0, (0,)), (1, (0,)), (2, (0,))), ()))
    back = point_of(formulation, (((2, (0,)), (1, (0,)), (0, (0,))), ()))
    assert kept(in_order(formulation), there) is False
    assert kept(in_order(formulation), back) is True


@pytest.mark.parametrize("objective", ["total_time", "makespan"])
def test_walking_needs_no_rows_against_visits_for_nothing(objective: str) -> None:
    assert own_visits(line(objective)) == []


def test_robots_that_differ_and_stay_are_not_put_in_order() -> None:
    data = on_a_line([0, 5], [1, 2, 4], [[[True]] * 3] * 2)
    assert in_order(EdgeFormulation.of(data, "makespan", 100.0)) == []
