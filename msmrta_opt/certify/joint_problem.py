"""The joint problem of a plan, worked out again from its instance, in exact numbers.

For checks: nothing here is shared with the planners, and nothing is rounded. A number of a file is
taken for the fraction that it is written for (0.3 for 3/10), so times have small denominators and
their greatest common divisor is exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations

from ..mission.exact import exact, greatest_common_divisor
from ..mission.instance import Instance
from ..mission.plan import Plan, Reason
from .walking import steps_from

ROUNDING = Fraction(1, 10**9)
"""Relative difference up to which two times are the same."""
TINY = Fraction(1, 10**9)
"""Share of a bound up to which times are tiny."""


def figure(number: Fraction) -> str:
    """`number` as people read it, whatever its size."""
    try:
        return f"{float(number):.9g}"
    except OverflowError:
        return "more than 1e308"


def service_times(mission: Instance) -> dict[tuple[int, str], Fraction]:
    """Service time of each victim's requirements."""
    return {
        (victim.id, kind): exact(victim.service_time.get(kind, mission.service_time[kind]))
        for victim in mission.victims
        for kind in victim.requirements
    }


@dataclass(frozen=True)
class Limits:
    """What is promised of every robot."""

    endurance: Fraction | None
    """Longest time that a robot may be busy."""
    longest_walk: Fraction | None
    """The number of moves that it may make."""
    returns: bool
    """Whether it walks back to its start."""

    @classmethod
    def of(cls, plan: Plan) -> Limits:
        """Those that the options of `plan` name; rounding does not break them."""
        endurance, walk = (plan.limits.get(name) for name in ("endurance", "longest_walk"))
        return cls(
            None if endurance is None else exact(endurance) * (1 + ROUNDING),
            None if walk is None else exact(walk) * (1 + ROUNDING),
            bool(plan.limits.get("return_to_start")),
        )

    def too_long(self, busy: Fraction) -> bool:
        """Whether a robot that is busy for so long breaks them."""
        return self.endurance is not None and busy > self.endurance

    def too_far(self, moves: int) -> bool:
        """Whether a robot that makes so many moves breaks them."""
        return self.longest_walk is not None and moves > self.longest_walk


def servable(known: Instance, limits: Limits) -> dict[tuple[int, int, str], Fraction]:
    """Which robot can serve what, within its limits if it does nothing else; and its travel there."""
    ways = 2 if limits.returns else 1
    service = service_times(known)
    found = {}
    for robot in known.robots:
        steps, speed = steps_from(known.map, robot.start), exact(robot.speed)
        for victim in known.victims:
            moves = steps.get(victim.cell)
            if moves is None or limits.too_far(ways * moves):
                continue
            for kind in victim.requirements:
                busy = ways * moves / speed + service[victim.id, kind]
                if kind in robot.capabilities and not limits.too_long(busy):
                    found[robot.id, victim.id, kind] = moves / speed
    return found


def beyond_limits(plan: Plan) -> dict[tuple[int, str], Reason]:
    """The requirements that nobody can serve within the limits, though without them, and why.

    A limit is the reason where some robot keeps to the other; else both are.
    """
    known, limits = plan.known, Limits.of(plan)
    in_time, in_walk, in_both, able = (
        {(v, k) for _, v, k in servable(known, kept)}
        for kept in (
            replace(limits, longest_walk=None),
            replace(limits, endurance=None),
            limits,
            replace(limits, endurance=None, longest_walk=None),
        )
    )
    reasons = {
        (False, True): Reason.BEYOND_ENDURANCE,
        (True, False): Reason.BEYOND_LONGEST_WALK,
    }
    return {
        task: reasons.get((task in in_time, task in in_walk), Reason.BEYOND_BOTH)
        for task in able - in_both
    }


@dataclass(frozen=True, eq=False)
class Joint:
    """Who can serve what, and how long everything takes, in time units; by ids.

    A requirement is here if a robot can serve it, within the limits if it serves nothing else.
    """

    robots: tuple[int, ...]
    able: frozenset[tuple[int, int, str]]
    """Robot, victim and kind that go together."""
    leave: dict[tuple[int, int], Fraction]
    """Travel of a robot from its start to a victim that it can serve."""
    between: dict[tuple[int, int, int], Fraction]
    """Travel of a robot between two such victims, the smaller id first."""
    returns: bool
    """Whether robots walk back to their starts."""
    service: dict[tuple[int, str], Fraction]
    """Service time of each requirement that is here."""
    priority: dict[int, Fraction]
    """What a unit of time until a victim is complete costs."""
    endurance: Fraction | None
    """Longest time that a robot may be busy."""
    walk: dict[int, Fraction]
    """Longest travel time of each robot, if there is a limit."""

    @classmethod
    def of(cls, plan: Plan) -> Joint:
        """The joint problem of `plan`, whose options hold its limits."""
        known, limits = plan.known, Limits.of(plan)
        speed = {robot.id: exact(robot.speed) for robot in known.robots}
        cell = {victim.id: victim.cell for victim in known.victims}
        ways = servable(known, limits)
        leave = {(r, v): way for (r, v, _), way in ways.items()}
        steps = {v: steps_from(known.map, cell[v]) for v in {v for _, v in leave}}
        between = {
            (r, i, j): steps[i][cell[j]] / speed[r]
            for r in speed
            for i, j in combinations(sorted(v for s, v in leave if s == r), 2)
        }
        times = service_times(known)
        return cls(
            robots=tuple(robot.id for robot in known.robots),
            able=frozenset(ways),
            leave=leave,
            between=between,
            returns=limits.returns,
            service={(v, k): times[v, k] for _, v, k in ways},
            priority={v.id: exact(v.priority) for v in known.victims if v.id in steps},
            endurance=limits.endurance,
            walk={}
            if limits.longest_walk is None
            else {r: limits.longest_walk / speed[r] for r in speed},
        )

    @cached_property
    def victims_of(self) -> dict[int, tuple[int, ...]]:
        """The victims that each robot can serve, in order."""
        return {r: tuple(sorted(v for s, v in self.leave if s == r)) for r in self.robots}

    def back(self, robot: int, victim: int) -> Fraction:
        """Travel back to the start, 0 where robots do not return."""
        return self.leave[robot, victim] if self.returns else Fraction(0)

    @property
    def total_service(self) -> Fraction:
        """Service time of all requirements."""
        return sum(self.service.values(), Fraction(0))

    def offset(self, objective: str) -> Fraction:
        """What every plan costs: all service, for total time."""
        return self.total_service if objective == "total_time" else Fraction(0)

    def travel(self, robot: int, victim: int, other: int) -> Fraction:
        """Travel of a robot between two victims that it can serve."""
        return self.between[robot, min(victim, other), max(victim, other)]

    @cached_property
    def kinds_of(self) -> dict[tuple[int, int], tuple[str, ...]]:
        """What each robot can serve at each victim, in order."""
        kinds: dict[tuple[int, int], tuple[str, ...]] = {}
        for r, v, k in sorted(self.able):
            kinds[r, v] = (*kinds.get((r, v), ()), k)
        return kinds

    @cached_property
    def soonest(self) -> dict[tuple[int, str], Fraction]:
        """When each requirement can be done, by whoever is the first at it."""
        soonest: dict[tuple[int, str], Fraction] = {}
        for r, v, k in self.able:
            done = self.leave[r, v] + self.service[v, k]
            soonest[v, k] = min(soonest.get((v, k), done), done)
        return soonest

    @cached_property
    def soonest_complete(self) -> dict[int, Fraction]:
        """When each victim can be complete."""
        complete: dict[int, Fraction] = {}
        for (v, _), done in self.soonest.items():
            complete[v] = max(complete.get(v, done), done)
        return complete

    def _times(self, objective: str) -> list[Fraction]:
        """What adds up to plans' values: ways, and service unless it is the same for all plans."""
        service = () if objective == "total_time" else self.service.values()
        return [*self.leave.values(), *self.between.values(), *service]

    def _weight(self, objective: str) -> Fraction:
        """What the weights of completion times are multiples of."""
        weighted = objective == "latency"
        return greatest_common_divisor(self.priority.values()) if weighted else Fraction(1)

    def step(self, objective: str) -> Fraction:
        """What plans' values differ by: multiples of this; 0 if they do not differ."""
        return greatest_common_divisor(self._times(objective)) * self._weight(objective)

    def up(self, bound: Fraction, objective: str, value: Fraction) -> Fraction:
        """The smallest from `bound` on that plans no worse than `value` can be worth, or `value`.

        They are worth multiples of the step of all times that are short enough to be in one of them.
        They are also multiples of the step of all but tiny times, and what these add to them, which may
        tell more.
        """
        offset, weight = self.offset(objective), self._weight(objective)
        longest = self._longest(objective, value)
        times = [time for time in self._times(objective) if time <= longest]
        tiny = bound * TINY
        found = bound
        for some, more in (
            (times, Fraction(0)),
            ([time for time in times if time > tiny], self._from_tiny(objective, tiny)),
        ):
            if step := greatest_common_divisor(some) * weight:
                found = max(found, offset + step * math.ceil((bound - more - offset) / step))
        return max(bound, min(found, value))

    def _longest(self, objective: str, value: Fraction) -> Fraction:
        """No longer time adds to what a plan is worth that is no worse than `value`."""
        if objective == "total_time":
            return value - self.offset(objective)
        weights = [weight for weight in self.priority.values() if weight > 0]
        return value / min(weights) if objective == "latency" and weights else value

    def _from_tiny(self, objective: str, tiny: Fraction) -> Fraction:
        """What times up to `tiny` add to the value of any plan at the maximum."""
        ways = [way for way in [*self.leave.values(), *self.between.values()] if way <= tiny]
        # A robot goes to each of its victims once, and perhaps back.
        more = max(ways, default=Fraction(0)) * (len(self.leave) + len(self.robots))
        if objective != "total_time":
            more += sum((time for time in self.service.values() if time <= tiny), Fraction(0))
        return more * sum(self.priority.values()) if objective == "latency" else more

    def each_alone(self, objective: str) -> Fraction:
        """A bound without any dual values: each requirement as if it were the only one."""
        if objective == "latency":
            complete = self.soonest_complete
            return sum((self.priority[v] * done for v, done in complete.items()), Fraction(0))
        soonest: dict[tuple[int, str], Fraction] = {}
        for r, v, k in self.able:
            way = self.leave[r, v] + self.back(r, v)
            soonest[v, k] = min(soonest.get((v, k), way), way)
        if objective == "makespan":
            return max(
                (way + self.service[v, k] for (v, k), way in soonest.items()), default=Fraction(0)
            )
        return self.total_service + max(soonest.values(), default=Fraction(0))
