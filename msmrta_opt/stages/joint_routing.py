"""The data of the joint problem: no line of Algorithm 1, but all its decisions at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import Bools, Floats
from ..mission.grid import Cell
from ..mission.plan import LIMITS, Reason
from ..routing.problem import RoutingData
from .options import StagedOptions
from .situation import Situation

ROUNDING = 1e-9
"""Relative difference up to which times are the same."""


def routing_data(
    situation: Situation,
    *,
    endurance: float | Floats | None = None,
    longest_walk: float | Floats | None = None,
    return_to_start: bool = False,
    homes: Sequence[Cell] | None = None,
) -> RoutingData:
    """The joint problem of the known victims.

    A requirement that each capable robot could serve only beyond its limits, even alone, is left
    out: the limits are options, so what they forbid is reported apart from what nobody can do.

    Parameters
    ----------
    situation : Situation
        Who can serve what, and the distances.
    endurance : float or array, optional
        Maximum time that a robot may be busy, its way back included; for all, or ``(n_robots,)``.
    longest_walk : float or array, optional
        Maximum number of cells that a robot may walk, its way back included.
    return_to_start : bool
        Whether robots walk back after their last visit.
    homes : sequence of cells, optional
        Where each robot walks back to, if that is not its start.
    """
    instance, distances = situation.instance, situation.distances
    speed = instance.speed
    leave = np.where(
        situation.reach, distances.between(instance.starts, instance.cells) / speed[:, None], 0.0
    )
    between = distances.between(instance.cells, instance.cells)
    between[np.isinf(between)] = 0.0
    back = np.zeros_like(leave)
    if return_to_start:
        back = leave if homes is None else distances.between(homes, instance.cells) / speed[:, None]
        back = np.where(np.isinf(back), 0.0, back)
    # Rounding does not break a limit.
    endurance, longest_walk = (
        np.inf if limit is None else limit * (1.0 + ROUNDING) for limit in (endurance, longest_walk)
    )
    data = RoutingData(
        leave=leave,
        length=between[None],
        speed=speed,
        is_metric=True,
        back=back,
        service=instance.service,
        able=situation.able,
        priority=instance.priority,
        endurance=np.full(instance.n_robots, endurance),
        longest_walk=longest_walk / speed,
        ids={
            "r": [robot.id for robot in instance.robots],
            "v": [victim.id for victim in instance.victims],
            "k": instance.capabilities,
        },
        around=situation.around(),
    )
    in_time, in_walk = _alone(data)
    return replace(data, able=situation.able & in_time & in_walk[:, :, None])


def limits_of(options: StagedOptions) -> dict[str, Any]:
    """The limits on whole routes that `options` name."""
    return {name: getattr(options, name) for name in LIMITS if hasattr(options, name)}


def beyond_limits(situation: Situation, data: RoutingData) -> dict[tuple[int, int], Reason]:
    """What `data` leaves out of what can be served, as pairs of victim and kind, and which limit does.

    A limit does where a robot would come within the other; where none does, or one robot for the one
    and another for the other, both do.
    """
    in_time, in_walk = _alone(data)
    by_time = np.any(situation.able & in_time, axis=0)
    by_walk = np.any(situation.able & in_walk[:, :, None], axis=0)
    reasons = {
        (False, True): Reason.BEYOND_ENDURANCE,
        (True, False): Reason.BEYOND_LONGEST_WALK,
    }
    return {
        (int(v), int(k)): reasons.get((by_time[v, k], by_walk[v, k]), Reason.BEYOND_BOTH)
        for v, k in np.argwhere(situation.available & ~data.required)
    }


def _alone(data: RoutingData) -> tuple[Bools, Bools]:
    """Where a robot that does nothing else keeps its endurance, and where its longest walk.

    Of shapes ``(n_robots, n_victims, n_kinds)`` and ``(n_robots, n_victims)``.
    """
    travel = data.leave + data.back
    busy = travel[:, :, None] + data.service[None]
    in_time = busy <= data.endurance[:, None, None]
    return in_time, travel <= data.longest_walk[:, None]
