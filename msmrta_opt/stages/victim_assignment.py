"""Victim assignment (Algorithm 1, VictimAssign; Eq. 2): who takes which remaining victim, stage B3.

A robot that takes several victims visits them nearest first, from where stage B2 leaves it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..optimise import registry
from ..optimise.data import VictimData
from ..optimise.solution import Solution
from ..optimise.solve import solve
from .cluster_assignment import binary, kinds
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
        ``victim_model`` and ``beta``.

    Raises
    ------
    CheckError
        If there is no solution that passes its check.
    """
    if not data.can_serve.any():
        return VictimAssignment([], None)
    model = registry.get(options.victim_model, stage="victim")
    solution = solve(model, data, **model.takes(beta=options.beta)).require()
    chosen = binary(solution, data.can_serve.shape)
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
