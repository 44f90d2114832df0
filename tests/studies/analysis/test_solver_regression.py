"""The project's own solver regression: shipped formulations × installed solvers × small missions.

Every solve is compared with the others of its program, and with `BASELINE`. After a change that is
meant to change answers, write the baseline again, and read the difference before it is committed::

    python tests/studies/test_solver_regression.py
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from msmrta_opt import formulations
from msmrta_opt.optimise import registry
from msmrta_opt.optimise.solve import AUTO
from msmrta_opt.optimise.solvers import solvers
from msmrta_opt.stages.data import STAGES, stage_data
from msmrta_opt.studies import compare as study
from msmrta_opt.studies.analysis.regression import changes, read_baseline, save_baseline
from msmrta_opt.studies.compare import cases, read_instances, solve_here
from msmrta_opt.studies.rows import Row, disagreements

ROOT = Path(__file__).parents[3]
BASELINE = ROOT / "tests" / "data" / "solver_baseline.json"
MISSIONS = ("corridor", "two_rooms", "split", "sum_or_max", "paper")
LONG = ("routing", "paper")
FREE = (AUTO, "highs", "scip", "cpsat", "glpk", "lsa")
COMMERCIAL = ("gurobi", "cplex", "xpress", "copt", "mosek")


def solve_all(names: tuple[str, ...]) -> list[Row]:
    """All programs by the solvers `names`, without what differs from machine to machine."""
    missions = read_instances([ROOT / "instances" / f"{name}.json" for name in MISSIONS])
    shipped = Path(formulations.__path__[0])
    rows = []
    with pytest.MonkeyPatch.context() as patch:
        # All solve the same arrays, so each mission's are worked out and canonicalised once.
        made = cache(lambda i, stage: stage_data(missions[i], stage))
        patch.setattr(study, "stage_data", lambda i, stage, _: made(missions.index(i), stage))
        for stage in STAGES:
            models = [item.name for item in registry.listings(stage) if item.path.parent == shipped]
            # GLPK takes a quarter of a minute for the routes of the paper's mission.
            small = [mission for mission in missions if (stage, mission.name) != LONG]
            todo = cases(small, stage=stage, models=models, solver_names=names)
            rows += [solve_here(case) for case in todo]
    return [
        replace(
            row,
            canonicalise_seconds=None,
            solve_seconds=None,
            total_seconds=None,
            nodes=None,
            solver_version="",
            machine="",
        )
        for row in rows
    ]


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return solve_all(FREE)


def test_every_solver_of_the_registry_is_free_or_commercial() -> None:
    assert {AUTO, *solvers()} == {*FREE, *COMMERCIAL}


def test_solvers_agree_on_every_program(rows: list[Row]) -> None:
    assert disagreements(rows) == []


def test_every_answer_passed_its_check(rows: list[Row]) -> None:
    answered = [row for row in rows if row.status in ("optimal", "feasible")]
    assert {row.check for row in answered} == {"passed"}


def test_nothing_fails(rows: list[Row]) -> None:
    assert [row for row in rows if row.status == "error"] == []


@pytest.mark.parametrize("name", FREE)
def test_no_free_solver_is_skipped_everywhere(rows: list[Row], name: str) -> None:
    proven = [row for row in rows if row.solver == name and row.status == "optimal"]
    assert proven, {row.message for row in rows if row.solver == name}


def test_a_skip_says_why(rows: list[Row]) -> None:
    assert all(row.message for row in rows if row.status == "skipped")


@pytest.mark.parametrize("name", [AUTO, "highs", "scip", "glpk"])
def test_solvers_of_every_kind_of_program_skip_none(rows: list[Row], name: str) -> None:
    assert [row.key for row in rows if row.solver == name and row.status == "skipped"] == []


def test_nothing_has_changed_against_the_baseline(rows: list[Row]) -> None:
    baseline = read_baseline(BASELINE)
    known = {row.model for row in baseline}
    # A formulation dropped into the folder has no past, and needs none to be tested.
    assert changes(baseline, [row for row in rows if row.model in known]) == []


@pytest.mark.parametrize("name", COMMERCIAL)
def test_a_commercial_solver_agrees_where_it_is_installed(rows: list[Row], name: str) -> None:
    solver = solvers()[name]
    if not solver.installed:
        pytest.skip(f"{name} is not installed; {solver.install}")
    theirs = solve_all((name,))
    assert [row for row in theirs if row.status not in ("optimal", "infeasible")] == []
    assert disagreements([*rows, *theirs]) == []


if __name__ == "__main__":
    save_baseline(solve_all(FREE), BASELINE)
