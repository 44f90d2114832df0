"""A robot's ng-routes: paths through victims, memories and steps of time, and the cheapest of them.

Times are rounded down to whole steps, and a robot at a victim remembers only neighbours of it, so it may
come back to others (ng-routes). Every route is such a path, no later and at no greater cost, so the
cheapest path costs no more than the cheapest route.

For checks: all is worked out from the joint problem, in whole numbers, and nothing is shared with the
planners.

Source: Baldacci, Mingozzi and Roberti, *New route relaxation and pricing strategies for the vehicle
routing problem* (2011) for ng-routes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from itertools import combinations
from typing import Protocol

import numpy as np

from ..arrays import Ints
from ..mission.errors import CheckError
from .joint_problem import Joint

Task = tuple[int, tuple[str, ...]]
"""A victim, and the kinds that are served there together."""
Deadlines = dict[int, Fraction | None]
"""When each victim is complete at the latest; ``None`` if nothing is known."""

NEVER = 1 << 61
"""The cost of what cannot be: two of them still are a number."""
_MAX_CELLS = 40_000_000
"""States times steps of a robot, beyond which memory would run out."""
_MAX_STEPS = 20_000
"""Up to a robot's last deadline, as many as the planner may have, and of a leg or a service hardly more:
a robot of 1e-9 cells in a time unit would have no end of them."""
_MAX_TASKS = 12
"""Of a robot at a victim; all sets of them are options."""


class Costed(Protocol):
    """What a task costs."""

    def cost(self, step: Fraction, n: int) -> Ints:
        """If it is done at 0, 1, …, n - 1 times `step`."""


def last_services(
    joint: Joint, robot: int, deadlines: Deadlines, maximum: Fraction
) -> dict[int, Fraction]:
    """When a robot serves each of its victims at the latest, if no time is longer than `maximum`."""
    own = joint.victims_of[robot]
    longest = Fraction(0)
    for v in own:
        ways = [joint.leave[robot, v], *(joint.travel(robot, v, w) for w in own if w != v)]
        longest += min(max(ways), maximum)
        longest += min(sum(joint.service[v, k] for k in joint.kinds_of[robot, v]), maximum)
    last = {}
    for v in own:
        limits = [longest]
        if (deadline := deadlines[v]) is not None:
            limits.append(deadline)
        if joint.endurance is not None:
            limits.append(joint.endurance - joint.back(robot, v))
        last[v] = min(limits)
    return last


class Network:
    """One robot's legs, and services at whole steps, that are not ruled out.

    Parameters
    ----------
    joint : Joint
        The joint problem.
    tasks : dict
        The tasks of each victim.
    robot : int
        Whose network.
    step : Fraction
        Its step of time, in time units; a longer one is taken where there would be too many.
    deadlines : dict
        When each victim is complete at the latest, if anything is known.

    Raises
    ------
    CheckError
        If there are more steps, or more tasks at a victim, than memory has room for.
    """

    def __init__(
        self,
        joint: Joint,
        tasks: dict[int, tuple[Task, ...]],
        robot: int,
        step: Fraction,
        deadlines: Deadlines,
    ) -> None:
        self.robot = robot
        self.victims = victims = joint.victims_of[robot]
        m = len(victims)
        able = {
            v: [task for task in tasks[v] if (robot, v, task[1][0]) in joint.able] for v in victims
        }
        if many := [v for v in victims if len(able[v]) > _MAX_TASKS]:
            raise CheckError(f"robot {robot} has too many tasks at victim {many[0]} to count with")
        self.options = [_options(able[v]) for v in victims]
        # Longer steps, and legs that are as long as what is longer: bounds only get lower.
        due = [deadline for v in victims if (deadline := deadlines[v]) is not None]
        self.step = step = max([step, *(deadline / _MAX_STEPS for deadline in due)])
        maximum = step * (_MAX_STEPS + 1)
        latest = last_services(joint, robot, deadlines, maximum)
        lasts = [math.floor(latest[v] / step) for v in victims]
        self.last = max(0, *lasts)
        n_options = max(map(len, self.options))
        if m * n_options * (self.last + 1) > _MAX_CELLS:
            raise CheckError(f"the time step of robot {robot} is too short to count with")
        self.open = np.zeros((m, n_options, self.last + 1), dtype=bool)
        for i, last in enumerate(lasts):
            self.open[i, : len(self.options[i]), : max(last + 1, 0)] = True

        def steps(time: Fraction) -> int:
            return min(math.floor(min(time, maximum) / step), self.last + 1)

        self.service = [
            [
                steps(sum((joint.service[v, k] for _, kinds in some for k in kinds), Fraction(0)))
                for some in own
            ]
            for v, own in zip(victims, self.options, strict=True)
        ]
        self.legs = np.zeros((m + 1, m), dtype=np.int64)
        for j, v in enumerate(victims):
            self.legs[m, j] = steps(joint.leave[robot, v])
            for i, w in enumerate(victims):
                if i != j:
                    self.legs[i, j] = steps(joint.travel(robot, w, v))
        self.leg_open = ~np.eye(m + 1, m, dtype=bool)

    def cost(self, duals: Mapping[Task, Costed]) -> Ints:
        """Of being done with every option at every step, ``(m, n_options, last + 1)``."""
        cost = np.full(self.open.shape, NEVER)
        for i, options in enumerate(self.options):
            alone = {
                task: duals[task].cost(self.step, self.last + 1)
                for some in options
                for task in some
            }
            for j, some in enumerate(options):
                cost[i, j] = sum(alone[task] for task in some)
        cost[~self.open] = NEVER
        return cost

    def states(self, remembered: dict[tuple[int, int], frozenset[int]]) -> States:
        """The states that its legs lead to, and the moves between them."""
        m = len(self.victims)
        bit = {v: 1 << i for i, v in enumerate(self.victims)}
        keeps = [
            sum(bit[w] for w in {v} | remembered.get((self.robot, v), frozenset()))
            for v in self.victims
        ]
        onward = [np.flatnonzero(ways).tolist() for ways in self.leg_open]
        usable = [np.flatnonzero(options.any(axis=1)).tolist() for options in self.open]
        places = [(m, 0)]
        number = {places[0]: 0}
        moves = []
        for tail, (i, memory) in enumerate(places):  # grows on the way
            for j in onward[i]:
                if memory & 1 << j or not usable[j]:
                    continue
                place = (j, memory & keeps[j] | 1 << j)
                head = number.setdefault(place, len(places))
                if head == len(places):
                    places.append(place)
                    if len(places) * (self.last + 1) > _MAX_CELLS:
                        raise CheckError(f"robot {self.robot} remembers too much to count")
                leg = int(self.legs[i, j])
                moves += [(head, tail, i, j, o, leg + self.service[j][o]) for o in usable[j]]
        return States(len(places), np.array(sorted(moves), dtype=np.int64).reshape(-1, 6))

    def rule_out(self, states: States, cost: Ints, there: Ints, limit: int) -> None:
        """Rule out what only paths that cost more than `limit` do."""
        service, leg = states.through(cost, there, self.leg_open.shape)
        self.open &= service <= limit
        self.leg_open &= leg <= limit
        used = np.flatnonzero(self.open.any(axis=(0, 1)))
        self.last = int(used[-1]) if len(used) else 0
        self.open = self.open[:, :, : self.last + 1]


class States:
    """Where a robot may be and what it remembers, the start first, and how it moves on.

    Parameters
    ----------
    n : int
        Number of states.
    moves : array, shape (n_moves, 6)
        State to and from, victim from and to, option served there, and steps until that is done; by
        the state to.
    """

    def __init__(self, n: int, moves: Ints) -> None:
        self.n = n
        self.head, self.tail, self.origin, self.victim, self.option, self.steps = moves.T
        if len(moves) and not self.steps.all():
            raise CheckError("a leg takes no step, so that steps do not order what is served")
        self.longest = int(self.steps.max(initial=0))

    def forward(self, cost: Ints) -> Ints:
        """Minimum cost of being done at each state at each step, ``(n, last + 1)``."""
        n_steps = cost.shape[2]
        width = self.longest + n_steps
        done = np.full((self.n, width), NEVER)
        done[0, self.longest] = 0
        if not len(self.head):
            return done[:, self.longest :]
        heads, first = np.unique(self.head, return_index=True)
        before = self.tail * width + self.longest - self.steps
        here = self._rows(cost) * n_steps
        for t in range(1, n_steps):
            ways = done.ravel()[before + t] + cost.ravel()[here + t]
            done[heads, self.longest + t] = np.minimum(np.minimum.reduceat(ways, first), NEVER)
        return done[:, self.longest :]

    def onward(self, cost: Ints) -> Ints:
        """Minimum cost of going on from each state at each step, ``(n, last + 1 + longest)``."""
        n_steps = cost.shape[2]
        width = n_steps + self.longest
        after = np.full((self.n, width), NEVER)
        after[:, :n_steps] = 0
        if not len(self.head):
            return after
        ahead = np.pad(cost, ((0, 0), (0, 0), (0, self.longest)), constant_values=NEVER)
        by_tail = np.argsort(self.tail, kind="stable")
        tails, first = np.unique(self.tail[by_tail], return_index=True)
        later = (self.head * width + self.steps)[by_tail]
        there = (self._rows(cost) * width + self.steps)[by_tail]
        for t in range(n_steps - 1, -1, -1):
            ways = after.ravel()[later + t] + ahead.ravel()[there + t]
            after[tails, t] = np.minimum(np.minimum.reduceat(ways, first), 0)
        return after

    def through(self, cost: Ints, there: Ints, legs: tuple[int, ...]) -> tuple[Ints, Ints]:
        """Minimum cost of a path with a service, ``cost.shape``, or with a leg, of shape `legs`."""
        service, leg = np.full(cost.shape, NEVER), np.full(legs, NEVER)
        if not len(self.head):
            return service, leg
        n_steps = cost.shape[2]
        after = self.onward(cost)
        row, here = self._rows(cost), self._rows(cost) * n_steps
        of_leg = self.origin * legs[1] + self.victim
        for t in range(n_steps - 1, 0, -1):
            left = np.where(self.steps <= t, t - self.steps, n_steps)
            whole = np.where(left < n_steps, there[self.tail, np.minimum(left, n_steps - 1)], NEVER)
            whole = whole + cost.ravel()[here + t] + after[self.head, t]
            np.minimum.at(service.reshape(-1, n_steps)[:, t], row, whole)
            np.minimum.at(leg.reshape(-1), of_leg, whole)
        return service, leg

    def _rows(self, cost: Ints) -> Ints:
        """The row of each move's option in `cost`."""
        return np.asarray(self.victim * cost.shape[1] + self.option)


def _options(tasks: list[Task]) -> list[tuple[Task, ...]]:
    """What may be served in one visit."""
    return [some for n in range(1, len(tasks) + 1) for some in combinations(tasks, n)]
