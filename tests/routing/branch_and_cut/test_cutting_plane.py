"""The relaxation: as good as the linear program written out, and never too good to be true."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import linprog
from support.amounts import sample
from support.joint_cases import any_routes, on_a_line, small_mission
from support.joint_oracle import minimum
from support.searches import exactly

from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.check import dual_bound
from msmrta_opt.optimise.program import Program
from msmrta_opt.routing.branch_and_cut.cutting_plane import Relaxation
from msmrta_opt.routing.branch_and_cut.edge_formulation import EdgeFormulation
from msmrta_opt.routing.branch_and_cut.separation import Cut
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.problem import RoutingData
from msmrta_opt.routing.stop import Interruption, MaximumRuntime

OBJECTIVES = ("total_time", "makespan")


def all_cuts(data: RoutingData) -> list[Cut]:
    """Every subtour and path cut of every robot."""
    cuts = []
    for r in range(data.n_robots):
        own = np.flatnonzero(data.can_visit[r]).tolist()
        for size in range(1, len(own) + 1):
            for members in combinations(own, size):
                cuts += [Cut(r, members, first=True), Cut(r, members, last=True)]
                cuts += [Cut(r, members, vertex=v) for v in members]
    return cuts


def by_linprog(program: Program) -> float:
    """The linear program's value by SciPy, without anything of ours but the arrays."""
    equal = program.row_lower == program.row_upper
    above = np.isfinite(program.row_upper) & ~equal
    below = np.isfinite(program.row_lower) & ~equal
    matrix = program.matrix.toarray()
    answer = linprog(
        program.cost,
        A_ub=np.vstack([matrix[above], -matrix[below]]),
        b_ub=np.concatenate([program.row_upper[above], -program.row_lower[below]]),
        A_eq=matrix[equal],
        b_eq=program.row_upper[equal],
        bounds=np.column_stack([program.lower, program.upper]),
    )
    assert answer.status == 0, answer.message
    return float(answer.fun) + program.offset


def formulation_of(data: RoutingData, objective: str) -> EdgeFormulation:
    maximum = value(data, any_routes(data), objective)
    return EdgeFormulation.of(data, objective, maximum)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("seed", sample(range(4), 2))
@pytest.mark.parametrize("returns", [False, True])
def test_its_value_is_that_of_the_linear_program_with_all_edges_and_all_cuts(
    seed: int, objective: str, returns: bool
) -> None:
    data = small_mission(seed, 2, 6, return_to_start=returns)
    formulation = replace(formulation_of(data, objective), time_weight=0.0)
    whole = by_linprog(formulation.program(all_cuts(data)))
    for neighbours in (1, 5):
        relaxed = Relaxation(formulation, parameters=exactly(neighbours)).solve()
        assert relaxed.finished
        assert relaxed.bound == pytest.approx(whole, rel=1e-6)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_limits_are_part_of_it(objective: str) -> None:
    data = small_mission(3, 2, 6)
    data = replace(data, endurance=np.full(2, 700.0), longest_walk=np.full(2, 400.0))
    formulation = replace(formulation_of(data, objective), time_weight=0.0)
    relaxed = Relaxation(formulation, parameters=exactly()).solve()
    assert relaxed.bound == pytest.approx(by_linprog(formulation.program(all_cuts(data))), rel=1e-6)


@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_a_weight_on_all_times_costs_the_bound_at_most_its_share(seed: int) -> None:
    data = small_mission(seed, 3, 7)
    weighted = formulation_of(data, "makespan")
    assert 0 < data.n_robots * weighted.time_weight <= 1e-3
    plain = Relaxation(replace(weighted, time_weight=0.0), parameters=exactly()).solve().bound
    bound = Relaxation(weighted, parameters=exactly()).solve().bound
    assert plain * (1 - 1e-3) <= bound <= plain + 1e-6


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("seed", sample(range(4), 2))
def test_the_stored_program_proves_the_bound_by_its_dual_values_and_by_another_solver(
    seed: int, objective: str
) -> None:
    data = small_mission(seed, 3, 8)
    formulation = formulation_of(data, objective)
    relaxed = Relaxation(formulation, parameters=exactly(2)).solve()
    program = formulation.program(list(relaxed.cuts)).relaxed()
    assert dual_bound(program, relaxed.dual_values) == pytest.approx(relaxed.bound, rel=1e-9)
    again = by_linprog(program)
    assert again * (1 - 1e-3) <= relaxed.bound <= again + 1e-6


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("seed", sample(range(6), 3))
def test_no_bound_on_the_way_exceeds_the_optimum(seed: int, objective: str) -> None:
    data = small_mission(seed, 3, 5)
    optimum = minimum(data, objective)
    bounds: list[float] = []
    relaxation = Relaxation(formulation_of(data, objective), parameters=exactly(1))
    relaxation.solve(proved=bounds.append)
    assert bounds
    assert max(bounds) <= optimum + 1e-9
    assert bounds == sorted(bounds)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_stop_before_the_first_program_leaves_a_bound(objective: str) -> None:
    data = small_mission(1, 3, 5)
    relaxed = Relaxation(formulation_of(data, objective)).solve(MaximumRuntime(0))
    assert not relaxed.finished
    assert np.isfinite(relaxed.bound)
    assert relaxed.bound <= minimum(data, objective)


def test_a_stop_between_rounds_is_obeyed() -> None:
    data = small_mission(2, 3, 12)
    formulation = formulation_of(data, "total_time")
    whole = Relaxation(formulation, parameters=exactly(1)).solve()
    bounds: list[float] = []
    early = Relaxation(formulation, parameters=exactly(1)).solve(
        Interruption(lambda: bool(bounds)), proved=bounds.append
    )
    assert whole.finished
    assert not early.finished
    assert early.bound < whole.bound


def test_the_optimum_of_a_corridor_is_its_bound() -> None:
    # Robot at 0, victims at 1, 2 and 5: a walk of 5, and three services of 2.
    data = on_a_line([0], [1, 2, 5], [[[True], [True], [True]]], service=2.0)
    for objective in OBJECTIVES:
        assert Relaxation(
            formulation_of(data, objective), parameters=exactly()
        ).solve().bound == pytest.approx(11.0)


def test_a_kind_that_is_covered_by_a_rarer_one_needs_no_row() -> None:
    # Whoever can serve kind 0 (robot 0) can serve kind 1, too: one covering row, robot 0 visits.
    data = on_a_line([0, 9], [1], [[[True, True]], [[False, True]]])
    formulation = formulation_of(data, "total_time")
    matrix, lower, upper = formulation.rows
    covering = np.isinf(upper)
    assert covering.sum() == 1
    assert lower[covering] == [1.0]
    visit = formulation.pair_of[0, 0]
    assert matrix.toarray()[covering].nonzero()[1].tolist() == [visit]


def test_latency_has_no_such_relaxation() -> None:
    with pytest.raises(InputError, match="latency"):
        EdgeFormulation.of(small_mission(0), "latency", 1.0)
