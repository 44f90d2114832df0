"""Limits on whole routes: one place for the exact planner and for the explicit models."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import msmrta_opt as mo
from msmrta_opt.cli import run
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.instance import Instance
from msmrta_opt.stages.data import stage_data
from msmrta_opt.stages.options import RoutingOptions

# By hand: a robot at 1 of a corridor of five cells, victims at 0 and 4, service 2 each. It walks 5
# cells and is done after 9; back at its start after 12, having walked 8.
LIMITS: list[tuple[dict[str, Any], float | None]] = [
    ({}, 9),
    ({"return_to_start": True}, 12),
    ({"endurance": 9}, 9),
    ({"endurance": 8.5}, None),
    ({"longest_walk": 5}, 9),
    ({"longest_walk": 4}, None),
    ({"return_to_start": True, "longest_walk": 8}, 12),
    ({"return_to_start": True, "longest_walk": 7}, None),
]
MODELS: dict[str, dict[str, float]] = {
    "joint_routing_flow": {"w": 0.0},
    "joint_routing_mtz": {"w_total": 1.0, "w_makespan": 0.0, "w_latency": 0.0},
}


@pytest.fixture
def corridor(instances_dir: Path) -> Instance:
    return Instance.read(instances_dir / "corridor.json")


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("limits", "total"), LIMITS)
def test_planner_and_models_agree_on_what_limits_allow(
    corridor: Instance, limits: dict[str, Any], total: float | None, model: str
) -> None:
    data = stage_data(corridor, "routing", RoutingOptions(**limits))
    solution = mo.solve(model, data, **MODELS[model])
    if total is None:
        assert solution.status == "infeasible"
        with pytest.raises(InputError, match="limits exists"):
            mo.plan(corridor, planner="exact", **limits)
    else:
        assert solution.objective == pytest.approx(total)
        made = mo.plan(corridor, planner="exact", **limits)
        assert made.metrics.total_time == pytest.approx(total)


def test_explain_heeds_limits_that_it_is_given(
    instances_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = ["explain", "joint_routing_mtz", str(instances_dir / "corridor.json"), "--option"]
    run([*line, "endurance=8.5"])
    assert "joint_routing_mtz is infeasible" in capsys.readouterr().out
    run([*line, "endurance=9"])
    assert "joint_routing_mtz is feasible" in capsys.readouterr().out
    assert run([*line, "longest_walks=4"]) == 2
    assert "longest_walks: no such option" in capsys.readouterr().err
