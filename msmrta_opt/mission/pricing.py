r"""What prices prove about latency, worked out again from the instance.

Let need g of victim v be rewarded with ρ_g, and charged φ_g(t) = ∫ μ_g from 0 to t if done at t, where

    μ_g(t) ≥ 0    and    Σ_g μ_g(t) ≤ priority_v    at every time t, over the needs g of v.

At each time before v is complete no more than its priority is charged, so its weighted completion time
is at least Σ_g φ_g(t_g). Every need is served once; so no plan has a latency below

    Σ_g ρ_g + Σ_r min(0, least Σ (φ_g(t_g) − ρ_g) of a route of robot r).

Routes are relaxed: times are rounded down to whole steps, and a robot at a victim remembers only
neighbours of it, so it may come back to others (ng-routes). The least is then that of a path through
states (victim, remembered victims) and steps, found by dynamic programming.

Only plans better than the one at hand matter. What costs more on every path than those can afford is
ruled out: services at certain steps, and legs. So every round of prices is on a smaller network than
the one before, and proves more.

All costs are whole numbers of one small unit: what needs are charged is rounded down to it, which the
proof allows, and nothing else is rounded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from .errors import CheckError
from .joint import Joint, exact
from .proof import LatencyProof, PriceRound

Ints = NDArray[np.int64]
Need = tuple[int, tuple[str, ...]]
"""A victim, and the kinds that are served there together."""

NEVER = 1 << 61
"""The cost of what cannot be: two of them still are a number."""
_MOST_BITS, _FEWEST_BITS = 40, 8
"""A unit of cost is 2 to the minus so many bits."""
_CHARGE_BITS = 60
"""Charges are counted in 2 to the minus so many bits."""
_MOST_CELLS = 100_000_000
"""States times steps of a robot, beyond which memory would run out."""


def proved(joint: Joint, proof: LatencyProof, worth: Fraction) -> Fraction:
    """What `proof` proves about the latency of all plans.

    Parameters
    ----------
    joint : Joint
        The joint problem.
    proof : LatencyProof
        Prices, round by round.
    worth : Fraction
        What the plan at hand is worth; nothing more is ever proved.

    Raises
    ------
    CheckError
        If prices are of what there is not, charge too much, or are too large to count with.
    """
    needs = _needs(joint)
    most = worth - joint.grain("latency")
    deadlines = _deadlines(joint, most)
    if deadlines is None:
        return worth
    clocks = _clocks(joint, proof)
    unit = _unit(joint, proof, clocks, deadlines)
    networks = [_Network(joint, needs, r, clocks[r], deadlines, unit.parts) for r in _movers(joint)]
    best = Fraction(0)
    for number, part in enumerate(proof.rounds):
        prices = _prices(joint, needs, part, unit, f"round {number}")
        remembered = _remembered(joint, part, f"round {number}")
        total = sum(price.reward for price in prices.values())
        priced = []
        for network in networks:
            states = network.states(remembered)
            cost = network.cost(prices)
            there = states.forward(cost)
            least = min(0, int(there.min()))
            total += least
            priced.append((network, states, cost, there, least))
        best = max(best, Fraction(total) / unit.scale)
        if best > most:
            return worth
        if number + 1 < len(proof.rounds):
            spare = math.floor(most * unit.scale) - total
            for network, states, cost, there, least in priced:
                network.rule_out(states, cost, there, spare + least)
    return best


@dataclass(frozen=True)
class _Unit:
    """How times and costs are counted."""

    parts: int
    """Of a time unit; the robots' steps are whole numbers of them."""
    bits: int
    """Binary digits of costs."""

    @property
    def scale(self) -> int:
        """Units of cost that make up 1."""
        return 1 << self.bits


@dataclass(frozen=True, eq=False)
class _Price:
    """Of one need: its reward in units of cost, and its charges."""

    unit: _Unit
    reward: int
    begin: Ints
    """Where the steps of its charges begin, in parts; the first at 0."""
    charge: tuple[int, ...]
    """For each part of each step, in `_CHARGE_BITS`."""

    def cost(self, times: Ints) -> Ints:
        """Charges less the reward, for being done at `times`, in parts; whole numbers of any size."""
        step = self.begin.searchsorted(times, side="right") - 1
        length = np.diff(self.begin).astype(object)
        charge = np.array(self.charge, dtype=object)
        before = np.concatenate([[0], np.cumsum(length * charge[:-1])])
        charged = before[step] + charge[step] * (times - self.begin[step]).astype(object)
        divisor = self.unit.parts << (_CHARGE_BITS - self.unit.bits)
        return np.asarray(charged // divisor - self.reward, dtype=np.int64)


def _needs(joint: Joint) -> dict[int, tuple[Need, ...]]:
    """The needs of each victim: what only one and the same robot can serve is one need."""
    able: dict[tuple[int, str], list[int]] = {}
    for r, v, k in sorted(joint.able):
        able.setdefault((v, k), []).append(r)
    together: dict[int, dict[tuple[int | str, ...], tuple[str, ...]]] = {}
    for (v, k), robots in sorted(able.items()):
        own = together.setdefault(v, {})
        who = tuple(robots) if len(robots) == 1 else (-1, k)
        own[who] = (*own.get(who, ()), k)
    return {v: tuple((v, kinds) for kinds in own.values()) for v, own in together.items()}


def _deadlines(joint: Joint, most: Fraction) -> dict[int, Fraction | None] | None:
    """When each victim is complete at the latest in plans worth at most `most`.

    No time for a victim without priority; nothing at all if there are no such plans.
    """
    soonest: dict[int, Fraction] = {}
    for (v, _), done in joint.soonest.items():
        soonest[v] = max(soonest.get(v, done), done)
    spare = most - sum(joint.priority[v] * done for v, done in soonest.items())
    if spare < 0:
        return None
    return {
        v: done + spare / joint.priority[v] if joint.priority[v] else None
        for v, done in soonest.items()
    }


def _clocks(joint: Joint, proof: LatencyProof) -> dict[int, Fraction]:
    """The step of each robot's time."""
    clocks = {clock.robot: exact(clock.length) for clock in proof.clocks}
    if missing := [r for r in joint.robots if joint.victims_of[r] and r not in clocks]:
        raise CheckError(f"robot {missing[0]} has no clock")
    return clocks


def _unit(
    joint: Joint,
    proof: LatencyProof,
    clocks: dict[int, Fraction],
    deadlines: dict[int, Fraction | None],
) -> _Unit:
    """A unit so small that little is lost, and so large that every sum is a 64-bit number."""
    parts = math.lcm(1, *(step.denominator for step in clocks.values()))
    latest = sum(
        (joint.priority[v] * last for v, last in deadlines.items() if last is not None), Fraction(0)
    )
    rewards = max(
        sum((abs(exact(need.reward)) for need in part.needs), Fraction(0)) for part in proof.rounds
    )
    # A path may come back to victims that it has forgotten, but not more often than it has steps.
    often = max(
        (math.ceil(_horizon(joint, r, deadlines) / clocks[r]) for r in _movers(joint)), default=1
    )
    largest = math.ceil((latest + rewards) * (often + 1))
    bits = min(_MOST_BITS, 60 - largest.bit_length())
    if bits < _FEWEST_BITS:
        raise CheckError("these prices and clocks are too large to count with")
    return _Unit(parts, bits)


def _movers(joint: Joint) -> Iterator[int]:
    return (r for r in joint.robots if joint.victims_of[r])


def _horizon(joint: Joint, robot: int, deadlines: dict[int, Fraction | None]) -> Fraction:
    return max(_last(joint, robot, v, deadlines) for v in joint.victims_of[robot])


def _last(joint: Joint, robot: int, victim: int, deadlines: dict[int, Fraction | None]) -> Fraction:
    """When a robot serves a victim at the latest."""
    own = joint.victims_of[robot]
    last = sum(
        (
            max([joint.leave[robot, v], *(joint.travel(robot, v, w) for w in own if w != v)])
            + sum(joint.service[v, k] for k in joint.kinds_of[robot, v])
            for v in own
        ),
        Fraction(0),
    )
    deadline = deadlines[victim]
    if deadline is not None:
        last = min(last, deadline)
    if joint.endurance is not None:
        last = min(last, joint.endurance - joint.back(robot, victim))
    return last


def _prices(
    joint: Joint,
    needs: dict[int, tuple[Need, ...]],
    part: PriceRound,
    unit: _Unit,
    name: str,
) -> dict[Need, _Price]:
    """The prices of every need, 0 where none are given."""
    begin: dict[int, list[Fraction]] = {}
    for steps in part.steps:
        if steps.victim in begin:
            raise CheckError(f"{name} gives the steps of victim {steps.victim} twice")
        begin[steps.victim] = [Fraction(0), *map(exact, steps.begin)]
        if sorted(begin[steps.victim]) != begin[steps.victim]:
            raise CheckError(f"{name} has steps of victim {steps.victim} that are out of order")
    known = {need for own in needs.values() for need in own}
    prices: dict[Need, _Price] = {}
    for item in part.needs:
        need = (item.victim, tuple(sorted(item.kinds)))
        if need not in known or need in prices:
            what = "twice prices" if need in prices else "prices"
            why = "" if need in prices else ", which is no need of this problem"
            raise CheckError(
                f"{name} has {what} of {', '.join(item.kinds)} at victim {item.victim}{why}"
            )
        own = begin.get(item.victim, [Fraction(0)])
        if len(item.charges) != len(own):
            raise CheckError(
                f"{name} has {len(item.charges)} charges for the {len(own)} steps of victim "
                f"{item.victim}"
            )
        prices[need] = _Price(
            unit,
            math.floor(exact(item.reward) * unit.scale),
            np.array([math.floor(time * unit.parts) for time in own], dtype=np.int64),
            tuple(math.floor(exact(charge) * 2**_CHARGE_BITS) for charge in item.charges),
        )
    for v, group in needs.items():
        charges = zip(*(prices[need].charge for need in group if need in prices), strict=True)
        if any(sum(charged) > joint.priority[v] * 2**_CHARGE_BITS for charged in charges):
            raise CheckError(f"{name} charges more for victim {v} than its priority")
    nothing = _Price(unit, 0, np.zeros(1, dtype=np.int64), (0,))
    return {need: prices.get(need, nothing) for need in known}


def _remembered(joint: Joint, part: PriceRound, name: str) -> dict[tuple[int, int], frozenset[int]]:
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


class _Network:
    """One robot's legs, and services at whole steps, that are not ruled out."""

    def __init__(
        self,
        joint: Joint,
        needs: dict[int, tuple[Need, ...]],
        robot: int,
        step: Fraction,
        deadlines: dict[int, Fraction | None],
        parts: int,
    ) -> None:
        self.robot = robot
        self.parts = int(step * parts)
        """Of a time unit in a step."""
        self.victims = victims = joint.victims_of[robot]
        m = len(victims)
        self.options = [
            _options([need for need in needs[v] if (robot, v, need[1][0]) in joint.able])
            for v in victims
        ]
        self.service = [
            [
                math.floor(sum(joint.service[v, k] for _, kinds in some for k in kinds) / step)
                for some in own
            ]
            for v, own in zip(victims, self.options, strict=True)
        ]
        self.legs = np.zeros((m + 1, m), dtype=np.int64)
        for j, v in enumerate(victims):
            self.legs[m, j] = math.floor(joint.leave[robot, v] / step)
            for i, w in enumerate(victims):
                if i != j:
                    self.legs[i, j] = math.floor(joint.travel(robot, w, v) / step)
        lasts = [math.floor(_last(joint, robot, v, deadlines) / step) for v in victims]
        self.last = max(0, *lasts)
        self.leg_open = ~np.eye(m + 1, m, dtype=bool)
        self.open = np.zeros((m, max(map(len, self.options)), self.last + 1), dtype=bool)
        for i, last in enumerate(lasts):
            self.open[i, : len(self.options[i]), : max(last + 1, 0)] = True

    def cost(self, prices: dict[Need, _Price]) -> Ints:
        """Of being done with every option at every step, ``(m, n_options, last + 1)``."""
        times = np.arange(self.last + 1) * self.parts
        cost = np.full(self.open.shape, NEVER)
        for i, options in enumerate(self.options):
            for j, some in enumerate(options):
                cost[i, j] = sum(prices[need].cost(times) for need in some)
        cost[~self.open] = NEVER
        return cost

    def states(self, remembered: dict[tuple[int, int], frozenset[int]]) -> _States:
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
                    if len(places) * (self.last + 1) > _MOST_CELLS:
                        raise CheckError(f"robot {self.robot} remembers too much to count")
                leg = int(self.legs[i, j])
                moves += [(head, tail, i, j, o, leg + self.service[j][o]) for o in usable[j]]
        return _States(len(places), np.array(sorted(moves), dtype=np.int64).reshape(-1, 6))

    def rule_out(self, states: _States, cost: Ints, there: Ints, most: int) -> None:
        """Rule out what only paths that cost more than `most` do."""
        service, leg = states.through(cost, there, self.leg_open.shape)
        self.open &= service <= most
        self.leg_open &= leg <= most
        used = np.flatnonzero(self.open.any(axis=(0, 1)))
        self.last = int(used[-1]) if len(used) else 0
        self.open = self.open[:, :, : self.last + 1]


class _States:
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
        """Least cost of being done at each state at each step, ``(n, last + 1)``."""
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

    def through(self, cost: Ints, there: Ints, legs: tuple[int, ...]) -> tuple[Ints, Ints]:
        """Least cost of a path with a service, ``cost.shape``, or with a leg, of shape `legs`."""
        service, leg = np.full(cost.shape, NEVER), np.full(legs, NEVER)
        if not len(self.head):
            return service, leg
        n_steps = cost.shape[2]
        width = n_steps + self.longest
        after = np.full((self.n, width), NEVER)
        ahead = np.pad(cost, ((0, 0), (0, 0), (0, self.longest)), constant_values=NEVER)
        by_tail = np.argsort(self.tail, kind="stable")
        tails, first = np.unique(self.tail[by_tail], return_index=True)
        later = (self.head * width + self.steps)[by_tail]
        price = (self._rows(cost) * width + self.steps)[by_tail]
        row, here = self._rows(cost), self._rows(cost) * n_steps
        of_leg = self.origin * legs[1] + self.victim
        for t in range(n_steps - 1, 0, -1):
            ways = after.ravel()[later + t] + ahead.ravel()[price + t]
            after[:, t] = 0
            after[tails, t] = np.minimum(np.minimum.reduceat(ways, first), 0)
            left = np.where(self.steps <= t, t - self.steps, n_steps)
            whole = np.where(left < n_steps, there[self.tail, np.minimum(left, n_steps - 1)], NEVER)
            whole = whole + cost.ravel()[here + t] + after[self.head, t]
            np.minimum.at(service.reshape(-1, n_steps)[:, t], row, whole)
            np.minimum.at(leg.reshape(-1), of_leg, whole)
        return service, leg

    def _rows(self, cost: Ints) -> Ints:
        """The row of each move's option in `cost`."""
        return np.asarray(self.victim * cost.shape[1] + self.option)


def _options(needs: list[Need]) -> list[tuple[Need, ...]]:
    """What may be served in one visit."""
    return [some for n in range(1, len(needs) + 1) for some in combinations(needs, n)]
