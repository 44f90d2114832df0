"""Performance analysis (Algorithm 1, PerfAnalysis): the success and failure times of Eq. 2.

For robot r and a remaining victim v, success is when r would be done there: its busy time so far, the
way from where stage B2 leaves it, and the service of what it can do. Failure is the service time that
others must redo, of this victim and of r's record in stage B2, over r's number of capabilities.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..optimise.data import VictimData
from .options import StagedOptions
from .situation import Situation, Stop


def performance_analysis(
    situation: Situation,
    stops: Sequence[Stop],
    remaining: NDArray[np.bool_],
    options: StagedOptions,
) -> VictimData:
    """The data of Eq. 2 after stage B2.

    Parameters
    ----------
    situation : Situation
        Who can serve what.
    stops : sequence of Stop
        Stage B2.
    remaining : bool array, shape (n_victims, n_kinds)
        Available requirements that B2 leaves open.
    options : StagedOptions
        ``performance``: ``pair`` as above; ``robot`` as in the authors' program, one pair of times
        per robot (its largest service time so far; its lost service time over its number of
        capabilities), so that Eq. 2 cannot tell victims apart. ``budget`` and ``endurance``, for
        the formulations that limit them.
    """
    instance = situation.instance
    ends, busy = situation.after(stops)
    left = instance.Q & remaining
    shared = instance.P.astype(int) @ left.T.astype(int)
    can_serve = situation.reach & (shared > 0)
    n_capabilities = np.maximum(instance.P.sum(axis=1), 1)
    record = lost_so_far(situation, stops)
    if options.performance == "pair":
        travel = situation.distances.between(ends, instance.cells) / instance.speed[:, None]
        # Robots with the same capabilities serve the same, and leave the same to others.
        first, like = _alike(instance.P)
        has = instance.P[first][:, None, :]
        service = ((has & left) * instance.service).sum(axis=2)[like]
        lost = (~has * (instance.service * remaining)).sum(axis=2)[like]
        success = busy[:, None] + travel + service
        failure = (lost + record[:, None]) / n_capabilities[:, None]
    else:
        largest = np.zeros(instance.n_robots)
        for stop in stops:
            if stop.victim is not None:
                times = instance.service[stop.victim, list(stop.kinds)]
                largest[stop.robot] = max(largest[stop.robot], times.max(initial=0.0))
        success = np.broadcast_to(largest[:, None], can_serve.shape)
        failure = np.broadcast_to((record / n_capabilities)[:, None], can_serve.shape)
        busy = np.zeros(instance.n_robots)
    endurance = np.inf if options.endurance is None else float(options.endurance)
    return VictimData(
        success=np.where(can_serve, success, 0.0),
        failure=np.where(can_serve, failure, 0.0),
        can_serve=can_serve,
        busy=busy,
        budget=np.full(instance.n_robots, options.budget, dtype=np.int64),
        endurance=np.full(instance.n_robots, endurance),
        ids={
            "r": [robot.id for robot in instance.robots],
            "v": [victim.id for victim in instance.victims],
        },
        around=situation.around(ends),
    )


def _alike(P: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:  # noqa: N803
    """The first robot of each set of capabilities, and the position among these of each robot's."""
    found: dict[bytes, int] = {}
    like = [found.setdefault(row.tobytes(), r) for r, row in enumerate(P)]
    first = np.array(list(found.values()), dtype=np.int64)
    return first, np.searchsorted(first, like)


def lost_so_far(situation: Situation, stops: Sequence[Stop]) -> NDArray[np.float64]:
    """Available service time that each robot left to others at the victims it visited."""
    instance = situation.instance
    record = np.zeros(instance.n_robots)
    visits = [(stop.robot, stop.victim) for stop in stops if stop.victim is not None]
    if visits:
        robots, victims = np.array(visits).T
        left = situation.available[victims] & ~instance.P[robots]
        np.add.at(record, robots, (instance.service[victims] * left).sum(axis=1))
    return record
