"""Both roads from cvxpy to arrays lead to the same numbers, and the short one knows its limits."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array
from support.amounts import examples
from support.joint_cases import small_mission
from support.small_cases import dense_case, shares

from msmrta_opt.optimise.compile import compile_formulation
from msmrta_opt.optimise.compile.affine import read_off
from msmrta_opt.optimise.compile.canonical import Canonical
from msmrta_opt.optimise.compile.compiled import canonicalise
from msmrta_opt.optimise.compile.reductions import reduced
from msmrta_opt.optimise.registry import get, listings

SHIPPED = [item.name for item in listings() if item.formulation is not None]
TABLES = [name for name in SHIPPED if get(name).spec.stage in ("cluster", "victim")]


def assert_same(short: Canonical, long: Canonical, parameters: list[cp.Parameter]) -> None:
    """All numbers, kinds and names, at several values of the parameters."""
    assert short.n_equations == long.n_equations
    assert short.integer.tolist() == long.integer.tolist()
    assert short.columns == long.columns
    assert short.rows == long.rows
    for value in (0.0, 0.25, 1.0):
        for parameter in parameters:
            parameter.value = value
        for ours, theirs in zip(short.numbers(), long.numbers(), strict=True):
            ours, theirs = (
                part.toarray() if isinstance(part, csr_array) else np.asarray(part)
                for part in (ours, theirs)
            )
            assert ours.shape == theirs.shape
            np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)


def built(name: str, seed: int = 0) -> cp.Problem:
    stage = get(name).spec.stage
    data = small_mission(seed, 2, 3) if stage == "routing" else dense_case(stage, seed)
    built = get(name).build(data)
    for parameter in built.parameters():
        parameter.value = 0.5
    return built


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_formulation_has_the_same_numbers_by_both_roads(name: str) -> None:
    for seed in range(5):
        stated = built(name, seed)
        short = read_off(stated)
        assert short is not None
        assert_same(short, reduced(name, stated), stated.parameters())


# Edits: what a person might do to a formulation of tables.


@st.composite
def edited(draw: st.DrawFn) -> cp.Problem:
    """A shipped formulation with rows dropped, turned and added, and another objective."""
    original = built(draw(st.sampled_from(TABLES)), draw(st.integers(0, 3)))
    x = original.var_dict["x"]
    rows = [draw(st.sampled_from([row, turned(row)])) for row in original.constraints]
    rows = [row for row in rows if draw(st.booleans())]
    rows += [draw(new_rows(x)) for _ in range(draw(st.integers(0, 3)))]
    worth = original.objective.expr + draw(st.integers(-2, 2))
    if draw(st.booleans()):
        worth = worth + draw(affine(x))
    sense = draw(st.sampled_from([cp.Minimize, cp.Maximize]))
    return cp.Problem(sense(worth), draw(st.permutations(rows)))


def turned(row: Any) -> Any:
    """The same sides, joined otherwise."""
    left, right = row.args
    return (left >= right) if isinstance(row, cp.constraints.Equality) else (left == right)


@st.composite
def affine(draw: st.DrawFn, x: cp.Variable) -> cp.Expression:
    """A scalar that is affine in `x`, in one of the ways that cvxpy has for it."""
    rng = np.random.default_rng(draw(st.integers(0, 9)))
    weight, share = rng.integers(-3, 4, x.shape).astype(float), cp.Parameter(name="share")
    share.value = 0.5
    r, c = draw(st.integers(0, x.shape[0] - 1)), draw(st.integers(0, x.shape[1] - 1))
    other = cp.Variable(2, nonneg=True, bounds=[-1, 4], name="other")
    whole = cp.Variable((2, 2), integer=True, nonpos=True, name="whole")
    return draw(
        st.sampled_from(
            [
                x[r, c],
                -2 * x[r, c] + 1,
                cp.sum(x[r, :]) - cp.sum(x[:, c]) / 2,
                cp.trace(weight.T @ x),
                share * cp.sum(cp.multiply(weight, x)) + share,
                (1 - share) * x[r, c] - (x.T)[c, r],
                cp.vec(x, order="F") @ weight.ravel(),
                cp.sum(cp.hstack([x[r, :], other])),
                cp.sum(cp.reshape(x, (x.size,), order="C")[1:]) + other[0] - other[1],
                weight[:, c] @ x @ weight[r, :] + cp.sum(whole),
                cp.sum(cp.vstack([x, x])) - whole[0, 1],
                cp.sum(share * x[:, c]) - cp.sum(x * (2 - share), axis=1)[r],
                cp.sum(cp.multiply(cp.reshape(share * np.ones(x.size), x.shape, order="F"), x)),
                cp.sum(x[np.array([r, 0, r]), :] + cp.sum(x, axis=0, keepdims=True)),
                cp.sum(cp.broadcast_to(x[r, :], (2, *x.shape)), axis=(0, 2))[0] / 4,
                cp.sum(cp.multiply(weight, cp.multiply(weight == 0, x)))
                + cp.Constant(csr_array(weight))[r, c],
            ]
        )
    )


@st.composite
def new_rows(draw: st.DrawFn, x: cp.Variable) -> Any:
    left: Any = draw(affine(x))
    right: Any = draw(st.sampled_from([-1.0, 0.0, 2.5]))
    if draw(st.booleans()):
        left, right = x - left, np.full(x.shape, right)
    join = draw(st.sampled_from(["<=", ">=", "=="]))
    row = (left <= right) if join == "<=" else (left >= right) if join == ">=" else (left == right)
    return row.set_label("new") if draw(st.booleans()) else row


@given(stated=edited())
@settings(max_examples=examples(80))
def test_an_edited_formulation_has_the_same_numbers_by_both_roads(stated: cp.Problem) -> None:
    assume(stated.variables())
    short = read_off(stated)
    assert short is not None
    assert_same(short, reduced("edited", stated), stated.parameters())


@given(stated=edited(), share=shares)
@settings(max_examples=examples(25))
def test_a_point_is_worth_and_asks_what_cvxpy_says(stated: cp.Problem, share: float) -> None:
    """By evaluation of the expressions: neither road's coefficients have a part in it."""
    assume(stated.variables())
    canonical = read_off(stated)
    assert canonical is not None
    for parameter in stated.parameters():
        parameter.value = share
    numbers, rng = canonical.numbers(), np.random.default_rng(1)
    x = np.zeros(len(numbers.cost))
    for variable in stated.variables():
        block = next(b for b in canonical.columns if b.name == name_of(variable, canonical))
        variable.save_value(rng.integers(0, 2, variable.shape).astype(float))
        x[block.start : block.stop] = np.ravel(variable.value, order="F")
    assert numbers.cost @ x + numbers.offset == pytest.approx(float(stated.objective.expr.value))
    gaps = numbers.matrix @ x - numbers.right
    kinds = (cp.constraints.Equality, cp.constraints.Inequality)
    stated_gaps = [
        np.ravel(row.args[0].value - row.args[1].value, order="F")
        for kind in kinds
        for row in stated.constraints
        if isinstance(row, kind)
    ]
    np.testing.assert_allclose(gaps, np.concatenate([np.zeros(0), *stated_gaps]), atol=1e-9)


def name_of(variable: cp.Variable, canonical: Canonical) -> str:
    """The name that its block has: with its number behind it where two have the same."""
    long = f"{variable.name()}_{variable.id}"
    return long if any(block.name == long for block in canonical.columns) else variable.name()


# What is left to cvxpy's reductions.

x = cp.Variable((2, 3), boolean=True, name="x")
y = cp.Variable(3, name="y")
share = cp.Parameter(name="share", value=0.5)
LONG: dict[str, Callable[[], cp.Problem]] = {
    "a maximum": lambda: cp.Problem(cp.Minimize(cp.max(y)), [y >= 1]),
    "an absolute value": lambda: cp.Problem(cp.Minimize(cp.sum(y)), [cp.abs(y) <= 1]),
    "an absolute value of a parameter": lambda: cp.Problem(
        cp.Minimize(cp.sum(y) + cp.abs(share)), [y >= 1]
    ),
    "running sums": lambda: cp.Problem(cp.Minimize(cp.sum(y)), [cp.cumsum(y) >= 1]),
    "three axes that cvxpy would have to compile": lambda: cp.Problem(
        cp.Minimize(cp.sum(cp.concatenate([cp.Variable((2, 2, 2), bounds=[1, 2])] * 2)))
    ),
    "a cone": lambda: cp.Problem(cp.Minimize(cp.sum(y)), [cp.constraints.NonNeg(y)]),
    "a parameter in bounds": lambda: cp.Problem(
        cp.Minimize(cp.sum(cp.Variable(2, name="z", bounds=[share, 1])))
    ),
    "integrality of some entries": lambda: cp.Problem(
        cp.Minimize(cp.sum(cp.Variable(3, name="z", integer=[(0, 2)], bounds=[0.5, 3])))
    ),
    "symmetry": lambda: cp.Problem(
        cp.Minimize(cp.sum(cp.Variable((2, 2), name="z", symmetric=True, bounds=[0, 1])))
    ),
    "complex numbers": lambda: cp.Problem(cp.Minimize(cp.real(cp.sum(1j * y))), [y <= 1]),
    "no entries": lambda: cp.Problem(cp.Minimize(cp.sum(y)), [y >= 0, y[:0] <= 1]),
}


@pytest.mark.parametrize("stated", LONG.values(), ids=LONG)
def test_what_is_not_affine_throughout_is_not_read_off(stated: Callable[[], cp.Problem]) -> None:
    assert read_off(stated()) is None


def test_axes_are_summed_as_numpy_sums_them() -> None:
    z = cp.Variable((2, 3, 4), name="z")
    for axis in (None, 0, 1, -1, (0, 2), (1, 2)):
        for keepdims in (False, True):
            row = cp.sum(z, axis=axis, keepdims=keepdims) <= 1
            canonical = read_off(cp.Problem(cp.Minimize(0), [row]))
            assert canonical is not None
            point = np.arange(24.0).reshape(2, 3, 4)
            sums = canonical.numbers().matrix @ point.ravel(order="F")
            expected = point.sum(axis=axis, keepdims=keepdims)
            np.testing.assert_array_equal(sums, np.ravel(expected, order="F"))


def test_a_cvxpy_without_what_the_short_road_needs_takes_the_long_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stated = built("victim_one_to_one")
    expected = canonicalise("it", stated)
    monkeypatch.setitem(sys.modules, "msmrta_opt.optimise.compile.coefficients", None)
    assert read_off(stated) is None
    assert_same(canonicalise("it", stated), expected, stated.parameters())


def test_a_cvxpy_that_is_asked_for_coefficients_in_another_way_takes_the_long_road(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    z = cp.Variable((2, 2), name="z", bounds=[0, 1])
    stated = cp.Problem(cp.Maximize(cp.sum(cp.hstack([z[0, 0], z[1, 1]]))))
    assert read_off(stated) is not None
    monkeypatch.setattr("msmrta_opt.optimise.compile.coefficients.CoeffExtractor", lambda: None)
    assert read_off(stated) is None
    assert canonicalise("it", stated).numbers().cost.tolist() == [1, 0, 0, 1]


def test_rows_without_parameters_are_the_same_arrays_at_every_value() -> None:
    compiled = compile_formulation(get("cluster_one_to_one"), dense_case("cluster", 0))
    one, other = compiled.program(psi=0.0), compiled.program(psi=1.0)
    assert one.matrix is other.matrix
    assert one.cost.tolist() != other.cost.tolist()


def test_rows_with_parameters_are_worked_out_at_each_value() -> None:
    """β weighs the loads of the balanced assignment, which are rows."""
    compiled = compile_formulation(get("victim_balanced"), dense_case("victim", 0))
    one, other = compiled.program(beta=0.0), compiled.program(beta=1.0)
    assert np.abs((one.matrix - other.matrix).toarray()).max() > 0
    again = compiled.program(beta=0.0)
    np.testing.assert_array_equal(again.matrix.toarray(), one.matrix.toarray())
