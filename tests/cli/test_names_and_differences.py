"""The commands instances and diff-plans, and shipped instances wherever a file is asked for."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.mission.examples import example
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan

Run = Callable[..., int]
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def plans(tmp_path: Path) -> tuple[Path, Path]:
    files = tmp_path / "a.json", tmp_path / "b.json"
    for file, planner in zip(files, ("greedy", "msmrta"), strict=True):
        plan(example("two_rooms"), planner=planner).save(file)
    return files


def test_instances_lists_what_can_be_named(msmrta: Run, capsys: Capture) -> None:
    assert msmrta("instances") == 0
    told = capsys.readouterr().out
    assert "suite/rooms" in told
    assert "corridor" in told


@pytest.mark.parametrize(
    "words",
    [
        ("plan", "corridor", "--planner", "greedy"),
        ("check", "corridor"),
        ("show", "cluster_printed", "corridor"),
        ("models", "corridor", "--stage", "cluster"),
        ("solve", "cluster_printed", "corridor"),
        ("scout", "scouted"),
        ("tradeoff", "corridor"),
    ],
)
def test_a_shipped_name_stands_for_its_file(
    words: tuple[str, ...], msmrta: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert msmrta(*words) == 0


def test_the_file_of_a_name_is_never_overwritten(
    msmrta: Run, instances_dir: Path, capsys: Capture
) -> None:
    before = (instances_dir / "corridor.json").read_bytes()
    assert msmrta("plan", "corridor", "--json", instances_dir / "corridor.json") == 2
    assert "would overwrite what is read" in capsys.readouterr().err
    assert (instances_dir / "corridor.json").read_bytes() == before


def test_diff_plans_shows_metrics_moves_and_a_picture(
    msmrta: Run, plans: tuple[Path, Path], tmp_path: Path, capsys: Capture
) -> None:
    before, after = (Plan.read(file) for file in plans)
    assert msmrta("diff-plans", *plans, "--figure", tmp_path / "both.svg") == 0
    told = capsys.readouterr().out
    assert f"{before.metrics.total_time:g}" in told
    assert f"{after.metrics.total_time:g}" in told
    assert before.diff(after).summary in told
    assert (tmp_path / "both.svg").stat().st_size > 0
    assert "different missions" not in told


def test_diff_plans_says_how_missions_differ(
    msmrta: Run, plans: tuple[Path, Path], tmp_path: Path, capsys: Capture
) -> None:
    other = tmp_path / "other.json"
    plan(example("corridor"), planner="greedy").save(other)
    assert msmrta("diff-plans", plans[0], other) == 0
    assert (
        "The plans are for different missions: the map has another size" in capsys.readouterr().out
    )
