"""The command export, as a user types it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
import typer
from support.own_models import ENOUGH

from msmrta_opt import cli, formulations
from msmrta_opt.cli import programs
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.export import read_program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.planners import plan

Run = Callable[..., int]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run one command, with this group's commands registered and no folder of models kept."""
    app = typer.Typer(pretty_exceptions_enable=False)
    programs.register(app)
    monkeypatch.setattr(cli, "app", app)
    monkeypatch.setattr(formulations, "__path__", [*formulations.__path__])
    return lambda *arguments: cli.run([str(argument) for argument in arguments])


@pytest.fixture
def paper_file(instances_dir: Path) -> Path:
    return instances_dir / "paper.json"


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
    run: Run,
    paper: Instance,
    paper_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    certificates = {item.model: item for item in plan(paper).certificates}
    for model in ("cluster_one_to_one", "victim_one_to_one"):
        file = tmp_path / f"{model}{suffix}"
        assert run("export", model, paper_file, "-o", file) == 0
        assert capsys.readouterr().out == f"{model} written to {file}\n"
        found = solve_program(read_program(file)).objective
        assert found == pytest.approx(certificates[model].objective)


def test_export_takes_parameters_options_and_folders_of_models(
    run: Run, paper_file: Path, own_models: Path, tmp_path: Path
) -> None:
    file = tmp_path / "enough.mps"
    own = ["--models", own_models]
    assert run("export", "cluster_enough", paper_file, "-o", file, *own, "--param", "need=3") == 0
    assert solve_program(read_program(file)).objective == pytest.approx(3.0)
    budget = ["--option", "budget=1"]
    assert run("export", "cluster_budgeted", paper_file, "-o", file, *budget) == 0
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
    run: Run,
    paper_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    given = [str(paper_file) if text == "INSTANCE" else text for text in arguments]
    assert run("export", *given) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("error: ")
    assert problem in told.err
    assert told.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
