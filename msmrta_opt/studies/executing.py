"""What a run of a policy does: plan a mission once, and execute the plan, seed by seed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import fmean
from typing import Any

from ..execution.execute import execute_checked
from ..execution.hindsight import digest_of_problem, hindsight
from ..mission.instance import Instance
from ..mission.run_metrics import RUN_METRICS
from ..mission.scenario import Scenario
from ..planners import plan
from ..routing.objectives import DEFAULT
from .tasks import Planning


@dataclass(frozen=True)
class Executing:
    """A planner's plan, executed by a policy with the seeds from 0 on."""

    planning: Planning
    policy: str
    options: Mapping[str, Any]
    """Of the policy."""
    scenario: Scenario
    runs: int
    hindsight: float | None = None
    """Seconds to find the best that a run's world allowed."""
    objective: str = DEFAULT
    """By what that is judged."""

    @property
    def folders(self) -> tuple[str, ...]:
        """Folders of models."""
        return self.planning.folders

    def asked(self) -> dict[str, Any]:
        """What a record says of it before there is a result."""
        options = {**self.planning.options, **{f"policy.{k}": v for k, v in self.options.items()}}
        if self.hindsight is not None:
            options["hindsight.objective"] = self.objective
        return {
            **self.planning.asked(),
            "method": "execution",
            "scenario": self.scenario.name,
            "policy": self.policy,
            "options_json": json.dumps(options, sort_keys=True),
        }

    def warm_up(self) -> None:
        """As the planner's."""
        self.planning.warm_up()

    def do(self, instance: Instance) -> dict[str, Any]:
        """Plan `instance` and execute the plan; returns fields of a record.

        Every run is checked. ``seconds`` are those of planning; deciding has its own, by seed.
        """
        made = plan(instance, planner=self.planning.planner, **dict(self.planning.options))
        values: dict[str, list[float]] = {name: [] for name in (*RUN_METRICS, "deciding_seconds")}
        for seed in range(self.runs):
            run = execute_checked(made, self.scenario, self.policy, seed, self.options)
            for name in RUN_METRICS:
                values[name].append(getattr(run.metrics, name))
            values["deciding_seconds"].append(run.deciding_seconds)
            if self.hindsight is not None:
                best = hindsight(run, objective=self.objective, time_limit=self.hindsight)
                values.setdefault("hindsight_best", []).append(best.best)
                values.setdefault("hindsight_bound", []).append(best.bound)
                values.setdefault("hindsight_problem", []).append(digest_of_problem(run))
        means = {name: fmean(values[name]) for name in RUN_METRICS}
        return {
            "metrics_json": json.dumps(means),
            "executions_json": json.dumps({"seeds": list(range(self.runs)), **values}),
            "check": "passed",
            "seconds": made.metrics.planning_seconds,
            "stage_seconds_json": json.dumps(made.planning_seconds),
        }
