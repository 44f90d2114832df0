"""The assignment algorithm against every matching, and its dual values as proof."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from support.amounts import examples
from support.programs import (
    INF,
    assignment_programs,
    best_value,
    edits,
    program,
    structured_programs,
)

from msmrta_opt.optimise.assignment import solve_assignment
from msmrta_opt.optimise.check import dual_bound, violations
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.structure import integral_relaxation, recognise

MISSING = INF


@dataclass(frozen=True, eq=False)
class Table:
    """A table of costs, with how it is to be matched."""

    cost: NDArray[np.float64]
    every_row: bool = False
    pairs: int | None = None

    def program(self) -> Program:
        """Rows of the table come first, then its columns, then the number of pairs."""
        n_rows, n_columns = self.cost.shape
        here = np.argwhere(np.isfinite(self.cost))
        matrix = np.zeros((n_rows + n_columns, len(here)))
        matrix[here[:, 0], np.arange(len(here))] = 1
        matrix[n_rows + here[:, 1], np.arange(len(here))] = 1
        low, high = np.full(len(matrix), -INF), np.ones(len(matrix))
        if self.every_row:
            low[:n_rows] = 1
        if self.pairs is not None:
            matrix = np.vstack([matrix, np.ones(len(here))])
            low, high = np.append(low, self.pairs), np.append(high, self.pairs)
        return program(matrix, high, self.cost[np.isfinite(self.cost)], row_lower=low)

    def least_cost(self) -> float | None:
        """Over all ways to give each row of the table a column of its own, or none."""
        n_rows, n_columns = self.cost.shape
        unmatched = [None] * n_rows
        best = None
        for picked in set(itertools.permutations([*range(n_columns), *unmatched], n_rows)):
            pairs = [(row, column) for row, column in enumerate(picked) if column is not None]
            if self.every_row and len(pairs) < n_rows:
                continue
            if self.pairs is not None and len(pairs) != self.pairs:
                continue
            total = sum((self.cost[pair] for pair in pairs), 0.0)
            if np.isfinite(total) and (best is None or total < best):
                best = float(total)
        return best


def assert_proven(program: Program, best: float | None) -> None:
    """The assignment algorithm handles the program, and its duals prove that it is right."""
    structure = recognise(program)
    assert structure is not None
    answer = solve_assignment(program, structure)
    if best is None:
        assert answer is None
        return
    assert answer is not None
    x, duals = answer
    assert violations(program, x) == []
    assert program.value(x) == pytest.approx(best, abs=1e-9)
    assert dual_bound(integral_relaxation(program, structure), duals) == pytest.approx(
        best, abs=1e-9
    )


@st.composite
def tables(draw: st.DrawFn) -> Table:
    """2 to 4 rows and columns, at least two entries in each, with ties, thirds and negatives."""
    n_rows, n_columns = draw(st.integers(2, 4)), draw(st.integers(2, 4))
    third = st.integers(-6, 9).map(lambda number: number / 3)
    cells = draw(st.lists(third, min_size=n_rows * n_columns, max_size=n_rows * n_columns))
    cost = np.array(cells).reshape(n_rows, n_columns)
    for row, column in draw(
        st.sets(st.tuples(st.integers(0, n_rows - 1), st.integers(0, n_columns - 1)), max_size=5)
    ):
        kept = np.isfinite(cost)
        if kept[row].sum() > 2 and kept[:, column].sum() > 2:
            cost[row, column] = MISSING
    way = draw(st.sampled_from(["free", "every row", "as many pairs as can be"]))
    if way == "every row" and n_rows <= n_columns:
        return Table(cost, every_row=True)
    if way == "as many pairs as can be":
        return Table(cost, pairs=min(n_rows, n_columns))
    return Table(cost)


@given(table=tables())
@settings(max_examples=examples(150))
def test_a_matching_costs_what_the_cheapest_of_all_costs_and_its_duals_prove_it(
    table: Table,
) -> None:
    assert_proven(table.program(), table.least_cost())


def test_unwanted_pairs_are_left_unmatched() -> None:
    assert_proven(Table(np.array([[-5.0, 1.0], [-4.0, 2.0]])).program(), -5)


def test_all_must_be_matched_where_the_rows_say_so_whatever_it_costs() -> None:
    assert_proven(Table(np.array([[-5.0, 1.0], [-4.0, 2.0]]), every_row=True).program(), -3)


def test_a_cardinality_asks_for_pairs_that_are_worth_nothing() -> None:
    wide = np.array([[3.0, 1.0, 2.0], [3.0, 1.0, 9.0]])
    assert_proven(Table(wide, pairs=2).program(), 3)
    assert_proven(Table(wide.T, pairs=2).program(), 3)


def test_a_table_without_a_complete_matching_has_no_solution() -> None:
    """Rows 0 and 1 have columns 0 and 1 to themselves; row 2 has none but these."""
    cost = np.array([[1, 2, MISSING, MISSING], [3, 4, MISSING, MISSING], [5, 6, MISSING, MISSING]])
    table = Table(np.vstack([cost, [9, 9, 1, 1]]), every_row=True)
    assert table.least_cost() is None
    assert_proven(table.program(), None)


def test_of_two_columns_for_one_pair_the_cheaper_counts() -> None:
    matrix = [[1, 1, 1, 0, 0], [0, 0, 0, 1, 1], [1, 1, 0, 1, 0], [0, 0, 1, 0, 1]]
    for cost in ([5, 2, 9, 9, 1], [2, 5, 9, 9, 1]):
        assert_proven(program(matrix, 1, cost, row_lower=[1, 1, -INF, -INF]), 3)


def test_a_maximisation_with_a_constant_is_proven_in_its_own_sense() -> None:
    matrix = Table(np.zeros((2, 2))).program().matrix.toarray()
    assert_proven(program(matrix, 1, [3, 1, 2, -4], sense="max", offset=10), 13)


@pytest.mark.parametrize(("maximum", "best"), [(1, None), (2, -5)])
def test_of_two_cardinalities_neither_is_forgotten(maximum: int, best: float | None) -> None:
    both = Table(np.zeros((2, 2))).program().matrix.toarray()
    matrix = np.vstack([both, np.ones((2, 4))])
    twice = program(
        matrix, [1, 1, 1, 1, 2, maximum], [-3, -1, 2, -2], row_lower=[-INF] * 4 + [2, 0]
    )
    structure = recognise(twice)
    if structure is not None and solve_assignment(twice, structure) is not None:
        assert_proven(twice, best)
    solution = solve_program(twice)
    assert solution.objective == best


def test_a_column_fixed_by_a_row_of_its_own_is_part_of_the_proof() -> None:
    """Without the pair of cost −9 the best is −1 and −2."""
    matrix = np.vstack([Table(np.zeros((2, 2))).program().matrix.toarray(), [1, 0, 0, 0]])
    fixed = program(matrix, [1, 1, 1, 1, 0], [-9, -1, -2, 0], row_lower=-INF)
    solution = solve_program(fixed, solver="lsa")
    if solution.status != "skipped":
        assert solution.status == "optimal"
        assert solution.objective == pytest.approx(-3)
        assert solution.bound == pytest.approx(-3)


@given(
    base=st.one_of(assignment_programs(), assignment_programs(most_edits=1)),
    data=st.data(),
)
@settings(max_examples=examples(200))
def test_the_solution_is_none_rather_than_a_wrong_one(base: Program, data: st.DataObject) -> None:
    if data.draw(st.booleans()):
        base = data.draw(edits(base))
    structure = recognise(base)
    answer = None if structure is None else solve_assignment(base, structure)
    if structure is None or answer is None:
        return
    x, duals = answer
    assert violations(base, x) == []
    assert base.value(x) == pytest.approx(best_value(base), abs=1e-9)
    bound = dual_bound(integral_relaxation(base, structure), duals)
    assert bound == pytest.approx(base.value(x), abs=1e-9)


@given(base=st.one_of(assignment_programs(most_edits=1), structured_programs()))
@settings(max_examples=examples(100))
def test_the_solver_lsa_proves_its_solution_or_skips_the_program(base: Program) -> None:
    solution = solve_program(base, solver="lsa")
    if solution.status == "infeasible":
        assert best_value(base) is None
    elif solution.status != "skipped":
        assert solution.status == "optimal"
        assert solution.objective == pytest.approx(best_value(base), abs=1e-9)
        assert solution.bound == pytest.approx(solution.objective, abs=1e-9)


def test_an_odd_cycle_is_skipped_by_the_solver_lsa() -> None:
    triangle = program([[1, 1, 0], [0, 1, 1], [1, 0, 1]], 1, -1)
    solution = solve_program(triangle, solver="lsa")
    assert solution.status == "skipped"
    assert "not recognised" in solution.message
    assert solution.values == {}
