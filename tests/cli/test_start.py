"""The command solve --start, as a user types it: a plan, or a planner, to start from."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.mission.instance import Instance
from msmrta_opt.planners import plan as make_plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def plan_file(corridor_file: Path, tmp_path: Path) -> Path:
    file = tmp_path / "plan.json"
    make_plan(Instance.read(corridor_file), planner="greedy").save(file)
    return file


@pytest.mark.parametrize("model", ["joint_routing_flow", "joint_routing_mtz"])
@pytest.mark.parametrize("start", ["staged", "mrga", "FILE"])
def test_a_start_is_the_solution_where_there_is_no_time_for_another(
    start: str, model: str, msmrta: Run, corridor_file: Path, plan_file: Path, capsys: Capture
) -> None:
    """1 + 4 moves and 4 of service, whoever plans it."""
    given = plan_file if start == "FILE" else start
    stopped = ["solve", model, corridor_file, "--time-limit", "0", "--solver", "scip"]
    assert msmrta(*stopped) == 1
    capsys.readouterr()
    assert msmrta(*stopped, "--start", given) == 0
    told = capsys.readouterr().out
    assert any(line.split() == ["objective", "9", "(min)"] for line in told.splitlines())


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["joint_routing_flow", "CORRIDOR", "--start", "none.json"], "none.json: no such file"),
        (
            ["joint_routing_flow", "PAPER", "--start", "FILE"],
            "the plan is for another mission than ",
        ),
        (
            ["joint_routing_flow", "CORRIDOR", "--start", "staged", "--solver", "glpk"],
            "solver glpk cannot do start",
        ),
        (
            ["cluster_one_to_one", "CORRIDOR", "--start", "staged"],
            "--start: a plan is no start for a formulation of stage 'cluster'",
        ),
    ],
)
def test_what_cannot_be_a_start_gets_one_line_and_status_2(
    arguments: list[str],
    problem: str,
    msmrta: Run,
    corridor_file: Path,
    paper_file: Path,
    plan_file: Path,
    capsys: Capture,
) -> None:
    names = {"CORRIDOR": corridor_file, "PAPER": paper_file, "FILE": plan_file}
    assert msmrta("solve", *(names.get(text, text) for text in arguments)) == 2
    told = capsys.readouterr()
    assert (told.out, told.err.count("\n")) == ("", 1)
    assert problem in told.err


def test_a_plan_that_does_not_hold_is_no_start(
    msmrta: Run, corridor_file: Path, plan_file: Path, capsys: Capture
) -> None:
    plan_file.write_text(plan_file.read_text().replace('"departure":3.0', '"departure":4.0'))
    assert msmrta("solve", "joint_routing_flow", corridor_file, "--start", plan_file) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "the plan does not hold: " in told
