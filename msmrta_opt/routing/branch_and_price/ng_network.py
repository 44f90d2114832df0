r"""One robot's routes as paths in a network over victims, memories and times (ng-route relaxation).

A state says where the robot is and which victims it remembers having visited. It remembers a victim as
long as it stays among victims that have it in their neighbourhood (ng-routes), so a path may come back
to a victim that it has forgotten; with neighbourhoods of all victims it may not. Time goes in whole
steps: the exact divisor of the robot's times where there is one, else a step to which times are
rounded down. Either way every route is a path that is no later and costs no more, so the cheapest path
(`pricing`) bounds the cheapest route from below.

Source: Baldacci, Mingozzi and Roberti, *New route relaxation and pricing strategies for the vehicle
routing problem* (2011) for ng-routes; time-expanded states for completion times are classical.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from itertools import combinations

import numpy as np

from ...arrays import Bools, Floats, Ints
from ..objective_step import time_step
from ..problem import RoutingData
from .tasks import Tasks

_BITS = 48
_MASK = (1 << _BITS) - 1
_ROUNDING = 1e-9
"""Steps of time by which a time may be off without being another."""
_DIGITS = 12
_CELLS = 2**24
"""Legs with memories, each of a bit per victim, that are looked at together."""

Stops = tuple[tuple[int, tuple[int, ...], float], ...]
"""Victim, tasks served there, and when that is done, in order."""


class Network:
    """The network of one robot.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    tasks : Tasks
        Its requirements.
    robot : int
        Which robot; it can serve something.
    deadline : array, shape (n_victims,)
        Routes that serve a victim later are of no interest; may be infinite.
    maximum_steps : int
        Of time up to the robot's horizon; beyond them times are rounded down to coarser ones.
    left : callable, optional
        Seconds left, whenever states are built or priced.

    Raises
    ------
    TimeoutError
        Once there are none.
    """

    def __init__(
        self,
        data: RoutingData,
        tasks: Tasks,
        robot: int,
        deadline: Floats,
        maximum_steps: int,
        left: Callable[[], float] = lambda: math.inf,
    ) -> None:
        self.robot, self.left = robot, left
        self.victims: Ints = np.flatnonzero(data.can_visit[robot])
        m = self.m = len(self.victims)
        sets = [_options(tasks, robot, int(v)) for v in self.victims]
        between = data.ways(robot, self.victims)
        leave = data.leave[robot, self.victims]
        horizon = np.minimum(deadline[self.victims], _longest(leave, between, sets))
        if np.isfinite(data.endurance[robot]):
            home = data.back[robot, self.victims].min()
            horizon = np.minimum(horizon, data.endurance[robot] - home)
        latest = max(float(horizon.max()), 0.0)
        own = np.arange(data.n_robots)[:, None, None] == robot
        divisor = time_step(replace(data, able=data.able & own))
        exact = divisor > 0.0 and latest <= divisor * maximum_steps
        self.step = divisor if exact else _short(latest / maximum_steps) or 1.0
        self.last = int(self._steps(np.array(latest)))

        service = [self._steps(np.array([time for time, _ in own])) for own in sets]
        shortest = np.array([own[0] for own in service])
        self.options = [tuple(chosen for _, chosen in own) for own in sets]
        self.n_options = max(map(len, sets))
        self.extra = np.zeros((m, self.n_options), dtype=np.int64)
        """Steps of service beyond the victim's shortest option, ``(m, n_options)``."""
        for i, steps in enumerate(service):
            self.extra[i, : len(steps)] = np.minimum(steps - shortest[i], self.last + 1)
        legs = np.vstack([self._steps(between), self._steps(leave)[None]]) + shortest
        self.leg: Ints = np.minimum(legs, self.last + 1)
        """Steps of going there and of the shortest service; the last row is from the start."""
        self.arc: Bools = ~np.eye(m + 1, m, dtype=bool)
        """Legs of interest, ``(m + 1, m)``."""
        first = int(self.leg[self.arc].min())
        self.timeless = first == 0
        """Whether a leg takes no step, so that times do not order the states."""
        self.block = max(first, 1)
        """Steps that can be computed at once: no leg is shorter."""
        self.open: Bools = np.zeros((m, self.n_options, self.last + 1), dtype=bool)
        """When each option may be done, ``(m, n_options, last + 1)``."""
        steps = np.arange(self.last + 1)
        for i in range(m):
            self.open[i, : len(sets[i])] = steps <= horizon[i] / self.step + _ROUNDING
        self.remember(np.eye(m, dtype=bool))

    def _steps(self, times: Floats) -> Ints:
        # A hair above keeps exact multiples from being rounded down by a whole step.
        return np.floor(times / self.step + _ROUNDING).astype(np.int64)

    def nearest(self, size: int) -> Bools:
        """Whether victim w is among the `size` nearest of v, itself included, ``(m, m)``."""
        far = np.where(np.eye(self.m, dtype=bool), -1, self.leg[:-1])
        return np.asarray(far.argsort(axis=1, kind="stable").argsort(axis=1) < size)

    def remember(self, neighbours: Bools) -> None:
        """Build the states in which victim v remembers ``neighbours[v]``, ``(m, m)``.

        Raises
        ------
        TimeoutError
            If no time is left.
        """
        self.neighbours = neighbours | np.eye(self.m, dtype=bool)
        self.rebuild()

    def rebuild(self) -> None:
        """Build the states that `arc` and the neighbourhoods leave.

        Raises
        ------
        TimeoutError
            If no time is left.
        """
        m = self.m
        # A memory is a number with one bit per neighbour of the victim; `bit` says which.
        count = self.neighbours.cumsum(axis=1)
        bit = np.vstack([np.where(self.neighbours, count - 1, -1), np.full((1, m), -1)])
        known = frontier = np.full(1, m << _BITS)
        tails: list[Ints] = []
        heads: list[Ints] = []
        while len(frontier):
            found = len(heads)
            for some in np.array_split(frontier, len(frontier) * m * m // _CELLS + 1):
                self.look_at_clock()
                at, memory = some >> _BITS, some & _MASK
                recalls = (bit[at] >= 0) & (memory[:, None] >> np.maximum(bit[at], 0) & 1 == 1)
                i, to = np.nonzero(~recalls & self.arc[at])
                kept = np.where(
                    recalls[i] & self.neighbours[to], np.int64(1) << np.maximum(bit[to], 0), 0
                ).sum(axis=1)
                tails.append(some[i])
                heads.append(to << _BITS | kept | np.int64(1) << bit[to, to])
            frontier = np.setdiff1d(np.concatenate(heads[found:]), known)
            known = np.union1d(known, frontier)
        self.look_at_clock()
        self.at: Ints = known >> _BITS
        """The victim of each state; the last state is the start, ``(n_states,)``."""
        tail = np.searchsorted(known, np.concatenate(tails))
        head = np.searchsorted(known, np.concatenate(heads))
        order = np.lexsort((tail, head))
        self.tail, self.head = tail[order], head[order]
        self.steps = self.leg[self.at[self.tail], self.at[self.head]]
        self.heads, self.first_in = np.unique(self.head, return_index=True)
        self.outward = np.argsort(self.tail, kind="stable")
        self.tails, self.first_out = np.unique(self.tail[self.outward], return_index=True)

    def look_at_clock(self) -> None:
        """Raise TimeoutError if no time is left."""
        if self.left() <= 0.0:
            raise TimeoutError

    @property
    def times(self) -> Floats:
        """The time of each step, ``(last + 1,)``."""
        return np.arange(self.last + 1) * np.float64(self.step)

    @property
    def n_states(self) -> int:
        """Number of places with memories, the start included."""
        return len(self.at)

    def copy(self) -> Network:
        """A network to rule out more in."""
        other = copy(self)
        other.open, other.arc = self.open.copy(), self.arc.copy()
        return other

    def restrict(self, task: int, *, serve: bool = True, after: float, until: float) -> None:
        """Rule out serving `task` at all, or but later than `after` and by `until`."""
        steps = np.arange(self.last + 1)
        within = steps > after / self.step + _ROUNDING
        within &= steps <= until / self.step + _ROUNDING
        for i, options in enumerate(self.options):
            for j, own in enumerate(options):
                if task in own:
                    self.open[i, j] &= within if serve else False

    def allows(self, stops: Stops) -> bool:
        """Whether a path is one of the network: nothing on it is ruled out or remembered."""
        place = {int(v): i for i, v in enumerate(self.victims)}
        before = self.m
        memory = np.zeros(self.m, dtype=bool)
        for v, served, time in stops:
            i = place[v]
            t = round(time / self.step)
            if memory[i] or t > self.last or not self.arc[before, i]:
                return False
            if not self.open[i, self.options[i].index(served), t]:
                return False
            memory &= self.neighbours[i]
            memory[i] = True
            before = i
        return True


def _options(tasks: Tasks, robot: int, victim: int) -> list[tuple[float, tuple[int, ...]]]:
    """What the robot may serve in one visit, with the time it takes, shortest first."""
    able = [g for g in tasks.of[victim] if tasks.able[robot, g]]
    sets = [some for n in range(1, len(able) + 1) for some in combinations(able, n)]
    return sorted((sum(tasks.service[g] for g in some), some) for some in sets)


def _short(number: float) -> float:
    """A number that is hardly larger and has few binary digits, so that it can be written exactly."""
    mantissa, exponent = math.frexp(number)
    return math.ldexp(math.ceil(mantissa * 2**_DIGITS), exponent - _DIGITS)


def _longest(
    leave: Floats, between: Floats, sets: list[list[tuple[float, tuple[int, ...]]]]
) -> float:
    """No route is longer."""
    ways = np.maximum(leave, between.max(axis=0))
    return float(ways.sum() + sum(own[-1][0] for own in sets))
