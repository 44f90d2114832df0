"""Improvement by parts: some robots at a time share out anew, and best, what they serve together.

A few robots make up a small joint problem, which the strong method solves as a rule in a second. Parts
are drawn where the relaxation of the whole is undecided: around robots between which it splits victims.
Once several of a size in a row are found to be best already, they grow by a robot.

Source: Taillard and Voss, *POPMUSIC: partial optimization metaheuristic under special intensification
conditions* (2002).
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Sequence

import numpy as np

from ...arrays import Floats
from ..objectives import Objective, objective_of
from ..problem import Routes, RoutingData, times

Solve = Callable[[RoutingData, Routes, float], Routes]
"""Better routes of a joint problem, given some, within seconds."""

FEWEST, MOST = 3, 7
"""Robots of a part, to begin with and at last."""
IN_VAIN = 10
"""Draws in a row that bring nothing, after which parts grow."""
LONGEST, SHARE = 10.0, 0.25
"""Seconds for a part, and the share of all seconds."""
_FAR = 1e-3
"""Weight of robots between which nothing is split."""
_BETTER = 1e-6


def improve_by_parts(
    data: RoutingData,
    objective: str | Objective,
    routes: Routes,
    split: Floats,
    solve: Solve,
    *,
    seconds: float,
    seed: int = 0,
    improved: Callable[[Routes], object] = lambda routes: None,
    should_stop: Callable[[], bool] = lambda: False,
) -> Routes:
    """Routes at least as good as `routes`.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    objective : str or Objective
        What to minimise.
    routes : Routes
        Feasible routes to begin with.
    split : array, shape (n_robots, n_robots)
        How much two robots may have to share out between them; 0 or more, symmetric.
    solve : callable
        Solves a part.
    seconds : float
        Wall time to spend.
    seed : int
        Of the draws.
    improved : callable
        Called with routes whenever some part of them got better.
    should_stop : callable
        Asked before each part.
    """
    objective = objective_of(objective)
    rng = random.Random(seed)
    until = time.monotonic() + seconds
    known: set[frozenset[int]] = set()
    size, in_vain = FEWEST, 0
    while size < min(MOST + 1, data.n_robots) and not should_stop():
        left = until - time.monotonic()
        if left <= 0:
            break
        if in_vain == IN_VAIN:
            size, in_vain = size + 1, 0
            continue
        in_vain += 1
        first = _busiest(data, routes) if objective.only_last else None
        robots = _draw(split, size, rng, first)
        key = frozenset(robots)
        part, own, victims = part_of(data, routes, robots)
        if key in known or not victims:
            continue
        known.add(key)
        found = solve(part, own, min(left, LONGEST, SHARE * seconds))
        if objective.value(part, found) < objective.value(part, own) - _BETTER:
            routes, in_vain = put_back(routes, robots, found, victims), 0
            improved(routes)
            # What was best beside the old routes need not be beside the new.
            known = {other for other in known if not other & key} | {key}
    return routes


def part_of(
    data: RoutingData, routes: Routes, robots: Sequence[int]
) -> tuple[RoutingData, Routes, list[int]]:
    """The joint problem of some robots, of what they serve: it, their routes, and its victims."""
    able = np.zeros_like(data.able)
    for r in robots:
        for v, kinds in routes[r]:
            for k in kinds:
                able[:, v, k] = data.able[:, v, k]
    own = np.array(robots)
    victims = np.flatnonzero(able[own].any(axis=(0, 2)))
    place = {int(v): i for i, v in enumerate(victims)}
    part = RoutingData(
        leave=data.leave[np.ix_(own, victims)],
        between=data.between[np.ix_(own, victims, victims)],
        back=data.back[np.ix_(own, victims)],
        service=data.service[victims],
        able=able[np.ix_(own, victims)],
        priority=data.priority[victims],
        endurance=data.endurance[own],
        longest_walk=data.longest_walk[own],
    )
    theirs = tuple(tuple((place[v], kinds) for v, kinds in routes[r]) for r in robots)
    return part, theirs, victims.tolist()


def put_back(
    routes: Routes, robots: Sequence[int], found: Routes, victims: Sequence[int]
) -> Routes:
    """The routes of all robots, with those that were found for a part."""
    whole = list(routes)
    for r, route in zip(robots, found, strict=True):
        whole[r] = tuple((victims[v], kinds) for v, kinds in route)
    return tuple(whole)


def _draw(split: Floats, size: int, rng: random.Random, first: int | None) -> list[int]:
    """Robots between which much is split, one of them `first` if it is given."""
    robots = range(len(split))
    # Roots, lest two robots that are alike, and share all they do, be in every part.
    weight = np.sqrt(split) + _FAR
    if first is None:
        first = rng.choices(robots, weight.sum(axis=1).tolist())[0]
    chosen = [first]
    while len(chosen) < size:
        others = [r for r in robots if r not in chosen]
        close = weight[chosen].sum(axis=0)[others]
        chosen += rng.choices(others, close.tolist())
    return sorted(chosen)


def _busiest(data: RoutingData, routes: Routes) -> int:
    return int(times(data, routes).busy.argmax())
