"""The command replay, as a user types it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.mission.plan import Plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def plan_file(plan: Plan, tmp_path: Path) -> Path:
    plan.save(tmp_path / "plan.json")
    return tmp_path / "plan.json"


def test_a_plan_is_written_as_a_page(
    msmrta: Run, plan_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    page = tmp_path / "page.html"
    assert msmrta("replay", plan_file, "-o", page) == 0
    assert capsys.readouterr().out == f"replay written to {page}\n"
    assert page.read_text(encoding="utf-8") == Plan.read(plan_file).replay().page


def test_a_plan_may_be_held_against_its_instance(
    msmrta: Run, plan: Plan, plan_file: Path, paper_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    page, own = tmp_path / "page.html", tmp_path / "own.json"
    plan.instance.save(own)
    assert msmrta("replay", plan_file, own, "-o", page) == 0
    page.unlink()
    assert msmrta("replay", plan_file, paper_file, "-o", page) == 1
    assert "the plan is for another mission: " in capsys.readouterr().err
    assert not page.exists()


def test_two_plans_are_called_by_their_files(
    msmrta: Run, plan: Plan, plan_file: Path, tmp_path: Path
) -> None:
    plan.save(tmp_path / "other.json")
    page = tmp_path / "page.html"
    assert msmrta("replay", plan_file, tmp_path / "other.json", "-o", page) == 0
    text = page.read_text(encoding="utf-8")
    assert '"label":"plan (by hand)"' in text
    assert '"label":"other (by hand)"' in text


def test_a_plan_that_does_not_hold_is_not_shown(
    msmrta: Run, plan_file: Path, tmp_path: Path, capsys: Capture
) -> None:
    document = json.loads(plan_file.read_text())
    document["routes"][0]["visits"][0]["arrival"] = 1.0
    plan_file.write_text(json.dumps(document))
    page = tmp_path / "page.html"
    assert msmrta("replay", plan_file, "-o", page) == 1
    error = capsys.readouterr().err
    assert error.startswith(f"error: {plan_file}: ")
    assert error.count("\n") == 1
    assert not page.exists()


def test_where_no_ffmpeg_is_a_line_says_so_and_nothing_is_written(
    msmrta: Run,
    plan_file: Path,
    tmp_path: Path,
    capsys: Capture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    film, page = tmp_path / "film.mp4", tmp_path / "page.html"
    assert msmrta("replay", plan_file, "-o", page, "--mp4", film) == 2
    said = f"error: {film}: needs the program ffmpeg; install it, or write a .gif\n"
    assert capsys.readouterr().err == said
    assert not page.exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["{plan}", "-o", "{folder}/page.pdf"], "unknown format '.pdf'; give a .html file"),
        (["{plan}", "-o", "{folder}/none/page.html"], "no folder "),
        (["{paper}", "-o", "{folder}/page.html"], "PLAN: 0 plans; give one or two"),
        (["{plan}", "{plan}", "-o", "{folder}/page.html"], "is given twice; give another plan"),
        (["{folder}/no.json", "-o", "{folder}/page.html"], "no such file"),
        (["{plan}"], "--output: nothing to write; give -o FILE.html, --gif or --mp4"),
        (["{plan}", "--gif", "{folder}/a.html"], "unknown format '.html'; give a .gif file"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(
    msmrta: Run,
    plan_file: Path,
    paper_file: Path,
    tmp_path: Path,
    capsys: Capture,
    arguments: list[str],
    said: str,
) -> None:
    names = {"plan": plan_file, "paper": paper_file, "folder": tmp_path}
    assert msmrta("replay", *(argument.format(**names) for argument in arguments)) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not list(tmp_path.glob("*.html"))
