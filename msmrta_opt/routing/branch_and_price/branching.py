"""Decisions that part the answers of a joint problem in two, for latency.

Who serves a need, and whether it is done by some time: where a relaxation's paths agree on both for
every need, they are whole routes. Either way only the robots' networks change.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable
from functools import partial

from ..problem import RoutingData
from .master import Path
from .ng_network import Network
from .tasks import Needs

UNDECIDED = 0.05
"""Share of a need beside the nearest whole one that asks for a decision on who serves it."""
_TINY = 1e-6

Restriction = Callable[[Network], None]
"""Rules out what is on the other side."""


def decision(
    data: RoutingData, needs: Needs, used: list[tuple[float, Path]]
) -> tuple[Restriction, ...]:
    """The two sides of the most open decision; none if every one is taken.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    needs : Needs
        Its requirements.
    used : list of (share, Path)
        The paths of a relaxation.
    """
    share: dict[tuple[int, int], float] = defaultdict(float)
    times: dict[int, dict[float, float]] = defaultdict(lambda: defaultdict(float))
    for part, (robot, stops) in used:
        for _, own, time in stops:
            for g in own:
                share[g, robot] += part
                times[g][time] += part
    open_, (need, robot) = max(
        ((min(part, 1.0 - part), who) for who, part in share.items()), default=(0.0, (0, 0))
    )
    if open_ > UNDECIDED:
        return (
            partial(_serve, need=need, robot=robot, serve=True),
            partial(_serve, need=need, robot=robot, serve=False),
        )
    spread: dict[int, tuple[float, float]] = {}
    for g, when in times.items():
        total = sum(when.values())
        mean = sum(t * part for t, part in when.items()) / total
        off = sum(abs(t - mean) * part for t, part in when.items()) / total
        spread[g] = float(data.priority[needs.victim[g]]) * off, mean
    need = max(spread, key=lambda g: spread[g], default=-1)
    if need < 0 or spread[need][0] <= _TINY:
        return ()
    middle = spread[need][1]
    return (
        partial(_when, need=need, after=-math.inf, until=middle),
        partial(_when, need=need, after=middle, until=math.inf),
    )


def _serve(network: Network, *, need: int, robot: int, serve: bool) -> None:
    """Only `robot` may serve `need`, or anyone but it."""
    if (network.robot == robot) != serve:
        network.restrict(need, serve=False, after=-math.inf, until=math.inf)


def _when(network: Network, *, need: int, after: float, until: float) -> None:
    """`need` is done later than `after` and by `until`."""
    network.restrict(need, after=after, until=until)
