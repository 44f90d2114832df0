"""Coefficients become integers for CP-SAT, as exactly as there is room."""

from __future__ import annotations

import numpy as np
import pytest
from support.programs import INF, best_value, program
from support.solver_contract import (
    solve,
)

from msmrta_opt.mission.errors import SolverError
from msmrta_opt.optimise.solvers import get
from msmrta_opt.optimise.solvers.cpsat import scaled


def test_coefficients_of_what_can_only_be_zero_are_no_integers_beyond_all_limits() -> None:
    form = scaled(np.array([1e10, 1.5, -1e300]), np.array([0.0, 3.0, 0.0]))
    assert (form.weights.tolist(), form.scale, form.error) == ([0, 3, 0], 2.0, 0.0)


def test_fractions_are_multiplied_by_their_least_common_denominator() -> None:
    form = scaled(np.array([0.5, 1 / 3, -2.0]), np.array([1.0, 5.0, 7.0]))
    assert form.weights.tolist() == [3, 2, -12]
    assert (form.scale, form.exact, form.error) == (6.0, True, 0.0)


def test_other_numbers_keep_all_the_digits_there_is_room_for() -> None:
    coefficients, magnitudes = np.array([np.pi, -np.e]), np.array([3.0, 2.0])
    form = scaled(coefficients, magnitudes)
    missed = np.abs(form.weights / form.scale - coefficients) @ magnitudes
    assert missed <= form.error / form.scale <= 1e-12
    assert np.abs(form.weights) @ magnitudes <= 2**50


def test_numbers_that_leave_no_room_for_digits_are_refused() -> None:
    with pytest.raises(SolverError, match="solver cpsat cannot do coefficients"):
        scaled(np.array([np.pi, np.e]), np.array([1e10, 1e10]))


def test_an_infinite_bound_is_refused_with_the_name_of_the_variable() -> None:
    asked = program([[1, 1]], 1, [1, 1], upper=[1, INF])
    with pytest.raises(SolverError, match=r"cannot do infinite bounds, as x\[1\] has"):
        solve(get("cpsat"), asked)


def test_large_numbers_do_not_cost_the_optimum() -> None:
    """A presolve of ortools 9.15 loses the best point of this one, and calls another optimal."""
    matrix = [
        [1324989402, 0, -537261898, 6401166215, -12234420871, 0, 4965185874],
        [0, -4101105763, 0, 0, -453310280, -6483919878, 7492103328],
        [2876602606, -4133840674, -832421452, 3972271378, -4170742880, 0, 0],
        [0, -23713569068, 0, 0, 2104542873, 0, 0],
        [0, -5852423171, -1854480878, 0, 0, -280574497, 9156118271],
        [7028864364, 0, 5141158207, -11169594080, 0, -2312306775, 3375623764],
        [-6996375136, 0, -5590791159, 3904011609, 0, 0, 0],
        [0, 6050665330, -8170263202, 0, 5714459091, 0, 0],
        [0, -8896741971, 0, -24816072050, 0, 0, 0],
    ]
    asked = program(
        matrix,
        [4960896142, INF, INF, 2104542944, 17470513094, -7214537082, 6996375181, 14304393738, INF],
        [-5961491148, 3314703860, -2825359925, -4412796714, -4761885228, 3609044337, 105863448],
        row_lower=[-12218973191, -INF, -INF, -INF, -INF, -INF, -INF, -2875475557, -INF],
        lower=[-3, -1, -2, 0, -1, 0, 0],
        upper=[0, 2, 0, 2, 3, 3, 2],
    )
    solution = solve(get("cpsat"), asked)
    assert solution.status == "optimal"
    assert solution.objective == best_value(asked)
