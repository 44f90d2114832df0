"""What the recogniser proves is true, and what it does not prove is not used."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from support.amounts import examples
from support.programs import (
    INF,
    assert_solved_right,
    assignment_programs,
    best_value,
    edits,
    program,
    structured_matrices,
    structured_programs,
)

from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.structure import integral_relaxation, recognise

# Two robots, two victims; columns x00, x01, x10, x11.
ROBOTS = [[1, 1, 0, 0], [0, 0, 1, 1]]
VICTIMS = [[1, 0, 1, 0], [0, 1, 0, 1]]
ALL = [[1, 1, 1, 1]]
# Arcs s→a, s→b, a→b, a→t, b→t; flow is kept at a and b, one unit leaves s.
ARCS = [[1, 1, 0, 0, 0], [-1, 0, 1, 1, 0], [0, -1, -1, 0, 1]]
TRIANGLE = [[1, 1, 0], [0, 1, 1], [1, 0, 1]]
WINDOWS = [[1, 1, 1, 0, 0, 0], [0, 1, 1, 1, 0, 0], [0, 0, 1, 1, 1, 0], [0, 0, 0, 1, 1, 1]]
OUT_OF_ORDER = [0, 2, 1, 3]


def kind(program: Program) -> str | None:
    structure = recognise(program)
    return None if structure is None else structure.kind


@pytest.mark.parametrize(
    ("matrix", "row_lower", "row_upper", "phrase"),
    [
        (ROBOTS + VICTIMS, -INF, 1, "bipartite assignment rows: totally unimodular"),
        (VICTIMS, -INF, 1, "semi-assignment rows: totally unimodular"),
        (VICTIMS, 1, 1, "semi-assignment rows: totally unimodular"),
        (
            ROBOTS + VICTIMS + ALL,
            [-INF, -INF, -INF, -INF, 2],
            [1, 1, 1, 1, 2],
            "bipartite assignment rows and a cardinality: totally unimodular",
        ),
        (VICTIMS + ALL, -INF, 1, "semi-assignment rows and a cardinality: totally unimodular"),
    ],
    ids=["assignment", "semi-assignment", "cover", "cardinality", "cardinality alone"],
)
def test_assignments_are_recognised_and_named(
    matrix: list[list[int]], row_lower: float, row_upper: float, phrase: str
) -> None:
    structure = recognise(program(matrix, row_upper, [1, 2, 3, 4], row_lower=row_lower))
    assert structure is not None
    assert structure.kind == "bipartite"
    assert structure.description == phrase


def test_a_transport_with_any_whole_supplies_and_demands_is_bipartite() -> None:
    transport = program(
        ROBOTS + VICTIMS, [3, 4, INF, INF], 1, row_lower=[-INF, -INF, 2, 5], upper=9
    )
    assert kind(transport) == "bipartite"
    assert solve_program(transport).objective == pytest.approx(7)


def test_a_row_written_with_the_other_sign_is_still_bipartite() -> None:
    signs = np.array([[1], [-1], [1], [-1]])
    at_most_one = program(
        signs * np.array(ROBOTS + VICTIMS), [1, INF, 1, INF], -1, row_lower=[-INF, -1, -INF, -1]
    )
    assert kind(at_most_one) == "bipartite"
    assert solve_program(at_most_one).objective == pytest.approx(-2)


def test_the_rows_of_a_flow_are_a_network() -> None:
    shortest_path = program(ARCS, [1, 0, 0], [1, 4, 1, 5, 1], row_lower=[1, 0, 0])
    assert kind(shortest_path) == "network"
    assert solve_program(shortest_path).objective == pytest.approx(3)  # s, a, b, t


def test_a_network_may_lie_on_its_side() -> None:
    """Potentials: rows are differences of two columns."""
    differences = np.array(ARCS).T
    potentials = program(differences, [0, 1, 1, 2, 0], [1, -1, -2], lower=-3, upper=3)
    assert kind(potentials) == "network"
    assert_solved_right(solve_program(potentials), best_value(potentials))


@pytest.mark.parametrize(
    ("matrix", "lines"),
    [
        (np.array(WINDOWS)[OUT_OF_ORDER], "row"),
        (np.array(WINDOWS).T[:, OUT_OF_ORDER], "column"),
    ],
)
def test_consecutive_ones_are_intervals_in_rows_and_in_columns(
    matrix: NDArray[np.int64], lines: str
) -> None:
    cost = [3, 2, 4, 2, 3, 1][: matrix.shape[1]]
    cover = program(matrix, INF, cost, row_lower=1, upper=2)
    structure = recognise(cover)
    assert structure is not None
    assert structure.kind == "interval"
    assert f"each {lines} consecutive" in structure.description
    assert_solved_right(solve_program(cover), best_value(cover))


def test_a_row_with_one_entry_is_a_bound_whatever_its_coefficient() -> None:
    """2 x00 ≤ 1 makes x00 zero, −3 x01 ≤ −1 makes x01 one, and no coefficient matters any more."""
    rows = [*ROBOTS, *VICTIMS, [2, 0, 0, 0], [0, -3, 0, 0]]
    bounded = program(rows, [1, 1, 1, 1, 1, -1], [-5, 0, -3, -4])
    assert kind(bounded) == "bipartite"
    assert_solved_right(solve_program(bounded), -3)  # x01 and x10


def test_a_fixed_column_may_have_any_whole_coefficient() -> None:
    rows = np.array(ROBOTS + VICTIMS)
    rows[0, 0] = 2
    fixed = program(rows, [3, 1, 1, 1], [-1, -2, -3, -4], lower=[1, 0, 0, 0])
    assert kind(fixed) == "bipartite"
    assert_solved_right(solve_program(fixed), best_value(fixed))


def test_a_fractional_bound_of_an_integer_column_is_the_whole_number_within() -> None:
    transport = program(ROBOTS + VICTIMS, [3, 3, 3, 3], -1, upper=[1.5, 9, 9, 2.5])
    structure = recognise(transport)
    assert structure is not None
    assert integral_relaxation(transport, structure).upper.tolist() == [1, 9, 9, 2]
    assert_solved_right(solve_program(transport), -6)


ASSIGNMENT = {"matrix": np.array(ROBOTS + VICTIMS), "row_upper": np.ones(4), "cost": -np.ones(4)}


def edited(**changes: object) -> Program:
    return program(**(ASSIGNMENT | changes))  # type: ignore[arg-type]


def with_entry(row: int, column: int, value: float) -> NDArray[np.float64]:
    matrix = np.array(ROBOTS + VICTIMS, float)
    matrix[row, column] = value
    return matrix


@pytest.mark.parametrize(
    "broken",
    [
        edited(matrix=with_entry(0, 0, 2)),
        edited(matrix=with_entry(0, 0, 0.5)),
        # x00 and x11 exclude each other: an odd cycle with a robot and a victim.
        edited(matrix=np.array([*ROBOTS, *VICTIMS, [1, 0, 0, 1]]), row_upper=np.ones(5)),
        program(TRIANGLE, 1, -1),
        edited(row_upper=[1, 1, 1, 1.5]),
        edited(row_lower=[-INF, 0.5, -INF, -INF]),
        edited(upper=[0.5, 1, 1, 1], integer=[False, True, True, True]),
        edited(lower=[0.5, 0, 0, 0], integer=[False, True, True, True]),
    ],
    ids=[
        "coefficient 2",
        "coefficient 1/2",
        "third row per column",
        "odd cycle",
        "fractional right-hand side",
        "fractional left-hand side",
        "fractional upper bound",
        "fractional lower bound",
    ],
)
def test_an_edit_that_breaks_the_proof_is_refused(broken: Program) -> None:
    assert kind(edited()) == "bipartite"
    assert recognise(broken) is None


def test_an_odd_cycle_is_solved_as_the_integer_program_that_it_is() -> None:
    assert_solved_right(solve_program(program(TRIANGLE, 1, -1)), -1)  # the relaxation has −1.5


def test_columns_whose_bounds_cross_prove_nothing_and_are_infeasible() -> None:
    crossed = edited(lower=[1, 0, 0, 0], upper=[0, 1, 1, 1])
    assert recognise(crossed) is None
    assert_solved_right(solve_program(crossed), None)


def test_a_program_without_rows_or_without_free_columns_is_solved() -> None:
    assert_solved_right(solve_program(program(np.zeros((0, 2)), [], [-1, 2])), -1)
    assert_solved_right(solve_program(edited(upper=0)), 0)


def test_a_row_of_fixed_columns_alone_is_not_forgotten() -> None:
    nobody_for_victim_0 = edited(row_lower=[-INF, -INF, 1, -INF], upper=[0, 1, 0, 1])
    assert_solved_right(solve_program(nobody_for_victim_0), None)


@pytest.mark.parametrize("must", [-INF, 1])
def test_an_empty_row_that_asks_for_something_is_infeasible(must: float) -> None:
    matrix = np.array([*ROBOTS, *VICTIMS, [0, 0, 0, 0]])
    asking = edited(matrix=matrix, row_upper=np.ones(5), row_lower=[must, must, -INF, -INF, 1])
    assert_solved_right(solve_program(asking), None)


def subdeterminants(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    found = []
    for size in range(1, min(matrix.shape) + 1):
        rows = list(itertools.combinations(range(matrix.shape[0]), size))
        columns = list(itertools.combinations(range(matrix.shape[1]), size))
        squares = [matrix[np.ix_(r, c)] for r in rows for c in columns]
        found.append(np.linalg.det(np.array(squares)))
    return np.concatenate(found) if found else np.zeros(0)


def test_the_oracle_for_total_unimodularity_knows_an_odd_cycle() -> None:
    assert np.abs(subdeterminants(np.array(TRIANGLE, float))).max() == pytest.approx(2)


@given(matrix=structured_matrices())
@settings(max_examples=examples(250))
def test_a_recognised_matrix_is_totally_unimodular(matrix: NDArray[np.int64]) -> None:
    structure = recognise(program(matrix, 1, 0, upper=2))
    if structure is None:
        return
    determinants = subdeterminants(structure.core.matrix.toarray())
    assert np.all(np.abs(determinants) <= 1 + 1e-9)


@given(program=structured_programs())
@settings(max_examples=examples(150))
def test_a_recognised_relaxation_has_an_integral_vertex_of_the_same_worth(
    program: Program,
) -> None:
    structure = recognise(program)
    if structure is None:
        return
    relaxed = solve_program(integral_relaxation(program, structure))
    assert_solved_right(relaxed, best_value(program))
    if relaxed.found:
        x = relaxed.values["x"]
        np.testing.assert_allclose(x, np.round(x), atol=1e-6)


@given(program=structured_programs())
@settings(max_examples=examples(150))
def test_all_ways_of_solving_agree_with_enumeration(program: Program) -> None:
    best = best_value(program)
    assert_solved_right(solve_program(program), best)
    assert_solved_right(solve_program(program, structure=False), best)


@given(base=st.one_of(assignment_programs(), structured_programs()), data=st.data())
@settings(max_examples=examples(200))
def test_no_edit_makes_the_ways_of_solving_disagree(base: Program, data: st.DataObject) -> None:
    for _ in range(data.draw(st.integers(1, 3))):
        base = data.draw(edits(base))
    best = best_value(base)
    assert_solved_right(solve_program(base), best)
    assert_solved_right(solve_program(base, structure=False), best)
