"""Proofs as a user meets them: solve --proof, check FILE.vipr, checker, compare --prove."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from msmrta_opt import cli
from msmrta_opt.mission.instance import Instance
from msmrta_opt.studies import comparison
from msmrta_opt.studies.proving import verdicts


@pytest.fixture
def proof(instances_dir: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    """That of victim_balanced on the mission of two rooms."""
    path = tmp_path / "proof.vipr"
    words = ["solve", "victim_balanced", str(instances_dir / "two_rooms.json")]
    assert cli.run([*words, "--proof", str(path)]) == 0
    assert f"{path}: proved (" in capsys.readouterr().out.replace("\n", "")
    return path


def test_a_proof_is_checked_alone_and_against_its_mission(
    proof: Path, instances_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["check", str(proof)]) == 0
    assert f"{proof}: proved: minimum in [" in capsys.readouterr().out
    mission = str(instances_dir / "two_rooms.json")
    assert cli.run(["check", str(proof), "victim_balanced", mission]) == 0
    assert "of victim_balanced on" in capsys.readouterr().out
    assert cli.run(["check", str(proof), "victim_balanced", mission, "--param", "beta=0.4"]) == 1
    told = capsys.readouterr().err
    assert "it is not of victim_balanced with beta=0.4: " in told
    assert "_load has " in told  # which coefficient of which row
    assert cli.run(["check", str(proof), "--param", "beta=0.4"]) == 2
    assert "--param: is for a formulation" in capsys.readouterr().err
    assert cli.run(["check", str(proof), "victim_balanced", str(instances_dir / "paper.json")]) == 1
    assert "the variables are not the same" in capsys.readouterr().err
    assert cli.run(["check", str(proof), mission]) == 2


def test_a_tampered_proof_is_refused_with_its_line_and_others_are_still_checked(
    proof: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = proof.with_name("bad.vipr")
    lines = proof.read_text().splitlines()
    place = next(i for i, line in enumerate(lines) if line.startswith("RTP range"))
    lines[place] = "RTP range 1000 2000"
    bad.write_text("\n".join(lines))
    assert cli.run(["check", str(bad), str(proof)]) == 1
    shown = capsys.readouterr()
    assert f"{bad}: line {place + 3}: the best solution has the value" in shown.err
    assert f"{proof}: proved: " in shown.out


def test_the_printed_checker_runs_with_nothing_but_python(
    proof: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["checker"]) == 0
    script = tmp_path / "check.py"
    script.write_text(capsys.readouterr().out, encoding="utf-8")
    run = subprocess.run(
        [sys.executable, "-I", "-S", script, proof], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert ": proved: minimum in [" in run.stdout


def test_bad_words_are_refused_before_any_work(
    instances_dir: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["solve", "victim_balanced", str(instances_dir / "two_rooms.json"), "--proof"]
    assert cli.run([*words, str(tmp_path / "proof.txt")]) == 2
    assert "the suffix is .vipr" in capsys.readouterr().err
    assert cli.run([*words, str(tmp_path / "none" / "proof.vipr")]) == 2
    assert cli.run(["check", str(tmp_path / "none.vipr")]) == 2
    assert not list(tmp_path.iterdir())


def test_compare_proves_each_program_once(
    instances_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["compare", str(instances_dir / "two_rooms.json"), "--stage", "victim", "--no-scores"]
    assert cli.run([*words, "--models", "victim_balanced", "--solvers", "highs", "--prove"]) == 0
    shown = capsys.readouterr().out
    assert "Proofs" in shown
    assert "contradicted" not in shown


def test_a_solver_with_a_false_optimum_is_convicted_whoever_it_is(paper: Instance) -> None:
    todo = comparison.cases(
        [paper], stage="cluster", models=["cluster_one_to_one"], solver_names=["highs", "auto"]
    )
    honest = [comparison.solve_here(run) for run in todo]
    claims = [
        honest[0],
        replace(honest[1], objective=6.0),  # the maximum is 6.15
        replace(honest[1], solver="x", objective=6.3),
        replace(honest[1], solver="y", status="infeasible", objective=None),
        replace(honest[1], solver="z", status="feasible", objective=5.0),  # stopped, and no lie
    ]
    (verdict,) = verdicts(todo, claims, time_limit=60)
    assert verdict.proof is not None
    assert verdict.proof.status == "proved"
    said = {row.solver: what for row, what in verdict.contradicted}
    assert set(said) == {"auto", "x", "y"}
    assert said["auto"] == "it claims that 6 is optimal, and 6.15 is feasible"
    assert said["x"] == "it claims a solution of value 6.3, and no point is better than 6.15"
    assert said["y"] == "it claims that there is no solution, and 6.15 is the value of one"


def test_a_convicted_row_is_shown_and_fails_the_comparison(
    instances_dir: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    compare = comparison.compare

    def lying(*given: object, **options: object):  # type: ignore[no-untyped-def]
        for row in compare(*given, **options):  # type: ignore[arg-type]
            yield replace(row, objective=6.0, bound=6.0)

    monkeypatch.setattr(comparison, "compare", lying)
    words = ["compare", str(instances_dir / "paper.json"), "--no-scores", "--prove"]
    assert cli.run([*words, "--models", "cluster_one_to_one", "--solvers", "highs"]) == 1
    shown = " ".join(capsys.readouterr().out.split())
    assert "contradicted: highs on cluster_one_to_one, " in shown
    assert "it claims that 6 is optimal, and 6.15 is feasible" in shown
    assert "1 solves failed their check" in shown


def test_the_exact_planner_proves_its_plan_and_check_checks_it(
    instances_dir: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mission, plan, path = (
        str(instances_dir / "two_rooms.json"), str(tmp_path / "plan.json"), str(tmp_path / "p.vipr")
    )  # fmt: skip
    words = ["exact", mission, "--objective", "makespan", "--json", plan, "--proof", path]
    assert cli.run(words) == 0
    shown = capsys.readouterr().out
    assert f"{path}: proved (" in shown.replace("\n", "")
    (row,) = [line for line in shown.splitlines() if "joint problem" in line and "makespan" in line]
    assert "proved (2 leaves" in row  # what the table says is the proof that was written
    assert cli.run(["check", path]) == 0
    assert "proved: minimum in [" in capsys.readouterr().out
    assert cli.run(["check", plan]) == 0
    assert "of its makespan is said: proved (2 leaves, " in capsys.readouterr().out
    assert cli.run(["check", plan, mission, "--proof", path]) == 0
    shown = capsys.readouterr().out
    assert "is optimal (" in shown
    assert f"{path}: the proof that the plan names" in shown
    Path(path).write_text(f"% of somebody else\n{Path(path).read_text()}")
    assert cli.run(["check", plan, mission, "--proof", path]) == 0
    assert f"{path}: not the proof (SHA-256 " in capsys.readouterr().out
    lines = Path(path).read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("degree:"))
    lines[at] = lines[at].replace(" E 0 ", " E 1 ", 1)
    Path(path).write_text("\n".join(lines))
    assert cli.run(["check", plan, "--proof", path]) == 1
    assert f"{path}: line {at + 1}: " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["exact", "two_rooms", "--objective", "latency", "--proof", "p.vipr"],
            "of a latency the suffix is .json",
        ),
        (
            ["exact", "two_rooms", "--proof", "p.txt"],
            "'p.txt'; of a total time the suffix is .vipr",
        ),
        (["check", "two_rooms", "--proof", "p.vipr"], "give one plan with it"),
        (["check", "q.vipr", "--proof", "p.vipr"], "is for a plan"),
    ],
)
def test_what_cannot_be_proved_is_said_before_anything_is_planned(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(words) == 2
    assert said in capsys.readouterr().err.replace("\n", " ")
