"""What staging costs, against enumeration and against the exact planner."""

from __future__ import annotations

import os
import signal
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from msmrta_opt.cli import run
from msmrta_opt.interruption import interruptible
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan
from msmrta_opt.studies.analysis import staging
from msmrta_opt.studies.analysis.staging import candidates, price_of_staging

INSTANCES = Path(__file__).parents[3] / "instances"


def test_losses_lead_from_the_staged_plan_to_the_optimum(paper: Instance) -> None:
    staged = plan(paper)
    losses = price_of_staging(staged, seconds=5)
    assert losses[0].before == pytest.approx(staged.metrics.total_time)
    for earlier, later in pairwise(losses):
        assert later.before == earlier.after
    for item in losses:
        assert item.loss >= -1e-9
        assert item.bound <= item.after + 1e-9
    # The mission's optimum, by two formulations and two solvers elsewhere.
    assert losses[-1].after == pytest.approx(1218 + 1 / 3)
    assert sum(item.loss for item in losses) == pytest.approx(losses[0].before - losses[-1].after)


def test_an_order_that_walks_past_a_victim_costs_what_a_hand_finds() -> None:
    """One robot at the left end of 1×5 cells; victims at columns 2 and 4, each 1 time unit.

    The cluster's centre is column 3, so the staged plan goes to 3, back to 2 (the nearer, first of
    two as near), on to 4: 3 + 1 + 2 = 6 cells; the best order walks 4. Service is 2 either way.
    """
    document = {
        "name": "past",
        "map": {"rows": ["....."]},
        "capabilities": ["A"],
        "service_time": {"A": 1},
        "robots": [{"id": 0, "start": [0, 0], "speed": 1, "capabilities": ["A"]}],
        "victims": [
            {"id": 0, "cell": [0, 2], "requirements": ["A"]},
            {"id": 1, "cell": [0, 4], "requirements": ["A"]},
        ],
    }
    mission = Instance.from_document(document)
    losses = price_of_staging(plan(mission), seconds=1)
    assert [item.loss for item in losses] == pytest.approx([2, 0, 0, 0])
    assert losses[-1].after == losses[-1].bound == pytest.approx(6)


def test_no_plan_is_better_than_the_bound_and_improving_never_hurts() -> None:
    mission = Instance.read(INSTANCES / "two_rooms.json")
    found = {item.name: item for item in candidates(mission, "makespan", seconds=2)}
    for name, item in found.items():
        assert item.value >= item.bound - 1e-9
        assert 0 <= item.gap <= 1
        if name.endswith(", improved"):
            assert item.value <= found[name.removesuffix(", improved")].value + 1e-9
    assert found["exact"].gap == 0


def test_a_plan_is_improved_by_as_much_on_any_machine(paper: Instance) -> None:
    """By a number of iterations: what is compared is the plan that `improve=True` gives."""
    found = {item.name: item for item in candidates(paper, "latency", seconds=0, seed=3)}
    alone = plan(paper, planner="greedy", improve=True, objective="latency", seed=3)
    assert found["greedy, improved"].value == alone.metrics.latency


def test_the_command_prints_both_tables_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "losses.png"
    arguments = ["compare-plans", str(INSTANCES / "two_rooms.json"), "--seconds", "1"]
    assert run([*arguments, "--figure", str(picture)]) == 0
    told = capsys.readouterr().out
    assert "order of visits" in told
    assert "exact" in told
    assert "total_time" in told
    assert "total time" not in told  # the same number a second time
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert run([*arguments, "--objective", "latency"]) == 0
    assert "two_rooms: plans by latency" in capsys.readouterr().out
    assert run([*arguments, "--objective", "duration"]) == 2
    assert "total_time, makespan, latency" in capsys.readouterr().err


@pytest.mark.parametrize(("after", "plans"), [(1, 1), (3, 3), (4, 4)])
def test_ctrl_c_ends_the_whole_with_what_there_is(
    after: int,
    plans: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """One Ctrl-C, sent as a plan is made, ends this mission's comparison and those that follow."""
    made = 0

    def plan_and_interrupt(*arguments: Any, **options: Any) -> Plan:
        nonlocal made
        made += 1
        if made == after:
            os.kill(os.getpid(), signal.SIGINT)
        return plan(*arguments, **options)

    monkeypatch.setattr(staging, "make_plan", plan_and_interrupt)
    missions = [str(INSTANCES / f"{name}.json") for name in ("two_rooms", "split")]
    picture = tmp_path / "losses.png"
    arguments = ["compare-plans", *missions, "--seconds", "1", "--figure", str(picture)]
    assert run(arguments) == 130
    assert made == plans
    told = capsys.readouterr().out
    assert "two_rooms: plans by total_time" in told
    assert "exact" in told
    assert "split" not in told
    assert not picture.exists(), "there is nothing to draw yet"


def test_ctrl_c_between_two_steps_keeps_those_that_were_made(paper: Instance) -> None:
    with interruptible():
        os.kill(os.getpid(), signal.SIGINT)
        assert price_of_staging(plan(paper)) == []
