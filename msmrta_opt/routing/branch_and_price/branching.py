"""Decisions that divide the solutions of a joint problem in two, for latency.

Who serves a task, and whether it is done by some time: where a relaxation's paths agree on both for
every task, they are whole routes. Either way only the robots' networks change.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable
from functools import partial

from ..problem import RoutingData
from .ng_network import Network
from .path_program import Path
from .tasks import Tasks

_TINY = 1e-6

Restriction = Callable[[Network], None]
"""Rules out what is on the other side."""


def decision(
    data: RoutingData, tasks: Tasks, used: list[tuple[float, Path]], undecided: float
) -> tuple[Restriction, ...]:
    """The two sides of the most open decision; none if every one is taken.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    tasks : Tasks
        Its requirements.
    used : list of (share, Path)
        The paths of a relaxation.
    undecided : float
        Distance of a task's share from the nearest whole number, from which on to decide who serves.
    """
    share: dict[tuple[int, int], float] = defaultdict(float)
    times: dict[int, dict[float, float]] = defaultdict(lambda: defaultdict(float))
    for part, (robot, stops) in used:
        for _, own, time in stops:
            for g in own:
                share[g, robot] += part
                times[g][time] += part
    open_, (task, robot) = max(
        ((min(part, 1.0 - part), who) for who, part in share.items()), default=(0.0, (0, 0))
    )
    if open_ > undecided:
        return (
            partial(_serve, task=task, robot=robot, serve=True),
            partial(_serve, task=task, robot=robot, serve=False),
        )
    spread: dict[int, tuple[float, float]] = {}
    for g, when in times.items():
        total = sum(when.values())
        mean = sum(t * part for t, part in when.items()) / total
        off = sum(abs(t - mean) * part for t, part in when.items()) / total
        spread[g] = float(data.priority[tasks.victim[g]]) * off, mean
    task = max(spread, key=lambda g: spread[g], default=-1)
    if task < 0 or spread[task][0] <= _TINY:
        return ()
    middle = spread[task][1]
    return (
        partial(_when, task=task, after=-math.inf, until=middle),
        partial(_when, task=task, after=middle, until=math.inf),
    )


def _serve(network: Network, *, task: int, robot: int, serve: bool) -> None:
    """Only `robot` may serve `task`, or anyone but it."""
    if (network.robot == robot) != serve:
        network.restrict(task, serve=False, after=-math.inf, until=math.inf)


def _when(network: Network, *, task: int, after: float, until: float) -> None:
    """`task` is done later than `after` and by `until`."""
    network.restrict(task, after=after, until=until)
