"""The figures of a report, by hand."""

from __future__ import annotations

from math import exp, log, sqrt

import pytest
from support.study_records import record, solve

from msmrta_opt.studies.report.baseline import ratios, savings
from msmrta_opt.studies.report.profile import profile
from msmrta_opt.studies.report.runs import common_instances, per_instance, table_of
from msmrta_opt.studies.report.scaling import fit, growths
from msmrta_opt.studies.report.tables import quality_table, solving_table, timing_table
from msmrta_opt.studies.report.text import file_names, number

OFF = [1, -2, 0, 2, -1]


def test_an_exact_power_law_has_its_own_exponent_and_no_error() -> None:
    sizes = [10.0, 20.0, 50.0, 100.0, 200.0]
    law = fit(sizes, [3e-4 * size**1.7 for size in sizes])
    assert law is not None
    assert law.exponent == pytest.approx(1.7)
    assert law.coefficient == pytest.approx(3e-4)
    assert law.error == pytest.approx(0, abs=1e-9)
    assert law.r2 == pytest.approx(1)


def test_the_standard_error_is_that_of_the_slope_on_the_logarithms() -> None:
    # log x = −2, −1, 0, 1, 2 and log y = 10 log x + (1, −2, 0, 2, −1): these are across to x
    # (Σ −2 + 2 + 0 + 2 − 2 = 0), so the slope is 10, and they are the residuals: their squares sum
    # to 10, those of x too; three degrees of freedom.
    x = [-2, -1, 0, 1, 2]
    law = fit([exp(a) for a in x], [exp(10 * a + r) for a, r in zip(x, OFF, strict=True)])
    assert law is not None
    assert law.exponent == pytest.approx(10)
    assert law.error == pytest.approx(sqrt(10 / 3 / 10))
    assert law.r2 == pytest.approx(1 - 10 / (10 + 100 * 10))


def test_four_sizes_are_too_few_for_an_exponent_however_many_points() -> None:
    assert fit([1, 1, 2, 2, 3, 4, 0, 5], [1, 1, 2, 2, 3, 4, 5, 0]) is None


def test_an_exponent_that_is_hardly_known_is_not_said() -> None:
    # The residuals of above beside a slope of 1: a standard error of 0.58.
    x = [-2, -1, 0, 1, 2]
    assert fit([exp(a) for a in x], [exp(a + r) for a, r in zip(x, OFF, strict=True)]) is None


def test_growth_over_victims_is_at_the_largest_number_of_robots_and_of_finished_runs() -> None:
    records = [
        record(f"{n}x{m}", who, 0.01 * n * m**2, n_robots=n, n_victims=m)
        for who in ("one", "two")
        for n in (2, 4)
        for m in (5, 10, 20, 40)
    ]
    lost = {"n_robots": 4, "n_victims": 80, "outcome": "timed out"}
    records += [
        record("4x80", "one", 256.0, n_robots=4, n_victims=80),
        record("4x80", "two", **lost),
    ]
    over_victims, over_product = growths(table_of(records))
    assert over_victims.n_robots == 4
    # The other has four sizes, which are drawn, and no law.
    assert {who: law.points for who, law in over_victims.fits.items()} == {"one": 5}
    assert over_victims.fits["one"].exponent == pytest.approx(2)
    assert list(over_victims.data["size"]) == [5, 10, 20, 40, 80, 5, 10, 20, 40]
    assert over_product.n_robots is None


def test_time_saved_is_of_the_means_over_the_cells_that_both_finished() -> None:
    records = [
        # A cell of two instances, 1 and 3 s against 20 and 40: means 2 and 30.
        record("a", "ours", 1.0, n_victims=10),
        record("b", "ours", 3.0, n_victims=10),
        record("a", "base", 20.0, n_victims=10),
        record("b", "base", 40.0, n_victims=10),
        # A cell of one: 4 against 10. Means of cells: 3 and 20, so 85 % is saved.
        record("c", "ours", 4.0, n_victims=20),
        record("c", "base", 10.0, n_victims=20),
        # Finished by one of them only.
        record("d", "ours", 1000.0, n_victims=30),
        record("d", "base", outcome="timed out", n_victims=30),
    ]
    (row,) = savings(table_of(records), "base", {"map0": 97.7}).to_dict("records")
    assert row["contender"] == "ours"
    assert (row["cells"], row["mean (s)"], row["baseline's mean (s)"]) == (2, 3, 20)
    assert row["saved (%)"] == pytest.approx(85)
    assert row["published (%)"] == 97.7
    # Instance by instance 95, 92.5 and 60 % are saved.
    assert row["median of instances (%)"] == pytest.approx(92.5)


def test_maps_are_compared_one_by_one_and_together() -> None:
    records = [
        record(f"{name}", who, seconds, map=name)
        for name, who, seconds in [
            *(("map0", "ours", 1.0), ("map0", "base", 4.0)),
            *(("map1", "ours", 3.0), ("map1", "base", 4.0)),
        ]
    ]
    data = savings(table_of(records), "base")
    assert dict(zip(data["map"], data["saved (%)"], strict=True)) == pytest.approx(
        {"map0": 75, "map1": 25, "all maps": 50}
    )


def test_ratios_of_quality_are_means_over_instances_where_the_baseline_is_not_zero() -> None:
    records = [
        record("a", "ours", distance=30, makespan=10.0),
        record("a", "base", distance=20, makespan=0.0),
        record("b", "ours", distance=10, makespan=9.0),
        record("b", "base", distance=20, makespan=3.0),
        record("c", "ours", distance=99, makespan=99.0),
        record("c", "base", outcome="crashed"),
    ]
    (row,) = ratios(table_of(records), "base").to_dict("records")
    assert row == {
        "map": "map0",
        "contender": "ours",
        "instances": 2,
        "distance": pytest.approx((1.5 + 0.5) / 2),
        "makespan": pytest.approx(3.0),
    }


def test_common_instances_are_those_that_all_finished_who_finished_any() -> None:
    records = [
        *(record("a", "one"), record("b", "one"), record("c", "one")),
        *(record("a", "two"), record("b", "two", outcome="raised"), record("c", "two")),
        *(record("a", "broken", outcome="raised"), record("b", "broken", outcome="raised")),
        # Another seed of the same failed: the instance does not count.
        record("c", "two", seed=1, outcome="timed out"),
    ]
    assert common_instances(table_of(records)) == {"a"}


def test_seeds_of_one_instance_count_as_one_by_their_mean() -> None:
    records = [
        *(
            record("a", "one", 1.0, seed=0, distance=10),
            record("a", "one", 3.0, seed=1, distance=20),
        ),
        record("b", "one", 5.0, seed=0, distance=45),
    ]
    runs = table_of(records)
    assert list(per_instance(runs, "seconds")["one"]) == [2, 5]
    assert list(quality_table(runs).data["distance (cells)"]) == [30]


def test_median_and_spread_of_times_are_over_the_common_instances() -> None:
    records = [
        record(
            name, "one", middle,
            seconds_low=middle - 0.5, seconds_high=middle + 1, repetitions=3,
        )
        for name, middle in (("a", 1.0), ("b", 2.0), ("c", 5.0))
    ]  # fmt: skip
    records += [record("d", "one", 100.0), record("d", "two", outcome="timed out")]
    records += [record(name, "two", 7.0) for name in "abc"]
    row = timing_table(table_of(records), "planner").data.iloc[0]
    assert (row["runs"], row["median (s)"]) == (3, 2)
    assert (row["lower quartile (s)"], row["upper quartile (s)"]) == (1.5, 3.5)
    assert (row["lowest (s)"], row["highest (s)"]) == (0.5, 6)
    # 1.5 s against 1, 2 and 5 s: 150, 75 and 30 %.
    assert row["spread of repetitions (%)"] == pytest.approx(75)


def test_solving_times_are_shifted_geometric_means_over_optimal_solves_only() -> None:
    records = [
        solve("a", "model", "highs", 0.02),
        solve("b", "model", "highs", 0.08),
        solve("c", "model", "highs", 50.0, status="feasible", gap=0.1),
        solve("d", "model", "highs", outcome="timed out"),
    ]
    row = solving_table(table_of(records)).data.iloc[0]
    assert row["shifted geometric mean (s)"] == pytest.approx(
        exp((log(0.03) + log(0.09)) / 2) - 0.01
    )
    assert (row["runs"], row["optimal"], row["feasible"], row["without result"]) == (4, 2, 1, 1)
    assert row["mean gap where stopped early (%)"] == pytest.approx(10)


def test_a_profile_is_the_share_of_what_anybody_finished_within_each_factor() -> None:
    records = [
        *(record("a", "quick", 1.0), record("a", "slow", 2.0)),
        *(record("b", "quick", 4.0), record("b", "slow", outcome="timed out")),
        *(record("c", "quick", outcome="raised"), record("c", "slow", outcome="raised")),
    ]
    steps = profile(per_instance(table_of(records), "seconds"))
    assert steps.to_dict("list") == {
        "who": ["quick", "slow"],
        "factor": [1, 2],
        "share (%)": [100, 50],
    }


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.0000123456, "0.0000123"),
        (2.346e-16, "2.35e-16"),
        (1.5, "1.50"),
        (97.7042, "97.7"),
        (1462.25, "1,462"),
        (float("nan"), "–"),
        (-0.125, "-0.125"),
    ],
)
def test_figures_have_three_significant_digits(value: float, text: str) -> None:
    assert number(value) == text


def test_files_of_names_that_look_alike_are_told_apart() -> None:
    assert file_names(["Map 1", "map/1", "…", "Map 1"]) == {
        "Map 1": "map-1",
        "map/1": "map-1-2",
        "…": "x",
    }
