"""A bound on latency without any prices: requirements in the robots' queues.

Requirement g of victim v takes robot r at least p_rg, its service and its share of the shortest way
into v, and delays as many requirements as are not yet done when it begins. So the least sum of
completion times is an assignment of requirements to places in queues, the l-th from the end at cost
l p_rg. A victim is complete no sooner than the mean of its requirements, so each of n requirements has
the n-th part of its priority as weight; requirements of different weights are taken apart in layers.

Times are rounded down to whole multiples of a unit of which, mostly, they are multiples.

Source: Horn, *Minimizing average flow time with parallel machines* (1973).
"""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

import numpy as np
from scipy.optimize import linear_sum_assignment

from .joint_problem import Joint

_FINEST = 10_000
"""Of the parts of a time unit that times are counted in."""

Need = tuple[int, str]


def in_queues(joint: Joint) -> Fraction:
    """No plan has a latency below this."""
    took = _least_times(joint)
    parts = min(math.lcm(1, *(time.denominator for time in took.values())), _FINEST)
    many = Counter(v for v, _ in joint.service)
    weight = {need: joint.priority[need[0]] / many[need[0]] for need in joint.service}
    bound, below = Fraction(0), Fraction(0)
    for level in sorted({w for w in weight.values() if w > 0}):
        layer = [need for need in sorted(weight) if weight[need] >= level]
        bound += (level - below) * Fraction(_least_sum(joint, layer, took, parts), parts)
        below = level
    return bound


def _least_times(joint: Joint) -> dict[tuple[int, Need], Fraction]:
    """What each requirement takes each robot able of it at least."""
    took: dict[tuple[int, Need], Fraction] = {}
    for (r, v), kinds in joint.kinds_of.items():
        ways = [joint.travel(r, v, w) for w in joint.victims_of[r] if w != v]
        share = min([joint.leave[r, v], *ways]) / len(kinds)
        took |= {(r, (v, k)): share + joint.service[v, k] for k in kinds}
    return took


def _least_sum(
    joint: Joint, needs: list[Need], took: dict[tuple[int, Need], Fraction], parts: int
) -> int:
    """Least sum of the requirements' completion times, in parts of a time unit."""
    n = len(needs)
    # What cannot be is dearer than all that can: some assignment there is.
    never = 1 + n * n * max(math.floor(time * parts) for time in took.values())
    cost = np.full((len(joint.robots), n), never, dtype=np.int64)
    for i, r in enumerate(joint.robots):
        for j, need in enumerate(needs):
            if (r, need) in took:
                cost[i, j] = math.floor(took[r, need] * parts)
    place = np.arange(1, n + 1)
    places = (np.minimum(cost, never)[:, None, :] * place[:, None]).reshape(-1, n)
    row, column = linear_sum_assignment(places)
    return int(places[row, column].sum())
