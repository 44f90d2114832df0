"""The commands that say what a program does, as a user types them."""

from __future__ import annotations

import json
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from support.own_models import ENOUGH
from support.programs import INF, program

from msmrta_opt import interruption
from msmrta_opt.diagnosis import clock, difference
from msmrta_opt.diagnosis import explain as explaining
from msmrta_opt.optimise.export import write_program

Run = Callable[..., int]
Said = pytest.CaptureFixture[str]


@pytest.fixture
def own_models(tmp_path: Path) -> Path:
    """A folder with one formulation, whose parameter makes it infeasible."""
    folder = tmp_path / "models"
    folder.mkdir()
    (folder / "cluster_enough.py").write_text(ENOUGH)
    return folder


def test_explain_names_the_constraints_that_conflict(
    msmrta: Run, paper_file: Path, own_models: Path, capsys: Said
) -> None:
    own = ["--models", own_models, "--param", "need=5"]
    assert msmrta("explain", "cluster_enough", paper_file, *own) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("cluster_enough is infeasible. These cannot hold together;")
    assert lines[1:6] == [
        *(f"  cluster {c} has at most one robot" for c in range(4)),
        "  enough are taken",
    ]
    assert lines[7] == "Smallest repair, of cost 1; none is cheaper (proved in exact numbers):"
    # Which of the five rows gives way is open.
    assert re.fullmatch(
        r"  (cluster \d has at most one robot|enough are taken): . \d instead of .*", lines[8]
    )


def test_explain_says_that_a_feasible_program_is_feasible(
    msmrta: Run, paper_file: Path, capsys: Said
) -> None:
    assert msmrta("explain", "victim_covering", paper_file, "--param", "beta=0.25") == 0
    assert capsys.readouterr().out.startswith("victim_covering is feasible: ")


def test_explain_without_a_solution_exits_with_1(
    msmrta: Run, paper_file: Path, capsys: Said
) -> None:
    assert msmrta("explain", "victim_balanced", paper_file, "--time-limit", "0") == 1
    assert "stopped before it was known to have a solution" in capsys.readouterr().out


def test_a_weight_keeps_a_row_as_it_is(
    msmrta: Run, paper_file: Path, own_models: Path, capsys: Said
) -> None:
    own = ["--models", own_models, "--param", "need=6"]
    keep = ["--weight", "cluster {c} has at most one robot=inf"]
    assert msmrta("explain", "cluster_enough", paper_file, *own, *keep) == 0
    out = capsys.readouterr().out
    assert "of cost 2; none is cheaper" in out
    assert "  enough are taken: ≥ 4 instead of ≥ 6" in out


def test_why_not_is_asked_by_value_or_by_file_and_told_in_json(
    msmrta: Run, paper_file: Path, tmp_path: Path, capsys: Said
) -> None:
    asked, answers = tmp_path / "asked.txt", []
    asked.write_text("x[0,0] = 1\nx[1,1] = 1  # as last time\n")
    for number, values in enumerate((["x[0,0]=1", "x[1,1]=1"], ["x[0,0]=1;x[1,1]=1"], [asked])):
        out = tmp_path / f"{number}.json"
        options = [part for value in values for part in ("--why-not", value)]
        assert msmrta("explain", "cluster_one_to_one", paper_file, *options, "--json", out) == 0
        assert "Why not x[0,0] = 1 and x[1,1] = 1: " in capsys.readouterr().out
        answers.append(json.loads(out.read_text()))
    assert answers[0] == answers[1] == answers[2]
    found = answers[0]["why_not"]
    assert found["objective"] + sum(t["before"] - t["after"] for t in found["terms"]) == (
        pytest.approx(answers[0]["objective"])
    )


def test_a_file_of_a_program_is_explained_by_itself(
    msmrta: Run, tmp_path: Path, capsys: Said
) -> None:
    path = tmp_path / "two.mps"
    write_program(program([[1, 1]], INF, 1, row_lower=3), path)
    assert msmrta("explain", path) == 0
    out = capsys.readouterr().out
    assert out.startswith("two.mps is infeasible. ")
    assert "row_0: ≥ 2 instead of ≥ 3" in out


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["cluster_fair"], "'cluster_fair' is a formulation; give an instance, too"),
        (["none.mps"], "none.mps: no such file"),
        (["none.mps", "MISSION"], "INSTANCE: a file stands by itself; leave it out"),
        (["cluster_fair", "MISSION", "--why-not", "x[9,9]=1"], "did you mean x["),
        (["cluster_fair", "MISSION", "--why-not", "none.txt"], "none.txt: no such file"),
        (["cluster_fair", "MISSION", "--why-not", "a=1", "--why-not", "f"], "give one file, or"),
        (["cluster_fair", "MISSION", "--weight", "x"], "'x'; give LABEL=NUMBER"),
        (["cluster_fair", "MISSION", "--json", "none/x.json"], "no folder"),
        (["cluster_fair", "MISSION", "--time-limit", "-1"], "time_limit: -1.0; give seconds"),
    ],
)
def test_bad_input_of_explain_is_one_line(
    arguments: list[str], problem: str, msmrta: Run, corridor_file: Path, capsys: Said
) -> None:
    given = [str(corridor_file) if text == "MISSION" else text for text in arguments]
    assert msmrta("explain", *given) == 2
    told = capsys.readouterr()
    assert problem in told.err
    assert (told.out, told.err.count("\n")) == ("", 1)


def test_ctrl_c_ends_explain_with_what_it_has(
    msmrta: Run, paper_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    solve = explaining.solve_program

    def solve_until_ctrl_c(*arguments: object, **options: object) -> object:
        found = solve(*arguments, **options)  # type: ignore[arg-type]
        os.kill(os.getpid(), signal.SIGINT)
        return found

    monkeypatch.setattr(explaining, "solve_program", solve_until_ctrl_c)
    assert msmrta("explain", "cluster_one_to_one", paper_file) == 0
    out = capsys.readouterr().out
    assert "is feasible: " in out
    assert "psi = 0.95: stopped before its range was known" in out


def test_diff_shows_two_formulations_row_by_row_and_writes_json(
    msmrta: Run, paper_file: Path, tmp_path: Path, capsys: Said
) -> None:
    out = tmp_path / "d.json"
    line = ["diff", "cluster_one_to_one", "cluster_budgeted", paper_file, "--option", "budget=2"]
    assert msmrta(*line, "--param", "psi=0.5", "--json", out) == 0
    said = capsys.readouterr().out
    assert "cluster_one_to_one against cluster_budgeted:\n" in said
    assert "Rows of cluster_budgeted alone (4):\n  robot 0 keeps to its budget\n" in said
    found = json.loads(out.read_text())["difference"]
    assert found["rows_a"][0] == "as many pairs as can be"
    assert found["optima_differ"] is (
        bool(found["b_in_a"]["broken"]) or found["a_in_b"]["loss"] > 0
    )


def test_diff_of_files_and_of_a_model_with_itself(
    msmrta: Run, tmp_path: Path, capsys: Said
) -> None:
    for name, side in (("a.mps", 1), ("b.lp", 2)):
        write_program(program([[1, 1]], side, [1, 2], row_lower=1), tmp_path / name)
    assert msmrta("diff", tmp_path / "a.mps", tmp_path / "b.lp") == 0
    assert "≥ 1 and ≤ 2" in capsys.readouterr().out
    assert msmrta("diff", tmp_path / "a.mps", tmp_path / "a.mps") == 0
    assert "are the same program" in capsys.readouterr().out


def test_diff_searches_for_a_witness_and_writes_it(
    msmrta: Run, tmp_path: Path, capsys: Said
) -> None:
    file = tmp_path / "w.json"
    line = ["diff", "cluster_one_to_one", "cluster_budgeted", "--search", "--option", "budget=2"]
    assert msmrta(*line, "--tries", "40", "--witness", file) == 0
    assert capsys.readouterr().out.startswith("A witness, the ")
    assert msmrta(*line[:3], file, "--option", "budget=2") == 0
    said = capsys.readouterr().out
    assert "worse than the optimum" in said or "is not feasible in" in said


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["cluster_fair", "cluster_printed"], "give an instance, too"),
        (["cluster_fair", "victim_covering", "--search"], "give two of one"),
        (["cluster_fair", "cluster_printed", "MISSION", "--param", "beta=1"], "neither has such a"),
        (["cluster_fair", "cluster_printed", "MISSION", "--param", "psi=7"], "psi: 7.0; give a"),
        (
            ["cluster_fair", "cluster_printed", "MISSION", "--witness", "w.json"],
            "goes with --search",
        ),
        (["cluster_fair", "nothing", "MISSION"], "no formulation 'nothing'"),
    ],
)
def test_bad_input_of_diff_is_one_line(
    arguments: list[str], problem: str, msmrta: Run, corridor_file: Path, capsys: Said
) -> None:
    given = [str(corridor_file) if text == "MISSION" else text for text in arguments]
    assert msmrta("diff", *given) == 2
    told = capsys.readouterr()
    assert problem in told.err
    assert (told.out, told.err.count("\n")) == ("", 1)


@pytest.mark.parametrize(
    "line",
    [
        ("explain", "cluster_fair", "MISSION"),
        ("explain", "cluster_fair", "MISSION", "--why-not", "minimum=0"),
        ("diff", "cluster_fair", "cluster_printed", "MISSION"),
        ("diff", "cluster_fair", "cluster_fair", "--search", "--tries", "2"),
    ],
)
def test_json_goes_to_standard_output_alone(
    line: tuple[str, ...], msmrta: Run, corridor_file: Path, capsys: Said
) -> None:
    given = [str(corridor_file) if text == "MISSION" else text for text in line]
    assert msmrta(*given, "--json", "-") == 0
    assert json.loads(capsys.readouterr().out)


def test_diff_that_is_interrupted_writes_what_it_knows_and_says_so_by_its_status(
    msmrta: Run, corridor_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """As after a Ctrl-C: nothing is solved any more, what differs is told all the same."""
    solved: list[object] = []
    monkeypatch.setattr(difference, "solve_program", lambda *a, **o: solved.append(a))
    monkeypatch.setattr(interruption, "interrupted", lambda: True)
    monkeypatch.setattr(clock, "interrupted", lambda: True)
    file = tmp_path / "difference.json"
    models = ("joint_routing_flow", "joint_routing_mtz")
    assert msmrta("diff", *models, corridor_file, "--json", file) == 130
    assert solved == []
    found = json.loads(file.read_text())["difference"]
    assert found["rows_a"]
    assert found["optima_differ"] is None
    said = capsys.readouterr()
    assert "joint_routing_flow has no optimum to try in joint_routing_mtz: no_solution." in said.out
    assert said.err == "interrupted\n"
