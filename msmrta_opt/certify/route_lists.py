r"""All routes of a robot that a better plan may use, listed, and what dual values prove about them.

At dual values that prove the bound L, no plan worth at most U has a route that costs more than U − L
beyond its robot's cheapest. Of these routes, each victim visited once and times rounded down to whole
steps, those that serve the same no sooner than another are left out: a plan with that other one is no
worse. What is left is a list, and then any dual values of the tasks prove

    Σ_g ρ_g + Σ_r minimum Σ (φ_g(t_g) − ρ_g) over the list of robot r

by looking at every route of it (`pricing_bound` has the notation). So a tree is checked leaf by leaf:
branching takes routes off the lists.

Source: Baldacci, Christofides and Mingozzi, *An exact algorithm for the vehicle routing problem based on
the set partitioning formulation with additional cuts* (2008).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from fractions import Fraction

import numpy as np

from ..arrays import Bools, Ints
from ..mission.errors import CheckError
from .ng_routes import NEVER, Network, Task
from .pricing_bound import Robot

MAX_LABELS = 400_000
"""Routes of a robot, finished or not, that are looked at."""
MAX_AT_ONCE = 4_000_000
"""Ways on from them."""
COMPARED = 30
"""Routes of its like that a route is held against."""


@dataclass(frozen=True, eq=False)
class RouteList:
    """The routes of one robot, with the empty one if it may stay at home."""

    network: Network
    option: Ints
    """Which option is served at which victim, -1 for none, ``(n_routes, m)``."""
    done: Ints
    """At which step, ``(n_routes, m)``; 0 for none."""

    def cost(self, cost: Ints) -> Ints:
        """Of each route, at costs of shape ``(m, n_options, last + 1)``."""
        if not self.option.shape[1]:
            return np.zeros(len(self.option), dtype=np.int64)
        each = cost[np.arange(self.option.shape[1]), self.option, self.done]
        return np.asarray(np.where(self.option >= 0, each, 0).sum(axis=1))

    def when(self, task: Task) -> Ints:
        """At which step a task is done in each route, -1 if it is not, ``(n_routes,)``."""
        victims = self.network.victims
        if task[0] not in victims:
            return np.full(len(self.option), -1)
        i = victims.index(task[0])
        serves = np.array([*(task in some for some in self.network.options[i]), False])
        return np.asarray(np.where(serves[self.option[:, i]], self.done[:, i], -1))

    def until(self, time: Fraction) -> int:
        """The last step that is not after a time."""
        return time // self.network.step


def route_list(robot: Robot, spare: int) -> RouteList:
    """The routes of a robot that cost at most `spare` more than its cheapest path.

    Raises
    ------
    CheckError
        If they are too many to list.
    """
    network, states = robot.network, robot.states
    m = len(network.victims)
    limit = min(robot.cheapest + spare, NEVER - 1)
    after = states.onward(robot.cost)
    order = np.argsort(states.tail, kind="stable")
    first = np.searchsorted(states.tail[order], np.arange(states.n + 1))
    layer = _Labels(
        np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64),
        np.full((1, m), -1), np.zeros((1, m), dtype=np.int64),
    )  # fmt: skip
    finished = [layer.take(layer.cost <= limit)]
    total = 1
    while len(layer):
        count = np.diff(first)[layer.state]
        if count.sum() > MAX_AT_ONCE:
            raise _too_many(network)
        row = np.repeat(np.arange(len(layer)), count)
        nth = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        move = order[first[layer.state[row]] + nth]
        to, option, head = states.victim[move], states.option[move], states.head[move]
        clock = layer.clock[row] + states.steps[move]
        fresh = (layer.option[row, to] < 0) & (clock <= network.last)
        row, to, option, head, clock = (x[fresh] for x in (row, to, option, head, clock))
        cost = layer.cost[row] + robot.cost[to, option, clock]
        good = cost + after[head, clock] <= limit
        row, to, option, head, clock, cost = (x[good] for x in (row, to, option, head, clock, cost))
        served, done = layer.option[row], layer.done[row]
        here = np.arange(len(row))
        served[here, to], done[here, to] = option, clock
        layer = _Labels(head, clock, cost, served, done).undominated(to)
        total += len(layer)
        if total > MAX_LABELS:
            raise _too_many(network)
        finished.append(layer.take(layer.cost <= limit))
    every = _Labels.joined(finished)
    kept = every.undominated(np.zeros(len(every), dtype=np.int64))
    return RouteList(network, kept.option, kept.done)


def _too_many(network: Network) -> CheckError:
    return CheckError(f"robot {network.robot} has too many routes to list")


@dataclass(frozen=True, eq=False)
class _Labels:
    """Routes under way, one a row."""

    state: Ints
    clock: Ints
    cost: Ints
    option: Ints
    """As in `RouteList`."""
    done: Ints

    def __len__(self) -> int:
        return len(self.state)

    def take(self, rows: Ints | Bools) -> _Labels:
        return _Labels(*(getattr(self, item.name)[rows] for item in fields(self)))

    @classmethod
    def joined(cls, parts: list[_Labels]) -> _Labels:
        arrays = (np.concatenate([getattr(p, item.name) for p in parts]) for item in fields(cls))
        return cls(*arrays)

    def undominated(self, end: Ints) -> _Labels:
        """Without routes that serve the same and end alike, but nothing sooner than another."""
        order = np.lexsort((self.done.sum(axis=1), *self.option.T, end))
        labels, end = self.take(order), end[order]
        dominated = np.zeros(len(labels), dtype=bool)
        for shift in range(1, min(COMPARED, len(labels) - 1) + 1):
            late, soon = slice(shift, None), slice(None, -shift)
            worse = (end[late] == end[soon]) & (labels.option[late] == labels.option[soon]).all(
                axis=1
            )
            worse &= (labels.done[soon] <= labels.done[late]).all(axis=1)
            dominated[late] |= worse
        return labels.take(~dominated)
