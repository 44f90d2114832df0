"""Victim assignment (Algorithm 1, VictimAssign; Eq. 2): who takes which remaining victim, stage B3.

A robot that takes several victims visits them nearest first, from where stage B2 leaves it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..mission.errors import CheckError
from ..optimise import registry
from ..optimise.data import VictimData
from ..optimise.solution import Solution
from ..optimise.solve import solve
from .cluster_assignment import kinds
from .options import StagedOptions
from .situation import Situation, Stop, each_once, nearest_first

STAGE = "B3"


@dataclass(frozen=True, eq=False)
class VictimAssignment:
    """Stage B3; ``solution`` is that of Eq. 2, ``None`` if nobody could be assigned."""

    stops: list[Stop]
    solution: Solution | None


def victim_assignment(
    situation: Situation,
    stops: Sequence[Stop],
    remaining: NDArray[np.bool_],
    data: VictimData,
    options: StagedOptions,
) -> VictimAssignment:
    """Solve Eq. 2, and queue what each robot serves.

    Parameters
    ----------
    stops : sequence of Stop
        Stage B2.
    remaining : bool array, shape (n_victims, n_kinds)
        Available requirements that B2 leaves open.
    data : VictimData
        From `performance_analysis`.
    options : StagedOptions
        ``victim_model`` and its parameters, ``solver``.

    Raises
    ------
    CheckError
        If there is no solution that passes its check; where it is the robots' endurance that allows
        none, with the time that is needed.
    """
    if not data.can_serve.any():
        return VictimAssignment([], None)
    model = registry.for_plans(options.victim_model, "victim")
    solution = solve(model, data, solver=options.solver, **options.values_for(model))
    if solution.status == "infeasible" and np.isfinite(data.endurance).any():
        raise CheckError(_too_little_time(situation, data))
    chosen = solution.require().values["x"] > 0.5
    cells = situation.instance.cells
    ends, _ = situation.after(stops)
    queued: list[Stop] = []
    for r, end in enumerate(ends):
        taken = [int(v) for v in np.flatnonzero(chosen[r])]
        order = nearest_first(situation.distances, end, [cells[v] for v in taken])
        queued.extend(
            Stop(r, cells[v], STAGE, v, kinds(situation.able[r, v] & remaining[v]))
            for v in (taken[i] for i in order)
        )
    return VictimAssignment(each_once(queued), solution)


def _too_little_time(situation: Situation, data: VictimData) -> str:
    """The first victim that asks for a longer endurance, or that all together do."""
    soonest = np.where(data.can_serve, data.success, np.inf).min(axis=0)
    enough = (data.can_serve & (data.success <= data.endurance[:, None])).any(axis=0)
    beyond = np.flatnonzero(data.can_serve.any(axis=0) & ~enough)
    endurance = float(data.endurance.max())
    if not beyond.size:
        return (
            f"endurance: within {endurance:g} the robots have the time for each victim, but not for all;"
            " give more"
        )
    v, others = beyond[0], beyond.size - 1
    more = f", and more for {others} other{'s' * (others > 1)}" if others else ""
    return (
        f"endurance: no robot has the time for victim {situation.instance.victims[v].id} within "
        f"{endurance:g}; at least {_up(float(soonest[v]))} is needed{more}"
    )


def _up(number: float) -> str:
    """`number` in twelve digits, rounded up so that it is enough."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 11)
    shown = f"{number:.12g}"
    return shown if float(shown) >= number else f"{number + unit:.12g}"
