"""What many runs say: quantiles, probabilities and paired differences, with confidence intervals.

All intervals are of 95 %. Those of quantiles are order statistics whose ranks are binomial, and hold for
any distribution. Those of probabilities are Wilson's; those of mean differences Student's.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .many_runs import Outcome

LEVEL = 0.95
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)


@dataclass(frozen=True)
class Quantile:
    """A quantile of a sample, and the ends of its interval: ``None`` where the sample has none."""

    share: float
    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Probability:
    """A share of runs, and the ends of its interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Difference:
    """A metric of one policy less that of another, over the same seeds.

    ``less``, ``equal`` and ``more`` count the seeds on which it is so.
    """

    mean: float
    low: float | None
    high: float | None
    less: int
    equal: int
    more: int


def quantile(values: Sequence[float], share: float) -> Quantile:
    """The smallest value up to which at least a share of `values` lies."""
    ordered, n = sorted(values), len(values)
    value = ordered[max(math.ceil(share * n) - 1, 0)]
    below = _binomial(n, share)
    tail = (1 - LEVEL) / 2
    # The value of rank j is above the quantile with probability P(B < j), B binomial.
    low = max((j for j in range(1, n + 1) if below[j - 1] <= tail), default=None)
    high = min((j for j in range(1, n + 1) if below[j - 1] >= 1 - tail), default=None)
    return Quantile(
        share,
        value,
        None if low is None else ordered[low - 1],
        None if high is None else ordered[high - 1],
    )


def _binomial(n: int, p: float) -> list[float]:
    """P(B ≤ j) for j = 0, …, n − 1, of n draws of probability p."""
    logs = [
        math.lgamma(n + 1) - math.lgamma(j + 1) - math.lgamma(n - j + 1)
        + j * math.log(p) + (n - j) * math.log1p(-p)
        for j in range(n)
    ]  # fmt: skip
    total, sums = 0.0, []
    for log in logs:
        total += math.exp(log)
        sums.append(total)
    return sums


def probability(successes: int, n: int) -> Probability:
    """The share of successes among n runs, with Wilson's interval."""
    z = 1.959963984540054
    share = successes / n
    centre = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    # Of none and of all one end is the share itself, which rounding must not move.
    low = centre - half if successes else 0.0
    high = centre + half if successes < n else 1.0
    return Probability(share, low, high)


def difference(ours: Sequence[float], theirs: Sequence[float]) -> Difference:
    """What differs on the same seeds, `theirs` less `ours`."""
    gaps = [b - a for a, b in zip(ours, theirs, strict=True)]
    n, mean = len(gaps), sum(gaps) / len(gaps)
    low = high = None
    if n > 1:
        from scipy.stats import t

        spread = math.sqrt(sum((gap - mean) ** 2 for gap in gaps) / (n - 1))
        half = float(t.ppf(1 - (1 - LEVEL) / 2, n - 1)) * spread / math.sqrt(n)
        low, high = mean - half, mean + half
    counts = (sum(gap < 0 for gap in gaps), gaps.count(0.0), sum(gap > 0 for gap in gaps))
    return Difference(mean, low, high, *counts)


def of_policy(outcomes: Iterable[Outcome], policy: str) -> list[Outcome]:
    """The outcomes of a policy, by their seeds."""
    return sorted((x for x in outcomes if x.policy == policy), key=lambda outcome: outcome.seed)


def served_by(outcomes: Sequence[Outcome], victim: int, time: float) -> Probability:
    """The probability that a victim has, by a time, all that any robot has for it."""
    successes = sum(outcome.served.get(victim, math.inf) <= time for outcome in outcomes)
    return probability(successes, len(outcomes))


def paired(outcomes: Sequence[Outcome], policy: str, other: str, metric: str) -> Difference:
    """By how much a metric of `other` is above that of `policy`, on the seeds that both have."""
    mine: Mapping[int, float] = {x.seed: x.figures[metric] for x in of_policy(outcomes, policy)}
    theirs = {x.seed: x.figures[metric] for x in of_policy(outcomes, other)}
    seeds = [seed for seed in mine if seed in theirs]
    return difference([mine[seed] for seed in seeds], [theirs[seed] for seed in seeds])
