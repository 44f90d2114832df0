"""The script that measures replanning, on small missions, in its quick form."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

import pytest

from msmrta_opt.execution.state import Task
from msmrta_opt.mission.instance import Instance


@pytest.fixture(scope="module")
def replanning() -> ModuleType:
    """The script as a module."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
    try:
        return importlib.import_module("replanning")
    finally:
        sys.path.pop(0)


def test_a_decision_and_a_fresh_plan_are_in_each_row(
    replanning: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    replanning.main(["--size", "3x6", "--seconds", "0.05", "--seeds", "1"])
    lines = capsys.readouterr().out.splitlines()
    rows = [line.strip("| ").split(" | ") for line in lines if line.startswith("| map")]
    assert len(rows) == len(replanning.NUMBERS)
    for _, _, visits, _, _, travel, fresh, ratio in rows:
        assert int(visits) > 0
        assert float(ratio) == pytest.approx(float(travel) / float(fresh), rel=0.02)
    assert lines[-2].startswith("| median |")


def test_travel_is_that_of_the_shortest_ways(replanning: ModuleType) -> None:
    mission = Instance.from_document(
        {
            "map": {"rows": ["......"]},
            "capabilities": ["Aid"],
            "service_time": {"Aid": 1.0},
            "robots": [{"id": 1, "start": [0, 2], "speed": 0.5, "capabilities": ["Aid"]}],
            "victims": [
                {"id": i, "cell": [0, col], "requirements": ["Aid"]} for i, col in ((7, 0), (8, 5))
            ],
        }
    )
    # Two cells to the left and five to the right, two time units each.
    assert replanning.travel_of(mission, {1: [Task(7), Task(8)]}) == 14.0
