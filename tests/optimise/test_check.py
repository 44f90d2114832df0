"""The independent check finds what is wrong, and its bounds are never better than the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import INF, assignment_programs, best_value, program, structured_programs

from msmrta_opt.optimise.check import TOLERANCE, dual_bound, settled, violations
from msmrta_opt.optimise.program import Block, Program
from msmrta_opt.optimise.solve import solve_program

# Two robots, two clusters; x is 2 × 2 in the order x[0,0], x[1,0], x[0,1], x[1,1].
POSTS = replace(
    program([[1, 1, 0, 0], [0, 0, 1, 1]], 1, [1, 2, 3, 4], row_lower=[0, 1]),
    columns=(Block("x", 0, (2, 2)),),
    rows=(Block("cluster {c} has at most one robot", 0, (2,)),),
)


def test_nothing_is_wrong_with_a_feasible_point() -> None:
    assert violations(POSTS, np.array([0.0, 1.0, 1.0, 0.0])) == []


def test_a_row_that_is_exceeded_is_named_in_the_modellers_words() -> None:
    (found,) = violations(POSTS, np.array([0.0, 0.0, 1.0, 1.0]))
    assert found == "row 'cluster 1 has at most one robot' is missed by 1"


def test_a_row_that_is_not_reached_is_named_too() -> None:
    (found,) = violations(POSTS, np.zeros(4))
    assert found == "row 'cluster 1 has at most one robot' is missed by 1"


@pytest.mark.parametrize("value", [-1.0, 2.0])
def test_a_value_outside_its_bounds_is_named(value: float) -> None:
    apart = program([[0, 0, 0, 0]], 9, 0)
    (found,) = violations(apart, np.array([0, value, 0, 0]))
    assert found == f"x[1] = {value:g} is outside its bounds"


def test_a_fraction_where_a_whole_number_belongs_is_named() -> None:
    (found,) = violations(POSTS, np.array([0.0, 0.5, 1.0, 0.0]))
    assert found == "x[1,0] = 0.5 is not integral"


def test_a_continuous_value_may_be_a_fraction() -> None:
    assert violations(POSTS.relaxed(), np.array([0.0, 0.5, 1.0, 0.0])) == []


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_not_finite_is_wrong(value: float) -> None:
    (found,) = violations(POSTS, np.array([0.0, value, 1.0, 0.0]))
    assert "not finite" in found


@pytest.mark.parametrize("shape", [(3,), (5,), (2, 2), ()])
def test_a_point_of_another_shape_is_wrong(shape: tuple[int, ...]) -> None:
    (found,) = violations(POSTS, np.zeros(shape))
    assert str(shape) in found


@pytest.mark.parametrize("where", ["matrix", "row_upper", "upper"])
def test_a_comparison_with_what_is_not_a_number_is_not_passed(where: str) -> None:
    """Comparisons with NaN are false, so a check must not ask whether something is wrong."""
    values = {
        "matrix": POSTS.matrix * np.nan,
        "row_upper": np.full(2, np.nan),
        "upper": np.full(4, np.nan),
    }
    unknown = replace(POSTS, **{where: values[where]})
    assert violations(unknown, np.array([0.0, 1.0, 1.0, 0.0])) != []


def test_the_worst_comes_first_and_only_so_many_are_named() -> None:
    wrong = np.array([0.0, 0.5, 3.0, 1.0])
    everything = violations(POSTS, wrong, maximum=9)
    assert len(everything) == 3  # row 1, the bound of x[0,1], the fraction of x[1,0]
    assert {text.split()[0] for text in everything} == {"row", "x[0,1]", "x[1,0]"}
    assert violations(POSTS, wrong, maximum=1) == everything[:1]


def test_rounding_errors_pass_and_errors_beyond_tolerance_do_not() -> None:
    one = program([[1]], 1, 1, integer=False, upper=9)
    assert violations(one, np.array([1 + TOLERANCE / 2])) == []
    assert violations(one, np.array([1 + TOLERANCE * 10])) != []


def test_a_long_row_is_measured_by_the_size_of_its_terms() -> None:
    """Terms of a million that cancel may miss by what rounding in them amounts to, not by 10."""
    balance = program([[1, -1]], 0, 0, row_lower=0, upper=INF, integer=False)
    assert violations(balance, np.array([1e6, 1e6 + 0.5])) == []
    assert violations(balance, np.array([1e6, 1e6 + 10])) != []


def test_a_value_that_is_whole_up_to_rounding_is_made_whole() -> None:
    x = settled(POSTS, np.array([1e-9, 1 - 1e-9, 1 + 1e-9, -1e-9]))
    assert x.tolist() == [0, 1, 1, 0]


def test_settling_never_hides_a_violation() -> None:
    """What is wrong by more than rounding is still wrong, and so still found, afterwards."""
    for wrong in ([0, 2.0, 1, 0], [0, -1.0, 1, 0], [0, 0.4, 1, 0]):
        assert violations(POSTS, settled(POSTS, np.array(wrong, float))) != []
    relaxed = replace(POSTS.relaxed(), row_upper=np.full(2, INF))
    assert violations(relaxed, settled(relaxed, np.array([0, 1.5, 1, 0]))) != []


duals = st.one_of(st.just(0.0), st.integers(-3, 3).map(float), st.floats(-1e3, 1e3))


@given(program=st.one_of(assignment_programs(most_edits=2), structured_programs()), data=st.data())
@settings(max_examples=examples(200))
def test_no_duals_prove_more_than_the_optimum(program: Program, data: st.DataObject) -> None:
    best = best_value(program)
    if best is None:
        return  # every bound is true of nothing
    given_duals = data.draw(st.lists(duals, min_size=program.n_rows, max_size=program.n_rows))
    bound = dual_bound(program, np.array(given_duals))
    assert not np.isnan(bound)
    assert program.sign * (bound - best) <= 1e-6 * max(1.0, np.abs(given_duals).max())


@given(
    cost=st.floats(-1e-8, 1e-8),
    price=st.floats(-1e-8, 1e-8),
    far=st.sampled_from([1.0, 1e6, 1e12]),
)
@example(cost=-1e-10, price=0.0, far=1e12)
@example(cost=0.0, price=-5e-10, far=1e12)
@settings(max_examples=examples(60))
def test_small_duals_and_costs_count_where_values_are_large(
    cost: float, price: float, far: float
) -> None:
    wide = program([[1]], far, cost, row_lower=-far, upper=far, integer=False)
    best = min(0.0, cost * far)
    assert dual_bound(wide, np.array([price])) <= best + 1e-6 * max(1.0, abs(best))


def test_the_right_duals_prove_the_optimum_of_a_maximisation() -> None:
    """max 3x + 2y + 7, x + y ≤ 4, x + 3y ≤ 6, x ≤ 3: x = 3, y = 1 is worth 18; row 0 costs 2."""
    best = program([[1, 1], [1, 3]], [4, 6], [3, 2], upper=[3, INF], sense="max", offset=7)
    assert dual_bound(best, np.array([-2.0, 0.0])) == pytest.approx(18)
    assert dual_bound(best, np.array([-3.0, 0.0])) == pytest.approx(19)


def test_the_right_duals_prove_the_optimum_of_a_minimisation() -> None:
    """min 2x + 3y, x + y ≥ 4, x ≤ 3: x = 3, y = 1 costs 9; a unit of the row costs 3."""
    minimum = program([[1, 1]], INF, [2, 3], row_lower=4, upper=[3, INF])
    assert dual_bound(minimum, np.array([3.0])) == pytest.approx(9)
    assert dual_bound(minimum, np.array([2.0])) == pytest.approx(8)


@pytest.mark.parametrize("size", [1.0, 1e-6])
@pytest.mark.parametrize(("sense", "nothing"), [("min", -INF), ("max", INF)])
def test_a_dual_that_leans_on_a_side_that_is_not_there_proves_nothing(
    sense: str, nothing: float, size: float
) -> None:
    at_most = program([[1, 1]], 1, 0, sense=sense)  # type: ignore[arg-type]
    assert dual_bound(at_most, np.array([size])) == nothing
    free = program([[1, 0]], 1, [0, size], upper=INF, lower=-INF, sense=sense)  # type: ignore[arg-type]
    assert dual_bound(free, np.array([0.0])) == nothing


def test_a_tolerance_is_no_larger_than_what_is_in_a_row() -> None:
    """1e6 z ≤ 750002 is missed at z = 3, however small z is in another row."""
    asked = program(
        [[0, 1e6], [3e5, 3e-5]],
        [750002, -299998.9999775],
        [0, -1e5],
        lower=[-1, 0],
        upper=[-1, 3],
        integer=[True, False],
    )
    (found,) = violations(asked, np.array([-1.0, 3.0]))
    assert found == "row 'row 0' is missed by 2.2e+06"
    for solver in ("auto", "highs", "scip", "glpk"):
        assert solve_program(asked, solver=solver).objective == pytest.approx(-75000.2)


@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk"])
def test_what_a_large_side_hides_from_solvers_is_no_optimum_by_their_word_alone(
    solver: str,
) -> None:
    """3 units of x₂ cost 9e-4 in a row with 2e7 on its side; so 0.4 + 3e-5 is the optimum."""
    asked = program(
        [[1e6, -3e3, 0, 0, 0.3], [-4e6, 0, -3e-4, 30, 0]],
        INF,
        [0, -2e-4, 1e-5, 0, 0.4],
        row_lower=[5249999.7, -21000068.5],
        lower=[-2, 0, 0, -3, -2],
        upper=[8, 3, 3, 6, 1],
        integer=[False, True, True, False, True],
        sense="max",
    )
    found = solve_program(asked, solver=solver)
    assert found.status != "optimal" or found.objective == pytest.approx(0.40003, rel=1e-9)
    assert found.status in ("optimal", "claimed")
