"""The command watch: a save is a solve, and what is told is what has changed."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.cli import watch

Run = Callable[..., int]
Said = pytest.CaptureFixture[str]


@pytest.fixture
def model(tmp_path: Path, instances_dir: Path) -> Path:
    """A copy of a shipped formulation, in a folder of its own."""
    folder = tmp_path / "models"
    folder.mkdir()
    source = instances_dir.parent / "models" / "cluster_one_to_one.py"
    path = folder / "cluster_mine.py"
    path.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    return path


@pytest.fixture
def watching(
    msmrta: Run, model: Path, paper_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> Callable[..., tuple[int, str]]:
    """Watch `model`, saved with each text in turn (deleted for none), until Ctrl-C."""

    def run(*texts: str, options: tuple[object, ...] = ()) -> tuple[int, str]:
        # Each wait is one look of the watch; after a save two are needed to see that it is whole.
        todo = [step for text in texts for step in (text, None, None)]

        def wait(_: float) -> None:
            if not todo:
                os.kill(os.getpid(), signal.SIGINT)
                return
            text = todo.pop(0)
            if text == "":
                model.unlink()
            elif text is not None:
                before = model.stat().st_mtime_ns if model.exists() else 10**18
                model.write_text(text, encoding="utf-8")
                os.utime(model, ns=(before + 10**9, before + 10**9))

        monkeypatch.setattr(watch.time, "sleep", wait)
        status = msmrta("watch", model.stem, paper_file, "--models", model.parent, *options)
        return status, capsys.readouterr().out

    return run


def test_ctrl_c_ends_it_with_0_and_the_first_solve_is_told(
    watching: Callable[..., tuple[int, str]],
) -> None:
    status, out = watching()
    assert status == 0
    assert "optimal: 6.15 (max), bound 6.15" in out
    assert "16 variables, 9 rows; bipartite assignment rows and a cardinality" in out
    assert out.count("robot ") == 4


def test_an_edit_is_told_by_objective_structure_rows_and_who_gets_what(
    model: Path, watching: Callable[..., tuple[int, str]], tmp_path: Path
) -> None:
    plain = model.read_text(encoding="utf-8")
    free = plain.replace(
        '(cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one cluster"),', ""
    )
    log = tmp_path / "log.jsonl"
    status, out = watching(free, plain, options=("--json", log))
    assert status == 0
    first, second = out.split("cluster_mine.py, save ")[1:]
    assert "  rows gone (4):\n    robot 0 has at most one cluster\n" in first
    assert "  objective: 6.15 → 6.25\n  bound: 6.15 → 6.25\n" in first
    assert "  structure " in first
    assert " → cluster " in first
    assert "  rows added (4):\n" in second
    assert "  objective: 6.25 → 6.15\n" in second
    told = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    assert [line["objective"] for line in told] == pytest.approx([6.15, 6.25, 6.15])
    assert set(told[0]["gets"]) == {f"robot {r}" for r in range(4)}


def test_a_broken_file_is_one_line_and_the_watch_goes_on(
    model: Path, watching: Callable[..., tuple[int, str]]
) -> None:
    plain = model.read_text(encoding="utf-8")
    status, out = watching(
        plain.replace("def build", "def build("), plain.replace("<= 1)", "<= 0)"), plain
    )
    assert status == 0
    lines = out.splitlines()
    (broken,) = [line for line in lines if line.startswith("broken: ")]
    assert "SyntaxError" in broken
    assert any(line.startswith("  status: optimal → infeasible") for line in lines)
    assert any(line.startswith("  status: infeasible → optimal") for line in lines)


def test_a_save_of_the_same_text_is_none(
    model: Path, watching: Callable[..., tuple[int, str]]
) -> None:
    _, out = watching(model.read_text(encoding="utf-8"))
    assert "save 1" not in out


def test_a_file_that_is_deleted_and_comes_back_is_watched_on(
    model: Path, watching: Callable[..., tuple[int, str]]
) -> None:
    plain = model.read_text(encoding="utf-8")
    status, out = watching("", plain.replace("== min(x.shape)", "== 2"))
    assert status == 0
    assert f"broken: {model}: the file is gone\n" in out
    assert "    as many pairs as can be: = 4 → = 2\n" in out


def test_a_model_that_there_is_not_is_one_line(msmrta: Run, paper_file: Path, capsys: Said) -> None:
    assert msmrta("watch", "cluster_none", paper_file) == 2
    assert capsys.readouterr().err.startswith("error: model: no formulation 'cluster_none'")
