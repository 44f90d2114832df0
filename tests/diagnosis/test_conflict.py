"""Why programs are infeasible: sets of constraints that conflict, none of which can be spared."""

from __future__ import annotations

import itertools
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from support.conflicts import assert_explained
from support.programs import INF, formulation, problem, program

from msmrta_opt.diagnosis import conflict as module
from msmrta_opt.diagnosis.conflict import Conflict, find_conflict
from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.data import ClusterData
from msmrta_opt.optimise.formulation import Parameter
from msmrta_opt.optimise.subject import subject


def conflict_of(what: Any, data: Any = None, **parameters: float) -> Conflict:
    asked = subject(what, data, **parameters)
    return find_conflict(asked.program, name=asked.name)


def test_two_rows_that_conflict_are_found_among_many() -> None:
    # Rows 0 to 8 each say x_i + x_(i+1) ≤ 1, row 9 that x_3 + x_4 ≥ 2.
    rows = [[float(j in (i, i + 1)) for j in range(10)] for i in range(9)]
    rows.append([float(j in (3, 4)) for j in range(10)])
    trial = program(rows, [1] * 9 + [INF], 1, row_lower=[-INF] * 9 + [2])
    found = find_conflict(trial)
    assert found.rows == ("row 3", "row 9")
    assert found.bounds == ()
    assert found.labels == ("row {i}",)
    assert not found.integrality
    assert_explained(trial, found)


def test_a_bound_against_a_row_is_named_with_its_side() -> None:
    found = find_conflict(program([[1, 1, 0]], INF, 1, row_lower=[2], upper=[1, 0, 1]))
    assert found.rows == ("row 0",)
    assert found.bounds == ("x[0] ≤ 1", "x[1] ≤ 0")


def test_a_fixed_variable_is_named_once() -> None:
    # x0 = 1 fixed against both x0 + x1 ≤ 1.5 with x1 ≥ 1, and nothing else.
    trial = program([[1, 1]], [1.5], 1, lower=[1, 1], upper=[1, INF], integer=False)
    assert find_conflict(trial).bounds == ("x[0] ≥ 1", "x[1] ≥ 1")
    # 1 ≤ x0 - x1 ≤ 1 with x1 free but x0 + x1 = 0 leaves x0 = ½, and x0 = 0 is at odds.
    trial = program([[1, -1], [1, 1]], [1, 0], 1, row_lower=[1, 0], lower=[0, -INF], upper=[0, INF])
    assert find_conflict(trial.relaxed()).bounds == ("x[0] ≤ 0",)


def test_bounds_that_cross_explain_themselves() -> None:
    found = find_conflict(program([[1, 1]], 1, 1, lower=[2, 0], upper=[1, 1], integer=False))
    assert found.rows == ()
    assert found.bounds == ("2 ≤ x[0] ≤ 1",)


def test_bounds_without_a_whole_number_between_them_explain_themselves() -> None:
    found = find_conflict(program([[1, 1]], 2, 1, lower=[0.3, 0], upper=[0.7, 1]))
    assert found.rows == ()
    assert found.bounds == ("0.3 ≤ x[0] ≤ 0.7",)
    assert found.integrality


def test_a_row_that_says_nothing_true_explains_itself() -> None:
    found = find_conflict(program([[0, 0], [1, 1]], [INF, 1], 1, row_lower=[1, -INF]))
    assert found.rows == ("row 0",)
    assert found.bounds == ()


@pytest.mark.parametrize("side", [1e-8, 1.0])
def test_a_row_without_variables_explains_itself_however_little_it_asks_for(side: float) -> None:
    found = find_conflict(program([[1, 1], [0, 0]], [2, INF], 1, row_lower=[-INF, side]))
    assert (found.rows, found.bounds, found.irreducible) == (("row 1",), (), True)


def test_half_a_unit_is_a_conflict_in_whole_numbers() -> None:
    found = find_conflict(program([[2, 0], [1, 1]], [1, 1], 1, row_lower=[1, 0]))
    assert found.rows == ("row 0",)
    assert found.bounds == ()
    assert found.integrality
    assert found.irreducible


def test_an_odd_cycle_is_a_conflict_in_whole_numbers() -> None:
    # Of 0-1, 1-2, 2-0 each exactly one end: possible with halves only. 2-3 is no part of it.
    x = cp.Variable(4, boolean=True, name="x")
    ends = [(0, 1), (1, 2), (2, 0), (2, 3)]
    edges = [(x[i] + x[j] == 1).set_label(f"one of {i} and {j}") for i, j in ends]
    found = conflict_of(problem(cp.Minimize(cp.sum(x)), edges), None)
    assert found.rows == found.labels == ("one of 0 and 1", "one of 1 and 2", "one of 2 and 0")
    assert found.bounds == ()
    assert found.integrality
    assert found.irreducible


def test_a_label_that_is_not_needed_is_left_out_of_a_conflict_in_whole_numbers() -> None:
    # Three triangles; only of the second each edge has exactly one end, which is impossible.
    x = cp.Variable((3, 3), boolean=True, name="x")
    constraints = [
        (cp.sum(x, axis=1) <= 2).set_label("triangle {t} has at most two"),
        (x + cp.hstack([x[:, 1:], x[:, :1]]) >= 0).set_label("edge {t},{e} has any"),
        (x[1] + cp.hstack([x[1, 1:], x[1, :1]]) == 1).set_label("edge {e} of 1 has one"),
    ]
    found = conflict_of(problem(cp.Minimize(cp.sum(x)), constraints), None)
    assert found.rows == tuple(f"edge {e} of 1 has one" for e in range(3))
    assert found.labels == ("edge {e} of 1 has one",)


def test_two_robots_cannot_take_three_victims_one_to_one() -> None:
    x = cp.Variable((2, 3), boolean=True, name="x")
    constraints = [
        (cp.sum(x, axis=0) == 1).set_label("victim {v} has one robot"),
        (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one victim"),
    ]
    found = conflict_of(problem(cp.Minimize(cp.sum(x)), constraints), None)
    assert found.rows == (
        "victim 0 has one robot",
        "victim 1 has one robot",
        "victim 2 has one robot",
        "robot 0 has at most one victim",
        "robot 1 has at most one victim",
    )
    assert found.labels == ("victim {v} has one robot", "robot {r} has at most one victim")
    assert found.bounds == ()
    assert not found.integrality


def test_a_parameter_decides_whether_there_is_a_conflict() -> None:
    def build(data: object) -> cp.Problem:
        need = cp.Parameter(nonneg=True, name="need")
        x = cp.Variable(2, boolean=True, name="x")
        return cp.Problem(cp.Minimize(cp.sum(x)), [(cp.sum(x) >= need).set_label("enough")])

    trial = formulation(build, need=Parameter(0, 9, 1, "how many"))
    assert conflict_of(trial, None).status == "feasible"
    found = conflict_of(trial, None, need=3)
    assert found.rows == ("enough",)
    assert found.bounds == ("x[0] ≤ 1", "x[1] ≤ 1")


def test_a_feasible_formulation_is_said_to_be_so() -> None:
    ones = np.ones((2, 2))
    found = conflict_of("cluster_one_to_one", ClusterData(ones, ones, np.array([1, 1])))
    assert found.status == "feasible"
    assert found.rows == found.bounds == found.labels == ()
    assert found.text == "cluster_one_to_one is feasible."


def test_an_unbounded_program_is_feasible() -> None:
    trial = program([[1, -1]], INF, 1, row_lower=[0], upper=INF, sense="max")
    assert find_conflict(trial).status == "feasible"
    assert find_conflict(trial.relaxed()).status == "feasible"


def test_the_text_names_every_kind_of_member_and_counts_many_of_a_kind() -> None:
    found = find_conflict(program([[1] * 9], INF, 1, row_lower=[10]), name="trial")
    assert found.text.splitlines() == [
        "trial is infeasible. These cannot hold together; "
        "without any one of them, fractional values satisfy the others:",
        "  row 0",
        "  x[0] ≤ 1",
        "  x[1] ≤ 1",
        "  … and 7 more like these",
        "Found by: Farkas multipliers, then deletion filter with linear programs.",
    ]
    halves = find_conflict(program([[2]], 1, 1, row_lower=[1]), name="trial").text.splitlines()
    assert halves == [
        "trial is infeasible. These cannot hold together in whole numbers; "
        "without any one of them, whole numbers satisfy the others:",
        "  row 0",
        "Found by: deletion filter with integer programs.",
    ]


@pytest.mark.parametrize("integer", [False, True])
def test_whenever_the_time_is_up_what_is_left_conflicts(
    integer: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # An odd cycle and two rows beside it; in fractions x0 + x2 = 1.5 against 0.6 and 0.8.
    rows = [[1, 1, 0, 0], [0, 1, 1, 0], [1, 0, 1, 0], [0, 0, 1, 1], [1, 1, 1, 1]]
    minimum = np.array([1, 1, 1 if integer else 1.5, 0, 0])
    trial = program(rows, [*minimum[:3], 2, 4], 1, row_lower=minimum)
    if not integer:
        trial = replace(trial, upper=np.array([0.6, 1, 0.8, 1])).relaxed()
    outcomes = set()
    for time_limit in range(0, 60, 2):
        # Each look at the clock takes a second, so that time runs out at every step in turn.
        clock = itertools.count()
        ticking = SimpleNamespace(perf_counter=lambda clock=clock: float(next(clock)))
        monkeypatch.setattr(module, "time", ticking)
        found = find_conflict(trial, time_limit=time_limit)
        outcomes.add((found.status, found.irreducible))
        if found.status == "infeasible":
            assert_explained(trial, found, irreducible=found.irreducible)
            assert ("not known whether all of them are" in found.text) != found.irreducible
        else:
            assert found.text.endswith("stopped before it was known to be infeasible.")
    assert outcomes == {("unknown", False), ("infeasible", False), ("infeasible", True)}


def test_without_time_nothing_is_claimed() -> None:
    found = find_conflict(program([[2]], 1, 1, row_lower=[1]), time_limit=0.0)
    assert found.status == "unknown"
    assert not found.irreducible


def test_a_negative_time_limit_is_refused() -> None:
    with pytest.raises(InputError, match="time_limit: -1"):
        find_conflict(program([[1]], 1, 1), time_limit=-1)


def test_a_bound_that_cannot_be_decided_stays_and_is_admitted() -> None:
    # 4 z - 6 y is even, so never 1, whatever the bounds; but without them branching need not end.
    found = find_conflict(program([[-6, 4]], 1, 1, row_lower=1, upper=3))
    assert found.status == "infeasible"
    assert found.rows == ("row 0",)
    assert found.irreducible == (found.bounds == ())


def test_a_conflict_of_highs_that_is_none_is_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    trial = program([[1, 1], [1, 0]], INF, 1, row_lower=[3, 0])
    monkeypatch.setattr(
        module._System, "conflict_by_multipliers", lambda system: np.zeros_like(system.everything)
    )
    found = find_conflict(trial)
    assert found.rows == ("row 0",)
    assert found.bounds == ("x[0] ≤ 1", "x[1] ≤ 1")
    assert found.method == "deletion filter with linear programs"


def test_what_only_tolerances_satisfy_is_no_proof_that_a_member_is_needed() -> None:
    # Row 1 has x₀ ≤ 0 wherever x₁ ≤ 1, so row 0 reaches 10, whatever x₂ may be. But with x₀ = 2e-4 the
    # rows are missed by 4e-7 only, and whatever one leaves out, solvers have such a point.
    trial = program(
        [
            [4e3, 10, -0.1, 0, 0, 0, -0.01, -0.3, -40, 2, 4e4, 0, 3e-3, 0.3, 0],
            [2e-3, -40, 0, 0, 0, 3e-4, 0, 0, -3e4, 0, -4e3, 1e3, 0, -2e-4, -1e-4],
        ],
        [INF, -40],
        [100, -10, 0.03, 400, 1e-3, -2, 4e-4, -1, -4e4, 0, 0.3, 0, 10, 20, 3e-3],
        row_lower=[10.775, -40],
        upper=[1, 1, 1, 1, 1, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0],
        integer=[j != 7 for j in range(15)],
    )
    found = find_conflict(trial)
    assert {"row 0", "row 1"} <= set(found.rows)
    assert found.irreducible <= ("0 ≤ x[2] ≤ 1" not in found.bounds)


def test_a_point_that_misses_a_row_by_a_part_in_a_thousand_million_proves_no_member_needed() -> (
    None
):
    # With x₀ = -2, x₂ ≤ -3 by row 1, and row 0 asks for x₃ > 2, whatever x₃ is at least. But with
    # x₂ = -2.999999 row 1 is missed by 2e-7 of its 400, and row 0 is content.
    trial = program(
        [[-0.03, -1e-4, -100, -0.01, -100], [-200, 0, -0.2, 0, 10], [-3, 1, 0, -1, 0]],
        [600.0400999999999, INF, 2],
        0,
        row_lower=[-INF, 370.6, -INF],
        lower=[-2, -3, -3, 0, -3],
        upper=[-2, -1, -2, 2, -3],
    )
    found = find_conflict(trial)
    assert {"row 0", "row 1"} <= set(found.rows)
    assert found.irreducible <= ("0 ≤ x[3] ≤ 2" not in found.bounds)


def test_the_same_program_is_always_explained_the_same() -> None:
    trial = program(np.ones((6, 4)), INF, 1, row_lower=[5, 5, 5, 6, 6, 6])
    assert len({find_conflict(trial) for _ in range(3)}) == 1


def test_what_no_whole_numbers_without_bounds_satisfy_is_found_out() -> None:
    # -2 x + 2 y - 2 z = 1 is odd against even, wherever x and z may go.
    trial = program(
        [[-2, 2, -2], [-2, 3, 0]], [1, 3], 1,
        row_lower=[1, -INF], lower=[-1, -1, -INF], upper=[INF, 1, 1],
    )  # fmt: skip
    found = find_conflict(trial)
    assert found.rows == ("row 0",)
    assert found.bounds == ()
    assert found.integrality
    assert found.irreducible
