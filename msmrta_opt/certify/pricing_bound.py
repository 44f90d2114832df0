r"""What prices prove about latency, worked out again from the instance.

Let need g of victim v be rewarded with ρ_g, and charged φ_g(t) = ∫ μ_g from 0 to t if done at t, where

    μ_g(t) ≥ 0    and    Σ_g μ_g(t) ≤ priority_v    at every time t, over the needs g of v.

At each time before v is complete no more than its priority is charged, so its weighted completion time
is at least Σ_g φ_g(t_g). Every need is served once; so no plan has a latency below

    Σ_g ρ_g + Σ_r min(0, least Σ (φ_g(t_g) − ρ_g) of a route of robot r).

The least is that of relaxed routes (`relaxed_routes`), found by dynamic programming.

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

import numpy as np

from ..mission.errors import CheckError
from ..mission.exact import exact
from ..mission.proof import LatencyProof, PriceRound
from .joint_problem import Joint
from .relaxed_routes import Deadlines, Ints, Need, Network, last_services

_MOST_BITS, _FEWEST_BITS = 40, 8
"""A unit of cost is 2 to the minus so many bits."""
_CHARGE_BITS = 60
"""Charges are counted in 2 to the minus so many bits."""


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
    networks = [Network(joint, needs, r, clocks[r], deadlines, unit.parts) for r in _movers(joint)]
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


def _deadlines(joint: Joint, most: Fraction) -> Deadlines | None:
    """When each victim is complete at the latest in plans worth at most `most`.

    No time for a victim without priority; nothing at all if there are no such plans.
    """
    spare = most - joint.at_once("latency")
    if spare < 0:
        return None
    return {
        v: done + spare / joint.priority[v] if joint.priority[v] else None
        for v, done in joint.soonest_complete.items()
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
    deadlines: Deadlines,
) -> _Unit:
    """A unit so small that little is lost, and so large that every sum is a 64-bit number."""
    parts = math.lcm(1, *(step.denominator for step in clocks.values()))
    latest = max(
        (max(last_services(joint, r, deadlines).values()) for r in _movers(joint)),
        default=Fraction(0),
    )
    charges = latest * sum(joint.priority.values(), Fraction(0))
    rewards = max(
        sum((abs(exact(need.reward)) for need in part.needs), Fraction(0)) for part in proof.rounds
    )
    # A path may come back to victims that it has forgotten, but not more often than it has steps.
    often = math.ceil(latest / min(clocks.values(), default=Fraction(1)))
    largest = math.ceil((charges + rewards) * (often + 1))
    bits = min(_MOST_BITS, 60 - largest.bit_length())
    if bits < _FEWEST_BITS:
        raise CheckError("these prices and clocks are too large to count with")
    return _Unit(parts, bits)


def _movers(joint: Joint) -> Iterator[int]:
    return (r for r in joint.robots if joint.victims_of[r])


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
