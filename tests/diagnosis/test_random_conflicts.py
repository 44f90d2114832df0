"""Of random programs: what is said to conflict does, and none of it can be spared."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import csr_array
from support.amounts import examples
from support.conflicts import assert_explained, everything
from support.programs import INF

from msmrta_opt.diagnosis.conflict import find_conflict
from msmrta_opt.optimise.program import Block, Program


@st.composite
def programs(draw: st.DrawFn, *, integer: bool) -> Program:
    """Up to three variables and five rows, entries up to 3; most of them infeasible."""
    n_columns, n_rows = draw(st.integers(1, 3)), draw(st.integers(1, 2 if integer else 5))

    def vector(size: int, values: st.SearchStrategy[Any]) -> NDArray[Any]:
        return np.array(draw(st.lists(values, min_size=size, max_size=size)))

    # Even entries and odd right-hand sides, within wide bounds, conflict only in whole numbers.
    entries = st.sampled_from([2, -2, 2, -2, 0, 1, 3]) if integer else st.integers(-3, 3)
    right = vector(n_rows, st.sampled_from([1, -1, 3, 0]) if integer else st.integers(-3, 3))
    low = vector(n_columns, st.integers(-2, 0 if integer else 1))
    wide = vector(n_columns, st.integers(1, 3) if integer else st.integers(0, 2))
    sides = vector(n_rows, st.sampled_from(["=", "=", "<", ">"]))
    open_ = vector(n_columns, st.sampled_from(["", "", "low", "high"]))
    return Program(
        sense="min",
        cost=np.ones(n_columns),
        offset=0.0,
        matrix=csr_array(
            vector(n_rows * n_columns, entries).reshape(n_rows, n_columns).astype(float)
        ),
        row_lower=np.where(sides == "<", -INF, right).astype(float),
        row_upper=np.where(sides == ">", INF, right).astype(float),
        lower=np.where(open_ == "low", -INF, low).astype(float),
        upper=np.where(open_ == "high", INF, low + wide).astype(float),
        integer=np.full(n_columns, integer),
        columns=(Block("x", 0, (n_columns,)),),
        rows=(Block("row {i}", 0, (n_rows,)),),
    )


@settings(max_examples=examples(80))
@given(trial=programs(integer=False))
def test_of_linear_programs_the_set_conflicts_and_no_member_can_be_spared(trial: Program) -> None:
    feasible = everything(trial).has_a_point(trial, whole=False)
    found = find_conflict(trial)
    assert (found.status == "feasible") == feasible
    if not feasible:
        assert not found.integrality
        assert_explained(trial, found)


@settings(max_examples=examples(120))
@given(trial=programs(integer=True))
def test_of_integer_programs_the_set_conflicts_and_no_member_can_be_spared(trial: Program) -> None:
    feasible = everything(trial).has_a_point(trial, whole=True)
    found = find_conflict(trial)
    assert (found.status == "feasible") == feasible
    if not feasible:
        in_fractions = everything(trial).has_a_point(trial, whole=False)
        assert found.integrality == in_fractions
        assert_explained(trial, found, irreducible=found.irreducible)
