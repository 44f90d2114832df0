"""Problems of cvxpy that know nothing of this package: explained, compared, solved and written."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.cvxpy_problems import CASES, Case, job_shop, knapsack

import msmrta_opt as mo
from msmrta_opt.mission.errors import InputError
from msmrta_opt.optimise.solve import solve_program


@pytest.fixture(params=list(CASES))
def case(request: pytest.FixtureRequest) -> Case:
    return CASES[request.param]


def test_the_optimum_is_that_of_the_hand_calculation(case: Case) -> None:
    found = mo.explain(case.build())
    assert found.status == "optimal"
    assert found.solution.objective == pytest.approx(case.optimum)
    assert found.optimum is not None
    assert {item.label for item in found.optimum.constraints} == {
        item.label for item in case.build().constraints
    }


def test_what_breaks_it_is_named_and_so_is_the_smallest_repair(case: Case) -> None:
    found = mo.explain(case.build(case.breaking))
    assert found.status == "infeasible"
    assert found.conflict is not None
    assert case.label in found.conflict.labels
    assert found.conflict.irreducible
    assert found.repair is not None
    assert found.repair.cost == pytest.approx(case.least_repair)
    assert found.repair.proof.startswith("proved")


def test_what_one_would_rather_have_costs_what_the_hand_calculation_says(case: Case) -> None:
    found = mo.explain(case.build(), why_not=case.why_not).why_not
    assert found is not None
    assert found.status == "costs"
    assert found.cost == pytest.approx(case.cost)
    assert sum(term.change for term in found.terms) == pytest.approx(
        (found.objective or 0) - case.optimum
    )


def test_the_rows_that_differ_are_those_that_hold_the_number(case: Case) -> None:
    found = mo.diff(case.build(), case.build(case.breaking))
    assert {row.label for row in found.rows} == {case.label}
    assert not (found.rows_a)
    assert not (found.rows_b)
    assert not (found.renamed)
    assert not (found.costs)
    assert not (found.domains)
    assert found.b_in_a.status == "infeasible"
    assert found.a_in_b.is_feasible is False
    assert found.optima_differ


def test_it_is_written_and_read_back(case: Case, tmp_path: Path) -> None:
    for name in ("p.mps", "p.lp"):
        mo.export(case.build(), tmp_path / name)
        value = solve_program(mo.read_program(tmp_path / name)).objective
        assert abs(value or 0) == pytest.approx(case.optimum)


def test_a_problem_without_a_file_is_not_written() -> None:
    with pytest.raises(InputError, match="path: no file; give one with the suffix"):
        mo.export(knapsack())
    with pytest.raises(InputError, match=r"unknown format '\.txt'"):
        mo.export(knapsack(), "p.txt")


def test_solvers_are_compared_on_any_problem() -> None:
    table = mo.compare_solvers(job_shop(), solvers=["auto", "highs", "lsa"]).set_index("solver")
    assert table.loc[["auto", "highs"], "objective"].tolist() == pytest.approx([7, 7])
    assert table.loc[["auto", "highs"], "agrees"].tolist() == [True, True]
    assert table.loc["lsa", "status"] == "skipped"
    assert table.loc["lsa", "message"]
    assert table.loc["lsa", "agrees"] is None
    infeasible = mo.compare_solvers(job_shop(6), solvers=["auto"])
    assert infeasible[["status", "agrees"]].values.tolist() == [["infeasible", True]]
    with pytest.raises(InputError, match="gurobo"):
        mo.compare_solvers(knapsack(), solvers=["gurobo"])
