"""What solutions, trade-offs and comparisons show of themselves, and their tables."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pandas as pd
import pytest

import msmrta_opt as mo
from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.comparison_table import Comparison
from msmrta_opt.studies.solves import records_of


@pytest.fixture(scope="module")
def solution() -> mo.Solution:
    """Robots 7 and 3, clusters C0 and C1: 1 + 2 against 4 + 3."""
    data = mo.ClusterData(np.array([[1.0, 4.0], [3.0, 2.0]]), np.zeros((2, 2)), np.array([1, 1]))
    return mo.solve("cluster_one_to_one", data, psi=0.0)


@pytest.fixture(scope="module")
def compared() -> Comparison:
    return mo.compare(
        [mo.example("corridor")], models=["cluster_printed", "cluster_fair"], solvers=["highs"]
    )


def test_a_solution_is_a_table_of_the_variables_that_are_not_zero(solution: mo.Solution) -> None:
    table = solution.to_frame()
    assert list(table.columns) == ["variable", "value"]
    assert list(table["variable"]) == ["x[1,0]", "x[0,1]"]
    assert len(solution.to_frame("x")) == 4
    with pytest.raises(InputError, match=r"no values of 'X' \(did you mean 'x'\?\); there are"):
        solution.to_frame("X")


def test_a_solution_says_its_status_objective_and_bound(solution: mo.Solution) -> None:
    assert repr(solution).startswith("Solution(cluster_one_to_one: optimal, max 7, bound 7, ")
    assert "x[0,1]" in solution._repr_html_()


def test_a_tradeoff_is_a_row_a_piece() -> None:
    # At psi = 0 the weights of partial, at 1 those of full satisfaction decide.
    found = mo.tradeoff(mo.example("paper"))
    table = found.to_frame()
    assert list(table["low"]) == [0.0, *(float(t) for t in found.breakpoints)]
    assert list(table["high"])[-1] == 1.0
    assert all(isinstance(segment.low, Fraction) for segment in found.segments)
    assert list(table["slope"]) == [float(segment.slope) for segment in found.segments]
    assert list(table["makespan"]) == [segment.metrics.makespan for segment in found.segments]
    assert repr(found).startswith(
        "Tradeoff(cluster_one_to_one over psi: 2 pieces, max, breakpoints"
    )
    assert "robots take" in found._repr_html_()


def test_regions_are_a_row_each() -> None:
    found = mo.tradeoff(mo.example("corridor"), ("psi", "beta"))
    table = found.to_frame()
    area = (table["psi high"] - table["psi low"]) * (table["beta high"] - table["beta low"])
    assert area.sum() == pytest.approx(1)
    assert repr(found).startswith("Regions(psi and beta: ")


def test_a_comparison_is_a_pandas_table_that_shows_itself_short(compared: Comparison) -> None:
    assert isinstance(compared, pd.DataFrame)
    lines = repr(compared).splitlines()
    assert lines[0] == "Comparison(2 solves: 2 optimal)"
    assert lines[1].split() == [
        "instance", "model", "solver", "status", "objective", "bound", "total_seconds",
    ]  # fmt: skip
    assert "cluster_fair" in compared._repr_html_()


@pytest.mark.parametrize(
    "take", [lambda t: t[["model"]], lambda t: t.head(1), lambda t: t.groupby("model").size()]
)
def test_what_is_taken_from_a_comparison_is_plain_pandas(compared: Comparison, take: Any) -> None:
    assert type(take(compared)) in (pd.DataFrame, pd.Series)


def test_a_comparison_goes_where_records_go(compared: Comparison) -> None:
    assert [record.model for record in records_of(compared)] == ["cluster_printed", "cluster_fair"]
    assert mo.disagreements(compared) == []
