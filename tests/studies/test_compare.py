"""Comparisons stay whole whatever a model does, and say what agrees and what does not."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from support.misbehaviour import MODELS, write_models

from msmrta_opt import formulations
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise import registry, solvers
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.studies import comparison as study
from msmrta_opt.studies.analysis.agreement import disagreements
from msmrta_opt.studies.analysis.times import shifted_geometric_means
from msmrta_opt.studies.comparison import cases, compare, comparison, solve_here
from msmrta_opt.studies.missions import read_instances
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.runs import Run
from msmrta_opt.studies.solves import COLUMNS, documents_of, record_of_row, records_of, table_of
from msmrta_opt.studies.tasks import Solving

ROW = {
    "instance": "paper",
    "stage": "cluster",
    "model": "model",
    "solver": "highs",
    "status": "optimal",
    "sense": "min",
    "objective": 5.0,
    "bound": 5.0,
    "gap": 0.0,
    "check": "passed",
}
RECORD = record_of_row(ROW)


def row(solver: str, **changes: Any) -> Record:
    return record_of_row(ROW | {"solver": solver} | changes)


def asked(run: Run) -> tuple[str, str, int | None]:
    assert isinstance(run.task, Solving)
    return run.task.model, run.task.solver, run.task.seed


@pytest.fixture(scope="module")
def faults(
    tmp_path_factory: pytest.TempPathFactory, instances_dir: Path
) -> Iterator[dict[str, Record]]:
    """One comparison of all faulty models, by name, under a limit that only one of them meets."""
    finite = [name for name in MODELS if name != "wrong_loop"]
    folder = write_models(tmp_path_factory.mktemp("faults") / "models", *finite)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(formulations, "__path__", [*formulations.__path__])
        registry.add_models(folder)
        todo = cases(
            [Instance.read(instances_dir / "two_rooms.json")],
            stage="cluster",
            models=[*sorted(finite), "cluster_one_to_one"],
            solver_names=["highs"],
        )
        yield {str(row.model): row for row in compare(todo, jobs=2, memory_limit=700)}


def test_a_model_that_never_ends_is_killed_after_the_time_limit_and_some_grace(
    tmp_path: Path, instances_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "GRACE_SECONDS", 0.125)
    registry.add_models(write_models(tmp_path / "models", "wrong_loop"))
    mission = Instance.read(instances_dir / "two_rooms.json")
    names = {"models": ["wrong_loop"], "solver_names": ["highs"]}
    (found,) = compare(cases([mission], stage="cluster", time_limit=0.125, **names))
    assert (found.verdict, found.reason) == ("error", "timed out: killed after 0.25 s")


def test_each_solve_is_one_row(faults: dict[str, Record]) -> None:
    assert {*faults} == {*MODELS, "cluster_one_to_one"} - {"wrong_loop"}
    assert len(faults) == len(MODELS)


@pytest.mark.parametrize(
    ("model", "status", "message"),
    [
        ("wrong_infeasible", "infeasible", ""),
        ("wrong_unbounded", "unbounded", ""),
        ("wrong_not_convex", "error", "not convex"),
        ("wrong_no_variables", "error", "no variables"),
        ("wrong_syntax", "error", "SyntaxError"),
        ("wrong_memory", "error", "out of memory: killed past 700 MiB"),
        ("wrong_kill", "error", "crashed: killed by SIGKILL"),
        ("wrong_exit", "error", "crashed: ended with exit status 7"),
    ],
)
def test_a_faulty_model_is_a_row_with_a_clear_status(
    faults: dict[str, Record], model: str, status: str, message: str
) -> None:
    found = faults[model]
    assert (found.verdict, found.objective, found.check or "") == (status, None, "")
    assert message in found.reason


# At most one pair among all; and by hand, the one cluster to the robot that can serve all three.
@pytest.mark.parametrize(("model", "value"), [("right", 1.0), ("cluster_one_to_one", 3.0)])
def test_sound_models_among_faulty_ones_are_whole(
    faults: dict[str, Record], model: str, value: float
) -> None:
    found = faults[model]
    assert (found.status, found.check) == ("optimal", "passed")
    assert found.objective == pytest.approx(value)
    assert found.bound == pytest.approx(value)


def test_a_solver_that_is_not_installed_is_skipped_with_its_remedy(
    paper: Instance, monkeypatch: pytest.MonkeyPatch
) -> None:
    missing = replace(solvers.get("scip"), name="missing", module="no_such_module")
    monkeypatch.setattr(solvers, "solvers", lambda: {"missing": missing})
    (case,) = cases([paper], stage="cluster", models=["cluster_fair"], solver_names=["missing"])
    found = solve_here(case)
    assert (found.verdict, found.reason) == ("skipped", f"not installed; {missing.install}")
    assert found.objective is found.seconds is None


def test_a_solver_is_skipped_for_what_it_cannot_do(paper: Instance) -> None:
    todo = cases(
        [paper], stage="cluster", models=["cluster_one_to_one"], solver_names=["lsa"], seeds=[1]
    )
    found = solve_here(todo[0])
    assert (found.verdict, found.reason) == ("skipped", "solver lsa cannot do seed")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"models": ["no_such_model"]}, "no formulation 'no_such_model'"),
        ({"solver_names": ["no_such_solver"]}, "no solver 'no_such_solver'"),
        ({"stage": "no_such_stage"}, "no stage 'no_such_stage'; there are clustering"),
        ({"time_limit": -1.0}, "time_limit"),
        ({"gap": math.nan}, "gap"),
        ({"seeds": [-1]}, "seed"),
    ],
)
def test_what_cannot_be_compared_is_refused_at_once(
    paper: Instance, wrong: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        cases([paper], **{"stage": "cluster", **wrong})


def test_cases_are_every_combination_once_and_in_order(paper: Instance) -> None:
    models, names = ["cluster_fair", "cluster_printed", "cluster_fair"], ["scip", "highs"]
    todo = cases([paper], stage="cluster", models=models, solver_names=names, seeds=[2, 1])
    assert [asked(run) for run in todo] == [
        (model, solver, seed)
        for model in ("cluster_fair", "cluster_printed")
        for solver in ("scip", "highs")
        for seed in (2, 1)
    ]


def test_by_default_every_installed_solver_is_compared(paper: Instance) -> None:
    todo = cases([paper], stage="cluster", models=["cluster_fair"])
    installed = [name for name, solver in solvers.solvers().items() if solver.installed]
    assert [asked(run)[1] for run in todo] == ["auto", *installed]


@pytest.mark.parametrize(
    ("others", "said"),
    [
        ([row("scip", objective=6.0, bound=6.0)], "highs has 5, but scip proves"),
        ([row("scip", status="feasible", objective=4.0, bound=3.0)], "scip has 4, but highs"),
        (
            [row("scip", status="no_solution", objective=None, bound=5.5)],
            "nothing is better than 5.5",
        ),
        (
            [row("scip", status="infeasible", objective=None, bound=None)],
            "scip proves it infeasible",
        ),
        ([row("scip", status="unbounded", objective=None, bound=None)], "scip proves it unbounded"),
        ([row("highs", seed=1, objective=5.1, bound=5.1)], "highs has 5, but highs proves"),
    ],
)
def test_a_contradiction_between_solvers_is_found(others: list[Record], said: str) -> None:
    (line,) = disagreements([RECORD, *others])
    assert said in line


def test_bounds_of_maximisations_are_read_from_above() -> None:
    better = row("scip", sense="max", status="feasible", objective=6.0, bound=7.0)
    worse = row("cpsat", sense="max", status="feasible", objective=4.0, bound=5.5)
    (line,) = disagreements([better, worse])
    assert "scip has 6, but cpsat proves that nothing is better than 5.5" in line
    assert disagreements([better, replace(worse, bound=6.0)]) == []


@pytest.mark.parametrize(
    "other",
    [
        row("scip", objective=5.0 + 1e-7, bound=5.0 + 1e-7),
        row("scip", status="feasible", objective=9.0, bound=2.0),
        row("scip", status="error", objective=None, bound=None),
        row("scip", status="skipped", objective=None, bound=None),
        row("scip", model="another", objective=7.0, bound=7.0),
        row("scip", instance="another", objective=7.0, bound=7.0),
    ],
)
def test_what_does_not_contradict_is_no_disagreement(other: Record) -> None:
    assert disagreements([RECORD, other]) == []


def test_shifted_geometric_means_are_those_of_optimal_solves() -> None:
    # With shift 1: sqrt((1 + 1) (7 + 1)) - 1 = 3.
    rows = [
        row("highs", total_seconds=1.0),
        row("highs", total_seconds=7.0),
        row("highs", status="feasible", total_seconds=60.0),
        row("highs", status="skipped"),
        row("scip", status="error"),
        row("lsa", status="skipped"),
    ]
    means = shifted_geometric_means(rows, shift=1.0)
    assert means["model", "highs"] == (pytest.approx(3.0), 2, 3)
    mean, solved, tried = means["model", "scip"]
    assert (math.isnan(mean), solved, tried) == (True, 0, 1)
    assert ("model", "lsa") not in means


def test_the_frame_has_a_column_per_field_and_survives_its_formats(tmp_path: Path) -> None:
    rows = [
        RECORD,
        row("scip", status="error", objective=None, bound=None, gap=None, message="é, \n"),
    ]
    table = table_of(rows)
    assert list(table.columns) == [*COLUMNS]
    assert table["objective"].isna().tolist() == [False, True]
    table.to_csv(tmp_path / "rows.csv", index=False)
    again = pd.read_csv(tmp_path / "rows.csv")
    assert again["message"].tolist()[1] == "é, \n"
    table.to_parquet(tmp_path / "rows.parquet")
    assert pd.read_parquet(tmp_path / "rows.parquet")["objective"].tolist()[0] == 5.0
    assert json.loads(json.dumps(documents_of(rows)))[1]["objective"] is None


def test_no_rows_make_an_empty_frame_with_columns() -> None:
    assert list(table_of([]).columns) == [*COLUMNS]


def test_instances_are_told_apart_by_name(instances_dir: Path, tmp_path: Path) -> None:
    document = json.loads((instances_dir / "split.json").read_text())
    nameless = tmp_path / "nameless.json"
    nameless.write_text(json.dumps({k: v for k, v in document.items() if k != "name"}))
    found = read_instances([instances_dir / "split.json", nameless])
    assert [instance.name for instance in found] == ["split", "nameless"]
    with pytest.raises(InputError, match="'split' is also another file's"):
        read_instances([instances_dir / "split.json"] * 2)


def test_a_table_is_as_good_as_its_rows() -> None:
    rows = [
        row("highs", seed=1, nodes=3),
        row("scip", objective=4.0, bound=4.0),
        row("glpk", status="skipped", objective=None, bound=None, gap=None),
    ]
    table = table_of(rows)
    assert documents_of(records_of(table)) == documents_of(rows)
    assert documents_of(records_of(table.set_index("solver"))) == documents_of(rows)
    assert disagreements(table) == disagreements(rows) != []


def test_a_table_of_something_else_is_refused() -> None:
    with pytest.raises(InputError, match="check; give the table as compare returns it"):
        disagreements(table_of([RECORD]).drop(columns="check"))


def test_rows_of_a_table_are_in_the_order_that_was_asked_for(instances_dir: Path) -> None:
    two_rooms = Instance.read(instances_dir / "two_rooms.json")
    asked = ["cluster_one_to_one", "cluster_printed"], ["highs", "auto"]
    table = comparison(
        [two_rooms], models=asked[0], solvers=asked[1], jobs=3, options=StagedOptions(psi=0.5)
    )
    found = list(zip(table.model, table.solver, strict=True))
    assert found == [(model, solver) for model in asked[0] for solver in asked[1]]


def test_a_gap_that_is_none_is_refused(instances_dir: Path) -> None:
    with pytest.raises(InputError, match="gap"):
        comparison([Instance.read(instances_dir / "two_rooms.json")], gap=-1.0)
