"""Bounds at once, before any search: one for each objective.

*Total time and makespan*: each requirement alone, by whoever is soonest done with it.

*Latency*: an assignment of requirements to places in queues. A requirement g at victim v takes robot r
at least

    p_rg = service_g + (shortest travel of r into v) / (number of kinds that r can serve at v),

since a visit's way in is shared by what is served there. If g is the l-th from the end of r's queue,
it delays l requirements, itself among them, so for requirements of one weight the minimum sum of
completion times is a linear assignment of requirements to places (r, l) at cost ``l p_rg`` (Horn 1973;
Bruno, Coffman and Sethi 1974). A victim is done no sooner than the mean of its requirements, so each
has the victim's priority over their number as its weight; unequal weights are taken apart into layers,
each of one weight and of the requirements that weigh at least so much, and the layers' bounds added
up. Where it is more, the bound is that of every victim by itself, which asks for the triangle
inequality: that no detour is shorter than the direct way. Where the assignment would be too large,
every requirement takes each robot as long as the fastest: then the shortest come first.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Floats
from .problem import RoutingData

_LARGEST = 3_000_000
"""Entries of the assignment's matrix, beyond which it would take more than an instant."""


def total_time_bound(data: RoutingData) -> float:
    """No routes take a total time below this, in time units."""
    travel = _soonest(data) - data.service[data.required]
    return data.total_service + float(travel.max(initial=0.0))


def makespan_bound(data: RoutingData) -> float:
    """No routes have a makespan below this, in time units."""
    return float(_soonest(data).max(initial=0.0))


def _soonest(data: RoutingData) -> Floats:
    """When each requirement is done and its robot home, if it serves nothing else, ``(n_required,)``."""
    alone = _shortest_ways(data)[:, :, None] + data.service[None]
    return np.asarray(np.where(data.able, alone, np.inf).min(axis=0, initial=np.inf)[data.required])


def _shortest_ways(data: RoutingData) -> Floats:
    """Shortest travel of r to v and home, by whatever detour, ``(n_robots, n_victims)``.

    Where times satisfy the triangle inequality, as walking does, this is the direct way.
    """
    if data.is_metric:
        return np.where(data.can_visit, data.leave + data.back, np.inf)
    ways = np.full(data.can_visit.shape, np.inf)
    for r, visits in enumerate(data.can_visit):
        own = np.flatnonzero(visits)
        if not len(own):
            continue
        between = data.ways(r, own)
        ways[r, own] = _shortest(data.leave[r, own], between)
        ways[r, own] += _shortest(data.back[r, own], between)
    return ways


def _shortest(way: Floats, between: Floats) -> Floats:
    """The shortest `way` to each place, ``(m,)``, perhaps by others."""
    while True:
        shorter: Floats = np.minimum(way, (way[:, None] + between).min(axis=0))
        if np.array_equal(shorter, way):
            return way
        way = shorter


def latency_bound(data: RoutingData) -> float:
    """No routes have a latency below this, in time units times priority."""
    if not data.required.any():
        return 0.0
    return max(_each_alone(data), _in_queues(data))


def _each_alone(data: RoutingData) -> float:
    """Every victim as if it were the only one."""
    alone = data.leave[:, :, None] + data.service[None]
    soonest = np.where(data.able, alone, np.inf).min(axis=0)
    last = np.where(data.required, soonest, 0.0).max(axis=1)
    return float(data.priority @ last)


def _in_queues(data: RoutingData) -> float:
    victim, kind = np.nonzero(data.required)
    time = _shortest_times(data)[:, victim, kind]
    weight = (data.priority / np.maximum(data.required.sum(axis=1), 1))[victim]
    bound, below = 0.0, 0.0
    for level in np.unique(weight[weight > 0]):
        bound += (level - below) * _unweighted(time[:, weight >= level])
        below = level
    return float(bound)


def _shortest_times(data: RoutingData) -> Floats:
    """p_rg, ``inf`` where r cannot serve g, ``(n_robots, n_victims, n_kinds)``."""
    way_in = np.array(data.leave)
    for r, visits in enumerate(data.can_visit):
        own = np.flatnonzero(visits)
        if len(own) > 1:
            away = data.ways(r, own)
            np.fill_diagonal(away, np.inf)
            way_in[r, own] = np.minimum(way_in[r, own], away.min(axis=0))
    shared = way_in / np.maximum(data.able.sum(axis=2), 1)
    return np.where(data.able, data.service[None] + shared[:, :, None], np.inf)


def _unweighted(time: Floats) -> float:
    """Minimum sum of completion times of jobs on unrelated machines, ``time (n_robots, n_jobs)``."""
    from scipy.optimize import linear_sum_assignment

    n_robots, n_jobs = time.shape
    if n_robots * n_jobs**2 > _LARGEST:
        # As if every robot were the fastest at each job: the shortest jobs come first.
        behind = np.arange(n_jobs, 0, -1)
        return float(np.sort(time.min(axis=0)) @ -(-behind // n_robots))
    place = np.arange(1, n_jobs + 1)
    cost = (time[:, None, :] * place[None, :, None]).reshape(-1, n_jobs).T
    jobs, places = linear_sum_assignment(cost)
    return float(cost[jobs, places].sum())
