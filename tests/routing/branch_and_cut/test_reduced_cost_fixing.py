"""Fixing keeps every better solution; objective steps are exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp
from support.amounts import sample
from support.joint_cases import any_routes, on_a_line, small_mission
from support.joint_oracle import minimum
from support.searches import exactly

from msmrta_opt.arrays import Floats
from msmrta_opt.routing.branch_and_cut.cutting_plane import Relaxation
from msmrta_opt.routing.branch_and_cut.edge_formulation import EdgeFormulation
from msmrta_opt.routing.branch_and_cut.points import point_supports
from msmrta_opt.routing.branch_and_cut.reduced_cost_fixing import fixed
from msmrta_opt.routing.branch_and_cut.separation import separate
from msmrta_opt.routing.objective_step import ObjectiveStep, objective_step
from msmrta_opt.routing.objectives import value


def by_milp(formulation: EdgeFormulation, lower: Floats, upper: Floats) -> float:
    """The least value within the columns' bounds, by SciPy and cuts as they turn out missing."""
    cuts: list = []
    while True:
        program = formulation.program(cuts)
        solution = milp(
            program.cost,
            integrality=program.integer,
            bounds=Bounds(lower, upper),
            constraints=LinearConstraint(program.matrix, program.row_lower, program.row_upper),
        )
        if solution.status == 2:
            return np.inf
        assert solution.status == 0, solution.message
        x = np.round(solution.x)
        new = [c for s in point_supports(formulation, x) for c in separate(s, tolerance=0.4)]
        if not new:
            return float(solution.fun) + program.offset
        cuts += new


@pytest.mark.parametrize("objective", ["total_time", "makespan"])
@pytest.mark.parametrize("seed", sample(range(5), 3))
def test_whatever_the_upper_bound_the_optimum_is_not_cut_off(seed: int, objective: str) -> None:
    data = small_mission(seed, 3, 5)
    optimum = minimum(data, objective)
    maximum = value(data, any_routes(data), objective)
    formulation = EdgeFormulation.of(data, objective, maximum)
    relaxed = Relaxation(formulation, parameters=exactly()).solve()
    step = objective_step(data, objective).step
    assert step > 0
    zero, one = np.zeros(formulation.n_columns), formulation.upper
    assert by_milp(formulation, zero, one) == pytest.approx(optimum)
    for upper in (optimum + step, optimum + 10 * step, maximum):
        low, high = fixed(formulation, relaxed, upper, zero, one)
        assert (low <= high).all()
        if upper > optimum + step / 2:
            assert by_milp(formulation, low, high) == pytest.approx(optimum), (seed, upper)


def test_a_tight_upper_bound_fixes_more_than_a_loose_one() -> None:
    data = small_mission(2, 3, 8)
    maximum = value(data, any_routes(data), "total_time")
    formulation = EdgeFormulation.of(data, "total_time", maximum)
    relaxed = Relaxation(formulation, parameters=exactly()).solve()
    zero, one = np.zeros(formulation.n_columns), formulation.upper
    loose = fixed(formulation, relaxed, maximum, zero, one)[1].sum()
    tight = fixed(formulation, relaxed, relaxed.bound + 10.0, zero, one)[1].sum()
    assert tight < loose <= one.sum()


def test_what_a_robot_does_not_visit_it_has_no_edges_to() -> None:
    data = on_a_line([0, 5], [1, 2, 3], [[[True]] * 3] * 2)
    formulation = EdgeFormulation.of(data, "makespan", 300.0)
    relaxed = Relaxation(formulation, parameters=exactly()).solve()
    never = formulation.pair_of[0, 1]
    upper = formulation.upper.copy()
    upper[never] = 0.0
    _, high = fixed(formulation, relaxed, 300.0, np.zeros(formulation.n_columns), upper)
    gone = np.flatnonzero((formulation.upper > 0) & (high == 0))
    # Robot 0 and victim 1: visit, first, last, service, and two edges.
    y, f, last, a, e = (formulation.start(name) for name in "yflae")
    edges = np.flatnonzero(
        (formulation.edges[:, 0] == 0) & (formulation.edges[:, 1:] == 1).any(axis=1)
    )
    service = np.flatnonzero(formulation.services[:, 0] == never)
    expected = [y + never, f + never, last + never, *(a + service), *(e + edges)]
    assert len(expected) == 6
    assert sorted(gone) == sorted(expected)


def test_objective_steps_are_the_greatest_common_divisors_of_all_times() -> None:
    # Times 4/0.4 = 10, 6/0.4 = 15 and between them 2/0.4 = 5; services 2.
    data = on_a_line([0], [4, 6], [[[True], [True]]], service=2.0)
    data = replace(data, leave=data.leave / 0.4, length=data.between / 0.4)
    assert objective_step(data, "total_time") == ObjectiveStep(offset=4.0, step=5.0)
    assert objective_step(data, "makespan") == ObjectiveStep(offset=0.0, step=1.0)


def test_speeds_with_no_short_decimal_still_have_a_step() -> None:
    # A third of a cell per time unit: 3 time units a cell. At 0.3, ten thirds.
    data = on_a_line([0, 0], [1, 2], [[[True], [True]]] * 2)
    speed = np.array([0.2, 0.3])
    data = replace(
        data, leave=data.leave / speed[:, None], length=data.between / speed[:, None, None]
    )
    # gcd(5, 10/3) = 5/3
    assert objective_step(data, "total_time").step == pytest.approx(5 / 3)


def test_times_without_a_common_measure_have_no_step() -> None:
    data = on_a_line([0], [np.sqrt(2.0), 1.0], [[[True], [True]]])
    step = objective_step(data, "total_time")
    assert step.step == 0.0
    assert step.up(1.25) == 1.25
    assert step.below(2.0) < 2.0


def test_bounds_are_rounded_up_to_the_next_possible_value_but_not_by_rounding_errors() -> None:
    step = ObjectiveStep(offset=1.0, step=2.5)
    assert step.up(6.1) == 8.5
    assert step.up(6.0 + 1e-8) == pytest.approx(6.0, abs=1e-6)
    assert step.up(6.0 - 1e-8) == 6.0
    assert step.below(6.0) == pytest.approx(3.5, abs=1e-4)
    assert step.below(6.0) > 3.5
