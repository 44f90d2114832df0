"""The study commands: run, status, export, report, each with one clear line for a mistake."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from support.studies import kept, many_runs, write_study

from msmrta_opt.studies.record import Record, frame
from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return many_runs(tmp_path, 3)


def test_a_study_is_run_shown_exported_and_reported(
    path: Path, tmp_path: Path, msmrta: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert msmrta("study", "run", path, "--jobs", 2) == 0
    assert "3 runs, 0 of them done before" in capsys.readouterr().out
    assert msmrta("study", "run", path) == 0
    assert "3 runs, 3 of them done before" in capsys.readouterr().out

    assert msmrta("study", "status", path) == 0
    assert "random" in capsys.readouterr().out

    outputs = {kind: tmp_path / f"runs.{kind}" for kind in ("csv", "parquet", "json")}
    options = [part for kind, file in outputs.items() for part in (f"--{kind}", file)]
    assert msmrta("study", "export", path, *options) == 0
    expected = frame(kept(path)).set_index("key")
    tables = {
        "csv": pd.read_csv(outputs["csv"]),
        "parquet": pd.read_parquet(outputs["parquet"]),
        "json": pd.DataFrame(json.loads(outputs["json"].read_text())),
    }
    for table in tables.values():
        assert list(table["contender"]) == ["random"] * 3
        found = table.set_index("key").loc[expected.index]
        assert list(found["distance"]) == list(expected["distance"])
        assert list(found["seconds"]) == pytest.approx(list(expected["seconds"]))

    assert msmrta("study", "report", path) == 0
    assert "report of 3 of 3 runs" in capsys.readouterr().out
    assert (tmp_path / "study-report" / "report.html").is_file()


def test_status_counts_what_is_open_and_names_what_failed(
    path: Path, msmrta: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    from msmrta_opt.studies.ledger import Ledger

    study = Study.read(path)
    first, second, _ = runs(study)
    blank = Record(instance="tiny", contender="random")
    with Ledger(study.ledger) as ledger:
        ledger.add(replace(blank, key=first.key, outcome="crashed", error="of old age"))
        ledger.add(replace(blank, key=second.key))
        ledger.add(replace(blank, key="of another time"))
    assert msmrta("study", "status", path) == 0
    out = capsys.readouterr().out
    (line,) = [line.split() for line in out.splitlines() if line.split()[:1] == ["random"]][:1]
    assert line == ["random", "3", "1", "1", "1"]
    assert "of old age" in out
    assert "1 more runs in the ledger are of other settings or versions" in out


def test_a_study_of_which_every_run_failed_says_so_and_ends_with_1(
    path: Path, msmrta: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    from msmrta_opt.studies.ledger import Ledger

    study = Study.read(path)
    blank = Record(instance="tiny", contender="random", outcome="crashed", error="of old age")
    with Ledger(study.ledger) as ledger:
        for run in runs(study):
            ledger.add(replace(blank, key=run.key))
    assert msmrta("study", "run", path) == 1
    said = capsys.readouterr().err.splitlines()
    assert said[-1] == f"error: {path}: every run failed; the first: crashed: of old age"


@pytest.mark.parametrize(
    ("command", "says"),
    [
        (["run", "none.toml"], "none.toml: no such file"),
        (["status", "study.toml"], "study.sqlite: no ledger yet; run the study first"),
        (["export", "study.toml"], "nothing to write; give --csv, --parquet or --json"),
        (["export", "study.toml", "--csv", "nowhere/x.csv"], "no folder 'nowhere'"),
        (["export", "study.toml", "--csv", "x.csv"], "no ledger yet"),
        (["report", "study.toml"], "no ledger yet"),
        (["run", "study.toml", "--jobs", "0"], "--jobs"),
        (["run", "broken.toml"], "broken.toml: broken TOML"),
    ],
)
def test_a_mistake_gets_one_clear_line_and_leaves_nothing(
    path: Path,
    msmrta: Callable[..., int],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: list[str],
    says: str,
) -> None:
    monkeypatch.chdir(path.parent)
    Path("broken.toml").write_text("[[instances")
    before = sorted(path.parent.iterdir())
    assert msmrta("study", *command) == 2
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1
    assert sorted(path.parent.iterdir()) == before


def test_a_ledger_that_is_none_is_refused(
    path: Path, msmrta: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    path.with_suffix(".sqlite").write_text("shopping list")
    assert msmrta("study", "run", path) == 2
    assert "study.sqlite: not a ledger that can be used" in capsys.readouterr().err


def test_the_papers_evaluation_is_the_papers_grid() -> None:
    todo = runs(Study.read(STUDIES / "paper_evaluation.toml"))
    cells = {(run.instance.map.name, run.instance.n_robots, run.instance.n_victims) for run in todo}
    assert cells == {
        (f"map{m}", n_robots, n_victims)
        for m in range(4)
        for n_robots in range(2, 11)
        for n_victims in range(10, 101, 10)
    }
    assert len(todo) == 3 * len(cells)


def test_the_small_evaluation_can_be_read() -> None:
    assert len(runs(Study.read(STUDIES / "paper_small.toml"))) == 2 * 3 * 3 * 6


def test_a_studys_words_may_hold_anything(
    tmp_path: Path, msmrta: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_study(
        tmp_path,
        'title = "[bold]<b>&"\n[[instances]]\nmaps="open.map"\nrobots=2\nvictims=1\n'
        '[[planners]]\nname = "[red]<script>"\nplanner = "greedy"\n',
    )
    assert msmrta("study", "run", path) == 0
    assert "[red]<script>" in capsys.readouterr().out
