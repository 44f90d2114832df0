"""The performance profile, by hand."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from msmrta_opt.optimise.solution import Status
from msmrta_opt.studies.pictures import performance_profile
from msmrta_opt.studies.rows import Row


def row(instance: str, solver: str, seconds: float | None, status: Status = "optimal") -> Row:
    return Row(instance, "cluster", "model", solver, None, status, total_seconds=seconds)


ROWS = [
    row("one", "quick", 1.0),
    row("two", "quick", 4.0),
    row("one", "slow", 2.0),  # a factor of 2
    row("two", "slow", 9.0, "feasible"),
    row("three", "quick", 9.0, "no_solution"),  # solved by nobody: does not count
    row("one", "absent", None, "skipped"),
]


def share(ax: Axes, label: str, ratio: float) -> float:
    """Percentage that the drawn step function of `label` has at `ratio`."""
    (line,) = (line for line in ax.get_lines() if str(line.get_label()).startswith(label))
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    return float(y[np.flatnonzero(x <= ratio)[-1]])


def test_a_profile_is_the_share_solved_within_each_factor_of_the_best() -> None:
    ax = performance_profile(ROWS)
    assert [share(ax, "quick", ratio) for ratio in (1.0, 2.5)] == [100, 100]
    assert [share(ax, "slow", ratio) for ratio in (1.0, 1.9, 2.0, 2.5)] == [0, 0, 50, 50]


def test_the_legend_says_how_many_each_solved() -> None:
    labels = {str(line.get_label()) for line in performance_profile(ROWS).get_lines()}
    assert labels == {"quick (2 of 2)", "slow (1 of 2)"}


def test_a_profile_is_drawn_on_the_axes_given() -> None:
    ax = Figure().subplots()
    assert performance_profile(ROWS, ax=ax) is ax
    assert ax.get_xlabel()
    assert ax.get_ylabel()


@pytest.mark.parametrize("rows", [[], [row("one", "slow", None, "error")]])
def test_a_profile_of_nothing_solved_is_empty_and_drawn(rows: list[Row]) -> None:
    ax = performance_profile(rows)
    ax.figure.canvas.draw()
    assert "0 programs" in ax.get_title()
