"""All that is said of a program at once, whatever it comes from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from support.programs import program

import msmrta_opt as mo
from msmrta_opt.mission.errors import InputError, ModelError
from msmrta_opt.optimise.export import write_program
from msmrta_opt.optimise.subject import subject


def shift() -> cp.Problem:
    """Three people, two of whom are needed on each of two days, at most one day each."""
    x = cp.Variable((3, 2), boolean=True, name="x")
    need = cp.Parameter(2, value=[2.0, 2.0], name="need")
    return cp.Problem(
        cp.Minimize(cp.sum(x)),
        [
            (cp.sum(x, axis=0) >= need).set_label("day {d} has enough people"),
            cp.sum(x, axis=1) <= 1,
        ],
    )


def test_a_problem_is_explained_by_its_labels_and_else_by_text_and_index() -> None:
    found = mo.explain(shift())
    assert found.status == "infeasible"
    assert found.conflict is not None
    assert found.conflict.rows == (
        "day 0 has enough people",
        "day 1 has enough people",
        *(f"constraint 2[{i}]: Sum(x, 1, False) <= 1.0" for i in range(3)),
    )
    assert found.repair is not None
    assert found.repair.cost == 1
    assert "These cannot hold together" in found.text
    assert "Smallest repair, of cost 1" in str(found)


def test_values_of_parameters_are_taken_as_they_are() -> None:
    problem = shift()
    problem.param_dict["need"].value = np.array([2.0, 1.0])
    found = mo.explain(problem)
    assert (found.status, found.solution.objective) == ("optimal", 3)
    problem.param_dict["need"].value = None
    with pytest.raises(InputError, match="parameter need of the problem has no value; set it"):
        mo.explain(problem)


def test_what_is_no_linear_program_is_one_line() -> None:
    x = cp.Variable(2)
    with pytest.raises(ModelError, match="not a linear integer program"):
        mo.explain(cp.Problem(cp.Minimize(cp.sum_squares(x))))
    with pytest.raises(InputError, match="int; give a formulation, a file, a program or a cvxpy"):
        mo.explain(3)


def test_maxima_and_absolute_values_are_explained_too() -> None:
    x = cp.Variable(2, name="x")
    far = (cp.abs(x[0] - x[1]) <= 1).set_label("close together")
    found = mo.explain(cp.Problem(cp.Minimize(cp.max(x)), [far, x[0] >= 3, x[1] <= 1]))
    assert found.status == "infeasible"
    assert found.conflict is not None
    assert any("close together" in row or "auxiliary" in row for row in found.conflict.rows)
    assert "constraint 3: x[1] <= 1.0" in found.conflict.rows


def test_an_unbounded_program_is_said_to_be_so() -> None:
    x = cp.Variable(name="x")
    found = mo.explain(cp.Problem(cp.Maximize(x), [x >= 0]))
    assert found.status == "unbounded"
    assert "is unbounded" in found.text


def test_a_file_and_arrays_are_explained(tmp_path: Path) -> None:
    trial = program([[1, 2]], 2, [3, 4], sense="max")
    write_program(trial, tmp_path / "p.mps")
    by_file, by_arrays = mo.explain(tmp_path / "p.mps"), mo.explain(trial)
    assert by_arrays.solution.objective == 4
    assert abs(by_file.solution.objective or 0) == 4


def test_all_of_it_is_json(tmp_path: Path) -> None:
    def walk(document: Any) -> None:
        assert json.loads(json.dumps(document, allow_nan=False)) == document

    walk(mo.explain(shift()).as_dict())
    walk(mo.explain(program([[1, 1]], 1, [1, 2], sense="max")).as_dict())
    walk(mo.explain(program([[1, 1]], 1, [1, 2], sense="max"), why_not="x[0]=1").as_dict())


def test_without_time_what_is_not_known_is_not_said() -> None:
    found = mo.explain(program(np.ones((5, 20)), [3] * 5, 1, row_lower=[3] * 5), time_limit=0.0)
    assert found.status in ("unknown", "feasible")
    assert found.optimum is None or found.optimum.ranges == ()


def test_a_negative_limit_is_refused_before_any_work() -> None:
    with pytest.raises(InputError, match="time_limit: -1; give seconds, 0 or more"):
        mo.explain(program([[1]], 1, 1), time_limit=-1)


def test_labels_stay_where_parameters_get_their_values() -> None:
    rows = subject(shift()).program.rows
    assert [block.name for block in rows] == ["day {d} has enough people", "constraint 2"]


def test_texts_have_no_braces_and_no_arrays_of_numbers() -> None:
    x = cp.Variable(30, name="{x}")
    asked = subject(cp.Problem(cp.Minimize(x[0]), [np.arange(30.0) @ x >= 1, x >= np.ones(30)]))
    assert [block.name for block in asked.described.rows] == [
        "constraint 1: 1.0 <= […] @ (x)",
        "constraint 2[{0}]: […] <= (x)",
    ]
    assert asked.described.row_name(3) == "constraint 2[2]: […] <= (x)"


def test_one_unit_of_hundreds_of_millions_is_explained_and_repaired_to_the_unit() -> None:
    # 22 tasks of 14,400,000 are all to be done, and the shift is one unit too short.
    n, task = 22, 14_400_000.0
    x = cp.Variable(n, boolean=True, name="x")
    shift = (np.full(n, task) @ x <= n * task - 1).set_label("the shift")
    asked = cp.Problem(cp.Minimize(cp.sum(x)), [(x >= 1).set_label("task {i} is done"), shift])
    told = str(mo.explain(asked))
    assert "the shift: ≤ 316800000 instead of ≤ 316799999" in told
    assert "task 0 is done" in told
