"""Who won, and at what price: a sentence, quality against time in a picture, and pairs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from ...plots.lettering import shortened, told_apart
from ...plots.style import FAINT, INK
from .blocks import Block, Picture, Section, Table, Words
from .pairs import CONFIDENCE, Comparison, Ratio, pairs_table
from .runs import METHODS, of_method
from .style import add_legend, own_axes
from .text import number

TITLE = "Who won"


def who_won(runs: pd.DataFrame, metric: str, looks: Mapping[str, Mapping[str, Any]]) -> Section:
    """The section: of planners by a metric of quality, of solvers by what they solved."""
    blocks: list[Block] = []
    planned = of_method(runs, "planner")
    if len(planned):
        found = Comparison(planned, metric)
        if len(found.contenders) > 1 and len(found.common):
            blocks = [Words(planner_sentence(found)), quality_time(found, looks), pairs(found)]
    if sentence := solver_sentence(of_method(runs, "formulation")):
        blocks.append(Words(sentence))
    return Section(TITLE, blocks)


def planner_sentence(found: Comparison) -> str:
    """Who makes the best plans, by how much, and what that costs in planning time."""
    n, every, what = len(found.common), len(found.worth), found.metric.label
    where = f"On the {n} of {every} instances that all finished" if n < every else (
        f"On all {n} instances" if n > 1 else "On the one instance"
    )  # fmt: skip
    ranked, alike, best = found.ranked, found.equals, found.order[0]
    others = [who for who in ranked if who not in alike]
    if others:
        said = _against(found, best, others[0], where)
    elif len(alike) > 1:
        said = (
            f"{where}, all plans are equally good by {what}, and {best} is the fastest to make them"
        )
    else:
        said = f"{where}, {best} wins: it alone serves the maximum"
    equal = [who for who in alike if who != best]
    if equal and others:
        said += f". As good and slower: {', '.join(equal)}"
    if left := [who for who in found.contenders if who not in ranked]:
        maximum = 100 * found.mean_served(best)
        less = ", ".join(f"{who} {100 * found.mean_served(who):.4g} %" for who in left)
        said += f". Out, for serving less than {maximum:.4g} % of what can be served: {less}"
    return f"{said}.{_price(found, best)}"


def _against(found: Comparison, best: str, second: str, where: str) -> str:
    """How the best differs from the next, or that it may be chance, as the interval has it."""
    what, pair = found.metric.label, found.pair(best, second, common=True)
    counted = f"better on {pair.wins}, equal on {pair.ties}, worse on {pair.losses}"
    if not pair.quality.n:
        return f"{where}, nobody wins: {best} and {second} never serve the same ({counted})"
    said = percent(pair.quality, pair.instances, "instances")
    if pair.quality.is_known or pair.instances == 1:
        return (
            f"{where}, {best} makes the best plans: its {what} is {said} than that"
            f" of {second}, the next ({counted})"
        )
    return (
        f"{where}, nobody wins by {what}: {best} and {second} differ by what may be chance, the"
        f" first's being {said}, {counted}"
    )


def percent(ratio: Ratio, n: int, things: str) -> str:
    """By how much a ratio differs from 1, with its confidence interval where there is one.

    It is told over how many of the `n` things it is, where it is not over all.
    """
    change, low, high = (100 * (x - 1) for x in (ratio.mean, ratio.low, ratio.high))
    sense = -1 if change < 0 else 1
    said = f"{abs(change):.3g} % {'lower' if sense < 0 else 'higher'}"
    over = "" if ratio.n == n else f" over the {ratio.n} of {n} {things} that serve the same"
    if ratio.n < 2:
        return said + over
    ends = sorted(sense * end for end in (low, high))
    return f"{said} ({CONFIDENCE:.0%} confidence{over}: {ends[0]:.3g} to {ends[1]:.3g} %)"


def _price(found: Comparison, winner: str) -> str:
    """What the winner's plans cost in planning time."""
    times = {who: found.mean_seconds(who) for who in found.contenders}
    times = {who: time for who, time in times.items() if time == time}
    if winner not in times or len(times) < 2:
        return ""
    quick, second = sorted(times, key=lambda who: times[who])[:2]
    if quick == winner:
        return (
            f" It is also the fastest: {second} takes {_times(times[second] / times[winner])} its"
            f" planning time of {number(times[winner])} s."
        )
    return (
        f" The price of {winner}: {_times(times[winner] / times[quick])} the planning time of"
        f" {quick}, the fastest ({number(times[winner])} s against {number(times[quick])} s)."
    )


def _times(factor: float) -> str:
    return f"{factor:.3g} times"


def quality_time(found: Comparison, looks: Mapping[str, Mapping[str, Any]]) -> Picture:
    """A mark for each contender: its planning time, and its plans beside the best of each instance."""
    what, less = found.metric.label, found.metric.better == "less"
    rows: list[dict[str, Any]] = []
    for who in found.contenders:
        ratio = found.to_best(who)
        rows.append(
            {
                "contender": who,
                "planning time (s)": found.mean_seconds(who),
                f"{what}, of the best": ratio.mean,
                "from": ratio.low,
                "to": ratio.high,
                "served (%)": 100 * found.mean_served(who),
            }
        )
    data = pd.DataFrame(rows)
    figure, ax = own_axes(5.2, 3.6 + 0.2 * len(rows))
    said = told_apart(found.contenders)
    for row in rows:
        who, x, y = row["contender"], row["planning time (s)"], row[f"{what}, of the best"]
        look = {key: value for key, value in looks[who].items() if key != "linestyle"}
        ends = np.array([[y - row["from"]], [row["to"] - y]])
        known = np.isfinite(ends).all()
        served = "" if who in found.fullest else f", serves {row['served (%)']:.4g} %"
        ax.errorbar(
            [x], [y], yerr=ends if known else None, **look, linestyle="none", markersize=9,
            markeredgecolor="white", capsize=3, label=f"{said[who]}{served}", zorder=3,
        )  # fmt: skip
    front = _front(rows, what, less=less)
    ax.step(
        [x for x, _ in front], [y for _, y in front], where="post", color=FAINT, linewidth=1,
        linestyle="--", zorder=2, label="nobody is faster and better",
    )  # fmt: skip
    ax.set_xscale("log")
    _plain_times(ax, data["planning time (s)"])
    ax.set_xlabel("planning time (s)")
    ax.set_ylabel(f"{shortened(what)}, as a multiple of the best")
    ax.margins(x=0.12, y=0.15)
    ax.set_title(f"{'Lower' if less else 'Higher'} left is better", fontsize=10, color=INK)
    add_legend(figure, ax)
    return Picture(
        "quality-against-time",
        "Quality against time",
        f"Over the {len(found.common)} instances that all finished. Across: geometric mean of the"
        f" planning time. Up: {what} as a multiple of the best on the same instance, geometric mean"
        f" with its {CONFIDENCE:.0%} confidence interval.",
        f"Quality against planning time; {what} as a multiple of the best: "
        + "; ".join(
            f"{row['contender']} {number(row[f'{what}, of the best'])} in"
            f" {number(row['planning time (s)'])} s"
            for row in rows
        ),
        figure,
        data,
    )


def _plain_times(ax: Any, seconds: pd.Series) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    known = seconds[seconds > 0]
    wide = len(known) and known.max() / known.min() > 300
    ax.xaxis.set_major_locator(LogLocator(subs=(1,) if wide else (1, 2, 5)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def _front(rows: list[dict[str, Any]], what: str, *, less: bool) -> list[tuple[float, float]]:
    """Those that nobody beats both ways, from the fastest on."""
    found: list[tuple[float, float]] = []
    points = sorted((row["planning time (s)"], row[f"{what}, of the best"]) for row in rows)
    for x, y in points:
        if not found or (y < found[-1][1] if less else y > found[-1][1]):
            found.append((x, y))
    return found


def pairs(found: Comparison) -> Table:
    """The table of pairs: all of few contenders, else the best against each other."""
    what = found.metric.label
    return Table(
        "pairs", "In pairs",
        pairs_table(found.named_pairs(), what, METHODS["planner"]),
        "Over the instances that both finished. A plan that serves more wins; of plans that serve the"
        f" same, the one with the {'lower' if found.metric.better == 'less' else 'higher'} {what}."
        f" Ratios are geometric means of contender / against, from and to the ends of their"
        f" {CONFIDENCE:.0%} confidence interval, that of {what} over plans that serve the same: an"
        " interval without 1 is hardly chance.",
    )  # fmt: skip


def solver_sentence(runs: pd.DataFrame) -> str:
    """Which solver proves the most programs optimal, and how fast the others are beside it."""
    if runs.empty or runs["solver"].nunique() < 2:
        return ""
    program = ["instance", "model", "options_json"]
    known = runs.assign(solved=runs["seconds"].where(runs["counts"]))
    each = known.groupby([*program, "solver"], sort=False)["solved"].mean()
    times = each.unstack("solver")  # noqa: PD010 - one value each, as grouped
    solved = times.notna().sum()
    if not solved.max():
        return ""
    common = times[times > 0].dropna()
    mean = np.exp(np.log(common).mean())
    order = sorted(solved.index, key=lambda who: (-solved[who], mean[who]))
    first = order[0]
    counts = ", ".join(f"{who} {solved[who]}" for who in order[1:])
    said = f"Of {len(times)} programs, {first} proves {solved[first]} optimal ({counts})"
    if common.empty:
        return f"{said}."
    n = len(common)
    ratios = ", ".join(f"{who} takes {_times(mean[who] / mean[first])}" for who in order[1:])
    return f"{said}. Over the {n} that all solve, {ratios} its solving time."
