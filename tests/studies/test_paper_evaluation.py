"""What the documents say of the paper's evaluation is what is in its table."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).parents[2]
BASELINE = "MRGA as published"
CELL = ["map", "n_robots", "n_victims"]


@pytest.fixture(scope="module")
def runs() -> pd.DataFrame:
    return pd.read_csv(ROOT / "studies" / "paper_evaluation.csv")


@pytest.fixture(scope="module")
def documents() -> dict[str, str]:
    return {
        name: (ROOT / name).read_text(encoding="utf-8")
        for name in ("README.md", "studies/README.md")
    }


def by_contender(runs: pd.DataFrame, figure: str) -> pd.DataFrame:
    return runs.pivot_table(index=CELL, columns="contender", values=figure)


def test_every_cell_of_the_grid_is_there_and_finished(runs: pd.DataFrame) -> None:
    assert len(runs) == 3 * 4 * 9 * 10
    assert not runs.duplicated([*CELL, "contender"]).any()
    assert (runs.outcome == "finished").all()
    assert (runs.n_served == runs.n_available).all()


def test_the_percentages_of_time_saved_are_those_of_the_table(
    runs: pd.DataFrame, documents: dict[str, str]
) -> None:
    seconds = by_contender(runs, "seconds")
    means = seconds.groupby("map").mean()
    for contender in ("MSMRTA", "MRGA with a table"):
        by_map = 100 * (1 - means[contender] / means[BASELINE])
        for saved in by_map:
            assert f" {saved:.2f} % " in documents["studies/README.md"]
        assert f"{by_map.min():.0f} to {by_map.max():.0f} % " in documents["README.md"]
        overall = 100 * (1 - seconds[contender].mean() / seconds[BASELINE].mean())
        median = 100 * (1 - (seconds[contender] / seconds[BASELINE]).median())
        assert f" {overall:.2f} % " in documents["studies/README.md"]
        assert f" {median:.2f} % " in documents["studies/README.md"]


def test_the_ratios_of_plan_quality_are_those_of_the_table(
    runs: pd.DataFrame, documents: dict[str, str]
) -> None:
    for figure in ("distance", "makespan", "total_time", "mean_completion"):
        values = by_contender(runs, figure)
        ratio = values["MSMRTA"] / values[BASELINE]
        for mean in [*ratio.groupby("map").mean(), ratio.mean()]:
            assert f" {mean:.2f} " in documents["studies/README.md"]
        assert (values[BASELINE] == values["MRGA with a table"]).all()
        if figure in ("distance", "makespan"):
            assert f" {ratio.mean():.2f} times" in documents["README.md"]
