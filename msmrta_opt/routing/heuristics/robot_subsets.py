"""Fix-and-optimise by robot subsets: some robots at a time share out anew what they serve together.

A few robots make up a small joint problem, which branch and cut solves as a rule in a second. Subsets
are drawn where the relaxation of the whole is undecided: around robots between which it splits victims.
Once several of a size in a row are found to be optimal already, they grow by a robot.

Source: Taillard and Voss, *POPMUSIC: partial optimization metaheuristic under special intensification
conditions* (2002).
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

import numpy as np

from ...arrays import Floats
from ..incumbent import Progress
from ..parameters import HeuristicsParameters
from ..problem import Routes, RoutingData, times
from ..stop import StoppingCriterion

Solve = Callable[[RoutingData, Routes, StoppingCriterion], Routes]
"""Better routes of a joint problem, given some."""

_FAR = 1e-3
"""Weight of robots between which nothing is split."""
_BETTER = 1e-9
"""Share by which a subset's value falls at the minimum where it gets better."""


def improve_robot_subsets(
    progress: Progress,
    shared: Floats,
    solve: Solve,
    *,
    stop: StoppingCriterion,
    seed: int = 0,
    parameters: HeuristicsParameters | None = None,
) -> None:
    """Offer `progress` better routes, whenever some subset of its robots finds some.

    Parameters
    ----------
    progress : Progress
        The joint problem and its incumbent.
    shared : array, shape (n_robots, n_robots)
        How much two robots may have to share out between them; 0 or more, symmetric.
    solve : callable
        Solves the joint problem of a subset.
    stop : StoppingCriterion
        When to end.
    seed : int
        Of the draws.
    parameters : HeuristicsParameters, optional
        How large subsets are.
    """
    tuning = parameters or HeuristicsParameters()
    data, objective, routes = progress.data, progress.objective, progress.routes
    rng = random.Random(seed)
    seconds = min(tuning.subset_seconds, tuning.subset_share * stop.seconds_left())
    known: set[frozenset[int]] = set()
    size, failures = tuning.smallest_subset, 0
    while size < min(tuning.largest_subset + 1, data.n_robots) and not stop.met():
        if failures == tuning.subset_failures:
            size, failures = size + 1, 0
            continue
        failures += 1
        first = _busiest(data, routes) if objective.only_last else None
        robots = _draw(shared, size, rng, first)
        key = frozenset(robots)
        subset, own, victims = subset_of(data, routes, robots)
        if key in known or not victims:
            continue
        known.add(key)
        found = solve(subset, own, stop.within(seconds))
        if objective.value(subset, found) < objective.value(subset, own) * (1.0 - _BETTER):
            routes, failures = put_back(routes, robots, found, victims), 0
            progress.offer(routes)
            # What was best beside the old routes need not be beside the new.
            known = {other for other in known if not other & key} | {key}


def subset_of(
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
    tables = own if len(data.length) > 1 else np.zeros(1, np.int64)
    subset = RoutingData(
        leave=data.leave[np.ix_(own, victims)],
        length=data.length[np.ix_(tables, victims, victims)],
        back=data.back[np.ix_(own, victims)],
        service=data.service[victims],
        able=able[np.ix_(own, victims)],
        priority=data.priority[victims],
        endurance=data.endurance[own],
        longest_walk=data.longest_walk[own],
        speed=data.speed[own],
        is_metric=data.is_metric,
        time_unit=data.time_unit,
        priority_unit=data.priority_unit,
        ids={
            "r": [data.ids["r"][r] for r in robots],
            "v": [data.ids["v"][v] for v in victims.tolist()],
            "k": data.ids["k"],
        },
    )
    theirs = tuple(tuple((place[v], kinds) for v, kinds in routes[r]) for r in robots)
    return subset, theirs, victims.tolist()


def put_back(
    routes: Routes, robots: Sequence[int], found: Routes, victims: Sequence[int]
) -> Routes:
    """The routes of all robots, with those that were found for a subset."""
    whole = list(routes)
    for r, route in zip(robots, found, strict=True):
        whole[r] = tuple((victims[v], kinds) for v, kinds in route)
    return tuple(whole)


def _draw(shared: Floats, size: int, rng: random.Random, first: int | None) -> list[int]:
    """Robots between which much is split, one of them `first` if it is given."""
    robots = range(len(shared))
    # Roots, lest two robots that are alike, and share all they do, be in every subset.
    weight = np.sqrt(shared) + _FAR
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
