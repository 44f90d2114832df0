"""Further formulations against every feasible answer, and on cases small enough to do by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from support.amounts import examples
from support.exhaustive import ORACLES
from support.oracles import assert_agrees
from support.small_cases import (
    cluster_cases,
    clustering_cases,
    dense_case,
    joint_cases,
    shares,
    victim_cases,
)

from msmrta_opt.optimise.data import ClusterData, ClusteringData, JointAssignmentData, VictimData
from msmrta_opt.optimise.registry import get
from msmrta_opt.optimise.solve import solve


@given(data=clustering_cases())
@settings(max_examples=examples(60))
def test_the_p_medians_are_the_best_of_all_choices_of_k_cells(data: ClusteringData) -> None:
    assert_agrees("clustering_pmedian", data)


@given(data=cluster_cases(), psi=shares)
@settings(max_examples=examples(40))
def test_the_fair_assignment_has_the_max_min_score(data: ClusterData, psi: float) -> None:
    assert_agrees("cluster_fair", data, psi=psi)


NOBODY = VictimData(
    success=np.zeros((2, 3)),
    failure=np.zeros((2, 3)),
    can_serve=np.zeros((2, 3), dtype=bool),
    busy=np.array([3.0, 5.0]),
    budget=np.full(2, 2),
    endurance=np.array([1.0, np.inf]),
)


@pytest.mark.parametrize("name", [name for name in ORACLES if name.startswith("victim")])
@given(data=victim_cases(), beta=shares)
@example(data=NOBODY, beta=0.5)
@settings(max_examples=examples(60))
def test_eq_2_is_worth_the_best_of_all_solutions(name: str, data: VictimData, beta: float) -> None:
    assert_agrees(name, data, beta=beta)


@given(data=joint_cases(), psi=shares, beta=shares, lam=shares)
@settings(max_examples=examples(40))
def test_posts_and_victims_together_are_worth_the_best_of_all_solutions(
    data: JointAssignmentData, psi: float, beta: float, lam: float
) -> None:
    assert_agrees("joint_assignment", data, psi=psi, beta=beta, lam=lam)


@pytest.mark.parametrize("name", ORACLES)
def test_dense_random_data_is_worth_the_best_of_all_solutions(name: str) -> None:
    spec = get(name).spec
    for seed in range(8):
        middle = {parameter: item.default for parameter, item in spec.parameters.items()}
        assert_agrees(name, dense_case(spec.stage, seed), **middle)


# By hand


def victims(success: list[list[float]], **changes: Any) -> VictimData:
    """Robots that are free now, can serve everybody, and have no limits."""
    times = np.array(success, dtype=float)
    data = VictimData(
        success=times,
        failure=np.zeros_like(times),
        can_serve=np.ones(times.shape, dtype=bool),
        busy=np.zeros(len(times)),
        budget=np.full(len(times), times.shape[1]),
        endurance=np.full(len(times), np.inf),
    )
    return replace(data, **changes)


def test_medians_are_chosen_by_weight_and_walks() -> None:
    """Four cells on a line, two victims on the first of them."""
    place = np.arange(4.0)
    distance = np.abs(place[:, None] - place)
    line = ClusteringData(distance, np.ones((4, 4), bool), np.array([2.0, 1.0, 1.0, 1.0]), 1)
    # From 0: 1 + 2 + 3 = 6; from 1: 2 + 1 + 2 = 5; from 2: 4 + 1 + 1 = 6; from 3: 6 + 2 + 1 = 9.
    solution = solve("clustering_pmedian", line)
    assert solution.objective == pytest.approx(5)
    assert solution.values["median"].tolist() == [0, 1, 0, 0]


def test_parts_of_a_map_need_a_median_each() -> None:
    apart = ClusteringData(np.zeros((2, 2)), np.eye(2, dtype=bool), np.ones(2), 1)
    assert solve("clustering_pmedian", apart).status == "infeasible"
    solution = solve("clustering_pmedian", replace(apart, n_clusters=2))
    assert solution.objective == pytest.approx(0)
    assert solution.values["y"].tolist() == [[1, 0], [0, 1]]


def test_fairness_gives_up_total_score_for_the_least() -> None:
    """9 + 1 is the larger sum, 4 + 5 has the larger least."""
    scores = np.array([[9.0, 4.0], [5.0, 1.0]])
    data = ClusterData(scores, np.zeros((2, 2)), np.ones(2, dtype=np.int64))
    assert solve("cluster_one_to_one", data, psi=0).objective == pytest.approx(10)
    assert solve("cluster_fair", data, psi=0).objective == pytest.approx(4)


def test_the_bottleneck_gives_up_total_time_for_the_slowest_pair() -> None:
    """1 + 9 is the least sum, 6 and 5 the least slowest."""
    data = victims([[1, 6], [5, 9]])
    assert solve("victim_one_to_one", data, beta=0).objective == pytest.approx(10)
    assert solve("victim_bottleneck", data, beta=0).objective == pytest.approx(6)


def test_a_quick_pair_is_no_reason_to_leave_a_victim_alone() -> None:
    """Only robot 0 can serve victim 1: both are served, though 0 alone would be done at 1."""
    can_serve = np.array([[True, True], [True, False]])
    data = victims([[1, 8], [3, 0]], can_serve=can_serve)
    assert solve("victim_bottleneck", data, beta=0).objective == pytest.approx(8)


def test_budgets_decide_how_many_victims_are_covered() -> None:
    """Three victims cost 1, 2 and 3 with robot 0, and 10 each with robot 1."""
    data = victims([[1, 2, 3], [10, 10, 10]])
    for budget, n_covered, cost in (
        ([3, 3], 3, 6),
        ([2, 3], 3, 1 + 2 + 10),
        ([2, 0], 2, 1 + 2),
        ([1, 1], 2, 1 + 10),
        ([0, 0], 0, 0),
    ):
        limited = replace(data, budget=np.array(budget))
        assert limited.budgeted_size == n_covered
        assert solve("victim_budgeted", limited, beta=0).objective == pytest.approx(cost)


def test_a_budget_is_of_no_use_for_victims_that_a_robot_cannot_serve() -> None:
    data = victims([[1, 1, 1], [1, 1, 1]], budget=np.array([3, 1]))
    can_serve = np.array([[True, False, False], [True, True, True]])
    assert replace(data, can_serve=can_serve).budgeted_size == 2


def test_a_budget_of_one_each_is_the_one_to_one_assignment() -> None:
    for seed in range(5):
        data = replace(dense_case("victim", seed), budget=np.ones(3, dtype=np.int64))
        assert data.budgeted_size == data.matching_size
        one_to_one = solve("victim_one_to_one", data).objective
        assert solve("victim_budgeted", data).objective == pytest.approx(one_to_one)


def test_endurance_sends_a_victim_to_a_slower_robot() -> None:
    """Robot 0 is busy until 10 and takes 2 and 3 more; up to 12 it has time for one of them."""
    busy = np.array([10.0, 0.0])
    data = victims([[12, 13], [15, 15]], busy=busy)
    for endurance, cost in (
        (15.0, 12 + 13),
        (14.9, 15 + 12),
        (12.0, 12 + 15),
        (10.0, 30),
        (4.0, 30),
    ):
        limited = replace(data, endurance=np.array([endurance, np.inf]))
        assert solve("victim_generalized", limited, beta=0).objective == pytest.approx(cost)


def test_without_endurance_enough_for_everybody_there_is_no_solution() -> None:
    data = victims([[4, 4], [4, 4]], endurance=np.array([4.0, 3.9]))
    assert solve("victim_generalized", data).status == "infeasible"


def test_without_limits_of_endurance_each_victim_chooses_by_itself() -> None:
    for seed in range(5):
        data = replace(dense_case("victim", seed), endurance=np.full(3, np.inf))
        covering = solve("victim_covering", data).objective
        assert solve("victim_generalized", data).objective == pytest.approx(covering)


def test_capacities_and_costs_of_the_generalised_assignment_are_endurance_and_failure_times() -> (
    None
):
    """Two agents, three items of weight 2: agent 0 has room for two of them, agent 1 for one."""
    costs = np.array([[1.0, 2.0, 3.0], [3.0, 1.0, 2.0]])
    data = victims([[2, 2, 2], [2, 2, 2]], failure=costs, endurance=np.array([4.0, 2.0]))
    # Agent 1 takes item 0: 3 + 2 + 3 = 8; item 1: 1 + 1 + 3 = 5; item 2: 1 + 2 + 2 = 5.
    assert solve("victim_generalized", data, beta=1).objective == pytest.approx(5)
    maximum = solve("victim_generalized", replace(data, failure=-costs), beta=1)
    assert maximum.objective == pytest.approx(-8)


FORK = JointAssignmentData(
    # One robot; its post is the far cluster 0, worth 2, or the near cluster 1, worth 1. Of the one
    # victim it leaves something in either case, and serves that for 3 more.
    w=np.array([[2.0, 1.0]]),
    w_full=np.zeros((1, 2)),
    cluster=np.array([0]),
    arrival=np.array([[[97.0], [7.0], [1.0]]]),
    record=np.zeros((1, 3)),
    service=np.full((1, 2, 1), 3.0),
    redo=np.zeros((1, 2, 1)),
    can_serve=np.ones((1, 2, 1), dtype=bool),
)


@pytest.mark.parametrize(
    ("lam", "time", "score"),
    [
        (0, 100, 2),  # Eq. 1 alone takes the far post
        (0.01, 100, 2),  # 1 − 1.98 = −0.98, against 0.1 − 0.99 = −0.89
        (0.5, 10, 1),  # 5 − 0.5, against 50 − 1
        (1, 10, 1),
    ],
)
def test_the_post_is_given_up_where_the_way_from_it_is_too_long(
    lam: float, time: float, score: float
) -> None:
    solution = solve("joint_assignment", FORK, psi=0, beta=0, lam=lam)
    assert solution.objective == pytest.approx(lam * time - (1 - lam) * score)
    assert solution.values["time"] == pytest.approx(time)
    assert solution.values["score"] == pytest.approx(score)


def test_a_robot_without_a_post_goes_from_its_start() -> None:
    """Robot 1 has no post: its way is 5, shorter than robot 0's from the only one, 9."""
    data = JointAssignmentData(
        w=np.array([[3.0], [1.0]]),
        w_full=np.zeros((2, 1)),
        cluster=np.array([0]),
        arrival=np.array([[[9.0], [2.0]], [[8.0], [5.0]]]),
        record=np.zeros((2, 2)),
        service=np.ones((2, 3, 1)),
        redo=np.zeros((2, 3, 1)),
        can_serve=np.ones((2, 3, 1), dtype=bool),
    )
    # Post to robot 0: −3 + min(9, 5) + 1; post to robot 1: −1 + min(8, 2) + 1; halved.
    solution = solve("joint_assignment", data, psi=0, beta=0, lam=0.5)
    assert solution.objective == pytest.approx((2 + 1 - 1) / 2)
    assert solution.values["x"].tolist() == [[0], [1]]
    assert solution.values["y"].tolist() == [[1], [0]]


def test_nobody_is_sent_to_a_victim_whose_holder_leaves_nothing() -> None:
    leaves_nothing = np.array([[[False], [True]]])
    data = replace(FORK, can_serve=leaves_nothing)
    # Taking the far post serves the victim on the way: no time, score 2.
    solution = solve("joint_assignment", data, psi=0, beta=0, lam=0.5)
    assert solution.objective == pytest.approx(-1)
    assert not solution.values["y"].any()


@pytest.mark.parametrize(
    ("name", "n_variables", "n_rows"),
    [
        ("clustering_pmedian", 4 * 4 + 4, 4 * 4 + 4 + 1),
        # N = 3 robots, K = 4 clusters, M = 4 victims, each of them coverable.
        ("cluster_fair", 13, 3 + 4 + 3 + 1),
        ("victim_bottleneck", 13, 2 * 3 + 4 + 1),
        ("victim_budgeted", 12, 3 + 4 + 1),
        ("victim_generalized", 12, 3 + 4),
        # N = K = 3, M = 4.
        ("joint_assignment", 9 + 12 * 9 + 2, 12 * 7 + 4 * 4 + 3 + 3 + 3),
    ],
)
def test_a_program_has_the_size_that_its_docstring_states(
    name: str, n_variables: int, n_rows: int
) -> None:
    solution = solve(name, dense_case(get(name).spec.stage, 0))
    assert (solution.n_variables, solution.n_rows) == (n_variables, n_rows)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"distance": np.zeros((2, 3)), "can_reach": np.ones((2, 3), bool)},
            r"distance has shape \(2, 3\); give \(2, 2\)",
        ),
        ({"weight": np.ones(3)}, "weight has shape"),
        ({"distance": np.full((2, 2), np.inf)}, "not finite"),
    ],
)
def test_clustering_data_of_the_wrong_shape_is_refused(changes: dict[str, Any], said: str) -> None:
    data = ClusteringData(np.zeros((2, 2)), np.ones((2, 2), dtype=bool), np.ones(2), 1)
    with pytest.raises(ValueError, match=said):
        replace(data, **changes)


def test_joint_data_of_the_wrong_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="arrival has shape"):
        replace(FORK, arrival=np.zeros((1, 2, 1)))
