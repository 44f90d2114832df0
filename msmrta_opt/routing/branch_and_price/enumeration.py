"""Enumeration of all routes of a robot that cost little enough at given dual values to matter.

If dual values prove the bound L, then in any solution worth at most U every route costs at most U - L
more than its robot's cheapest. So all of them can be enumerated where the gap is small, and an integer
program on them closes it. Routes are built visit by visit, a layer at a time; what is left to do is
bounded by the network's cheapest way on. Of routes that serve the same tasks and end at the same
victim, those that are dominated, no sooner done with anything, are dropped.

Source: Baldacci, Christofides and Mingozzi, *An exact algorithm for the vehicle routing problem based
on the set partitioning formulation with additional cuts* (2008).
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ...arrays import Floats, Ints
from ..parameters import BranchAndPriceParameters
from ..problem import RoutingData
from .ng_network import Network, Stops
from .path_program import Path
from .pricing import costs_to_go
from .tasks import Tasks

_SLACK = 1e-9
"""Share of a limit by which rounding may exceed it."""
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
    """At the dual values and the rounded times."""
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


def enumerate_routes(
    data: RoutingData,
    tasks: Tasks,
    network: Network,
    cost: Floats,
    maximum: float,
    parameters: BranchAndPriceParameters,
) -> list[Path] | None:
    """The routes of `network` that cost at most `maximum`, except those that are dominated.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    tasks : Tasks
        Its requirements.
    network : Network
        Of one robot.
    cost : array, shape (m, n_options, last + 1)
        Of being done with an option at a time.
    maximum : float
        What routes may cost.
    parameters : BranchAndPriceParameters
        With ``maximum_labels``, beyond which it is given up, with ``None``.
    """
    digits = network.n_options + 1
    if digits**network.m >= 2**62:
        return None
    extension = _Extension(data, tasks, network, cost, maximum)
    limit, compared = parameters.maximum_labels, parameters.compared_labels
    frontier = extension.start()
    finished: list[_Labels] = []
    total = 0
    while len(frontier):
        if extension.count(frontier) > 20 * limit:
            return None
        grown = extension.grow(frontier)
        frontier = _undominated(data, network, grown, compared, by_end=True)
        total += len(frontier)
        if total > limit:
            return None
        finished.append(frontier.take(np.flatnonzero(extension.may_end(frontier))))
    ended = _undominated(data, network, _Labels.joined(finished), compared, by_end=False)
    return [(network.robot, _stops(network, ended, n, digits)) for n in range(len(ended))]


class _Extension:
    """How labels grow by a visit.

    Parameters
    ----------
    data, tasks, network, cost, maximum
        As for `enumerate_routes`.
    """

    def __init__(
        self, data: RoutingData, tasks: Tasks, network: Network, cost: Floats, maximum: float
    ) -> None:
        self.data, self.network, self.cost, self.maximum = data, network, cost, maximum
        own, robot, m = network.victims, network.robot, network.m
        self.travel = np.vstack([data.ways(robot, own), data.leave[robot, own]])
        """Between the robot's victims, from its start in the last row, ``(m + 1, m)``."""
        self.service = np.zeros((m, network.n_options))
        for i, options in enumerate(network.options):
            times = [sum(tasks.service[g] for g in served) for served in options]
            self.service[i, : len(options)] = times
        self.place = _places(network)
        self.after, _ = costs_to_go(network, cost)
        self.first = np.searchsorted(network.tail[network.outward], np.arange(network.n_states + 1))

    def start(self) -> _Labels:
        """The robot at its start."""
        ints, floats = np.zeros(1, dtype=np.int64), np.zeros(1)
        state = np.array([self.network.n_states - 1])
        return _Labels(state, ints, floats, floats, floats, ints, np.zeros((1, self.network.m)))

    def count(self, labels: _Labels) -> int:
        """How many labels there may be after one more visit."""
        return int(np.diff(self.first)[labels.state].sum()) * self.network.n_options

    def grow(self, labels: _Labels) -> _Labels:
        """The labels after one more visit that may yet cost little enough."""
        network = self.network
        count = np.diff(self.first)[labels.state]
        row = np.repeat(np.arange(len(labels)), count)
        nth = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        arc = network.outward[self.first[labels.state[row]] + nth]
        to = network.at[network.head[arc]]
        fresh = labels.done[row, to] == 0
        row, arc, to = row[fresh], arc[fresh], to[fresh]
        grown = []
        for j in range(network.n_options):
            steps = labels.steps[row] + network.steps[arc] + network.extra[to, j]
            within = np.minimum(steps, network.last)
            so_far = labels.cost[row] + self.cost[to, j, within]
            in_all = so_far + self.after[network.head[arc], within]
            good = np.flatnonzero((steps <= network.last) & (in_all <= self.maximum))
            old, i = row[good], to[good]
            way = self.travel[network.at[labels.state[old]], i]
            clock = labels.clock[old] + way + self.service[i, j]
            done = labels.done[old]
            done[np.arange(len(good)), i] = clock
            grown.append(
                _Labels(
                    network.head[arc[good]],
                    steps[good],
                    clock,
                    so_far[good],
                    labels.walk[old] + way,
                    labels.served[old] + (j + 1) * self.place[i],
                    done,
                )
            )
        return _Labels.joined(grown)

    def may_end(self, labels: _Labels) -> np.ndarray:
        """Whether routes may stop here: cheap enough, and home within their limits."""
        data, robot = self.data, self.network.robot
        home = data.back[robot, self.network.victims[self.network.at[labels.state]]]
        return np.asarray(
            (labels.cost <= self.maximum)
            & (labels.clock + home <= data.endurance[robot] * (1 + _SLACK))
            & (labels.walk + home <= data.longest_walk[robot] * (1 + _SLACK))
        )


def _places(network: Network) -> Ints:
    """The place values of options in the number that says which was served where, ``(m,)``."""
    return np.asarray((network.n_options + 1) ** np.arange(network.m, dtype=np.int64))


def _undominated(
    data: RoutingData, network: Network, labels: _Labels, compared: int, *, by_end: bool
) -> _Labels:
    """Without the routes that others, which serve the same, dominate.

    Each is held against so many of its like that are sooner done; with `by_end` only those that end at
    the same victim compare, since they are to go on.
    """
    end = network.at[labels.state] if by_end else np.zeros(len(labels), dtype=np.int64)
    limited = by_end and np.isfinite(data.longest_walk[network.robot])
    labels = labels.take(np.lexsort((labels.done.sum(axis=1), end, labels.served)))
    end = network.at[labels.state] if by_end else end
    dominated = np.zeros(len(labels), dtype=bool)
    for shift in range(1, min(compared, len(labels) - 1) + 1):
        late, soon = slice(shift, None), slice(None, -shift)
        alike = (labels.served[late] == labels.served[soon]) & (end[late] == end[soon])
        if limited:
            alike &= labels.walk[soon] <= labels.walk[late] + _EXACT
        rows = np.flatnonzero(alike)
        no_sooner = (labels.done[rows] <= labels.done[rows + shift] + _EXACT).all(axis=1)
        dominated[rows[no_sooner] + shift] = True
    return labels.take(np.flatnonzero(~dominated))


def _stops(network: Network, labels: _Labels, row: int, digits: int) -> Stops:
    done = labels.done[row]
    option = labels.served[row] // _places(network) % digits - 1
    order = np.argsort(done, kind="stable")
    return tuple(
        (int(network.victims[i]), network.options[i][option[i]], float(done[i]))
        for i in order[option[order] >= 0]
    )
