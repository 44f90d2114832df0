"""Other units and smaller big Ms change no point, and small programs are settled by all points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import INF, program

from msmrta_opt.optimise.check import violations
from msmrta_opt.optimise.scaling import scaled, scaling
from msmrta_opt.optimise.settle import settle


@given(data=st.data())
@settings(max_examples=examples(60))
def test_scaling_changes_neither_points_nor_values(data: st.DataObject) -> None:
    powers = data.draw(st.lists(st.integers(-9, 9), min_size=6, max_size=6))
    matrix = 10.0 ** np.array(powers, float).reshape(2, 3)
    trial = program(matrix, [3, 4], matrix[0], integer=[True, False, False], upper=5, offset=2)
    factors = scaling(trial)
    sent = scaled(trial, factors)
    x = np.array([1.0, 0.5, 2.0])
    np.testing.assert_array_equal(np.log2(factors.row) % 1, 0)
    np.testing.assert_allclose(sent.matrix @ (x / factors.column), factors.row * (trial.matrix @ x))
    assert sent.value(x / factors.column) * factors.unit + 2 == pytest.approx(trial.value(x))


def test_tight_coefficients_leave_the_same_points() -> None:
    for trial in (
        program([[1, -1e9]], 0, 1, upper=[5, 1]),
        program([[1, 1e9]], 1e9, 1, upper=[5, 1]),
        program([[-1, 1e9]], INF, 1, row_lower=0, upper=[5, 1]),
        program([[1, -1e9]], 0, 1, upper=[5, 3]),
    ):
        tight = trial.with_tight_coefficients()
        assert np.abs(tight.matrix.data).max() <= 5
        for a in range(6):
            for z in range(int(trial.upper[1]) + 1):
                x = np.array([a, z], float)
                assert (violations(trial, x) == []) == (violations(tight, x) == [])


def test_all_points_of_a_small_program_are_looked_at() -> None:
    truth = settle(program([[2, 3]], 7, [3, 4], upper=3, sense="max"))
    assert truth is not None
    assert truth.x is not None
    assert truth.x.tolist() == [2, 1]
    assert truth.n_points == 16
    assert settle(program([[2, 3]], 7, [3, 4], upper=INF)) is None


@pytest.mark.filterwarnings("error")
def test_a_program_of_more_points_than_floats_count_is_left_alone_without_a_warning() -> None:
    assert settle(program([[1] * 1100], 7, [1] * 1100, upper=1, sense="max")) is None
