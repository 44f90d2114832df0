"""Who won: pairs, intervals and sentences, by hand."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, log, sqrt

import pandas as pd
import pytest
from support.study_records import record, solve

from msmrta_opt.studies.record import Record
from msmrta_opt.studies.report.blocks import Table
from msmrta_opt.studies.report.heat import time_heat
from msmrta_opt.studies.report.pairs import Comparison, Ratio
from msmrta_opt.studies.report.runs import constants, table_of
from msmrta_opt.studies.report.tables import quality_table, same_everywhere
from msmrta_opt.studies.report.text import compact
from msmrta_opt.studies.report.winner import planner_sentence, quality_time, solver_sentence

T = 12.706204736  # Student's t of 97.5 % at one degree of freedom, as published


def runs_of(*given: tuple[str, Sequence[float | None], float]) -> list[Record]:
    """For each contender its total time on a, b, …, and its seconds on each; None is a failure."""
    found = []
    for who, worth, seconds in given:
        for name, value in zip("abcdefgh", worth, strict=False):
            if value is None:
                found.append(record(name, who, outcome="timed out"))
            else:
                found.append(record(name, who, seconds, total_time=value, served_share=1.0))
    return found


def compared(records: list[Record]) -> Comparison:
    return Comparison(table_of(records), "total_time")


def test_a_ratio_has_the_interval_of_students_t_on_the_logarithms() -> None:
    # Of 1/2 and 2: logarithms ∓log 2, mean 0, standard deviation √2 log 2, its error log 2.
    ratio = Ratio.of(pd.Series([0.5, 2.0]).to_numpy())
    assert ratio.mean == pytest.approx(1)
    assert (ratio.low, ratio.high) == (pytest.approx(2**-T), pytest.approx(2**T))
    assert not ratio.is_known


def test_pairs_are_won_by_what_is_served_and_then_by_quality() -> None:
    records = runs_of(("one", [10, 20, 30], 2.0), ("two", [20, 20, 20], 1.0))
    records += [
        record("d", "one", 2.0, total_time=99, served_share=1.0),
        record("d", "two", 1.0, total_time=1, served_share=0.5),  # quicker, and serves less
        record("e", "one", 2.0, total_time=1, served_share=1.0),
        record("e", "two", outcome="timed out"),
    ]
    pair = compared(records).pair("one", "two")
    assert (pair.wins, pair.ties, pair.losses) == (2, 1, 1)
    # Of a, b, c alone, where both serve the same: 1/2, 1 and 3/2.
    assert pair.quality.mean == pytest.approx((1 / 2 * 1 * 3 / 2) ** (1 / 3))
    assert pair.quality.n == 3
    assert pair.time.mean == pytest.approx(2)
    other = compared(records).pair("two", "one")
    assert (other.wins, other.ties, other.losses) == (1, 1, 2)
    assert other.quality.mean == pytest.approx(1 / pair.quality.mean)


def test_the_sentence_says_who_wins_by_how_much_and_at_what_price() -> None:
    # Half of the other's on every instance: no spread, so the interval is the ratio.
    said = planner_sentence(compared(runs_of(("slow", [5, 10], 6.0), ("quick", [10, 20], 2.0))))
    assert said == (
        "On all 2 instances, slow makes the best plans: its total time is 50 % lower (95% confidence:"
        " 50 to 50 %) than that of quick, the next (better on 2, equal on 0, worse on 0). The price of"
        " slow: 3 times the planning time of quick, the fastest (6.00 s against 2.00 s)."
    )


def test_what_may_be_chance_is_no_win() -> None:
    said = planner_sentence(compared(runs_of(("one", [10, 20], 1.0), ("two", [11, 19], 2.0))))
    # Logarithms log(10/11) and log(20/19).
    logs = log(10 / 11), log(20 / 19)
    mean = sum(logs) / 2
    error = sqrt(sum((x - mean) ** 2 for x in logs)) / sqrt(2)
    low, high = (100 * (exp(mean + sign * T * error) - 1) for sign in (-1, 1))
    lower = 100 * (1 - exp(mean))
    assert (
        "nobody wins by total time: one and two differ by what may be chance, the first's being"
        in (said)
    )
    assert f"{lower:.3g} % lower (95% confidence: {-high:.3g} to {-low:.3g} %)" in said
    assert said.endswith(
        "better on 1, equal on 0, worse on 1. It is also the fastest: two takes 2 times its planning"
        " time of 1.00 s."
    )


def test_those_who_serve_less_are_out_and_equals_are_named() -> None:
    records = runs_of(("one", [10, 20], 3.0), ("same", [10, 20], 2.0), ("worse", [20, 40], 1.0))
    records += [record(name, "half", 0.5, total_time=1, served_share=0.5) for name in "ab"]
    assert planner_sentence(compared(records)) == (
        "On all 2 instances, same makes the best plans: its total time is 50 % lower (95% confidence:"
        " 50 to 50 %) than that of worse, the next (better on 2, equal on 0, worse on 0). As good and"
        " slower: one. Out, for serving less than 100 % of what can be served: half 50 %. The price of"
        " same: 4 times the planning time of half, the fastest (2.00 s against 0.500 s)."
    )


def test_all_alike_the_fastest_is_named_and_only_what_all_finished_counts() -> None:
    records = runs_of(("one", [10, 20, 5], 3.0), ("two", [10, 20, None], 2.0))
    assert planner_sentence(compared(records)) == (
        "On the 2 of 3 instances that all finished, all plans are equally good by total time, and two"
        " is the fastest to make them. It is also the fastest: one takes 1.5 times its planning time"
        " of 2.00 s."
    )


def test_the_picture_shows_each_contender_as_a_multiple_of_the_best() -> None:
    records = runs_of(("one", [10, 40], 1.0), ("two", [20, 20], 4.0))
    looks = {"one": {"color": "red", "marker": "o"}, "two": {"color": "blue", "marker": "s"}}
    picture = quality_time(compared(records), looks)
    # One: 1 and 2 of the best, geometric mean √2; two: 2 and 1, the same.
    assert list(picture.data["total time, of the best"]) == pytest.approx([sqrt(2), sqrt(2)])
    assert list(picture.data["planning time (s)"]) == pytest.approx([1, 4])
    (ax,) = picture.figure.axes
    marks = [line for line in ax.lines if line.get_marker() in ("o", "s")]
    assert [float(line.get_xdata()[0]) for line in marks] == pytest.approx([1, 4])  # type: ignore[index]
    assert [float(line.get_ydata()[0]) for line in marks] == pytest.approx([sqrt(2)] * 2)  # type: ignore[index]


def test_solvers_are_told_by_what_they_prove_and_by_time_where_all_do() -> None:
    records = [
        *(solve(name, "m", "highs", 2.0) for name in "abc"),
        *(solve(name, "m", "scip", 1.0) for name in "ab"),
        solve("c", "m", "scip", 9.0, status="feasible"),
    ]
    assert solver_sentence(table_of(records)) == (
        "Of 3 programs, highs proves 3 optimal (scip 2). Over the 2 that all solve, scip takes 0.5"
        " times its solving time."
    )


def test_what_is_the_same_in_every_run_is_a_sentence_and_no_column() -> None:
    records = runs_of(("one", [10, 20], 1.0), ("two", [30, 40], 1.0))
    runs = table_of(records)
    assert constants(runs) == {"served_share": 1.0}
    said = same_everywhere(runs)
    assert said is not None
    assert said.text == "The same in every run: served share 100 %."
    assert "served share (%)" not in quality_table(runs).data
    assert constants(table_of(records[:1])) == {}


def test_the_best_of_a_column_is_marked_within_its_map_unless_all_are_equal() -> None:
    data = pd.DataFrame(
        {"map": ["m", "m", "n", "n"], "time": [2.0, 1.0, 3.0, 3.0], "share": [5.0, 4.0, 6.0, 7.0]}
    )
    table = Table("t", "T", data, better={"time": "less", "share": "more"}, within="map")
    assert table.best() == {(1, 1), (0, 2), (3, 2)}


def test_small_heat_maps_tell_their_values_and_large_ones_do_not() -> None:
    def heat(victims: range) -> list[str]:
        records = [
            record(f"{n}x{m}", "one", n * m / 10, n_robots=n, n_victims=m)
            for n in (1, 2)
            for m in victims
        ]
        found = time_heat(table_of(records), "planner")
        assert found is not None
        return [cell.text for cell in found.maps[0].panels[0].cells]

    assert heat(range(1, 4)) == ["0.100", "0.200", "0.300", "0.200", "0.400", "0.600"]
    assert set(heat(range(1, 8))) == {""}


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.00123, "0.0012"), (5.5, "5.50"), (9999.0, "9,999"), (12_345.0, "12k"),
     (2.345e6, "2.35M")],
)  # fmt: skip
def test_values_in_cells_are_short(value: float, text: str) -> None:
    assert compact(value) == text
