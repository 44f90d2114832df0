"""Policies compared in a report: means, quantiles, pairs and regret, from values chosen by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from math import exp, log, sqrt

import numpy as np
import pytest
from scipy import stats

from msmrta_opt.mission.run_metrics import RUN_METRICS
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.report.blocks import Table, Words
from msmrta_opt.studies.report.policies import (
    mean_of,
    policy_section,
    quantile_of,
    seeds_of,
    served_picture,
)

SERVED = {"keep": [0.5, 1.0, 1.0, 0.5], "repair": [1.0] * 4}
TIME = {"keep": [10.0, 40.0, 40.0, 10.0], "repair": [30.0, 20.0, 20.0, 30.0]}
BEST = {"hindsight_best": [10.0] * 4, "hindsight_bound": [10.0, 10.0, 10.0, 8.0]}


def record(policy: str, scenario: str = "rough", **more: object) -> Record:
    values = {name: [0.0] * 4 for name in (*RUN_METRICS, "deciding_seconds")}
    values |= {"served_share": SERVED[policy], "total_time": TIME[policy]}
    values |= {"seeds": [0, 1, 2, 3]} | (BEST if scenario == "rough" else {})
    return Record(
        instance="one", map="m", n_robots=2, n_victims=3, contender=policy, method="execution",
        planner="ssi", policy=policy, scenario=scenario, executions_json=json.dumps(values),
        **more,  # type: ignore[arg-type]
    )  # fmt: skip


@pytest.fixture(scope="module")
def tables() -> dict[str, Table]:
    blocks = policy_section([record(name) for name in TIME], "total_time").blocks
    return {block.name: block for block in blocks if isinstance(block, Table)}


def test_a_row_says_what_each_policy_comes_to(tables: dict[str, Table]) -> None:
    rows = tables["policies"].data.set_index("contender")
    assert rows["served (%)"].to_dict() == {"keep": 75, "repair": 100}
    assert rows.loc["keep", "total time: median"] == 10  # half of the runs are done by then
    assert rows["runs"].tolist() == [4, 4]


def test_pairs_are_on_the_same_seeds(tables: dict[str, Table]) -> None:
    pairs = tables["policies-pairs-rough"].data.set_index(["contender", "against"])
    best = pairs.loc[("repair", "keep")]
    # On seeds 0 and 3 keep serves less; on 1 and 2 both serve all, and repair takes half the time.
    assert (best["wins"], best["ties"], best["losses"]) == (4, 0, 0)
    assert best["total time ratio"] == pytest.approx(1 / 2)


def test_regret_is_the_share_above_the_best_that_the_world_allowed(
    tables: dict[str, Table],
) -> None:
    regret = tables["policies-regret-rough"].data.set_index("contender")
    # The best is 10 in every world, and its bound 8 where it is not proved, on seed 3.
    assert regret.loc["keep", "regret, at least (%)"] == pytest.approx(100 * (0 + 3 + 3 + 0) / 4)
    maximum = 100 * (0 + 3 + 3 + (10 / 8 - 1)) / 4
    assert regret.loc["keep", "regret, at most (%)"] == pytest.approx(maximum)
    assert regret.loc["repair", ["highest (%)", "proved (%)"]].tolist() == pytest.approx([200, 75])


def test_runs_of_one_problem_have_what_is_known_of_its_best_together() -> None:
    """Equal runs have equal regrets, whichever was proved in time."""
    known = {
        "keep": {"hindsight_best": [10.0] * 4, "hindsight_bound": [10.0, 9.0, 8.0, 8.0]},
        "repair": {"hindsight_best": [10.0, 9.0, 10.0, 10.0], "hindsight_bound": [7.0] * 4},
    }
    records = []
    for name, values in known.items():
        made = record(name)
        # The last run of either policy is of a problem of its own.
        more = {**values, "hindsight_problem": [1, 2, 3, 4 if name == "keep" else 5]}
        document = json.dumps({**made.executions, **more})
        records.append(replace(made, executions_json=document))
    rows = seeds_of(records)
    assert rows["hindsight_best"].tolist() == [10, 9, 10, 10] * 2
    assert rows["hindsight_bound"].tolist() == [10, 9, 8, 8, 10, 9, 8, 7]


def test_scenarios_are_never_mixed() -> None:
    records = [record(name, where) for where in ("rough", "calm") for name in ("keep", "repair")]
    blocks = policy_section(records, "total_time").blocks
    names = [block.name for block in blocks if isinstance(block, Table)]
    assert names == [
        "policies", "policies-regret-rough", "policies-pairs-rough", "policies-pairs-calm",
    ]  # fmt: skip


def test_nothing_is_said_where_nothing_was_executed() -> None:
    failed = record("keep", outcome="raised")
    assert not policy_section([Record(instance="one"), failed], "total_time").blocks
    assert seeds_of([failed]).empty


def test_the_interval_of_a_mean_is_students() -> None:
    # Of 1, 2, 3: mean 2, standard error 1 / sqrt(3), t of two degrees of freedom 4.3027.
    found = mean_of(np.array([1.0, 2.0, 3.0]))
    assert (found.value, found.low) == (2, pytest.approx(2 - 4.302653 / 3**0.5))
    assert np.isnan(mean_of(np.array([1.0])).low)


def test_the_interval_of_a_median_is_that_of_published_tables() -> None:
    # Order statistics for a 95 % interval of the median: 2 and 9 of 10, 40 and 61 of 100.
    ten = quantile_of(np.arange(1.0, 11), 0.5)
    assert (ten.value, ten.low, ten.high) == (5, 2, 9)
    hundred = quantile_of(np.arange(1.0, 101), 0.5)
    assert (hundred.low, hundred.high) == (40, 61)
    five = quantile_of(np.arange(1.0, 6), 0.5)
    assert np.isnan(five.low)
    assert np.isnan(five.high)


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_the_interval_of_a_quantile_holds_it_as_often_as_it_says(share: float) -> None:
    # Exactly: the chance that the k-th of n uniform values is below the quantile is a beta's.
    n = 200
    found = quantile_of(np.arange(1.0, n + 1), share)
    low, high = int(found.low), int(found.high)
    below = stats.beta.cdf(share, low, n + 1 - low)
    above = stats.beta.sf(share, high, n + 1 - high)
    assert below + above - 1 >= 0.95


def told(values: dict[str, tuple[list[float], list[float]]]) -> str:
    """What is said of policies, each with its shares served and its total times, by seed."""
    records = []
    for name, (served, time) in values.items():
        n = len(served)
        document = {key: [2.0] * n for key in (*RUN_METRICS, "deciding_seconds")}
        document |= {"seeds": list(range(n)), "served_share": served, "total_time": time}
        made = replace(record("keep"), contender=name, executions_json=json.dumps(document))
        records.append(made)
    (words, *_) = [b for b in policy_section(records, "total_time").blocks if isinstance(b, Words)]
    return words.text


def test_a_sentence_says_which_policy_won_and_by_how_much() -> None:
    keep, repair = ([0.5] * 8, [10.0] * 8), ([1.0] * 8, [30.0] * 8)
    assert told({"keep": keep, "repair": repair}) == (
        "Under rough, repair wins: it serves 100 % of what can be served against 50 % of keep, the next"
        " (50 points more, 95% confidence: 50 to 50; better in 8, equal in 0, worse in 0 of 8 runs)."
        " Its decisions take 2.00 s a run."
    )


def test_policies_that_differ_by_chance_or_not_at_all_are_said_to() -> None:
    # One win of one that differs is chance; of 8 that serve the same, the faster wins.
    one, other = ([1.0] * 8, [10.0] * 8), ([1.0] * 8, [10.0] * 7 + [20.0])
    assert told({"keep": one, "repair": other}).startswith(
        "Under rough, nobody wins: keep and repair differ by what may be chance; the first serves as"
        " much, at a total time 8.3 % lower"
    )
    assert (
        told({"keep": one, "repair": one})
        == "Under rough, all come to the same, in each of 8 runs."
    )
    twice = ([1.0] * 8, [20.0] * 8)
    assert "keep wins: it serves as much, at a total time 50 % lower" in told(
        {"keep": one, "r": twice}
    )


def test_the_verdict_is_that_of_the_interval_that_is_shown() -> None:
    # Six runs serve the same, 10 against 12 or 10.1 against 10; in each of the other four one serves
    # half, two each: as much on average, and never known. Of six logarithms the interval holds 0.
    gain = log(10 / 12), log(10.1 / 10)
    logs = [gain[0]] * 3 + [gain[1]] * 3
    mean = sum(logs) / 6
    error = sqrt(sum((x - mean) ** 2 for x in logs) / 5 / 6)
    low, high = (100 * (1 - exp(mean + sign * 2.570582 * error)) for sign in (1, -1))
    assert low < 0 < high
    one = [1.0] * 6 + [1.0, 1.0, 0.5, 0.5], [10.0] * 3 + [10.1] * 3 + [1.0] * 4
    other = [1.0] * 6 + [0.5, 0.5, 1.0, 1.0], [12.0] * 3 + [10.0] * 3 + [1.0] * 4
    assert told({"one": one, "other": other}).startswith(
        "Under rough, nobody wins: one and other differ by what may be chance; the first serves as"
        f" much, at a total time {100 * (1 - exp(mean)):.3g} % lower (95% confidence over the 6 of 10"
        f" runs that serve the same: {low:.3g} to {high:.3g} %) than that of the second (better in 5,"
        " equal in 0, worse in 5 of 10 runs)"
    )
    # Won in all of five runs, which a sign test calls chance; of differences 50, 50, 50, 50, 40 the
    # mean is 48, the error 2, and t of four degrees of freedom 2.776445.
    half = [0.5, 0.5, 0.5, 0.5, 0.6], [1.0] * 5
    said = told({"half": half, "all": ([1.0] * 5, [9.0] * 5)})
    assert "all wins: it serves 100 % of what can be served against 52 % of half" in said
    low, high = 48 - 2.776445 * 2, 48 + 2.776445 * 2
    assert f"48 points more, 95% confidence: {low:.3g} to {high:.3g}" in said


def test_who_is_slower_where_both_serve_the_same_is_not_the_winner() -> None:
    # Over all runs the first is faster, as it serves half of one; the other does of another.
    slow = [1.0, 1.0, 0.5, 1.0], [12.0, 12.0, 1.0, 10.0]
    quick = [1.0, 1.0, 1.0, 0.5], [10.0, 10.0, 10.0, 10.0]
    assert told({"slow": slow, "quick": quick}).startswith(
        "Under rough, quick wins: it serves as much, at a total time 16.7 % lower (95% confidence over"
        " the 2 of 4 runs that serve the same: 16.7 to 16.7 %) than that of slow, the next"
    )


def test_whoever_wins_does_so_against_each_of_the_others() -> None:
    # Faster than the next in every run; the third serves less in one of four, by chance, and is faster.
    best, next_, third = [10.0] * 4, [11.0] * 4, [5.0] * 4
    full, less = [1.0] * 4, [1.0, 1.0, 1.0, 0.5]
    # Differences 0, 0, 0, 50: mean 12.5, error 12.5, and t of three degrees of freedom 3.182446.
    assert told({"best": (full, best), "next": (full, next_), "third": (less, third)}).startswith(
        "Under rough, nobody wins: best and third differ by what may be chance; the first serves 100 %"
        " of what can be served against 87.5 % of the second (12.5 points more, 95% confidence: "
        f"{12.5 - 12.5 * 3.182446:.3g} to {12.5 + 12.5 * 3.182446:.3g}; better in 1, equal in 0, worse"
        " in 3 of 4 runs)"
    )


def test_the_picture_goes_scenario_by_scenario_and_cuts_no_contender() -> None:
    """Records come planner by planner; what tells them apart is whole."""
    long = "greedy, replan, stability = "
    records = [
        replace(record("repair", scenario), contender=f"{long}{price}")
        for price in (0, 50)
        for scenario in ("aftershock", "calm")
    ]
    picture = served_picture(seeds_of(records))
    assert picture.data["scenario"].tolist() == ["aftershock"] * 2 + ["calm"] * 2
    (ax,) = picture.figure.axes
    ticks = [
        (y, label.get_text())
        for y, label in zip(ax.get_yticks(), ax.get_yticklabels(), strict=True)
    ]
    headings = [(text.get_position()[1], text.get_text()) for text in ax.texts]
    assert sorted([*ticks, *headings]) == [
        (0, "under aftershock"), (1, f"{long}0"), (2, f"{long}50"),
        (3, "under calm"), (4, f"{long}0"), (5, f"{long}50"),
    ]  # fmt: skip


def test_of_many_policies_the_pairs_are_those_of_the_best() -> None:
    times = {"a": 50.0, "b": 40.0, "best": 10.0, "c": 30.0, "d": 20.0}
    records = []
    for name, time in times.items():
        values = {**record("repair").executions, "total_time": [time] * 4}
        made = replace(record("repair"), contender=name, executions_json=json.dumps(values))
        records.append(made)
    blocks = policy_section(records, "total_time").blocks
    (pairs,) = [b.data for b in blocks if isinstance(b, Table) and "pairs" in b.name]
    assert pairs["contender"].tolist() == ["best"] * 4
    assert pairs["against"].tolist() == ["d", "c", "b", "a"]
    (words, *_) = [block.text for block in blocks if isinstance(block, Words)]
    assert "best wins" in words
    assert "of d, the next" in words
