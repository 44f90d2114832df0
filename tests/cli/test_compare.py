"""The command compare, as a user types it."""

from __future__ import annotations

import csv
import importlib.util
import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest
from support.misbehaviour import write_models
from support.studies import solved_here

from msmrta_opt import cli, formulations
from msmrta_opt.studies import comparison as study
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.runs import Run as Solve

Run = Callable[..., int]


@pytest.fixture
def run(run_apart: Run) -> Iterator[Run]:
    """The same, with the solves in this process."""
    with solved_here():
        yield run_apart


@pytest.fixture
def run_apart(monkeypatch: pytest.MonkeyPatch, instances_dir: Path) -> Run:
    """Compare on two missions, on HiGHS unless told otherwise; returns the exit status."""
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    missions = [instances_dir / "two_rooms.json", instances_dir / "paper.json"]

    def compare(*arguments: object, solvers: str = "highs", scores: bool = False) -> int:
        line = ["compare", *missions, "--solvers", solvers, *arguments]
        return cli.run([str(word) for word in (*line, *(() if scores else ("--no-scores",)))])

    return compare


ONE = ("--models", "cluster_one_to_one")


def test_formulations_and_solvers_are_shown_in_tables_and_agree(
    run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    models = "cluster_one_to_one,cluster_printed"
    assert run("--models", models, solvers="highs,scip", scores=True) == 0
    shown = capsys.readouterr().out
    solves, means, measured = (
        shown.split("Shifted geometric")[0],
        shown,
        shown.split("What each")[1],
    )
    words = [line.split() for line in solves.splitlines()]
    chosen = [tuple(word[:3]) for word in words if word and word[0] in ("two_rooms", "paper")]
    assert chosen == [
        (instance, model, solver)
        for instance in ("two_rooms", "paper")
        for model in ("cluster_one_to_one", "cluster_printed")
        for solver in ("highs", "scip")
    ]
    # The paper's mission, at ψ = 0.95: 6.15 by one to one and 6.25 as printed.
    values = {tuple(word[:3]): word[5] for word in words if word and word[0] == "paper"}
    assert values["paper", "cluster_one_to_one", "scip"] == "6.15"
    assert values["paper", "cluster_printed", "highs"] == "6.25"
    assert "Shifted geometric mean times" in means
    assert [word in measured for word in ("Eq. 1", "Eq. 2", "B2", "makespan")] == [True] * 4
    assert "all solutions agree" in shown


def test_rows_are_written_as_csv_parquet_and_json_and_the_profile_as_a_picture(
    run: Run, tmp_path: Path
) -> None:
    names = ("rows.csv", "rows.parquet", "rows.json", "profile.png")
    options = ("--csv", "--parquet", "--json", "--figure")
    outputs = [word for pair in zip(options, names, strict=True) for word in pair]
    outputs = [tmp_path / word if word in names else word for word in outputs]
    assert run(*ONE, *outputs) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    documents = json.loads((tmp_path / "rows.json").read_text())
    assert [row["instance"] for row in documents] == ["two_rooms", "paper"]
    with (tmp_path / "rows.csv").open() as file:
        assert [float(row["objective"]) for row in csv.DictReader(file)] == [
            row["objective"] for row in documents
        ]
    assert (tmp_path / "profile.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "rows.parquet").read_bytes().startswith(b"PAR1")


def test_seeds_may_be_listed_with_commas(run: Run, tmp_path: Path) -> None:
    assert run(*ONE, "--seeds", "2,1", "--json", tmp_path / "rows.json") == 0
    documents = json.loads((tmp_path / "rows.json").read_text())
    assert [row["seed"] for row in documents] == [2, 1, 2, 1]


@pytest.mark.parametrize(
    ("flags", "by_structure"), [((), True), (("--structure",), True), (("--no-structure",), False)]
)
def test_structure_is_used_unless_told_otherwise(
    run: Run, tmp_path: Path, flags: tuple[str, ...], by_structure: bool
) -> None:
    """Either way the paper's mission is worth 6.15; only its matrix tells that this is an assignment."""
    assert run(*ONE, *flags, "--json", tmp_path / "rows.json", solvers="auto") == 0
    found = json.loads((tmp_path / "rows.json").read_text())[1]
    assert found["objective"] == pytest.approx(6.15)
    assert ("totally unimodular" in found["proof"]) == by_structure


def test_a_folder_of_models_is_compared_by_itself_and_a_fault_leaves_the_rest_whole(
    run_apart: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_models(tmp_path / "own", "right", "wrong_syntax", "wrong_kill")
    assert run_apart("--models", folder, "--json", tmp_path / "rows.json") == 0
    documents = json.loads((tmp_path / "rows.json").read_text())
    assert [(row["model"], row["status"]) for row in documents] == [
        ("right", "optimal"),
        ("wrong_kill", "error"),
        ("wrong_syntax", "error"),
    ] * 2
    assert "4 of 6 solves gave no solution" in capsys.readouterr().out


def test_no_solution_at_all_is_exit_status_1(
    run_apart: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_models(tmp_path / "own", "wrong_exit")
    assert run_apart("--models", folder) == 1
    assert "agree" not in capsys.readouterr().out


def test_a_disagreement_is_shown_and_sets_the_exit_status(
    run: Run, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(study, "compare", _liar)
    assert run(*ONE, solvers="highs,scip") == 1
    shown = " ".join(capsys.readouterr().out.split())
    assert "disagreement: cluster_one_to_one on paper: highs has 1, but scip proves" in shown
    assert "all solutions agree" not in shown


def _liar(todo: list[Solve], **_: object) -> Iterator[Record]:
    """Solves whose optima are 1 by HiGHS and 2 by others."""
    for run in todo:
        value = 1.0 if run.task.solver == "highs" else 2.0  # type: ignore[union-attr]
        proved = {"status": "optimal", "sense": "min", "objective": value, "bound": value}
        asked = {"instance": run.instance.name, "key": run.key, "check": "passed"}
        yield Record(**run.task.asked(), **asked, **proved)


def test_against_its_own_baseline_nothing_has_changed(
    run: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    baseline = tmp_path / "baseline.json"
    assert run(*ONE, "--save", baseline) == 0
    assert run(*ONE, "--against", baseline) == 0
    assert "nothing has changed" in capsys.readouterr().out


def test_what_changed_is_listed_and_sets_the_exit_status(
    run: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    baseline = tmp_path / "baseline.json"
    assert run(*ONE, "--save", baseline) == 0
    document = json.loads(baseline.read_text())
    first, second = document["rows"]
    first["objective"] += 0.5
    second["status"] = "feasible"
    document["rows"].append({**first, "solver": "scip"})
    baseline.write_text(json.dumps(document))
    assert run(*ONE, "--against", baseline) == 1
    shown = " ".join(capsys.readouterr().out.split())
    assert "changed: cluster_one_to_one on two_rooms by highs: objective 3, was 3.5" in shown
    assert "changed: cluster_one_to_one on paper by highs: status optimal, was feasible" in shown
    assert "cluster_one_to_one on two_rooms by scip: was there before, is missing" in shown


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--models", "no_such_model"], "no formulation 'no_such_model'"),
        (["--solvers", "no_such_solver"], "no solver 'no_such_solver'"),
        (["--stage", "no_such_stage"], "no stage 'no_such_stage'"),
        (["--psi", "2"], "psi"),
        (["--jobs", "0"], "jobs"),
        (["--time-limit", "-1"], "time_limit"),
        (["--memory-limit", "0"], "memory-limit"),
        (["--seeds", "one"], "--seeds"),
        (["--slower", "2"], "--against"),
        (["--csv", "no/such/folder/rows.csv"], "no folder"),
        (["--figure", "profile.txt"], "picture format"),
        (["--against", "no_such_file.json"], "no such file"),
    ],
)
def test_a_wrong_argument_is_one_line_and_exit_status_2(
    run: Run, capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    assert run(*arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert said in err


def test_a_broken_baseline_is_one_line_before_any_work(
    run: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "baseline.json").write_text('{"format": "msmrta-comparison/1", "rows": [{}]}')
    assert run("--against", tmp_path / "baseline.json") == 2
    assert "rows[0].instance: is missing" in capsys.readouterr().err


def test_parquet_without_pyarrow_says_what_to_install(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert run(*ONE, "--parquet", tmp_path / "rows.parquet") == 2
    assert "pip install 'msmrta_opt[parquet]'" in capsys.readouterr().err


def test_a_folder_without_a_formulation_of_the_stage_is_refused(
    run: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("--models", write_models(tmp_path / "own", "right"), "--stage", "victim") == 2
    assert "no formulation of stage 'victim'" in capsys.readouterr().err


def test_a_model_whose_name_is_taken_is_refused_rather_than_confused(
    run: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = write_models(tmp_path / "own", cluster_fair="    return None")
    assert run("--models", own) == 2
    assert "the name is taken" in capsys.readouterr().err


def test_ctrl_c_shows_what_was_finished_and_leaves_nothing_behind(
    instances_dir: Path, tmp_path: Path
) -> None:
    outputs = tmp_path / "outputs"
    outputs.mkdir()
    started = tmp_path / "started"
    sleeps = f"    open({str(started)!r}, 'w').close()\n    time.sleep(600)"
    own = write_models(tmp_path / "own", "right", sleeps=sleeps)
    line = ["compare", instances_dir / "two_rooms.json", "--models", own, "--solvers", "highs"]
    line += ["--json", outputs / "rows.json", "--save", outputs / "baseline.json"]
    code = f"import sys; sys.path[:] = {sys.path!r}; from msmrta_opt.cli import main; main()"
    command = subprocess.Popen(
        [sys.executable, "-c", code, *line],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        while not started.exists():
            assert command.poll() is None, command.communicate()
            time.sleep(0.05)
        family = psutil.Process(command.pid).children(recursive=True)
        command.send_signal(signal.SIGINT)
        out, err = command.communicate(timeout=60)
    finally:
        command.kill()
    assert command.returncode == 130
    assert "right" in out
    assert "interrupted: 1 of 2 solves are shown" in out
    assert "Traceback" not in err
    assert family
    _, alive = psutil.wait_procs(family, timeout=20)
    assert [process for process in alive if process.status() != psutil.STATUS_ZOMBIE] == []
    # The rows that were finished are written whole; they are no baseline, and no scrap is left.
    assert [path.name for path in outputs.iterdir()] == ["rows.json"]
    assert [row["model"] for row in json.loads((outputs / "rows.json").read_text())] == ["right"]
