"""What differs between two programs, and what becomes of each optimum in the other."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.programs import best_value, edits, feasible_points, program, structured_programs

import msmrta_opt as mo
from msmrta_opt.diagnosis.difference import diff
from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.program import Program


def pairs(maximum: int = 1, *, at_least: int = 1) -> cp.Problem:
    """Two robots and two clusters, worth 3 and 2, 1 and 1."""
    x = cp.Variable((2, 2), boolean=True, name="x")
    return cp.Problem(
        cp.Maximize(cp.sum(cp.multiply(np.array([[3.0, 2], [1, 1]]), x))),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x, axis=1) <= maximum).set_label("robot {r} keeps to its budget"),
            (cp.sum(x) >= at_least).set_label("some are taken"),
        ],
    )


def test_a_program_does_not_differ_from_itself() -> None:
    found = mo.diff(pairs(), pairs())
    assert found.is_none
    assert found.optima_differ is False
    assert found.text.splitlines()[0].endswith("are the same program.")


@pytest.mark.parametrize(
    ("programs", "given", "problem"),
    [
        (("victim_balanced", "victim_printed"), {"bta": 0.3}, r"bta: neither .* mean 'beta'\?\)"),
        (("victim_balanced", "victim_printed"), {"beta": 7}, "beta: 7; give a number from 0 to 1"),
        ((pairs(), "victim_printed"), {"psi": 0.3}, "psi: neither has such a parameter; .* beta"),
        ((pairs(), pairs(2)), {"beta": 0.3}, "there are none"),
    ],
)
def test_a_parameter_that_neither_program_has_is_refused(
    programs: tuple[Any, Any], given: dict[str, float], problem: str, paper: mo.Instance
) -> None:
    with pytest.raises(InputError, match=problem):
        mo.diff(*programs, mo.stage_data(paper, "victim"), **given)


@pytest.mark.parametrize("ask", [mo.solve, mo.explain, mo.export])
def test_parameters_of_what_is_no_formulation_are_refused(ask: Any, tmp_path: Path) -> None:
    path = [tmp_path / "a.lp"] if ask is mo.export else []
    for what in (pairs(), program([[1]], 1, 1)):
        with pytest.raises(InputError, match="psi: only formulations take parameters"):
            ask(what, None, *path, psi=0.3)


def test_a_formulation_that_gets_no_data_says_what_to_give() -> None:
    with pytest.raises(mo.ModelError, match=r"no data, give mo.stage_data\(mission, 'clu"):
        mo.diff(pairs(), "cluster_fair")


def test_a_start_that_is_no_mapping_is_refused() -> None:
    with pytest.raises(InputError, match="start: list; give arrays by variable, of x"):
        mo.solve(pairs(), start=[[1, 0], [0, 1]])


def test_a_side_that_differs_is_named_by_row_and_label_and_so_is_what_it_does() -> None:
    found = mo.diff(pairs(1), pairs(2))
    assert [(row.name, row.label, row.changes) for row in found.rows] == [
        (f"robot {r} keeps to its budget", "robot {r} keeps to its budget", ("≤ 1 → ≤ 2",))
        for r in (0, 1)
    ]
    assert not (found.rows_a)
    assert not (found.rows_b)
    assert not (found.costs)
    assert not (found.domains)
    assert not (found.renamed)
    # One each is worth 3 + 1, both by the first 3 + 2.
    assert (found.a_in_b.value, found.a_in_b.loss) == (4, 1)
    assert found.b_in_a.broken == ("robot 0 keeps to its budget, by 1",)
    assert found.optima_differ
    lines = found.text.splitlines()
    assert "  robot 0 keeps to its budget: ≤ 1 → ≤ 2" in lines
    assert lines[-1] == "  robot 0 keeps to its budget, by 1"


def test_a_row_written_the_other_way_round_or_scaled_is_the_same() -> None:
    x, y = cp.Variable(2, name="x"), cp.Variable(2, name="x")
    a = cp.Problem(cp.Minimize(x[0]), [(x[0] - x[1] >= 1).set_label("apart"), x[1] >= 0])
    b = cp.Problem(cp.Minimize(y[0]), [(2 * y[1] + 2 <= 2 * y[0]).set_label("apart"), y[1] >= 0])
    found = mo.diff(a, b)
    assert not found.rows
    assert found.is_none


def test_rows_that_say_the_same_under_two_names_are_told_as_renamed() -> None:
    a, b = pairs(), pairs()
    b.constraints[2].set_label("not nothing")
    found = mo.diff(a, b)
    assert found.renamed == (("some are taken", "not nothing"),)
    assert found.is_none


def test_variables_bounds_kinds_and_costs_that_differ_are_named() -> None:
    a = program([[1, 1]], 1, [1, 2], sense="max")
    b = program([[1, 1]], 1, [1, 5], upper=[1, 3], integer=[False, True], sense="max", offset=2)
    found = diff(a, b)
    assert [(item.name, item.changes) for item in found.domains] == [
        ("x[0]", ("integer → continuous",)),
        ("x[1]", ("≤ 1 → ≤ 3",)),
    ]
    assert [(item.name, item.changes) for item in found.costs] == [
        ("x[1]", ("2 → 5",)),
        ("constant", ("0 → 2",)),
    ]
    wider = diff(a, program([[1, 1, 1]], 1, 1))
    assert (wider.variables_a, wider.variables_b) == ((), ("x[2]",))
    assert wider.sense == ("max", "min")


def test_continuous_variables_follow_the_integers_that_are_kept() -> None:
    def load(times: list[float]) -> cp.Problem:
        x = cp.Variable((2, 3), boolean=True, name="x")
        longest = cp.Variable(name="longest")
        return cp.Problem(
            cp.Minimize(longest),
            [
                (cp.sum(x, axis=0) == 1).set_label("job {j} has a machine"),
                (x @ np.array(times) <= longest).set_label("machine {m} ends by the longest"),
            ],
        )

    # With 3, 2, 2 it is 3 against 2 + 2; in the other 3 against 2 + 6, where 6 against 3 + 2 is best.
    found = mo.diff(load([3, 2, 2]), load([3, 2, 6]))
    assert (found.a_in_b.value, found.a_in_b.is_feasible) == (4, True)
    assert found.a_in_b.loss in (pytest.approx(2), pytest.approx(0))
    assert {row.changes for row in found.rows} == {("x[0,2]: 2 → 6",), ("x[1,2]: 2 → 6",)}


def test_an_infeasible_program_has_no_optimum_to_try() -> None:
    found = mo.diff(pairs(), pairs(at_least=3))
    assert found.b_in_a.value is None
    assert found.b_in_a.status == "infeasible"
    assert found.optima_differ
    assert found.a_in_b.broken == ("some are taken, by 1",)
    assert "has no optimum to try" in found.text


@settings(max_examples=examples(80))
@given(data=st.data())
def test_what_becomes_of_an_optimum_is_what_all_points_say(data: st.DataObject) -> None:
    a: Program = data.draw(structured_programs())
    b: Program = data.draw(edits(a))
    found = diff(a, b)
    best = best_value(a), best_value(b)
    for tried, there, of, other in (
        (found.a_in_b, b, best[0], best[1]),
        (found.b_in_a, a, best[1], best[0]),
    ):
        if of is None:
            assert tried.value is None
            continue
        assert tried.value == pytest.approx(of)
        if other is None:
            assert tried.is_feasible is False
        if tried.is_feasible:
            assert tried.loss == pytest.approx(abs((tried.value_there or 0) - (other or 0)))
            assert len(feasible_points(there))
        else:
            assert tried.broken
    if found.is_none:
        assert best[0] == best[1]


def test_rows_of_one_name_are_told_apart() -> None:
    x = cp.Variable(2, name="x")
    rows = [(x[0] >= 1).set_label("low"), (x[1] >= 1).set_label("low")]
    more = [rows[0], (x[1] >= 2).set_label("low")]
    found = mo.diff(
        cp.Problem(cp.Minimize(cp.sum(x)), rows), cp.Problem(cp.Minimize(cp.sum(x)), more)
    )
    assert [(row.name, row.changes) for row in found.rows] == [("low (2)", ("≥ 1 → ≥ 2",))]


def test_all_of_it_is_json() -> None:
    for found in (mo.diff(pairs(1), pairs(2)), mo.diff(pairs(), pairs(at_least=3))):
        document = found.as_dict()
        assert json.loads(json.dumps(document, allow_nan=False))["optima_differ"] is True


def test_without_time_nothing_is_claimed_of_the_optima() -> None:
    trial = program(np.ones((3, 12)), [5, 5, 5], 1, row_lower=[1, 1, 1])
    found = diff(trial, replace(trial, cost=2 * trial.cost), time_limit=0.0)
    assert found.costs
    assert found.a_in_b.is_feasible is None
    assert found.optima_differ is None


def test_wrong_names_are_one_line() -> None:
    with pytest.raises(InputError, match="no formulation 'nothing'"):
        mo.diff("nothing", pairs())
