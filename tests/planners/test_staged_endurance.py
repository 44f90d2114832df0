"""The staged planner's endurance is Eq. 2's: what other stages give a robot comes on top."""

from __future__ import annotations

from pathlib import Path

import msmrta_opt as mo


def test_a_staged_plan_may_keep_its_robots_busy_beyond_the_endurance_of_eq_2(
    instances_dir: Path,
) -> None:
    mission = mo.read(str(instances_dir / "paper.json"))
    plan = mo.plan(mission, victim_model="victim_generalized", endurance=400)
    assert plan.metrics.served_share == 1
    assert plan.metrics.makespan > 400
