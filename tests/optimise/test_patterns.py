"""Where coefficients are is found once for problems that are made alike; what is read is the same."""

from __future__ import annotations

from collections.abc import Callable

import cvxpy as cp
import numpy as np
import pytest

from msmrta_opt.arrays import Floats
from msmrta_opt.optimise.compile.affine import Patterns, read_off
from msmrta_opt.optimise.compile.canonical import Canonical

Build = Callable[[Floats], cp.Problem]


def costs_and_rows(a: Floats) -> cp.Problem:
    x, t = cp.Variable(a.shape, boolean=True), cp.Parameter(nonneg=True, value=0.25)
    worth = (1 - t) * cp.sum(cp.multiply(a, x)) + t * cp.sum(x) / 2 + a[0, 0]
    return cp.Problem(cp.Maximize(worth), [cp.sum(cp.multiply(a, x), axis=1) <= 3, x[0] <= x[1]])


def shared_constant(a: Floats) -> cp.Problem:
    x, both = cp.Variable(a.shape, bounds=[0, a]), cp.Constant(a)
    return cp.Problem(cp.Minimize(cp.sum(cp.multiply(both, x))), [cp.multiply(-both, x) <= both])


def own_constants(a: Floats) -> cp.Problem:
    x = cp.Variable(a.shape, bounds=[0, a])
    half = cp.Constant(a / 2)
    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(a, x))), [cp.multiply(-cp.Constant(a), x) <= half]
    )


def by_cvxpy(a: Floats) -> cp.Problem:
    x = cp.Variable(a.shape)
    return cp.Problem(cp.Minimize(cp.sum(a @ x.T)), [a @ x.T >= 1])


def as_the_data_says(a: Floats) -> cp.Problem:
    x = cp.Variable(a.shape, boolean=True)
    rows = [x[int(i)] <= 1 for i in np.flatnonzero(a[:, 0] > 0)]
    return cp.Problem(cp.Maximize(cp.sum(x[int(a[1, 1])])), [cp.sum(x) <= 2, *rows])


def arrays(found: Canonical | None) -> list[Floats]:
    assert found is not None
    cost, offset, matrix, right, lower, upper = found.numbers()
    return [cost, np.array(offset), matrix.toarray(), right, lower, upper, found.integer]


@pytest.mark.parametrize(
    "build", [costs_and_rows, shared_constant, own_constants, by_cvxpy, as_the_data_says]
)
def test_other_data_is_read_as_if_it_were_the_first(build: Build) -> None:
    random, patterns = np.random.default_rng(0), Patterns()
    for _ in range(12):
        data = random.integers(0, 3, (3, 2)).astype(float)
        for got, right in zip(
            arrays(read_off(build(data), patterns)), arrays(read_off(build(data))), strict=True
        ):
            assert np.array_equal(got, right)


def test_problems_that_differ_in_their_making_alone_are_told_apart() -> None:
    a, patterns = np.array([[1.0, 2.0], [3.0, 4.0]]), Patterns()
    for build in (shared_constant, own_constants, costs_and_rows, own_constants, shared_constant):
        got, right = arrays(read_off(build(a), patterns)), arrays(read_off(build(a)))
        assert all(map(np.array_equal, got, right))


def test_the_rows_of_alike_problems_are_one_matrix() -> None:
    patterns = Patterns()

    def matrix(worth: float) -> object:
        x = cp.Variable(2, boolean=True)
        stated = cp.Problem(cp.Maximize(worth * cp.sum(x)), [cp.sum(x) <= 1])
        found = read_off(stated, patterns)
        assert found is not None
        return found.numbers().matrix

    assert matrix(2.0) is matrix(3.0)


def test_a_complex_constant_is_no_number_of_a_pattern() -> None:
    x, patterns = cp.Variable(2), Patterns()
    assert read_off(cp.Problem(cp.Minimize(cp.sum(x)), [x >= np.ones(2)]), patterns) is not None
    unreal = cp.Problem(cp.Minimize(cp.sum(x)), [cp.real(x * 1j) >= 1])
    assert read_off(unreal, patterns) is None
