"""Why a solution is the best: what binds, dual values, and how far parameters may go."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import feasible_points, formulation

from msmrta_opt.diagnosis.explain import Explanation, explain
from msmrta_opt.diagnosis.optimum import Optimum
from msmrta_opt.optimise.compile import compile_formulation
from msmrta_opt.optimise.data import VictimData
from msmrta_opt.optimise.formulation import Parameter


def optimum_of(found: Explanation) -> Optimum:
    assert found.optimum is not None
    return found.optimum


def diet(enough: float = 4, some: float = 1) -> cp.Problem:
    """Two foods of 3 and 2: at least 4 in sum, at least 1 of the first, at most 9: 1 and 3, 9."""
    x = cp.Variable(2, nonneg=True, name="x")
    return cp.Problem(
        cp.Minimize(3 * x[0] + 2 * x[1]),
        [
            (cp.sum(x) >= enough).set_label("enough"),
            (x[0] >= some).set_label("some of the first"),
            (cp.sum(x) <= 9).set_label("not too much"),
        ],
    )


def test_binding_rows_have_the_dual_values_that_a_hand_calculation_gives() -> None:
    # One more of enough costs 2; one more of the first takes the place of one second: 3 - 2.
    found = optimum_of(explain(diet()))
    assert {row.name: (row.side, row.dual) for row in found.binding} == {
        "enough": (4.0, 2.0),
        "some of the first": (1.0, 1.0),
    }
    loose = {item.label: item.least_slack for item in found.constraints}
    assert loose == {"enough": None, "some of the first": None, "not too much": 5.0}


def test_a_dual_value_is_what_one_more_of_a_side_changes() -> None:
    duals = {row.name: row.dual for row in optimum_of(explain(diet())).binding}
    for label, more in (("enough", diet(enough=5)), ("some of the first", diet(some=2))):
        changed = explain(more).solution.objective
        assert changed == pytest.approx(9 + (duals[label] or 0))


@pytest.mark.parametrize("more", [0.5, 1, 2, 4])
@pytest.mark.parametrize("integer", [True, False])
def test_a_change_of_a_side_gains_no_more_than_its_dual_value_says(
    integer: bool, more: float
) -> None:
    # Maximise 5 x, 2 x ≤ 4, x ≤ 3: from 10 at x = 2 to 15 at the most, at a rate of 2.5.
    def bags(side: float) -> cp.Problem:
        x = cp.Variable(integer=integer, bounds=[0, 3], name="x")
        return cp.Problem(cp.Maximize(5 * x), [(2 * x <= side).set_label("room")])

    found = explain(bags(4))
    assert (
        "What one more of a side would gain at most, or cost at least:\n  room: +2.5" in found.text
    )
    changed = explain(bags(4 + more)).solution.objective
    right = min((4 + more) / 2, 3)
    assert changed == pytest.approx(5 * (np.floor(right) if integer else right))
    assert changed - 10 <= 2.5 * more


def weighed(matrix: Any, low: float, high: float) -> Any:
    """Choose one of three things, each worth a line in t."""

    def build(data: object) -> cp.Problem:
        t = cp.Parameter(name="t")
        x = cp.Variable(3, boolean=True, name="x")
        one = (cp.sum(x) == 1).set_label("one")
        first, second = (np.array(row, float) for row in matrix)
        return cp.Problem(cp.Minimize(first @ x + t * (second @ x)), [one])

    return formulation(build, t=Parameter(low, high, low, "what it weighs"))


@settings(max_examples=examples(40))
@given(
    matrix=st.lists(st.lists(st.integers(-4, 4), min_size=3, max_size=3), min_size=2, max_size=2),
    low=st.integers(-2, 1),
    width=st.integers(1, 4),
    share=st.sampled_from([Fraction(0), Fraction(1, 4), Fraction(1, 2), Fraction(1)]),
)
def test_a_range_is_all_values_at_which_the_solution_is_the_best(
    matrix: list[list[int]], low: int, width: int, share: Fraction
) -> None:
    # The oracle: lines at + b t, of which the chosen one is least exactly on an interval.
    high = low + width
    value = low + share * width
    found = explain(weighed(matrix, low, high), None, t=float(value))
    (reach,) = optimum_of(found).ranges
    chosen = int(np.argmax(found.solution.values["x"]))
    ends = [Fraction(low), Fraction(high)]
    a, b = matrix
    for other in range(3):
        rise, fall = b[chosen] - b[other], a[other] - a[chosen]
        if rise > 0:
            ends[1] = min(ends[1], Fraction(fall, rise))
        elif rise < 0:
            ends[0] = max(ends[0], Fraction(fall, rise))
    assert (reach.low, reach.high) == tuple(ends)
    assert reach.is_exact


def test_of_a_mixed_program_the_integers_stay_while_the_others_follow() -> None:
    # min (1-t) c0 + t c1: machine 0 or 1 open, c the two loads; integer choice x, split y of 4 units.
    def build(data: object) -> cp.Problem:
        t = cp.Parameter(nonneg=True, name="t")
        x = cp.Variable(boolean=True, name="x")
        y = cp.Variable(2, nonneg=True, name="y")
        rows = [(cp.sum(y) == 4).set_label("all"), (y[1] <= 4 * x).set_label("only if open")]
        return cp.Problem(cp.Minimize((1 - t) * y[0] + t * y[1] + 0.5 * x), rows)

    # Closed: 4 (1 - t). Open: 1/2 + 4 min(t, 1 - t). Open is better while 4 t + 1/2 < 4 - 4 t: t < 7/16.
    trial = formulation(build, t=Parameter(0, 1, 0.1, "weight"))
    (reach,) = optimum_of(explain(trial, None)).ranges
    assert float(reach.low or 0) == pytest.approx(0)
    assert float(reach.high or 0) == pytest.approx(7 / 16)
    assert not reach.is_exact
    assert "(to 1e-9)" in reach.text


def test_a_parameter_of_rows_has_no_range_and_that_is_said() -> None:
    data = VictimData(
        np.array([[3.0, 4]]), np.array([[1.0, 2]]), np.ones((1, 2), bool),
        np.zeros(1), np.array([2]), np.full(1, np.inf),
    )  # fmt: skip
    (reach,) = optimum_of(explain("victim_balanced", data)).ranges
    assert reach.text.startswith("beta = 0.5: no range: beta enters the rows")


def test_the_range_holds_for_the_paper_as_all_points_say(paper_cluster: Any) -> None:
    reach = optimum_of(explain("cluster_one_to_one", paper_cluster, psi=0.95)).ranges[0]
    found = explain("cluster_one_to_one", paper_cluster, psi=0.95)
    from msmrta_opt.optimise.registry import get

    compiled = compile_formulation(get("cluster_one_to_one"), paper_cluster)
    points = feasible_points(compiled.program())
    x = compiled.program().flat(found.solution.values)
    assert reach.low is not None
    assert reach.high is not None

    def is_best(psi: float) -> bool:
        cost = compiled.program(psi=psi).cost
        return bool(cost @ x >= (points @ cost).max() - 1e-9)

    assert all(is_best(float(end)) for end in (reach.low, reach.high))
    assert reach.low == 0 or not is_best(float(reach.low) - 1e-3)
    assert reach.high == 1 or not is_best(float(reach.high) + 1e-3)
