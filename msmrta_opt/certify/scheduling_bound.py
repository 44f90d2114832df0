"""A bound on latency without any dual values: requirements as jobs on parallel machines.

Requirement g of victim v takes robot r at least p_rg, its service and its share of the shortest way
into v, and delays as many requirements as are not yet done when it begins. So the minimum sum of
completion times is an assignment of requirements to places in the robots' sequences, the l-th from the
end at cost l p_rg. A victim is complete no sooner than the mean of its requirements, so each of n
requirements has the n-th part of its priority as weight; requirements of different weights are taken
apart in layers.

Source: Horn, *Minimizing average flow time with parallel machines* (1973).
"""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

import numpy as np

from .assignment import minimum_cost
from .joint_problem import Joint

_BITS = 60
"""Of the largest number that is counted with."""

Requirement = tuple[int, str]


def power_of_two_below(number: Fraction) -> Fraction:
    """A power of two that is at most `number`, and more than a quarter of it."""
    power = number.numerator.bit_length() - number.denominator.bit_length() - 1
    return Fraction(2) ** power


def scheduling_bound(joint: Joint) -> Fraction:
    """No plan has a latency below this."""
    shortest = _shortest_times(joint)
    many = Counter(v for v, _ in joint.service)
    weight = {g: joint.priority[g[0]] / many[g[0]] for g in joint.service}
    bound, below = Fraction(0), Fraction(0)
    for level in sorted({w for w in weight.values() if w > 0}):
        layer = [g for g in sorted(weight) if weight[g] >= level]
        bound += (level - below) * _minimum_sum(joint, layer, shortest)
        below = level
    return bound


def _shortest_times(joint: Joint) -> dict[tuple[int, Requirement], Fraction]:
    """What each requirement takes each robot able of it at least."""
    shortest: dict[tuple[int, Requirement], Fraction] = {}
    for (r, v), kinds in joint.kinds_of.items():
        ways = [joint.travel(r, v, w) for w in joint.victims_of[r] if w != v]
        share = min([joint.leave[r, v], *ways]) / len(kinds)
        shortest |= {(r, (v, k)): share + joint.service[v, k] for k in kinds}
    return shortest


def _minimum_sum(
    joint: Joint, layer: list[Requirement], shortest: dict[tuple[int, Requirement], Fraction]
) -> Fraction:
    """Minimum sum of the requirements' completion times."""
    n, own = len(layer), set(layer)
    soonest: dict[Requirement, Fraction] = {}
    for (_, g), time in shortest.items():
        soonest[g] = min(soonest.get(g, time), time)
    # What takes longer than all of the layer by whoever is soonest, one after another, is in no minimum:
    # without it, a robot of another scale takes no digits from the rest.
    most = n * sum(soonest[g] for g in layer)
    shortest = {(r, g): t for (r, g), t in shortest.items() if t <= most and g in own}
    longest = max(shortest.values())
    if not longest:
        return Fraction(0)
    # Whole numbers: exact if they can be, else rounded down.
    scale = Fraction(math.lcm(*(time.denominator for time in shortest.values())))
    largest = 2**_BITS / (longest * n**3 * len(joint.robots))
    if scale > largest:
        scale = power_of_two_below(largest)
    never = n * n * math.ceil(longest * scale)
    cost = np.full((len(joint.robots), n, n), never, dtype=np.int64)
    place = np.arange(1, n + 1)
    for i, r in enumerate(joint.robots):
        for j, g in enumerate(layer):
            if (r, g) in shortest:
                cost[i, :, j] = place * math.floor(shortest[r, g] * scale)
    return minimum_cost(cost.reshape(-1, n).T) / scale
