r"""One robot's routes as paths in a network over places, memories and times, and the cheapest of them.

A state says where the robot is and which victims it remembers having visited. It remembers a victim as
long as it stays among victims that have it in their neighbourhood (ng-routes), so a path may come back
to a victim that it has forgotten; with neighbourhoods of all victims it may not. Time goes in whole
steps: the exact divisor of the robot's times where there is one, else a step to which times are
rounded down. Either way every route is a path that is no later and costs no more, so the cheapest path
bounds the cheapest route from below.

Costs belong to what is served and when: ``cost[i, j, t]`` for serving option j (a set of needs) at
victim i by time t, infinite where that is ruled out. Times move in blocks no longer than the shortest
leg, so that whole blocks are computed at once.

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
from numpy.lib.stride_tricks import sliding_window_view

from ...arrays import Bools, Floats, Ints
from ..objective_step import time_step
from ..problem import RoutingData
from .tasks import Needs

MOST_STEPS = 4000
"""Of time up to a robot's horizon; beyond them times are rounded down to coarser ones."""
MOST_PATHS = 10
"""Taken from one network at one set of prices."""
MOST_REMEMBERED = 40
"""Victims in a neighbourhood."""
_BITS = 48
_MASK = (1 << _BITS) - 1
_EXACT = 1e-9
_DIGITS = 12

Stops = tuple[tuple[int, tuple[int, ...], float], ...]
"""Victim, needs served there, and when that is done, in order."""


class Network:
    """The network of one robot.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    needs : Needs
        Its requirements.
    robot : int
        Which robot; it can serve something.
    deadline : array, shape (n_victims,)
        Routes that serve a victim later are of no interest; may be infinite.
    """

    def __init__(self, data: RoutingData, needs: Needs, robot: int, deadline: Floats) -> None:
        self.robot = robot
        self.victims: Ints = np.flatnonzero(data.can_visit[robot])
        m = self.m = len(self.victims)
        sets = [_options(needs, robot, int(v)) for v in self.victims]
        own = np.arange(data.n_robots)[:, None, None] == robot
        grain = time_step(replace(data, able=data.able & own))
        between = data.between[robot][np.ix_(self.victims, self.victims)]
        leave = data.leave[robot, self.victims]
        horizon = np.minimum(deadline[self.victims], _longest(leave, between, sets))
        if np.isfinite(data.endurance[robot]):
            home = data.back[robot, self.victims].min()
            horizon = np.minimum(horizon, data.endurance[robot] - home)
        latest = max(float(horizon.max()), 0.0)
        exact = grain > 0.0 and latest <= grain * MOST_STEPS
        self.step = grain if exact else _short(latest / MOST_STEPS) or 1.0
        self.last = int(self._steps(np.array(latest)))

        service = [self._steps(np.array([time for time, _ in own])) for own in sets]
        least = np.array([own[0] for own in service])
        self.options = [tuple(needs for _, needs in own) for own in sets]
        self.n_options = max(map(len, sets))
        self.extra = np.zeros((m, self.n_options), dtype=np.int64)
        """Steps of service beyond the victim's shortest option, ``(m, n_options)``."""
        for i, steps in enumerate(service):
            self.extra[i, : len(steps)] = np.minimum(steps - least[i], self.last + 1)
        legs = np.vstack([self._steps(between), self._steps(leave)[None]]) + least
        self.leg: Ints = np.minimum(legs, self.last + 1)
        """Steps of going there and of the shortest service; the last row is from the start."""
        self.arc: Bools = ~np.eye(m + 1, m, dtype=bool)
        """Legs of interest, ``(m + 1, m)``."""
        shortest = int(self.leg[self.arc].min())
        self.timeless = shortest == 0
        """Whether a leg takes no step, so that times do not order the states."""
        self.block = max(shortest, 1)
        self.open: Bools = np.zeros((m, self.n_options, self.last + 1), dtype=bool)
        """When each option may be done, ``(m, n_options, last + 1)``."""
        steps = np.arange(self.last + 1)
        for i in range(m):
            self.open[i, : len(sets[i])] = steps * self.step <= horizon[i] + _EXACT
        self.remember(np.eye(m, dtype=bool))

    def _steps(self, times: Floats) -> Ints:
        # A hair above keeps exact multiples from being rounded down by a whole step.
        return np.floor(times / self.step + 1e-7).astype(np.int64)

    def nearest(self, size: int) -> Bools:
        """Whether victim w is among the `size` nearest of v, itself included, ``(m, m)``."""
        far = np.where(np.eye(self.m, dtype=bool), -1, self.leg[:-1])
        return np.asarray(far.argsort(axis=1, kind="stable").argsort(axis=1) < size)

    def remember(self, neighbours: Bools) -> None:
        """Build the states in which victim v remembers ``neighbours[v]``, ``(m, m)``."""
        self.neighbours = neighbours | np.eye(self.m, dtype=bool)
        self.rebuild()

    def rebuild(self) -> None:
        """Build the states that `arc` and the neighbourhoods leave."""
        m = self.m
        # A memory is a number with one bit per neighbour of the victim; `bit` says which.
        count = self.neighbours.cumsum(axis=1)
        bit = np.vstack([np.where(self.neighbours, count - 1, -1), np.full((1, m), -1)])
        known = frontier = np.full(1, m << _BITS)
        tails, heads = [], []
        while len(frontier):
            at, memory = frontier >> _BITS, frontier & _MASK
            recalls = (bit[at] >= 0) & (memory[:, None] >> np.maximum(bit[at], 0) & 1 == 1)
            i, to = np.nonzero(~recalls & self.arc[at])
            kept = np.where(
                recalls[i] & self.neighbours[to], np.int64(1) << np.maximum(bit[to], 0), 0
            ).sum(axis=1)
            reached = to << _BITS | kept | np.int64(1) << bit[to, to]
            tails.append(frontier[i])
            heads.append(reached)
            frontier = np.setdiff1d(reached, known)
            known = np.union1d(known, frontier)
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

    @property
    def times(self) -> Floats:
        """The time of each step, ``(last + 1,)``."""
        return np.arange(self.last + 1) * np.float64(self.step)

    @property
    def n_states(self) -> int:
        """Number of places with memories, the start included."""
        return len(self.at)

    def forward(self, cost: Floats, left: Callable[[], float] | None = None) -> Forward:
        """The cheapest way to every state at every time, at ``cost (m, n_options, last + 1)``.

        Raises
        ------
        TimeoutError
            Once `left`, the seconds left, says that there are none.
        """
        return Forward(self, cost, left or (lambda: 1.0))

    def to_go(self, cost: Floats) -> tuple[Floats, Floats]:
        """What the cheapest way on costs.

        Returns
        -------
        after : array, shape (n_states, last + 1)
            From a state whose service is done at that time; at most 0, for stopping there.
        into : array, shape (n_states, >= last + 1)
            From a state whose shortest option would be done at that time; infinite beyond `last`.
        """
        block, last = self.block, self.last
        beyond = max(int(self.leg.max()), int(self.extra.max())) + block
        width = block + last + 1 + beyond
        after, into = np.full((2, self.n_states, width), np.inf)
        victim = self.at[:-1]
        around = ((0, 0), (0, 0), (block, beyond))
        ahead = np.pad(cost, around, constant_values=np.inf)
        into_from = sliding_window_view(into.ravel(), block)
        after_from = sliding_window_view(after.ravel(), block)
        base = (self.head * width + self.steps)[self.outward]
        rows = np.arange(self.n_states - 1) * width
        for t in range(last + 1, 0, -block):
            # Columns t .. t + block - 1 stand for times that are `block` less.
            own = np.minimum.reduceat(into_from[base + t], self.first_out, axis=0)
            after[:, t : t + block] = 0.0
            after[self.tails, t : t + block] = np.minimum(own, 0.0)
            best = np.full((self.n_states - 1, block), np.inf)
            for j in range(self.n_options):
                extra = self.extra[victim, j]
                onward = after_from[rows + extra + t]
                when = t + extra[:, None] + np.arange(block)
                np.minimum(best, onward + ahead[victim[:, None], j, when], out=best)
            into[:-1, t : t + block] = best
        return after[:, block : block + last + 1], into[:, block:]

    def fix(self, cost: Floats, most: float) -> int:
        """Rule out what only paths that cost more than `most` do; returns how much that is.

        Services at certain times are ruled out, and legs.
        """
        there = self.forward(cost)
        after, into = self.to_go(cost)
        through = np.full(self.open.shape, np.inf)
        steps = np.arange(self.last + 1)
        starts = np.flatnonzero(np.diff(self.at[:-1], prepend=-1))
        for j in range(self.n_options):
            extra = self.extra[self.at[:-1], j]
            ways = there.before(extra) + after[:-1]
            through[self.at[starts], j] = np.minimum.reduceat(ways, starts, axis=0)
        through += cost
        ruled_out = self.open & ~(through <= most)
        self.open &= ~ruled_out
        cheapest = np.full((self.m + 1, self.m), np.inf)
        for some in np.array_split(
            np.arange(len(self.tail)), len(self.tail) * len(steps) // 2**22 + 1
        ):
            ways = there.values[self.tail[some]]
            onward = np.take_along_axis(
                into[self.head[some]], self.steps[some, None] + steps, axis=1
            )
            least = (ways + onward).min(axis=1)
            np.minimum.at(cheapest, (self.at[self.tail[some]], self.at[self.head[some]]), least)
        removed = self.arc & ~(cheapest <= most)
        self.arc &= ~removed
        done = self.open.any(axis=(0, 1))
        self.last = int(np.flatnonzero(done)[-1]) if done.any() else 0
        self.open = self.open[:, :, : self.last + 1]
        if removed.any():
            self.rebuild()
        return int(ruled_out.sum() + removed.sum())

    def copy(self) -> Network:
        """A network to rule out more in."""
        other = copy(self)
        other.open, other.arc = self.open.copy(), self.arc.copy()
        return other

    def restrict(self, need: int, *, serve: bool = True, after: float, until: float) -> None:
        """Rule out serving `need` at all, or but later than `after` and by `until`."""
        times = self.times
        within = (times > after + _EXACT) & (times <= until + _EXACT)
        for i, options in enumerate(self.options):
            for j, own in enumerate(options):
                if need in own:
                    self.open[i, j] &= within if serve else False

    def allows(self, stops: Stops) -> bool:
        """Whether a path is one of the network: nothing on it is ruled out or remembered."""
        place = {int(v): i for i, v in enumerate(self.victims)}
        before = self.m
        memory = np.zeros(self.m, dtype=bool)
        for v, needs, time in stops:
            i = place[v]
            t = round(time / self.step)
            if memory[i] or t > self.last or not self.arc[before, i]:
                return False
            if not self.open[i, self.options[i].index(needs), t]:
                return False
            memory &= self.neighbours[i]
            memory[i] = True
            before = i
        return True


class Forward:
    """The cheapest way to every state of a network at every time."""

    def __init__(self, network: Network, cost: Floats, left: Callable[[], float]) -> None:
        self.network, self.cost = network, cost
        block, last = network.block, network.last
        pad = max(int(network.leg.max()), int(network.extra.max()))
        width = pad + last + 1 + block
        # `done` is by when service ends, `short` by when the shortest option would end.
        done, short = np.full((2, network.n_states, width), np.inf)
        done[-1, pad] = 0.0
        done_from = sliding_window_view(done.ravel(), block)
        short_from = sliding_window_view(short.ravel(), block)
        base = network.tail * width + pad - network.steps
        heads, victim = network.heads, network.at[network.heads]
        rows = [heads * width + pad - network.extra[victim, j] for j in range(network.n_options)]
        ahead = np.pad(cost, ((0, 0), (0, 0), (0, block)), constant_values=np.inf)
        for t in range(1, last + 1, block):
            if left() <= 0:
                raise TimeoutError
            way = np.minimum.reduceat(done_from[base + t], network.first_in, axis=0)
            short[heads, pad + t : pad + t + block] = way
            best = way + ahead[victim, 0, t : t + block]
            for j in range(1, network.n_options):
                # The shortest option's own row is written, so later ones may read it.
                np.minimum(
                    best, short_from[rows[j] + t] + ahead[victim, j, t : t + block], out=best
                )
            done[heads, pad + t : pad + t + block] = best
        self.pad, self.width = pad, width
        self.done, self.short = done, short

    @property
    def values(self) -> Floats:
        """Least cost of having served at each state by each time, ``(n_states, last + 1)``."""
        return self.done[:, self.pad : self.pad + self.network.last + 1]

    def before(self, extra: Ints) -> Floats:
        """Least cost before the service that takes ``extra[s]`` steps more than the shortest."""
        rows = np.arange(self.network.n_states - 1) * self.width + self.pad - extra
        before: Floats = sliding_window_view(self.short.ravel(), self.network.last + 1)[rows]
        return before

    def least(self) -> float:
        """Cost of the cheapest path; infinite if there is none."""
        return float(self.values[:-1].min(initial=np.inf))

    def paths(self, below: float) -> list[Stops]:
        """The cheapest paths that end at different victims, and cost less than `below`."""
        values = self.values[:-1]
        when = values.argmin(axis=1)
        least = values[np.arange(len(values)), when]
        ends = []
        for i in np.unique(self.network.at[:-1]):
            states = np.flatnonzero(self.network.at[:-1] == i)
            state = int(states[least[states].argmin()])
            if least[state] < below:
                ends.append((float(least[state]), state))
        return [self._trace(state, int(when[state])) for _, state in sorted(ends)[:MOST_PATHS]]

    def _trace(self, state: int, t: int) -> Stops:
        network = self.network
        stops = []
        while state != network.n_states - 1:
            i = int(network.at[state])
            ways = [
                self.short[state, self.pad + t - network.extra[i, j]] + self.cost[i, j, t]
                for j in range(len(network.options[i]))
            ]
            j = int(np.argmin(ways))
            stops.append((int(network.victims[i]), network.options[i][j], t * network.step))
            t -= int(network.extra[i, j])
            low, high = np.searchsorted(network.head, [state, state + 1])
            legs = network.steps[low:high]
            arc = int(self.done[network.tail[low:high], self.pad + t - legs].argmin())
            state, t = int(network.tail[low + arc]), t - int(legs[arc])
        return tuple(reversed(stops))


def _options(needs: Needs, robot: int, victim: int) -> list[tuple[float, tuple[int, ...]]]:
    """What the robot may serve in one visit, with the time it takes, shortest first."""
    able = [g for g in needs.of[victim] if needs.able[robot, g]]
    sets = [some for n in range(1, len(able) + 1) for some in combinations(able, n)]
    return sorted((sum(needs.service[g] for g in some), some) for some in sets)


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
