"""The project's own solver regression: shipped formulations × installed solvers × small missions.

Every solve is compared with the others of its program, and with `BASELINE`. After a change that is
meant to change answers, write the baseline again, and read the difference before it is committed::

    python tests/studies/analysis/test_solver_regression.py
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
from msmrta_opt.studies import tasks
from msmrta_opt.studies.analysis.agreement import disagreements
from msmrta_opt.studies.analysis.regression import changes, read_baseline, save_baseline
from msmrta_opt.studies.comparison import cases, solve_here
from msmrta_opt.studies.missions import read_instances
from msmrta_opt.studies.record import Record

ROOT = Path(__file__).parents[3]
BASELINE = ROOT / "tests" / "data" / "solver_baseline.json"
MISSIONS = ("corridor", "two_rooms", "split", "sum_or_max", "paper")
LONG = ("routing", "paper")
FREE = (AUTO, "highs", "scip", "cpsat", "glpk", "lsa")
COMMERCIAL = ("gurobi", "cplex", "xpress", "copt", "mosek")


def solve_all(names: tuple[str, ...]) -> list[Record]:
    """All programs by the solvers `names`, without what differs from machine to machine."""
    missions = read_instances([ROOT / "instances" / f"{name}.json" for name in MISSIONS])
    shipped = Path(formulations.__path__[0])
    rows = []
    with pytest.MonkeyPatch.context() as patch:
        # All solve the same arrays, so each mission's are worked out and canonicalised once.
        named = {mission.name: mission for mission in missions}
        made = cache(lambda name, stage: stage_data(named[name], stage))
        patch.setattr(tasks, "stage_data", lambda mission, stage, _: made(mission.name, stage))
        patch.setattr(tasks.Solving, "warm_up", lambda _: None)
        for stage in STAGES:
            models = [item.name for item in registry.listings(stage) if item.path.parent == shipped]
            # GLPK takes a quarter of a minute for the routes of the paper's mission.
            small = [mission for mission in missions if (stage, mission.name) != LONG]
            todo = cases(small, stage=stage, models=models, solver_names=names)
            rows += [solve_here(case) for case in todo]
    return [
        replace(
            row,
            stage_seconds_json="{}",
            seconds=None,
            nodes=None,
            solver_version="",
            machine="",
        )
        for row in rows
    ]


@pytest.fixture(scope="module")
def rows() -> list[Record]:
    return solve_all(FREE)


def test_every_solver_of_the_registry_is_free_or_commercial() -> None:
    assert {AUTO, *solvers()} == {*FREE, *COMMERCIAL}


def test_solvers_agree_on_every_program(rows: list[Record]) -> None:
    assert disagreements(rows) == []


def test_every_solution_passed_its_check(rows: list[Record]) -> None:
    answered = [row for row in rows if row.verdict in ("optimal", "feasible")]
    assert {row.check for row in answered} == {"passed"}


def test_nothing_fails(rows: list[Record]) -> None:
    assert [row for row in rows if row.verdict == "error"] == []


@pytest.mark.parametrize("name", FREE)
def test_no_free_solver_is_skipped_everywhere(rows: list[Record], name: str) -> None:
    proven = [row for row in rows if row.solver == name and row.verdict == "optimal"]
    assert proven, {row.reason for row in rows if row.solver == name}


def test_a_skip_says_why(rows: list[Record]) -> None:
    assert all(row.reason for row in rows if row.verdict == "skipped")


@pytest.mark.parametrize("name", [AUTO, "highs", "scip", "glpk"])
def test_solvers_of_every_kind_of_program_skip_none(rows: list[Record], name: str) -> None:
    assert [row.solve for row in rows if row.solver == name and row.verdict == "skipped"] == []


def test_nothing_has_changed_against_the_baseline(rows: list[Record]) -> None:
    baseline = read_baseline(BASELINE)
    known = {row.model for row in baseline}
    # A formulation dropped into the folder has no past, and needs none to be tested.
    assert changes(baseline, [row for row in rows if row.model in known]) == []


def test_commercial_solvers_agree_where_they_are_installed(rows: list[Record]) -> None:
    installed = tuple(name for name in COMMERCIAL if solvers()[name].installed)
    if not installed:
        pytest.skip(f"none of {', '.join(COMMERCIAL)} is installed")
    theirs = solve_all(installed)
    assert [row for row in theirs if row.verdict not in ("optimal", "infeasible")] == []
    assert disagreements([*rows, *theirs]) == []


if __name__ == "__main__":
    save_baseline(solve_all(FREE), BASELINE)
