"""Contenders in pairs, instance by instance: wins, ties, losses, and ratios with confidence intervals.

A plan that serves more wins. Among plans that serve the same, the better by one metric of quality wins;
only over these the ratio is taken: its geometric mean, with the 95 % confidence interval of Student's t
on the logarithms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from ...mission.metrics import METRICS
from .runs import contenders, per_instance

SAME = 1e-9
"""Relative difference up to which two values are equal."""
CONFIDENCE = 0.95
ALL_PAIRS = 4
"""Up to so many contenders all pairs are compared; of more the best with each other."""


@dataclass(frozen=True)
class Ratio:
    """A geometric mean of ratios, and its confidence interval; NaN where it cannot be known."""

    mean: float
    low: float = float("nan")
    high: float = float("nan")
    n: int = 0

    @classmethod
    def of(cls, ratios: NDArray[np.float64]) -> Ratio:
        """Of positive ratios, shape ``(n_instances,)``; NaN of none."""
        logs = np.log(ratios)
        n = len(logs)
        if not n:
            return cls(float("nan"))
        mean = float(logs.mean())
        if n < 2:
            return cls(float(np.exp(mean)), n=n)
        half = stats.t.ppf((1 + CONFIDENCE) / 2, n - 1) * logs.std(ddof=1) / np.sqrt(n)
        middle, low, high = (float(np.exp(x)) for x in (mean, mean - half, mean + half))
        return cls(middle, low, high, n)

    @property
    def is_known(self) -> bool:
        """Whether the interval leaves 1 out, so that the difference is hardly chance."""
        return bool(self.low > 1 or self.high < 1)


@dataclass(frozen=True)
class Pair:
    """One contender against another, over the instances that both finished."""

    one: str
    other: str
    wins: int
    ties: int
    losses: int
    quality: Ratio
    """The one's value / the other's, where both serve the same."""
    time: Ratio

    @property
    def instances(self) -> int:
        """How many both finished."""
        return self.wins + self.ties + self.losses


class Comparison:
    """Planners' runs, instance by instance, by one metric of quality.

    Parameters
    ----------
    runs : DataFrame
        Of planners, as of `table_of`.
    metric : str
        One of `METRICS` that says which way is better.
    """

    def __init__(self, runs: pd.DataFrame, metric: str) -> None:
        self.metric = METRICS[metric]
        self.served = per_instance(runs, "served_share")
        self.worth = per_instance(runs, metric)
        self.seconds = per_instance(runs, "seconds")
        finished = self.worth.notna().any()
        self.contenders = [name for name in contenders(runs) if finished[name]]
        self.common = self.worth[self.contenders].dropna().index
        """The instances that all finished who finished any."""

    def pair(self, one: str, other: str, *, common: bool = False) -> Pair:
        """`one` against `other`, over what both finished, or only over the common instances."""
        mine, theirs = self.worth[one], self.worth[other]
        both = mine.notna() & theirs.notna()
        if common:
            both &= both.index.isin(self.common)
        mine, theirs = mine[both].to_numpy(float), theirs[both].to_numpy(float)
        # Where it is not known what is served, it is taken to be the same.
        fuller = np.nan_to_num((self.served[one] - self.served[other])[both].to_numpy(float))
        alike = np.abs(fuller) <= SAME
        gain = theirs - mine if self.metric.better == "less" else mine - theirs
        equal = np.abs(gain) <= SAME * np.maximum(np.abs(mine), np.abs(theirs))
        better = np.where(alike, np.where(equal, 0.0, gain), fuller)
        seconds = (self.seconds[one] / self.seconds[other])[both].to_numpy(float)
        return Pair(
            one,
            other,
            wins=int((better > 0).sum()),
            ties=int((better == 0).sum()),
            losses=int((better < 0).sum()),
            quality=_ratio(mine[alike], theirs[alike]),
            time=Ratio.of(seconds[np.isfinite(seconds) & (seconds > 0)]),
        )

    def to_best(self, who: str) -> Ratio:
        """The values of `who`, each as a multiple of the best on its instance, over the common ones."""
        worth = self.worth.loc[self.common, self.fullest]
        best = worth.min(axis=1) if self.metric.better == "less" else worth.max(axis=1)
        return _ratio(self.worth.loc[self.common, who].to_numpy(float), best.to_numpy(float))

    def mean_served(self, who: str) -> float:
        """Mean share of the available requirements that are served, over the common instances."""
        return float(self.served.loc[self.common, who].mean())

    def mean_seconds(self, who: str) -> float:
        """Geometric mean of the planning times, over the common instances."""
        times = self.seconds.loc[self.common, who].to_numpy(float)
        times = times[times > 0]
        return float(np.exp(np.log(times).mean())) if len(times) else float("nan")

    @property
    def fullest(self) -> list[str]:
        """Those that serve the maximum, who alone are ranked."""
        served = {who: np.nan_to_num(self.mean_served(who), nan=1.0) for who in self.contenders}
        maximum = max(served.values(), default=1.0)
        return [who for who, share in served.items() if share >= maximum - SAME]

    @property
    def ranked(self) -> list[str]:
        """`fullest`, the best by the metric first; equals in the study's order."""
        less = self.metric.better == "less"
        mean = {who: self.to_best(who).mean for who in self.fullest}
        return sorted(mean, key=lambda who: mean[who] if less else -mean[who])

    @property
    def equals(self) -> list[str]:
        """The best of `ranked`, and those that are as good on each of the common instances.

        That is the first, unless the next is better where both serve the same.
        """
        found = self._as_good_as(self.ranked[0])
        rest = [who for who in self.ranked if who not in found]
        if rest:
            ratio = self.pair(found[0], rest[0], common=True).quality.mean
            if ratio > 1 if self.metric.better == "less" else ratio < 1:
                return self._as_good_as(rest[0])
        return found

    def _as_good_as(self, one: str) -> list[str]:
        pairs = [self.pair(one, who, common=True) for who in self.ranked if who != one]
        return [one, *(pair.other for pair in pairs if not pair.wins and not pair.losses)]

    @property
    def order(self) -> list[str]:
        """All, the best first: the fastest of `equals`, the others of `ranked`, those who serve less."""
        equals = self.equals
        best = min(equals, key=lambda who: (self.mean_seconds(who), equals.index(who)))
        ranked = [who for who in self.ranked if who != best]
        less = [who for who in self.contenders if who != best and who not in ranked]
        return [best, *ranked, *sorted(less, key=lambda who: -self.mean_served(who))]

    def named_pairs(self) -> list[Pair]:
        """The pairs to be shown: all of few contenders, else the best against each other."""
        best, *others = self.order
        if len(self.contenders) <= ALL_PAIRS:
            return [self.pair(*pair) for pair in combinations([best, *others], 2)]
        return [self.pair(best, other) for other in others]


def pairs_table(pairs: Sequence[Pair], quality: str, time: str) -> pd.DataFrame:
    """A row a pair; `quality` and `time` are what the ratios are called."""
    rows = [
        {
            "contender": pair.one,
            "against": pair.other,
            "wins": pair.wins,
            "ties": pair.ties,
            "losses": pair.losses,
            f"{quality} ratio": pair.quality.mean,
            "from": pair.quality.low,
            "to": pair.quality.high,
            f"{time} ratio": pair.time.mean,
            "time from": pair.time.low,
            "time to": pair.time.high,
        }
        for pair in pairs
    ]
    return pd.DataFrame(rows).dropna(axis="columns", how="all")


def _ratio(mine: NDArray[np.float64], theirs: NDArray[np.float64]) -> Ratio:
    known = (mine > 0) & (theirs > 0)
    return Ratio.of(mine[known] / theirs[known])
