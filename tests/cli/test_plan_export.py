"""The command export-plan."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from msmrta_opt.mission.plan import Plan

Run = Callable[..., int]


def test_export_plan_writes_a_file_for_each_robot(msmrta: Run, plan: Plan, tmp_path: Path) -> None:
    plan.save(tmp_path / "plan.json")
    assert msmrta("export-plan", tmp_path / "plan.json", "-o", tmp_path / "w.yaml") == 0
    assert sorted(path.name for path in tmp_path.glob("w*")) == ["w-3.yaml", "w-7.yaml"]


def test_export_plan_writes_no_plan_that_does_not_hold(
    msmrta: Run, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = plan.document()
    wrong["routes"][0]["visits"][0]["arrival"] = 1
    (tmp_path / "wrong.json").write_text(json.dumps(wrong))
    assert msmrta("export-plan", tmp_path / "wrong.json", "-o", tmp_path / "w.csv") == 1
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not (tmp_path / "w.csv").exists()


def test_export_plan_refuses_a_folder_that_is_not_there(
    msmrta: Run, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    assert msmrta("export-plan", tmp_path / "plan.json", "-o", tmp_path / "no" / "w.csv") == 2
    assert "no folder" in capsys.readouterr().err


def test_a_name_that_the_system_does_not_take_is_told_in_a_line(
    msmrta: Run, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan.save(tmp_path / "plan.json")
    name = tmp_path / f"{'x' * 300}.csv"
    assert msmrta("export-plan", tmp_path / "plan.json", "-o", name) == 2
    assert capsys.readouterr().err == f"error: {name}: File name too long\n"
