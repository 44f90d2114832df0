r"""What dual values prove about latency, worked out again from the instance.

Let task g of victim v have the dual value ρ_g, and the cost φ_g(t) = ∫ μ_g from 0 to t if done at t,
where the densities

    μ_g(t) ≥ 0    and    Σ_g μ_g(t) ≤ priority_v    at every time t, over the tasks g of v.

At each time before v is complete the densities of tasks not yet done add up to no more than its
priority, so its weighted completion time is at least Σ_g φ_g(t_g). Every task is served once; so no plan
has a latency below

    Σ_g ρ_g + Σ_r min(0, minimum Σ (φ_g(t_g) − ρ_g) of a route of robot r).

The minimum is that of ng-routes (`ng_routes`), the pricing problem, found by dynamic programming.

Only plans better than the one at hand matter. What costs more on every path than those can afford is
ruled out: services at certain steps, and legs. So every round is on a smaller network than the one
before, and proves more.

All costs are whole numbers of one small unit: what tasks cost is rounded down to it, which the proof
allows, and nothing else is rounded.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Ints
from ..mission.errors import CheckError
from ..mission.exact import exact
from ..mission.proof import LatencyProof, PricingRound
from .joint_problem import Joint
from .ng_routes import NEVER, Deadlines, Network, States, Task
from .scheduling_bound import power_of_two_below

_BITS = 60
"""Every sum of costs is a number of so many."""
_DENSITY_BITS = 60
"""Densities are counted in the priority's parts, 2 to the power of so many."""


def pricing_bound(joint: Joint, proof: LatencyProof, worth: Fraction) -> Fraction:
    """What `proof` proves about the latency of all plans.

    Parameters
    ----------
    joint : Joint
        The joint problem.
    proof : LatencyProof
        Dual values, round by round.
    worth : Fraction
        What the plan at hand is worth; nothing more is ever proved.

    Raises
    ------
    CheckError
        If dual values are of what there is not, densities are too high, or there is more than can be
        counted.
    """
    priced = price(joint, proof, worth)
    return worth if priced is None else priced.best


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot's network, and its cheapest paths at some dual values."""

    network: Network
    states: States
    cost: Ints
    """Of being done with every option at every step, ``(m, n_options, last + 1)``."""
    there: Ints
    """Minimum cost of being at each state at each step."""
    cheapest: int
    """Of all paths; 0 if staying is."""


@dataclass(frozen=True, eq=False)
class Priced:
    """What rounds of dual values prove and leave open."""

    best: Fraction
    """No better plan is worth less."""
    better: int
    """What better plans are worth at most, in units."""
    unit: Fraction
    """Of costs."""
    spare: int
    """What a plan's paths cost together beyond the cheapest ones at the maximum, in units."""
    robots: tuple[Robot, ...]
    tasks: dict[int, tuple[Task, ...]]


def price(joint: Joint, proof: LatencyProof, worth: Fraction) -> Priced | None:
    """As `pricing_bound`; ``None`` if that is all that can be proved."""
    tasks = _tasks(joint)
    better = worth - joint.step("latency")
    deadlines = _deadlines(joint, better)
    if deadlines is None:
        return None
    steps = _time_steps(joint, proof)
    networks = [Network(joint, tasks, r, steps[r], deadlines) for r in steps]
    unit = _unit(joint, proof, networks)
    best = Fraction(0)
    for number, part in enumerate(proof.rounds):
        name = f"round {number}"
        duals = task_duals(joint, tasks, part, unit, name)
        remembered = _remembered(joint, part, name)
        total = sum(dual.value for dual in duals.values())
        robots = []
        for network in networks:
            states = network.states(remembered)
            cost = network.cost(duals)
            there = states.forward(cost)
            robots.append(Robot(network, states, cost, there, min(0, int(there.min()))))
        total += sum(robot.cheapest for robot in robots)
        best = max(best, total * unit)
        if best > better:
            return None
        maximum = math.floor(better / unit)
        spare = maximum - total
        if number + 1 < len(proof.rounds):
            for robot in robots:
                limit = min(spare + robot.cheapest, NEVER - 1)
                robot.network.rule_out(robot.states, robot.cost, robot.there, limit)
    return Priced(best, maximum, unit, spare, tuple(robots), tasks)


@dataclass(frozen=True, eq=False)
class _Dual:
    """Of one task, in exact numbers."""

    unit: Fraction
    """Of costs."""
    value: int
    """Of its being served, in units of cost."""
    priority: Fraction
    breakpoints: tuple[Fraction, ...]
    """Where its densities begin, the first at 0."""
    densities: tuple[int, ...]
    """In shares of the priority, of `_DENSITY_BITS`."""

    def cost(self, step: Fraction, n: int) -> Ints:
        """Of being done at 0, 1, …, n - 1 times `step`, less the dual value, in units."""
        parts = math.lcm(step.denominator, *(time.denominator for time in self.breakpoints))
        begin = [int(time * parts) for time in self.breakpoints]
        before = [0]
        for here, there, density in zip(begin, begin[1:], self.densities, strict=False):
            before.append(before[-1] + density * (there - here))
        worth = self.priority / (self.unit * parts * 2**_DENSITY_BITS)
        top, bottom, length = worth.numerator, worth.denominator, int(step * parts)
        costs = []
        for time in range(0, n * length, length):
            i = bisect_right(begin, time) - 1
            passed = before[i] + self.densities[i] * (time - begin[i])
            costs.append(passed * top // bottom - self.value)
        return np.array(costs, dtype=np.int64)


def _tasks(joint: Joint) -> dict[int, tuple[Task, ...]]:
    """The tasks of each victim: what only one and the same robot can serve is one task."""
    able: dict[tuple[int, str], list[int]] = {}
    for r, v, k in sorted(joint.able):
        able.setdefault((v, k), []).append(r)
    together: dict[int, dict[tuple[int | str, ...], tuple[str, ...]]] = {}
    for (v, k), robots in sorted(able.items()):
        own = together.setdefault(v, {})
        who = tuple(robots) if len(robots) == 1 else (-1, k)
        own[who] = (*own.get(who, ()), k)
    return {v: tuple((v, kinds) for kinds in own.values()) for v, own in together.items()}


def _deadlines(joint: Joint, better: Fraction) -> Deadlines | None:
    """When each victim is complete at the latest in plans worth at most `better`.

    No time for a victim without priority; nothing at all if there are no such plans.
    """
    spare = better - joint.each_alone("latency")
    if spare < 0:
        return None
    return {
        v: done + spare / joint.priority[v] if joint.priority[v] else None
        for v, done in joint.soonest_complete.items()
    }


def _time_steps(joint: Joint, proof: LatencyProof) -> dict[int, Fraction]:
    """The time step of each robot that can serve something."""
    steps = {step.robot: exact(step.length) for step in proof.time_steps}
    movers = [r for r in joint.robots if joint.victims_of[r]]
    if missing := [r for r in movers if r not in steps]:
        raise CheckError(f"robot {missing[0]} has no time step")
    return {r: steps[r] for r in movers}


def _unit(joint: Joint, proof: LatencyProof, networks: list[Network]) -> Fraction:
    """A unit of cost so small that little is lost, and so large that every sum is a 64-bit number."""
    latest = max((network.last * network.step for network in networks), default=Fraction(0))
    charges = latest * sum(joint.priority.values(), Fraction(0))
    duals = max(
        sum((abs(exact(task.dual)) for task in part.tasks), Fraction(0)) for part in proof.rounds
    )
    # A path may come back to victims that it has forgotten, but not more often than it has steps.
    often = 1 + max((network.last for network in networks), default=0)
    largest = (charges + duals) * (often + 1)
    return 1 / power_of_two_below(2**_BITS / largest) if largest else Fraction(1)


def task_duals(
    joint: Joint,
    tasks: dict[int, tuple[Task, ...]],
    part: PricingRound,
    unit: Fraction,
    name: str,
) -> dict[Task, _Dual]:
    """The dual values of every task, 0 where none are given."""
    begin = _breakpoints(part, name)
    duals: dict[Task, _Dual] = {}
    known = {task for own in tasks.values() for task in own}
    for item in part.tasks:
        task = (item.victim, tuple(sorted(item.kinds)))
        what = f"{', '.join(item.kinds)} at victim {item.victim}"
        if task not in known:
            raise CheckError(f"{name} has a dual value of {what}, which is no task of this problem")
        if task in duals:
            raise CheckError(f"{name} has two dual values of {what}")
        own, priority = begin.get(item.victim, (Fraction(0),)), joint.priority[item.victim]
        if len(item.densities) != len(own):
            raise CheckError(
                f"{name} has {len(item.densities)} densities of {what} for {len(own)} intervals of "
                "time"
            )
        duals[task] = _Dual(
            unit,
            math.floor(exact(item.dual) / unit),
            priority,
            own,
            tuple(
                math.floor(exact(density) / priority * 2**_DENSITY_BITS) if priority else 0
                for density in item.densities
            ),
        )
    for v, group in tasks.items():
        densities = zip(*(duals[task].densities for task in group if task in duals), strict=True)
        if any(sum(at_once) > 2**_DENSITY_BITS for at_once in densities):
            raise CheckError(f"{name} has densities at victim {v} that exceed its priority")
    nothing = _Dual(unit, 0, Fraction(0), (Fraction(0),), (0,))
    return {task: duals.get(task, nothing) for task in known}


def _breakpoints(part: PricingRound, name: str) -> dict[int, tuple[Fraction, ...]]:
    begin: dict[int, tuple[Fraction, ...]] = {}
    for item in part.breakpoints:
        if item.victim in begin:
            raise CheckError(f"{name} gives the breakpoints of victim {item.victim} twice")
        times = (Fraction(0), *map(exact, item.times))
        if sorted(times) != list(times):
            raise CheckError(
                f"{name} has breakpoints of victim {item.victim} that are out of order"
            )
        begin[item.victim] = times
    return begin


def _remembered(
    joint: Joint, part: PricingRound, name: str
) -> dict[tuple[int, int], frozenset[int]]:
    """What a robot remembers at a victim, besides that victim."""
    remembered = {}
    for item in part.neighbourhoods:
        own = joint.victims_of.get(item.robot, ())
        if strange := ({item.victim} | set(item.remembers)) - set(own):
            raise CheckError(
                f"{name} has robot {item.robot} remember victim {min(strange)}, which it cannot serve"
            )
        remembered[item.robot, item.victim] = frozenset(item.remembers)
    return remembered
