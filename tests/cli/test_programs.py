"""The commands solve and export, of formulations and of files, as a user types them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
import typer
from support.own_models import ENOUGH

from msmrta_opt.cli.proofs import check_proofs
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.export import read_program
from msmrta_opt.optimise.solve import solve, solve_program
from msmrta_opt.planners import plan

Run = Callable[..., int]


@pytest.fixture
def own_models(tmp_path: Path) -> Path:
    """A folder with one formulation, whose parameter makes it infeasible."""
    folder = tmp_path / "models"
    folder.mkdir()
    (folder / "cluster_enough.py").write_text(ENOUGH)
    return folder


@pytest.mark.parametrize("suffix", [".mps", ".lp"])
def test_export_writes_what_the_planner_solves(
    suffix: str,
    msmrta: Run,
    paper: Instance,
    paper_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    certificates = {item.model: item for item in plan(paper).certificates}
    for model in ("cluster_one_to_one", "victim_one_to_one"):
        file = tmp_path / f"{model}{suffix}"
        assert msmrta("export", model, paper_file, "-o", file) == 0
        assert capsys.readouterr().out == f"{model} written to {file}\n"
        found = solve_program(read_program(file)).objective
        assert found == pytest.approx(certificates[model].objective)


def test_export_takes_parameters_options_and_folders_of_models(
    msmrta: Run, paper_file: Path, own_models: Path, tmp_path: Path
) -> None:
    file = tmp_path / "enough.mps"
    own = ["--models", own_models]
    assert (
        msmrta("export", "cluster_enough", paper_file, "-o", file, *own, "--param", "need=3") == 0
    )
    assert solve_program(read_program(file)).objective == pytest.approx(3.0)
    budget = ["--option", "budget=1"]
    assert msmrta("export", "cluster_budgeted", paper_file, "-o", file, *budget) == 0
    program = read_program(file)
    assert program.row_upper.tolist() == [1.0] * 8


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["cluster_printed", "INSTANCE", "-o", "eq1.txt"], "the suffix is one of .mps, .lp"),
        (["cluster_printed", "INSTANCE", "-o", "none/eq1.lp"], "no folder"),
        (["cluster_nothing", "INSTANCE", "-o", "eq1.lp"], "no formulation 'cluster_nothing'"),
        (["cluster_printed", "none.json", "-o", "eq1.lp"], "none.json: no such file"),
        (["cluster_printed", "INSTANCE", "-o", "eq1.lp", "--param", "psi"], "give NAME=NUMBER"),
        (["cluster_printed", "INSTANCE", "-o", "eq1.lp", "--param", "psi=x"], "give NAME=NUMBER"),
        (["cluster_printed", "INSTANCE", "-o", "eq1.lp", "--param", "psi=2"], "psi: 2.0; give a"),
        (["cluster_printed", "INSTANCE", "-o", "eq1.lp", "--param", "path=1"], "no such parameter"),
        (["cluster_printed", "INSTANCE", "-o", "eq1.lp", "--option", "x=1"], "no such option"),
        (["cluster_printed", "INSTANCE", "-o", "eq1.lp", "--models", "none"], "no such folder"),
    ],
)
def test_bad_input_gets_one_line_and_exit_2_and_writes_nothing(
    arguments: list[str],
    problem: str,
    msmrta: Run,
    paper_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    given = [str(paper_file) if text == "INSTANCE" else text for text in arguments]
    assert msmrta("export", *given) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("error: ")
    assert problem in told.err
    assert told.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


COVER = """\\ two of three, the cheaper ones
Minimize
 cost: 3 a + 5 b + 4 c
Subject To
 two: a + b + c >= 2
 apart: a + c <= 1
Binaries
 a b c
End
"""


def test_the_program_of_a_file_is_solved_proved_checked_and_turned_into_the_other_format(
    msmrta: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of a and c only one: b and a, at 8."""
    lp, mps, proof = (tmp_path / f"cover{suffix}" for suffix in (".lp", ".mps", ".vipr"))
    lp.write_text(COVER)
    assert msmrta("solve", lp, "--proof", proof, "--json", tmp_path / "found.json") == 0
    found = json.loads((tmp_path / "found.json").read_text())
    assert (found["status"], found["objective"]) == ("optimal", 8)
    assert "reads nothing" not in capsys.readouterr().out
    assert msmrta("export", lp, "-o", mps) == 0
    assert solve(mps).objective == solve(read_program(lp)).objective == 8
    check_proofs([proof, mps], None, None)
    assert f"minimum in [8, 8], of {mps}" in capsys.readouterr().out
    lp.write_text(COVER.replace("5 b", "6 b"))
    with pytest.raises(typer.Exit):
        check_proofs([proof, lp], None, None)
    assert "it is not of cover.lp" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["cover.lp", "paper"], "INSTANCE: a file stands by itself; leave it out"),
        (["cover.lp", "--param", "psi=1"], "--param: a file stands by itself; leave it out"),
        (["cover.lp", "--option", "budget=1"], "--option: a file stands by itself; leave it out"),
        (["cover.lp", "--start", "greedy"], "--start: a plan is no start for a file"),
        (["none.lp"], "none.lp: no such file"),
        (["cover.txt"], "no formulation 'cover.txt'"),
        (["cluster_one_to_one"], "'cluster_one_to_one' is a formulation; give an instance, too"),
        (["cover.lp", "--json", "cover.lp"], "cover.lp: would overwrite what is read"),
    ],
)
def test_what_does_not_go_with_a_file_gets_one_line(
    arguments: list[str],
    message: str,
    msmrta: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("cover.lp").write_text(COVER)
    assert msmrta("solve", *arguments) == 2
    error = capsys.readouterr().err
    assert (message in error, error.count("\n")) == (True, 1)
    assert Path("cover.lp").read_text() == COVER
