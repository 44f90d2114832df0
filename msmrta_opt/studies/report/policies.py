"""Policies compared: under each scenario what their runs come to, and pairs on the same seeds.

A run that serves more wins; of runs that serve the same, the one that is better by the report's metric
of quality. What a run is above the best that its world allowed, if that was looked for, is its regret.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from ...mission.metrics import METRICS
from ...mission.run_metrics import RUN_METRICS
from ...plots.lettering import name_ticks, shortened, told_apart
from ...plots.style import INK
from ...routing.objectives import DEFAULT
from .blocks import Block, Picture, Section, Table, Words
from .pairs import CONFIDENCE, SAME, Comparison, pairs_table
from .runs import INSTANCE, contenders
from .style import own_axes
from .text import file_names
from .text import number as shown
from .winner import percent

if TYPE_CHECKING:
    from ..record import Record

QUANTILES = (0.05, 0.5, 0.95)


@dataclass(frozen=True)
class Interval:
    """A value with the ends of its 95 % confidence interval; NaN where they cannot be known."""

    value: float
    low: float = float("nan")
    high: float = float("nan")


def mean_of(values: NDArray[np.float64]) -> Interval:
    """The mean, by Student's t; `values` of shape ``(n,)``, independent of each other."""
    n, mean = len(values), float(values.mean()) if len(values) else float("nan")
    if n < 2:
        return Interval(mean)
    half = stats.t.ppf((1 + CONFIDENCE) / 2, n - 1) * values.std(ddof=1) / np.sqrt(n)
    return Interval(mean, mean - half, mean + half)


def quantile_of(values: NDArray[np.float64], share: float) -> Interval:
    """A quantile and the order statistics that hold it between them in 95 % of samples.

    Whatever the distribution is: how many of n values lie below its quantile is binomial (Conover,
    Practical Nonparametric Statistics, section 3.2). NaN where n is too small for that.
    """
    ordered, n = np.sort(values), len(values)
    value = float(np.quantile(ordered, share, method="inverted_cdf"))
    tail = (1 - CONFIDENCE) / 2
    low = int(stats.binom.ppf(tail, n, share))  # values below it, at least, but for one tail
    high = int(stats.binom.ppf(1 - tail, n, share)) + 1
    is_low = low >= 1 and stats.binom.cdf(low - 1, n, share) <= tail
    is_high = high <= n and stats.binom.sf(high - 1, n, share) <= tail
    return Interval(
        value,
        float(ordered[low - 1]) if is_low else float("nan"),
        float(ordered[high - 1]) if is_high else float("nan"),
    )


def seeds_of(records: Iterable[Record]) -> pd.DataFrame:
    """A row for each seed of each record of executions, with its metrics; in the records' order.

    What is known of the best that a world allowed counts for all runs of the same problem: those that
    serve the same in the same world. So equal runs have equal regrets.
    """
    rows = []
    for record in records:
        if record.method != "execution" or record.failed:
            continue
        values = record.executions
        for number, seed in enumerate(values["seeds"]):
            metrics = {name: float(x[number]) for name, x in values.items() if name != "seeds"}
            rows.append(
                {
                    **{name: getattr(record, name) for name in (*INSTANCE, "contender")},
                    **{name: getattr(record, name) for name in ("scenario", "policy")},
                    "planner_seed": record.seed,
                    "objective": json.loads(record.options_json).get(
                        "hindsight.objective", DEFAULT
                    ),
                    "seed": int(seed),
                    **metrics,
                }
            )
    return _pooled(pd.DataFrame(rows))


def _pooled(runs: pd.DataFrame) -> pd.DataFrame:
    if "hindsight_problem" not in runs:
        return runs
    same = runs.groupby([*INSTANCE, "objective", "hindsight_problem"])
    best = same["hindsight_best"].transform("min").fillna(runs["hindsight_best"])
    bound = same["hindsight_bound"].transform("max").fillna(runs["hindsight_bound"])
    return runs.assign(hindsight_best=best, hindsight_bound=np.minimum(bound, best))


def policy_section(records: Iterable[Record], quality: str) -> Section:
    """What policies come to under each scenario; nothing where nothing was executed."""
    found = seeds_of(records)
    if found.empty:
        return Section("Policies", [])
    groups = list(found.groupby("scenario", sort=False))
    names = file_names([str(scenario) for scenario, _ in groups])
    said = [policy_sentence(str(scenario), _compared(mine, quality)) for scenario, mine in groups]
    blocks: list[Block] = [
        *([Words(" ".join(filter(None, said)))] if any(said) else []),
        Words(
            "Each plan is executed by each policy in the same worlds, one for each seed. A run that"
            f" serves more wins; of runs that serve the same, the one with the better"
            f" {METRICS[quality].label}."
        ),
        served_picture(found),
        Table(
            "policies", "What runs come to",
            pd.DataFrame(
                [row for scenario, mine in groups for row in _come_to(str(scenario), mine, quality)]
            ),
            f"From and to are the ends of {CONFIDENCE:.0%} confidence intervals, over runs: of a mean"
            " by Student's t, of a quantile between order statistics, where there are runs enough."
            " Time is that of deciding, all of a run's decisions together.",
            {"served (%)": "more"}, within="scenario",
        ),
    ]  # fmt: skip
    for scenario, mine in groups:
        blocks += [
            block
            for block in (
                _regret(str(scenario), mine, names[str(scenario)]),
                _pairs(str(scenario), mine, quality, names[str(scenario)]),
            )
            if block is not None
        ]
    return Section("Policies", blocks)


def _come_to(scenario: str, runs: pd.DataFrame, quality: str) -> Iterator[dict[str, object]]:
    """A row for each contender."""
    entry = RUN_METRICS[quality]
    for contender in contenders(runs):
        mine = runs[runs["contender"] == contender]
        served = mean_of(100 * mine["served_share"].to_numpy(float))
        row: dict[str, object] = {
            "scenario": scenario,
            "contender": contender,
            "instances": mine["instance"].nunique(),
            "runs": len(mine),
            "served (%)": served.value,
            "from": served.low,
            "to": served.high,
        }
        for share in QUANTILES:
            found = quantile_of(mine[quality].to_numpy(float), share)
            words = "median" if share == 0.5 else f"{100 * share:.0f} %"
            row |= {
                f"{entry.label}: {words}": found.value,
                f"{words} from": found.low,
                f"{words} to": found.high,
            }
        yield row | {
            "replans": mine["replans"].mean(),
            "changed visits": mine["changed_visits"].mean(),
            "median time (s)": mine["deciding_seconds"].median(),
        }


def _compared(runs: pd.DataFrame, quality: str) -> Comparison:
    """The contenders on every seed of every instance, as `Comparison` takes instances."""
    rows = runs.assign(
        instance=runs["instance"] + "\0" + runs["seed"].astype(str),
        seconds=runs["deciding_seconds"],
        counts=True,
    )
    return Comparison(rows, quality)


def policy_sentence(scenario: str, found: Comparison) -> str:
    """Who wins under a scenario, by how much, and what deciding took; nothing of one contender.

    Whoever wins does so against each of the others; else one is named against whom it may be chance.
    """
    if len(found.contenders) < 2 or not len(found.common):
        return ""
    (best, *others), alike = found.order, found.equals
    leads = [_Lead.of(found, best, who) for who in others if who not in alike]
    if not leads:
        return f"Under {scenario}, all come to the same, in each of {len(found.common)} runs."
    chance = [lead for lead in leads if not lead.is_known]
    if chance:
        lead = chance[0]
        said = (
            f"nobody wins: {best} and {lead.other} differ by what may be chance; the first serves"
            f" {lead.more} of the second ({lead.counted})"
        )
    else:
        lead = leads[0]
        said = f"{best} wins: it serves {lead.more} of {lead.other}, the next ({lead.counted})"
    equal = [who for who in alike if who != best]
    said += f". As good and slower: {', '.join(equal)}" if equal else ""
    seconds = found.mean_seconds(best)
    took = "" if np.isnan(seconds) else f" Its decisions take {shown(seconds)} s a run."
    return f"Under {scenario}, {said}.{took}"


@dataclass(frozen=True)
class _Lead:
    """How the best differs from another; it is known where the interval leaves out no difference."""

    other: str
    is_known: bool
    more: str
    counted: str

    @classmethod
    def of(cls, found: Comparison, best: str, other: str) -> _Lead:
        """By what is served; where that is as much, by quality where both serve the same."""
        n, pair = len(found.common), found.pair(best, other, common=True)
        counted = f"better in {pair.wins}, equal in {pair.ties}, worse in {pair.losses} of {n} runs"
        gaps = (found.served[best] - found.served[other])[found.common]
        gap = mean_of(100 * gaps.to_numpy(float))
        if gap.value > 100 * SAME:
            share, less = (100 * found.mean_served(who) for who in (best, other))
            told = f"{gap.value:.3g} points more"
            if n > 1:
                told += f", {CONFIDENCE:.0%} confidence: {gap.low:.3g} to {gap.high:.3g}"
            more = f"{share:.4g} % of what can be served against {less:.4g} %"
            return cls(other, gap.low > 0, more, f"{told}; {counted}")
        if not pair.quality.n:
            return cls(other, False, "as much as that", f"never the same in one run; {counted}")
        more = f"as much, at a {found.metric.label} {percent(pair.quality, n, 'runs')} than that"
        return cls(other, pair.quality.is_known, more, counted)


def _pairs(scenario: str, runs: pd.DataFrame, quality: str, name: str) -> Table | None:
    who = contenders(runs)
    if len(who) < 2:
        return None
    found = _compared(runs, quality)
    what = METRICS[quality].label
    data = pairs_table(found.named_pairs(), what, "deciding time")
    return Table(
        f"policies-pairs-{name}", f"In pairs, under {scenario}", data,
        "Run by run, on the same seed of the same instance. Ratios are geometric means of contender /"
        f" against, from and to the ends of their {CONFIDENCE:.0%} confidence interval, that of {what}"
        " over runs that serve the same: an interval without 1 is hardly chance.",
    )  # fmt: skip


def _regret(scenario: str, runs: pd.DataFrame, name: str) -> Table | None:
    """How far runs stay above the best that their worlds allowed, by what that is judged."""
    if "hindsight_best" not in runs or runs["hindsight_best"].isna().all():
        return None
    rows = []
    objective = str(runs["objective"].iloc[0])
    for who in contenders(runs):
        mine = runs[(runs["contender"] == who) & (runs["hindsight_best"] > 0)]
        minimum = 100 * (mine[objective] / mine["hindsight_best"] - 1).to_numpy(float)
        bounded = mine[mine["hindsight_bound"] > 0]
        maximum = 100 * (bounded[objective] / bounded["hindsight_bound"] - 1).to_numpy(float)
        proved = mine["hindsight_best"] - mine["hindsight_bound"] <= SAME * mine["hindsight_best"]
        low = mean_of(np.maximum(minimum, 0))
        rows.append(
            {
                "contender": who,
                "runs": len(mine),
                "regret, at least (%)": low.value,
                "from": low.low,
                "to": low.high,
                "highest (%)": minimum.max() if len(minimum) else float("nan"),
                "regret, at most (%)": maximum.mean() if len(maximum) else float("nan"),
                "proved (%)": 100 * proved.mean(),
            }
        )
    return Table(
        f"policies-regret-{name}", f"Regret against hindsight, under {scenario}", pd.DataFrame(rows),
        f"By {RUN_METRICS[objective].label}: what runs are above the best that their worlds allowed, of"
        " what they served, had all been known from the beginning; above the best found, and the bound"
        " that is proved. Means over runs, in per cent; proved are the runs whose best is proved to be"
        " optimal.",
    )  # fmt: skip


def served_picture(runs: pd.DataFrame) -> Picture:
    """What share of the available requirements runs serve, scenario by scenario, by contender."""
    rows = []
    order = {scenario: i for i, scenario in enumerate(runs["scenario"].unique())}
    groups = list(runs.groupby(["scenario", "contender"], sort=False))
    for (scenario, contender), mine in sorted(groups, key=lambda group: order[group[0][0]]):
        values = 100 * mine["served_share"].to_numpy(float)
        mean = mean_of(values)
        rows.append(
            {
                "scenario": scenario,
                "contender": contender,
                "mean": mean.value,
                "from": mean.low,
                "to": mean.high,
                "5 %": np.quantile(values, 0.05, method="inverted_cdf"),
                "95 %": np.quantile(values, 0.95, method="inverted_cdf"),
            }
        )
    data = pd.DataFrame(rows)
    # Above the contenders under a scenario there is a line with its name.
    headings = np.flatnonzero(~data["scenario"].duplicated())
    places = np.arange(len(data)) + data["scenario"].map(order).to_numpy(int) + 1
    n_lines = len(data) + len(headings)
    figure, ax = own_axes(6.4, 1.2 + 0.42 * n_lines)
    ax.hlines(places, data["5 %"], data["95 %"], color=INK, lw=1)
    ax.hlines(places, data["from"], data["to"], color=INK, lw=4)
    ax.plot(data["mean"], places, "o", color=INK, ms=6)
    said = told_apart(data["contender"])
    name_ticks(ax.yaxis, places, [said[name] for name in data["contender"]], color=INK)
    for place, scenario in zip(places[headings] - 1, data["scenario"].iloc[headings], strict=True):
        ax.text(
            -0.02, place, f"under {shortened(scenario)}", transform=ax.get_yaxis_transform(),
            ha="right", va="center", color=INK, weight="bold",
        )  # fmt: skip
    ax.set_ylim(n_lines - 0.5, -0.5)
    names = [f"{s}: {c}" for s, c in zip(data["scenario"], data["contender"], strict=True)]
    ax.margins(x=0.04)
    ax.set_xlabel("available requirements served (%)")
    told = ", ".join(f"{name} {mean:.3g} %" for name, mean in zip(names, data["mean"], strict=True))
    return Picture(
        "policies-served", "What is served",
        "Dots are means, thick lines their confidence intervals; between the ends of a thin line lie"
        " nine of ten runs.",
        f"Shares of the available requirements that are served: {told}.",
        figure, data,
    )  # fmt: skip
