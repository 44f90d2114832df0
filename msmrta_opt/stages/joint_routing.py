"""The data of the joint problem: no line of Algorithm 1, but all its decisions at once."""

from __future__ import annotations

import numpy as np

from ..routing.problem import RoutingData
from .situation import Situation


def routing_data(
    situation: Situation,
    *,
    endurance: float | None = None,
    longest_walk: float | None = None,
    return_to_start: bool = False,
) -> RoutingData:
    """The joint problem of the known victims.

    A requirement that each capable robot could serve only beyond its limits, even alone, is left
    out: the limits are options, so what they forbid is reported apart from what nobody can do.

    Parameters
    ----------
    situation : Situation
        Who can serve what, and the distances.
    endurance : float, optional
        Most time units that a robot may be busy.
    longest_walk : float, optional
        Most cells that a robot may walk.
    return_to_start : bool
        Whether robots walk back after their last visit.
    """
    instance, distances = situation.instance, situation.distances
    speed = instance.speed
    leave = np.where(
        situation.reach, distances.between(instance.starts, instance.cells) / speed[:, None], 0.0
    )
    between = distances.between(instance.cells, instance.cells)
    between = np.where(np.isfinite(between), between, 0.0)[None] / speed[:, None, None]
    back = leave if return_to_start else np.zeros_like(leave)
    most_busy = np.full(instance.n_robots, np.inf if endurance is None else float(endurance))
    most_walk = np.inf if longest_walk is None else float(longest_walk) / speed
    most_travel = np.broadcast_to(most_walk, speed.shape).astype(float)
    alone = leave + back
    within = alone[:, :, None] + instance.service[None] <= most_busy[:, None, None] + 1e-9
    within &= (alone <= most_travel[:, None] + 1e-9)[:, :, None]
    return RoutingData(
        leave=leave,
        between=between,
        back=back,
        service=instance.service,
        able=situation.able & within,
        priority=instance.priority,
        endurance=most_busy,
        longest_walk=most_travel,
    )
