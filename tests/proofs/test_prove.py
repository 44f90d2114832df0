"""Proofs of small programs: what they prove is true, and what is false they refute."""

from __future__ import annotations

import time
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import INF, best_value, program

from msmrta_opt.certify import vipr
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solution import Solution
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.proofs.prove import Proof, prove_program
from msmrta_opt.proofs.relaxation import Relaxation


def proved(given: Program, path: Path, claim: Solution | None = None, **options: Any) -> Proof:
    return prove_program(given, claim or solve_program(given), path / "proof.vipr", **options)


def claims(status: str, objective: float | None = None, x: list[float] | None = None) -> Solution:
    """What a solver might say."""
    values = {} if x is None else {"x": np.array(x)}
    return Solution("", status, "min", objective, values=values, solver="liar")  # type: ignore[arg-type]


@st.composite
def integer_programs(draw: st.DrawFn) -> Program:
    """Up to six variables and five rows, of whole, decimal and third coefficients, either sense."""
    n_rows, n_columns = draw(st.integers(1, 5)), draw(st.integers(1, 6))
    unit = draw(st.sampled_from([1.0, 0.1, 1 / 3, 2.0**-20, 1e6]))
    number = st.integers(-4, 5).map(lambda k: k * unit)
    rows = draw(st.lists(st.lists(number, min_size=n_columns, max_size=n_columns),
                         min_size=n_rows, max_size=n_rows))  # fmt: skip
    lower = draw(st.lists(st.sampled_from([0.0, 0.0, -1.0, -0.5]), min_size=n_columns,
                          max_size=n_columns))  # fmt: skip
    width = draw(st.lists(st.integers(0, 3), min_size=n_columns, max_size=n_columns))
    # Sides half a unit beside what points reach, so that rounding decides nothing.
    side = [(k + 0.5) * unit for k in draw(st.lists(st.integers(-6, 12), min_size=n_rows,
                                                    max_size=n_rows))]  # fmt: skip
    ranged = draw(st.lists(st.booleans(), min_size=n_rows, max_size=n_rows))
    lowest = [s - 4 * unit if r else -INF for s, r in zip(side, ranged, strict=True)]
    return program(
        rows, side, draw(st.lists(st.sampled_from([-3.0, -1.5, 0.0, 1.0, 1 / 3, 0.7, 2.0]),
                                  min_size=n_columns, max_size=n_columns)),
        row_lower=lowest, lower=lower, upper=np.add(lower, width),
        sense=draw(st.sampled_from(["min", "max"])), offset=draw(st.sampled_from([0.0, 7.0, -0.1])),
    )  # fmt: skip


@settings(max_examples=examples(60))
@given(integer_programs())
def test_the_optimum_of_brute_force_is_proved(tmp_path_factory: Any, given: Program) -> None:
    path = tmp_path_factory.getbasetemp()
    best = best_value(given)
    proof = proved(given, path)
    assert proof.contradiction == ""
    if best is None:
        assert proof.status == "infeasible"
    else:
        assert proof.status == "proved"
        assert proof.value == pytest.approx(best)
        assert proof.bound == pytest.approx(best)


@settings(max_examples=examples(25))
@given(integer_programs(), st.floats(0.2, 5.0))
def test_a_better_value_than_the_optimum_is_never_proved(
    tmp_path_factory: Any, given: Program, better: float
) -> None:
    best = best_value(given)
    claim = claims("optimal", 1.0 if best is None else best - given.sign * better)
    proof = proved(given, tmp_path_factory.getbasetemp(), claim)
    assert proof.contradiction
    if best is not None:
        assert proof.status == "proved"
        assert proof.value == pytest.approx(best)


@settings(max_examples=examples(25))
@given(integer_programs())
def test_a_claim_that_there_is_no_solution_is_refuted_by_one(
    tmp_path_factory: Any, given: Program
) -> None:
    proof = proved(given, tmp_path_factory.getbasetemp(), claims("infeasible"))
    best = best_value(given)
    assert bool(proof.contradiction) == (best is not None)
    assert proof.status == ("infeasible" if best is None else "proved")


@settings(max_examples=examples(25))
@given(integer_programs())
def test_a_solution_that_is_not_the_best_is_refuted_by_a_better_one(
    tmp_path_factory: Any, given: Program
) -> None:
    solution = solve_program(replace(given, cost=-given.cost))  # the worst one
    if not solution.found:
        return
    worst = given.value(np.concatenate([solution.values["x"]]))
    claim = replace(solution, objective=worst)
    proof = proved(given, tmp_path_factory.getbasetemp(), claim)
    best = best_value(given)
    assert proof.value == pytest.approx(best)
    assert bool(proof.contradiction) == (abs(worst - (best or 0.0)) > 1e-9)


def test_a_mixed_program_is_proved_by_hand(tmp_path: Path) -> None:
    # max 2 x + y over x + y ≤ 5/2, x whole, 0 ≤ x ≤ 3, 0 ≤ y ≤ 2: x = 2, y = 1/2, so 9/2.
    given = program([[1, 1]], [2.5], [2, 1], upper=[3, 2], integer=[True, False], sense="max")
    proof = proved(given, tmp_path)
    assert proof.status == "proved"
    assert proof.exact_value == proof.exact_bound == Fraction(9, 2)
    found = vipr.verify(proof.path)
    assert found.claim == "maximum in [9/2, 9/2] (about 4.5)"
    assert found.names == ["x[0]", "x[1]"]
    assert found.integer == {0}


def test_the_stated_program_is_the_compiled_one_number_by_number(tmp_path: Path) -> None:
    given = program(
        [[0.1, -2, 0], [1 / 3, 0, 1e-7]], [0.3, 5], [0.7, 0, -1], row_lower=[0.3, -1.5],
        upper=[4, INF, 0.5], lower=[-1, 0, -INF], integer=[True, True, False], offset=0.25,
    )  # fmt: skip
    found = vipr.verify(proved(given, tmp_path, claims("unbounded")).path)
    exact = [
        (item.sense, {j: Fraction(a, item.under) for j, a in item.terms.items()},
         Fraction(item.side, item.under)) for item in found.constraints
    ]  # fmt: skip
    assert exact == [
        (1, {0: 1}, -1), (-1, {0: 1}, 4), (1, {1: 1}, 0), (-1, {2: 1}, Fraction(1, 2)),
        (0, {3: 1}, 1),
        (0, {0: Fraction(0.1), 1: -2}, Fraction(0.3)),
        (1, {0: Fraction(1 / 3), 2: Fraction(1e-7)}, Fraction(-3, 2)),
        (-1, {0: Fraction(1 / 3), 2: Fraction(1e-7)}, 5),
    ]  # fmt: skip
    assert {j: Fraction(a, found.objective_under) for j, a in found.objective.items()} == {
        0: Fraction(0.7), 2: -1, 3: Fraction(1, 4)
    }  # fmt: skip
    assert found.names[3] == "objective_constant"
    assert found.integer == {0, 1, 3}


def test_unbounded_columns_are_paid_for_by_what_rows_imply_or_exactly(tmp_path: Path) -> None:
    # min T, T ≥ 3 a + 1, T ≥ 5 − 3 a, a free and continuous: T = 3 at a = 2/3.
    given = program(
        [[1, -3], [1, 3]],
        [INF, INF],
        [1, 0],
        row_lower=[1, 5],
        lower=-INF,
        upper=INF,
        integer=False,
    )
    proof = proved(given, tmp_path)
    assert (proof.exact_value, proof.exact_bound) == (3, 3)


def test_the_grid_of_costs_with_rounding_closes_the_gap(tmp_path: Path) -> None:
    # Nine thirds or a hundred: (100/3) Σ x over Σ x ≥ 5/2, as floats; three of them are 100.
    given = program([[1, 1, 1, 1]], [INF], [100 / 3] * 4, row_lower=[2.5])
    proof = proved(given, tmp_path)
    assert proof.status == "proved"
    assert proof.leaves == 1
    assert proof.bound == pytest.approx(100, abs=1e-10)


def test_cuts_prove_what_branching_would_take_long_for(tmp_path: Path) -> None:
    # 2 Σ x = 15 has no whole solution; branching alone looks at thousands of nodes.
    given = program([[2] * 15], [15], [1] * 15, row_lower=[15])
    proof = proved(given, tmp_path, claims("infeasible"))
    assert proof.status == "infeasible"
    assert proof.leaves < 50


def test_a_claim_within_rounding_of_feasible_is_not_accused(tmp_path: Path) -> None:
    # 0.1 + 0.2 is not 0.30000000000000004 in binary: x = (1, 1) misses the row by 3e-17.
    given = program([[0.1, 0.2]], [0.1 + 0.2], [1, 1], row_lower=[0.1 + 0.2])
    claim = solve_program(given)
    assert claim.objective == 2
    proof = proved(given, tmp_path, claim, numbers=["binary"])
    assert proof.contradiction == ""
    assert proof.status != "proved"
    assert proof.rounded
    assert "is missed by" in proof.remark


def test_decimals_are_meant_where_binary_fractions_do_not_fit(tmp_path: Path) -> None:
    # 0.1 x = 0.3 y holds for x = 3, y = 1 in decimals only.
    given = program([[0.1, -0.3]], [0.0], [-1, 0], row_lower=[0.0], upper=5)
    proof = proved(given, tmp_path)
    assert (proof.status, proof.value, proof.numbers) == ("proved", -3, "simple")
    assert "simplest fraction" in Path(proof.path).read_text()
    with_binary = proved(given, tmp_path, numbers=["binary"])
    assert with_binary.status == "partial"
    assert with_binary.contradiction == ""


def test_a_limit_leaves_a_partial_bound_that_says_so(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    given = program(rng.integers(5, 60, (6, 40)), [200] * 6, rng.integers(5, 60, 40), sense="max")
    best = solve_program(given)
    for limit in ({"time_limit": 0.0}, {"size_limit": 3_000}):
        proof = proved(given, tmp_path, best, **limit)
        assert proof.status == "partial"
        assert proof.value == best.objective
        assert proof.bound is None or proof.bound >= (best.objective or 0)
        assert proof.remark in ("time limit", "size limit")
        assert f"proved up to {'nothing' if proof.bound is None else ''}" in proof.summary
        vipr.verify(proof.path)


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("constant", [1e9, -1e12, 1e13])
def test_a_constant_proves_nothing_and_excuses_no_claim(
    tmp_path: Path, constant: float, fixed: bool
) -> None:
    """Whether it stands in the objective or is what a fixed variable costs."""
    rng = np.random.default_rng(5)
    rows = np.hstack([rng.integers(5, 60, (6, 40)), np.zeros((6, 1))])
    cost = np.append(rng.integers(5, 60, 40), constant if fixed else 0.0)
    lower = np.append(np.zeros(40), 1.0)
    offset = 0.0 if fixed else constant
    given = program(rows, [200] * 6, cost, lower=lower, offset=offset, sense="max")
    nothing = claims("optimal", constant, np.append(np.zeros(40), 1).tolist())
    proof = proved(given, tmp_path, nothing, time_limit=0.0)
    assert proof.status == "partial"
    assert proof.bound is None or proof.bound > constant + 100
    assert proved(given, tmp_path, nothing).contradiction


def test_a_claim_that_misses_the_optimum_by_a_step_is_convicted(tmp_path: Path) -> None:
    # x + y ≤ 2,000,000 in whole numbers: 3 x + 2 y is at most 6,000,000 at x = 2,000,000.
    given = program([[1, 1]], [2e6], [3, 2], upper=INF, sense="max")
    assert not proved(given, tmp_path, claims("optimal", 6e6, [2e6, 0])).contradiction
    false = proved(given, tmp_path, claims("optimal", 6e6 - 1, [2e6 - 1, 1]))
    assert "5999999 is optimal" in false.contradiction
    # Of continuous variables solvers allow themselves as much.
    relaxed = replace(given, integer=np.zeros(2, dtype=bool))
    assert not proved(relaxed, tmp_path, claims("optimal", 6e6 - 1, [2e6 - 1, 1])).contradiction


def test_an_interrupt_leaves_what_is_proved_by_then(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(5)
    given = program(rng.integers(5, 60, (6, 40)), [200] * 6, rng.integers(5, 60, 40), sense="max")
    best, solve, count = solve_program(given), Relaxation.solve, iter(range(10**9))

    def interrupted(self: Relaxation, **options: Any) -> Any:
        if next(count) == 40:
            raise KeyboardInterrupt
        return solve(self, **options)

    monkeypatch.setattr(Relaxation, "solve", interrupted)
    proof = proved(given, tmp_path, best)
    assert (proof.status, proof.remark) == ("partial", "interrupted")
    assert proof.bound is not None
    assert proof.bound >= (best.objective or 0)


def test_an_unbounded_program_is_said_to_have_nothing_to_prove(tmp_path: Path) -> None:
    given = program([[0]], [1], [-1], upper=INF)
    proof = proved(given, tmp_path)
    assert proof.status == "none"
    assert "unbounded" in proof.remark


@pytest.mark.parametrize(
    ("given", "claim", "best"),
    [
        # Big-M of 1e9: x = 1e-7 passes for 0, and y = 100 for allowed. The optimum is 0.9 at y = 100.
        (
            program([[1, -1e9]], [0], [-0.01, 0.1], upper=[100, 1], integer=[False, True]),
            claims("optimal", -1.0, [100, 0]), -0.9,
        ),
        # Badly scaled rows: 1e-9 x ≥ 0.7e-9 asks for x = 1, and absolute tolerances for nothing.
        (
            program([[1e-9, 0], [1e9, 1]], [INF, 1e9 + 1], [1, -1], row_lower=[0.7e-9, -INF]),
            claims("optimal", -1.0, [0, 1]), 0.0,
        ),
        # A presolve that loses the optimum: 17 instead of 22, at (1, 1, 1).
        (
            program([[3, 5, 4]], [12], [5, 9, 8], sense="max", upper=2),
            claims("optimal", 17.0, [0, 1, 1]), 22.0,
        ),
        # A feasible program that is called infeasible.
        (program([[2, 3]], [5], [1, 1], row_lower=[5]), claims("infeasible"), 2.0),
        # A solution that is none.
        (program([[2, 2]], [3], [1, 1], row_lower=[3]), claims("optimal", 1.5, [1, 0.5]), None),
    ],
)  # fmt: skip
def test_false_claims_are_convicted(
    tmp_path: Path, given: Program, claim: Solution, best: float | None
) -> None:
    proof = proved(given, tmp_path, claim)
    assert proof.contradiction
    assert "CONTRADICTED" in proof.summary
    assert proof.status == ("infeasible" if best is None else "proved")
    assert proof.value == pytest.approx(best) if best is not None else proof.value is None


def test_proofs_take_no_longer_than_they_say(tmp_path: Path) -> None:
    began = time.perf_counter()
    proof = proved(program([[1]], [1], [1]), tmp_path)
    assert 0 < proof.seconds + proof.check_seconds <= time.perf_counter() - began
    assert proof.size == Path(proof.path).stat().st_size
