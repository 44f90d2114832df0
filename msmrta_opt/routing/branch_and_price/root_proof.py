"""What proves a bound on latency before branching, in words that outlive the program.

The rounds of `duals.LatencyRoot`, by the ids of robots and victims; see `mission.proof`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ...mission.instance import Instance
from ...mission.proof import LatencyProof
from ..problem import RoutingData
from ..run_highs import highs_version
from .duals import LatencyRoot, Round

_PARTS = 10**9
"""Densities are rounded down by up to two such parts of a priority: they never add up to more."""
_DIGITS = 12
"""Significant digits of a dual value: any prove a bound, these the same one to that precision."""


@dataclass(frozen=True, eq=False)
class LatencyEvidence:
    """What column generation proved before branching."""

    root: LatencyRoot
    data: RoutingData
    size: tuple[int, int] = (0, 0)
    """Its programs are not stored."""

    def written(self, instance: Instance, worth: float) -> LatencyProof:
        """The proof of the root bound.

        Parameters
        ----------
        instance : Instance
            With the known victims, in the order of `data`.
        worth : float
            Value of the routes found: no bound is above it.
        """
        data = self.data
        unit = data.time_unit * data.priority_unit
        return LatencyProof.model_validate(
            {
                "bound": min(self.root.value * unit, worth),
                "solver": highs_version(),
                "time_steps": [
                    {"robot": instance.robots[r].id, "length": step * data.time_unit}
                    for r, step in self.root.time_steps.items()
                ],
                "rounds": [self._round(instance, part) for part in self.root.rounds],
            }
        )

    def _round(self, instance: Instance, part: Round) -> dict[str, Any]:
        victims = [victim.id for victim in instance.victims]
        tasks, data = self.root.tasks, self.data
        duals = part.duals.scaled(data.time_unit, data.priority_unit)
        priority = data.priority * data.priority_unit
        return {
            "tasks": [
                {
                    "victim": victims[v],
                    "kinds": [instance.capabilities[k] for k in kinds],
                    "dual": float(f"{duals.value[g]:.{_DIGITS}g}"),
                    "densities": [rounded_down(mu, float(priority[v])) for mu in duals.density[g]],
                }
                for g, (v, kinds) in enumerate(zip(tasks.victim, tasks.kinds, strict=True))
            ],
            "breakpoints": [
                {"victim": victims[v], "times": own[1:].tolist()}
                for v, own in enumerate(duals.breakpoints)
                if len(own) > 1
            ],
            "neighbourhoods": [
                {
                    "robot": instance.robots[r].id,
                    "victim": victims[own[i]],
                    "remembers": [victims[w] for w in own[row] if w != own[i]],
                }
                for r, (own, neighbours) in part.neighbours.items()
                for i, row in enumerate(neighbours)
                if row.sum() > 1
            ],
        }


def rounded_down(density: float, priority: float) -> float:
    """A density in parts of the priority, so that those of a victim never add up to more."""
    share = density / priority if priority else 0.0
    return priority if share >= 1.0 else max(math.floor(share * _PARTS) - 1, 0) * priority / _PARTS
