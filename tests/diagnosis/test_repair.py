"""The smallest repair, against all that there is: every point of the box, and what it would take."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from fractions import Fraction

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import INF, program

from msmrta_opt.diagnosis.repair import Repair, repair
from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.program import Block, Program
from msmrta_opt.optimise.subject import subject


def least_cost(program: Program, weights: list[float]) -> Fraction:
    """Of all points of the box, the least weighted sum of what rows are missed by, in fractions."""
    boxes = [
        range(math.ceil(low), math.floor(high) + 1)
        for low, high in zip(program.lower, program.upper, strict=True)
    ]
    matrix = program.matrix.toarray().tolist()
    best: Fraction | None = None
    for point in itertools.product(*boxes):
        cost = Fraction(0)
        for row, low, high, weight in zip(
            matrix, program.row_lower.tolist(), program.row_upper.tolist(), weights, strict=True
        ):
            activity = sum((Fraction(a) * x for a, x in zip(row, point, strict=True)), Fraction(0))
            if math.isfinite(low):
                cost += Fraction(weight) * max(Fraction(low) - activity, Fraction(0))
            if math.isfinite(high):
                cost += Fraction(weight) * max(activity - Fraction(high), Fraction(0))
        best = cost if best is None else min(best, cost)
    assert best is not None
    return best


@st.composite
def conflicting(draw: st.DrawFn) -> Program:
    """Up to four rows on up to three integers of 0 to 2, each row with a label of its own."""
    n_rows, n_columns = draw(st.integers(1, 4)), draw(st.integers(1, 3))
    number = st.integers(-3, 3)
    matrix = [draw(st.lists(number, min_size=n_columns, max_size=n_columns)) for _ in range(n_rows)]
    sides = [
        draw(st.sampled_from([(low, INF), (-INF, high), (low, low), (low, low + 1)]))
        for low in draw(st.lists(st.integers(-4, 8), min_size=n_rows, max_size=n_rows))
        for high in [draw(st.integers(-4, 2))]
    ]
    made = program(
        matrix, [high for _, high in sides], 1, row_lower=[low for low, _ in sides], upper=2
    )
    return replace(made, rows=tuple(Block(f"row {i}", i, ()) for i in range(n_rows)))


@settings(max_examples=examples(60))
@given(
    trial=conflicting(),
    weights=st.lists(st.sampled_from([0.5, 1.0, 3.0]), min_size=4, max_size=4),
)
def test_no_point_of_the_box_has_a_cheaper_repair(trial: Program, weights: list[float]) -> None:
    weights = weights[: trial.n_rows]
    found = repair(trial, weights={f"row {i}": weight for i, weight in enumerate(weights)})
    assert found.proof == "proved in exact numbers"
    assert found.cost == least_cost(trial, weights)
    exact = [item.exact for item in found.rows if item.exact is not None]
    paid = [Fraction(weights[int(item.name.removeprefix("row "))]) for item in found.rows]
    assert len(exact) == len(found.rows)
    assert sum((w * by for w, by in zip(paid, exact, strict=True)), Fraction(0)) == found.cost


def two_rows() -> Program:
    """x + y ≤ 1 and x + y ≥ 2, binary."""
    made = program([[1, 1], [-1, -1]], [1, -2], 1)
    return replace(made, rows=(Block("at most one", 0, ()), Block("at least two", 1, ())))


def test_a_weight_decides_which_row_gives_way() -> None:
    assert [item.text for item in repair(two_rows(), weights={"at most one": 3}).rows] == [
        "at least two: ≥ 1 instead of ≥ 2"
    ]
    assert [item.text for item in repair(two_rows(), weights={"at least two": 3}).rows] == [
        "at most one: ≤ 2 instead of ≤ 1"
    ]


def test_what_must_stay_stays() -> None:
    stays = {"at most one": INF}
    assert [item.name for item in repair(two_rows(), weights=stays).rows] == ["at least two"]
    found = repair(two_rows(), weights={**stays, "at least two": INF})
    assert found == Repair(message="nothing is allowed to give way")
    assert found.text == "No repair: nothing is allowed to give way."


def test_bounds_give_way_only_if_they_have_a_weight() -> None:
    # x ≤ 0 by its bound against x ≥ 2.
    trial = program([[1]], INF, 1, row_lower=[2], upper=0)
    assert [item.text for item in repair(trial).rows] == ["row 0: ≥ 0 instead of ≥ 2"]
    found = repair(trial, weights={"x": 0.25})
    assert [item.text for item in found.rows] == ["x[0]: ≤ 2 instead of ≤ 0"]
    assert found.cost == 0.5
    assert found.point is not None
    assert found.point["x"].tolist() == [2.0]


def test_bounds_that_cross_have_no_repair() -> None:
    found = repair(program([[1]], 1, 1, lower=2, upper=1))
    assert found.cost is None
    assert "conflict by themselves" in found.message


def test_a_repair_of_continuous_variables_is_exact_to_the_last_digit() -> None:
    # x + y ≤ 1/3 as a float, and x = y ≥ 1/4: 1/2 - 1/3 is missed, in the binary fraction of the float.
    third = 1 / 3
    trial = program(
        [[1, 1], [1, -1]], [third, 0], 1, row_lower=[-INF, 0], lower=0.25, integer=False
    )
    (relaxed,) = repair(trial).rows
    assert relaxed.exact == Fraction(1, 2) - Fraction(third)


def test_weights_of_nothing_are_refused() -> None:
    with pytest.raises(
        InputError, match=r"no rows and no variable 'row 7'; there are 'row \{i\}', 'x'"
    ):
        repair(program([[1]], 1, 1), weights={"row 7": 1})
    with pytest.raises(InputError, match="-1; give 0 or more"):
        repair(two_rows(), weights={"at most one": -1})


def test_rows_are_told_as_they_are_written() -> None:
    x = cp.Variable(2, boolean=True, name="x")
    both = (cp.sum(x) >= 3).set_label("three of two")
    asked = subject(cp.Problem(cp.Minimize(cp.sum(x)), [both]))
    assert [item.text for item in repair(asked.described).rows] == [
        "three of two: ≥ 2 instead of ≥ 3"
    ]


def test_an_equation_stays_one() -> None:
    x = cp.Variable(2, boolean=True, name="x")
    for side, moved in ((1.5, "= 1 instead of = 1.5"), (2.75, "= 2 instead of = 2.75")):
        asked = cp.Problem(cp.Minimize(cp.sum(x)), [(cp.sum(x) == side).set_label("so many")])
        found = repair(subject(asked).program)
        assert [item.text for item in found.rows] == [f"so many: {moved}"]


def test_without_time_there_is_none() -> None:
    assert repair(two_rows(), time_limit=0.0).cost in (None, 1.0)


def test_one_repair_of_many_is_always_the_same() -> None:
    trial = program(np.ones((3, 3)), [0, 0, 0], 1, row_lower=[1, 1, 1])
    assert len({repair(trial).rows for _ in range(3)}) == 1
