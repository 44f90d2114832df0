"""What proves a bound on latency before branching, in words that outlive the program.

The rounds of `latency_prices.LatencyRoot`, by the ids of robots and victims; see `mission.proof`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from ...mission.instance import Instance
from ...mission.proof import LatencyProof
from ..problem import RoutingData
from .duals import LatencyRoot, Round
from .tasks import Needs

_PARTS = 10**9
"""Charges are rounded down by up to two such parts of a victim's priority: they never add up to more."""
_DIGITS = 12
"""Significant digits of a reward: any rewards prove a bound, these the same one to that precision."""


@dataclass(frozen=True, eq=False)
class LatencyEvidence:
    """What column generation proved before branching."""

    root: LatencyRoot
    data: RoutingData
    size: tuple[int, int] = (0, 0)
    """Its programs are not stored."""

    def written(self, instance: Instance, worth: float) -> LatencyProof:
        """By the ids of `instance`, for routes worth `worth`."""
        return latency_proof(instance, self.data, self.root, worth)


def latency_proof(
    instance: Instance, data: RoutingData, root: LatencyRoot, worth: float
) -> LatencyProof:
    """The proof of a root bound on latency.

    Parameters
    ----------
    instance : Instance
        With the known victims, in the order of `data`.
    data : RoutingData
        The joint problem.
    root : LatencyRoot
        What its search proved before branching.
    worth : float
        Value of the routes found: no bound is above it.
    """
    return LatencyProof.model_validate(
        {
            "bound": min(root.value, worth),
            "solver": f"highs {version('highspy')}",
            "time_steps": [
                {"robot": instance.robots[r].id, "length": step} for r, step in root.clocks.items()
            ],
            "rounds": [_round(instance, data, root.needs, part) for part in root.rounds],
        }
    )


def _round(instance: Instance, data: RoutingData, needs: Needs, part: Round) -> dict[str, Any]:
    victims = [victim.id for victim in instance.victims]
    prices = part.prices
    return {
        "tasks": [
            {
                "victim": victims[v],
                "kinds": [instance.capabilities[k] for k in kinds],
                "dual": float(f"{prices.reward[g]:.{_DIGITS}g}"),
                "densities": [_down(mu, float(data.priority[v])) for mu in prices.density[g]],
            }
            for g, (v, kinds) in enumerate(zip(needs.victim, needs.kinds, strict=True))
        ],
        "breakpoints": [
            {"victim": victims[v], "times": breaks[1:].tolist()}
            for v, breaks in enumerate(prices.breaks)
            if len(breaks) > 1
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


def _down(charge: float, priority: float) -> float:
    share = charge / priority if priority else 0.0
    return priority if share >= 1.0 else max(math.floor(share * _PARTS) - 1, 0) * priority / _PARTS
