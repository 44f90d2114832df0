"""All routes of a robot that cost little enough at given prices to matter for latency.

If the best routes cost no less than L at some prices, then in any answer worth at most U every route
costs at most U - L more than its robot's cheapest. So all of them can be listed where the gap is
small, and an integer program on the list closes it. Routes are built visit by visit, a layer at a
time; what is left to do is bounded by the network's cheapest way on. Of routes that serve the same
needs and end at the same victim, those that are no sooner done with anything are dropped.

Source: Baldacci, Christofides and Mingozzi, *An exact algorithm for the vehicle routing problem based
on the set partitioning formulation with additional cuts* (2008).
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ...arrays import Floats, Ints
from ..problem import RoutingData
from .master import Path
from .ng_network import Network
from .tasks import Needs

COMPARED = 12
"""How many of its like, sooner done, a route is compared with."""
_SLACK = 1e-6
_EXACT = 1e-9


@dataclass(frozen=True, eq=False)
class _Labels:
    """Routes under way, one row each."""

    state: Ints
    steps: Ints
    """When they are there, rounded down."""
    clock: Floats
    """When they are there."""
    cost: Floats
    """At the prices and the rounded times."""
    walk: Floats
    """Travel, in time units."""
    served: Ints
    """A number for which option was served at which victim."""
    done: Floats
    """When each victim's service ended, 0 if not served, ``(n_labels, m)``."""

    def __len__(self) -> int:
        return len(self.state)

    def take(self, rows: Ints) -> _Labels:
        return _Labels(*(getattr(self, name.name)[rows] for name in fields(self)))

    @classmethod
    def joined(cls, parts: list[_Labels]) -> _Labels:
        return cls(
            *(np.concatenate([getattr(part, name.name) for part in parts]) for name in fields(cls))
        )


def all_paths(
    data: RoutingData, needs: Needs, network: Network, cost: Floats, most: float, limit: int
) -> list[Path] | None:
    """The routes of `network` that cost at most `most`, except those that others make needless.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    needs : Needs
        Its requirements.
    network : Network
        Of one robot.
    cost : array, shape (m, n_options, last + 1)
        Of being done with an option at a time.
    most : float
        What routes may cost.
    limit : int
        Give up, with ``None``, beyond so many routes under way.
    """
    digits = network.n_options + 1
    if digits**network.m >= 2**62:
        return None
    after, _ = network.to_go(cost)
    place = digits ** np.arange(network.m, dtype=np.int64)
    travel, service = _travel(data, network), _service(data, needs, network)
    first = np.searchsorted(network.tail[network.outward], np.arange(network.n_states + 1))
    frontier = _Labels(
        np.array([network.n_states - 1]),
        np.zeros(1, dtype=np.int64),
        np.zeros(1),
        np.zeros(1),
        np.zeros(1),
        np.zeros(1, dtype=np.int64),
        np.zeros((1, network.m)),
    )
    finished: list[_Labels] = []
    total = 0
    while len(frontier):
        count = np.diff(first)[frontier.state]
        if count.sum() * network.n_options > 20 * limit:
            return None
        row = np.repeat(np.arange(len(frontier)), count)
        nth = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        arc = network.outward[first[frontier.state[row]] + nth]
        to = network.at[network.head[arc]]
        fresh = frontier.done[row, to] == 0
        row, arc, to = row[fresh], arc[fresh], to[fresh]
        grown = []
        for j in range(network.n_options):
            steps = frontier.steps[row] + network.steps[arc] + network.extra[to, j]
            within = np.minimum(steps, network.last)
            price = frontier.cost[row] + cost[to, j, within]
            hope = price + after[network.head[arc], within]
            good = np.flatnonzero((steps <= network.last) & (hope <= most))
            old, i = row[good], to[good]
            way = travel[network.at[frontier.state[old]], i]
            clock = frontier.clock[old] + way + service[i, j]
            done = frontier.done[old]
            done[np.arange(len(good)), i] = clock
            grown.append(
                _Labels(
                    network.head[arc[good]],
                    steps[good],
                    clock,
                    price[good],
                    frontier.walk[old] + way,
                    frontier.served[old] + (j + 1) * place[i],
                    done,
                )
            )
        frontier = _undominated(data, network, _Labels.joined(grown), by_end=True)
        total += len(frontier)
        if total > limit:
            return None
        finished.append(frontier.take(np.flatnonzero(_may_end(data, network, frontier, most))))
    ended = _undominated(data, network, _Labels.joined(finished), by_end=False)
    return [(network.robot, _stops(network, ended, n, place, digits)) for n in range(len(ended))]


def _travel(data: RoutingData, network: Network) -> Floats:
    """Travel between the robot's victims, from its start in the last row, ``(m + 1, m)``."""
    own = network.victims
    return np.vstack(
        [data.between[network.robot][np.ix_(own, own)], data.leave[network.robot, own][None]]
    )


def _service(data: RoutingData, needs: Needs, network: Network) -> Floats:
    """Service time of each option, ``(m, n_options)``."""
    service = np.zeros((network.m, network.n_options))
    for i, options in enumerate(network.options):
        service[i, : len(options)] = [sum(needs.service[g] for g in own) for own in options]
    return service


def _may_end(data: RoutingData, network: Network, labels: _Labels, most: float) -> np.ndarray:
    """Whether routes may stop here: cheap enough, and home within their limits."""
    home = data.back[network.robot, network.victims[network.at[labels.state]]]
    busy = labels.clock + home
    walk = labels.walk + home
    return np.asarray(
        (labels.cost <= most)
        & (busy <= data.endurance[network.robot] + _SLACK)
        & (walk <= data.longest_walk[network.robot] + _SLACK)
    )


def _undominated(data: RoutingData, network: Network, labels: _Labels, *, by_end: bool) -> _Labels:
    """Without the routes that others, which serve the same, make needless.

    `by_end`: only those that end at the same victim compare, since they are to go on.
    """
    end = network.at[labels.state] if by_end else np.zeros(len(labels), dtype=np.int64)
    limited = by_end and np.isfinite(data.longest_walk[network.robot])
    labels = labels.take(np.lexsort((labels.done.sum(axis=1), end, labels.served)))
    end = network.at[labels.state] if by_end else end
    needless = np.zeros(len(labels), dtype=bool)
    for shift in range(1, min(COMPARED, len(labels) - 1) + 1):
        late, soon = slice(shift, None), slice(None, -shift)
        alike = (labels.served[late] == labels.served[soon]) & (end[late] == end[soon])
        if limited:
            alike &= labels.walk[soon] <= labels.walk[late] + _EXACT
        rows = np.flatnonzero(alike)
        no_sooner = (labels.done[rows] <= labels.done[rows + shift] + _EXACT).all(axis=1)
        needless[rows[no_sooner] + shift] = True
    return labels.take(np.flatnonzero(~needless))


def _stops(
    network: Network, labels: _Labels, row: int, place: Ints, digits: int
) -> tuple[tuple[int, tuple[int, ...], float], ...]:
    done = labels.done[row]
    option = labels.served[row] // place % digits - 1
    order = np.argsort(done, kind="stable")
    return tuple(
        (int(network.victims[i]), network.options[i][option[i]], float(done[i]))
        for i in order[option[order] >= 0]
    )
