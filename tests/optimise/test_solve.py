"""One call from a formulation and data to a checked answer: statuses, bounds, refusals, the cache."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import (
    INF,
    assert_solved_right,
    best_value,
    edits,
    problem,
    program,
    structured_programs,
)

from msmrta_opt.mission.errors import CheckError, InputError
from msmrta_opt.optimise.data import ClusterData
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve, solve_program
from msmrta_opt.optimise.solvers import Options, Outcome, get, solvers

both_ways = pytest.mark.parametrize("structure", [True, False])


def cluster_data() -> ClusterData:
    return ClusterData(np.array([[4.0, 1.0], [2.0, 2.0]]), np.zeros((2, 2)), np.full(2, 2))


def test_any_linear_problem_of_cvxpy_and_any_arrays_are_solved() -> None:
    """3 x0 + 5 x1 with x0 + x1 of at least two: twice the first, within its bound."""
    x, need = cp.Variable(2, integer=True, bounds=[0, 4], name="x"), cp.Parameter(name="need")
    asked = cp.Problem(cp.Minimize(np.array([3.0, 5.0]) @ x), [cp.sum(x) >= need])
    with pytest.raises(InputError, match="parameter need of the problem has no value"):
        solve(asked)
    need.value = 2
    found = solve(asked, solver="scip")
    assert (found.status, found.objective, found.check) == ("optimal", 6, "passed")
    assert found.values["x"].tolist() == [2, 0]
    assert (found.formulation, found.digest, found.parameters) == ("the cvxpy problem", "", {})
    assert solve(program([[1.0, 1.0]], INF, [3.0, 5.0], row_lower=2.0, upper=4.0)).objective == 6
    need.value = 9
    assert solve(asked).reason.endswith("; `explain` names the rows that conflict")
    with pytest.raises(InputError, match="give a formulation, a file, a program or a cvxpy"):
        solve(3)


def knapsacks(sense: str = "max", offset: float = 0.0) -> Program:
    """Hard enough that a solver which is stopped early has not proven its incumbent."""
    random = np.random.RandomState(0)
    weight = random.randint(0, 60, (30, 60)).astype(float)
    worth = random.randint(10, 60, 60) * (1 if sense == "max" else -1)
    return program(weight, weight.sum(axis=1) // 3, worth, sense=sense, offset=offset)  # type: ignore[arg-type]


# Statuses.


@both_ways
def test_a_program_without_a_feasible_point_is_infeasible(structure: bool) -> None:
    x = cp.Variable(2, boolean=True, name="x")
    solution = solve(problem(cp.Maximize(cp.sum(x)), [cp.sum(x) >= 3]), None, structure=structure)
    assert_solved_right(solution, None)
    assert solution.bound is None
    with pytest.raises(CheckError, match="infeasible"):
        solution.require()


@both_ways
def test_a_program_that_only_integrality_makes_infeasible_is_infeasible(structure: bool) -> None:
    x = cp.Variable(2, boolean=True, name="x")
    solution = solve(problem(cp.Minimize(x[0]), [2 * cp.sum(x) == 1]), None, structure=structure)
    assert_solved_right(solution, None)


@both_ways
@pytest.mark.parametrize("kind", [{"integer": True}, {}])
def test_a_program_without_a_best_point_is_unbounded(
    kind: dict[str, bool], structure: bool
) -> None:
    x = cp.Variable(2, name="x", **kind)
    solution = solve(problem(cp.Maximize(cp.sum(x)), [x[0] <= 3]), None, structure=structure)
    assert solution.status == "unbounded"
    assert solution.objective is None
    assert solution.values == {}


@both_ways
def test_unbounded_and_infeasible_at_once_is_infeasible(structure: bool) -> None:
    x = cp.Variable(2, integer=True, name="x")
    contradictory = problem(cp.Maximize(x[1]), [2 * x[0] == 1])
    assert_solved_right(solve(contradictory, None, structure=structure), None)


@both_ways
def test_no_time_leaves_no_solution_and_claims_nothing(structure: bool) -> None:
    solution = solve_program(knapsacks(), structure=structure, options=Options(time_limit=0))
    assert solution.status == "no_solution"
    assert solution.objective is None
    assert solution.values == {}
    assert solution.options == {"time_limit": 0}


@pytest.mark.parametrize(("sense", "offset"), [("min", 600.0), ("max", -600.0)])
def test_a_solution_within_a_gap_is_feasible_with_a_bound_in_the_models_own_sense(
    sense: str, offset: float
) -> None:
    """A constant is in the objective and in the bound, and no part of the gap."""
    hard = knapsacks(sense, offset)
    solution = solve_program(hard, options=Options(gap=0.5))
    assert solution.check == "passed"
    assert solution.objective is not None
    assert solution.bound is not None
    assert solution.gap is not None
    assert 0 < solution.gap <= 0.5
    assert hard.sign * (solution.objective - solution.bound) > 0
    assert solution.gap == pytest.approx(
        abs(solution.objective - solution.bound) / abs(solution.objective - offset)
    )
    # Stopped with an incumbent; "optimal" is for what is proven.
    assert solution.status == "feasible"
    assert solution.found


@both_ways
@pytest.mark.parametrize(("objective", "best"), [(cp.Maximize, 12.0), (cp.Minimize, 7.0)])
def test_objective_and_bound_are_in_the_models_own_sense_with_its_constant(
    objective: Callable[..., Any], best: float, structure: bool
) -> None:
    x = cp.Variable(3, boolean=True, name="x")
    worth = np.array([2, 3, -2])
    solution = solve(
        problem(objective(worth @ x + 9), [x[0] + x[1] <= 1]), None, structure=structure
    )
    assert_solved_right(solution, best)
    assert solution.gap == 0


@both_ways
@pytest.mark.parametrize(
    ("bounded", "best"),
    [
        # HiGHS' presolve is known to go wrong where integer columns have fractional bounds.
        (program([[1]], 1.5, -1, row_lower=1, upper=1.5), -1),
        (program([[-3, 0, 3], [0, 3, -1]], [4, 5], [3.5, 5, 0.5], row_lower=[-INF, 4],
                 upper=[2, 3.5, 1.5]), 10.5),
        (program([[-0.6, 0, 0]], -0.5, [-3, -1.4, -2.5], upper=[1.5, 2, 1]), -8.3),
        (program([[1, 0, 0]], INF, [0, 0, 3], row_lower=-15.5, lower=-20,
                 upper=[4.5, 20, 0]), -60),
    ],
)  # fmt: skip
def test_fractional_bounds_of_integer_columns_are_solved_right(
    bounded: Program, best: float, structure: bool
) -> None:
    assert best_value(bounded) == pytest.approx(best)
    assert_solved_right(solve_program(bounded, structure=structure), best)


ROUNDING = 0.1 + 0.2 - 0.3  # 6e-17


@both_ways
@pytest.mark.parametrize(
    "touching",
    [
        program([[0, 0], [1, 1]], [ROUNDING, 1], [-1, -2], row_lower=[ROUNDING, -INF]),
        program([[1, 1]], 1, [-1, -2], lower=[0.1 + 0.2, 0], upper=[0.3, 1], integer=[False, True]),
        program([[1, 1]], 0.3, [-1, -2], row_lower=0.1 + 0.2, integer=False),
        program([[1, 1]], 1, [-1, -2], lower=[1 + 1e-12, 0], upper=[1, 1]),
    ],
    ids=["row without entries", "bounds", "sides of a row", "bounds of an integer"],
)
def test_sides_that_cross_by_rounding_alone_are_no_contradiction(
    touching: Program, structure: bool
) -> None:
    solution = solve_program(touching, structure=structure)
    assert solution.status == "optimal"
    assert solution.check == "passed"


@given(base=structured_programs(), data=st.data())
@settings(max_examples=examples(150))
def test_fractions_anywhere_are_solved_right(base: Program, data: st.DataObject) -> None:
    fractions = st.sampled_from([0.0, 0.0, 0.5, 0.25])
    more = [data.draw(fractions) for _ in range(base.n_columns)]
    fractional = replace(data.draw(edits(base)), upper=base.upper + np.array(more))
    best = best_value(fractional)
    assert_solved_right(solve_program(fractional), best)
    assert_solved_right(solve_program(fractional, structure=False), best)


# What fails the check is never shown.

ONE_OF_TWO = program([[1, 1]], 1, [1, 2], sense="max")


@pytest.fixture
def liar(monkeypatch: pytest.MonkeyPatch) -> Callable[[Outcome], Solution]:
    """A solver that says what it is told to say, asked for the better of two columns, worth 2."""

    def answer(outcome: Outcome) -> Solution:
        said = replace(get("highs"), name="liar", run=lambda *_: outcome)
        monkeypatch.setitem(solvers(), "liar", said)
        return solve_program(ONE_OF_TWO, solver="liar")

    return answer


Liar = Callable[[Outcome], Solution]


@pytest.mark.parametrize(
    ("x", "said"),
    [
        ([1.0, 1.0], "row 'row 0' is missed by 1"),
        ([0.0, 0.5], "x[1] = 0.5 is not integral"),
        ([0.0, 7.0], "row 'row 0' is missed by 6"),
        ([-1.0, 1.0], "x[0] = -1 is outside its bounds"),
        ([-6.0, 7.0], "is outside its bounds"),
        ([0.0, np.nan], "not finite"),
        ([0.0, np.inf], "not finite"),
        ([0.0, 1.0, 0.0], "shape (3,)"),
        ([[0.0, 1.0]], "shape (1, 2)"),
    ],
)
@pytest.mark.parametrize("status", ["optimal", "feasible"])
def test_a_wrong_point_is_an_error_and_not_shown(
    liar: Liar, x: list[float], said: str, status: str
) -> None:
    solution = liar(Outcome(status, np.array(x), bound=2.0, proof="trust me"))  # type: ignore[arg-type]
    assert solution.status == "error"
    assert solution.objective is None
    assert solution.bound is None
    assert solution.gap is None
    assert solution.values == {}
    assert solution.proof == ""
    assert not solution.found
    assert said in solution.check
    with pytest.raises(CheckError):
        solution.require()


def test_a_bound_that_the_incumbent_beats_is_an_error_and_nothing_is_shown(liar: Liar) -> None:
    solution = liar(Outcome("optimal", np.array([0.0, 1.0]), bound=1.5))
    assert solution.status == "error"
    assert "bound 1.5" in solution.check
    assert solution.values == {}
    assert solution.objective is None


def test_a_solution_far_from_its_bound_is_not_optimal_whatever_the_solver_says(liar: Liar) -> None:
    solution = liar(Outcome("optimal", np.array([1.0, 0.0]), bound=2.0))
    assert solution.status == "feasible"
    assert (solution.objective, solution.bound) == (1, 2)


def test_a_bound_within_rounding_of_the_objective_closes_the_gap(liar: Liar) -> None:
    for bound in (2 + 1e-10, 2 - 1e-8):
        solution = liar(Outcome("optimal", np.array([1e-9, 1 - 1e-9]), bound=bound))
        assert solution.status == "optimal"
        assert solution.objective == solution.bound == 2
        assert solution.gap == 0
        assert solution.values["x"].tolist() == [0, 1]


def test_a_point_beside_another_status_is_not_shown(liar: Liar) -> None:
    for status in ("infeasible", "unbounded", "error", "skipped", "no_solution"):
        solution = liar(Outcome(status, np.array([0.0, 1.0]), message="so I say"))
        # That there is no point, or no best one, is refuted by looking at the few there are.
        refuted = status in ("infeasible", "unbounded")
        assert solution.status == ("contradicted" if refuted else status)
        assert solution.values == {}
        assert not solution.found
        with pytest.raises(CheckError):
            solution.require()


def test_an_assignment_that_its_duals_do_not_prove_is_solved_otherwise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def nobody(program: Program, _: object) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(program.n_columns), np.zeros(program.n_rows)

    monkeypatch.setattr("msmrta_opt.optimise.by_structure.solve_assignment", nobody)
    solution = solve("cluster_one_to_one", cluster_data(), psi=0)
    assert_solved_right(solution, 6)
    assert "simplex" in solution.proof


@both_ways
def test_a_start_may_be_partial_and_need_not_be_feasible(structure: bool) -> None:
    for start in (np.array([[1, np.nan], [np.nan, np.nan]]), np.ones((2, 2))):
        solution = solve(
            "cluster_one_to_one", cluster_data(), psi=0, start={"x": start}, structure=structure
        )
        assert_solved_right(solution, 6)
        assert solution.options == {"start": True}


# The record.


def test_a_solution_says_how_it_came_about() -> None:
    solution = solve("cluster_one_to_one", cluster_data(), psi=0.25, seed=3, structure=False)
    assert solution.formulation == "cluster_one_to_one"
    assert solution.parameters == {"psi": 0.25}
    assert solution.options == {"seed": 3}
    assert solution.sense == "max"
    assert solution.solver == "highs"
    assert solution.solver_version
    assert (solution.n_variables, solution.n_rows) == (4, 5)
    assert solution.proof == "branch and bound; all 16 points within the bounds"
    assert solution.nodes is not None


def test_the_proof_tells_how_the_matrix_decided() -> None:
    proofs = {
        solve("cluster_one_to_one", cluster_data()).proof: "assignment algorithm",
        solve("cluster_printed", cluster_data()).proof: "simplex",
        solve_program(program([[2, 2]], 3, [-2, -1]).relaxed()).proof: "LP duality",
        solve_program(program([[2, 2]], 2, [-2, -1])).proof: "integral vertex of the relaxation",
        solve_program(program([[2, 2]], 3, [-2, -1])).proof: "branch and bound; all 4 points",
    }
    for proof, word in proofs.items():
        assert word in proof


@both_ways
def test_a_solution_survives_pickling(structure: bool) -> None:
    solution = solve("cluster_one_to_one", cluster_data(), psi=0, structure=structure)
    again = pickle.loads(pickle.dumps(solution))
    assert isinstance(again, Solution)
    for name in solution.__dataclass_fields__:
        before, after = getattr(solution, name), getattr(again, name)
        if isinstance(before, dict):
            assert before.keys() == after.keys()
            assert all(np.array_equal(before[key], after[key]) for key in before)
        else:
            assert before == after


def test_duals_come_by_the_labels_of_their_rows() -> None:
    """A unit more of the row is worth 3, the price of the better column."""
    x = cp.Variable(2, name="x", nonneg=True)
    limit = (cp.sum(x) <= 4).set_label("what there is")
    solution = solve(problem(cp.Maximize(np.array([3, 2]) @ x), [limit]), None)
    assert solution.objective == pytest.approx(12)
    assert abs(float(solution.duals["what there is"])) == pytest.approx(3)
