"""The performance profile by hand, and what staging costs, drawn legibly."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from msmrta_opt.optimise.solution import Status
from msmrta_opt.plots.figure import PictureAxes
from msmrta_opt.studies.analysis.profile import performance_profile
from msmrta_opt.studies.analysis.staging import Loss
from msmrta_opt.studies.analysis.staging_picture import staging_losses
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.solves import record_of_row, table_of


def row(instance: str, solver: str, seconds: float | None, status: Status = "optimal") -> Record:
    asked = {"instance": instance, "stage": "cluster", "model": "model", "solver": solver}
    return record_of_row({**asked, "status": status, "total_seconds": seconds})


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
def test_a_profile_of_nothing_solved_is_empty_and_drawn(rows: list[Record]) -> None:
    ax = performance_profile(rows)
    ax.figure.canvas.draw()
    assert "0 programs" in ax.get_title()


def test_a_table_gives_the_profile_of_its_rows() -> None:
    table, rows = performance_profile(table_of(ROWS)), performance_profile(ROWS)
    for one, other in zip(table.get_lines(), rows.get_lines(), strict=True):
        assert one.get_label() == other.get_label()
        np.testing.assert_array_equal(one.get_xydata(), other.get_xydata())


@pytest.mark.parametrize(
    ("worst", "some"),
    [(1.5, {"1.2×", "1.4×"}), (2.2, {"2×"}), (12, {"1×", "2×", "5×", "10×"}), (5000, {"1000×"})],
)
def test_several_factors_are_named_however_far_they_reach(worst: float, some: set[str]) -> None:
    ax = performance_profile([row("one", "quick", 1.0), row("one", "slow", worst)])
    ax.figure.canvas.draw()
    low, high = ax.get_xlim()
    ticks = zip(ax.get_xticks(), ax.get_xticklabels(), strict=True)
    named = {label.get_text() for at, label in ticks if low <= at <= high}
    assert some <= named
    assert 3 <= len(named) <= 8


LOSSES = [Loss("order of visits", 12, 9 + 1 / 3, 9), Loss("auction (B4)", 9 + 1 / 3, 8, 8)]


def test_losses_are_drawn_with_one_decimal_and_a_legend_clear_of_the_axis() -> None:
    ax = staging_losses({"thirds": [Loss("a", 8 + 1 / 3, 8, 8)], "whole": LOSSES}, "total_time")
    assert [text.get_text().strip() for text in ax.texts] == ["8.3", "12.0"]
    ax.figure.canvas.draw()
    legend = ax.get_legend()
    assert legend is not None
    assert legend.get_window_extent().y1 < ax.xaxis.label.get_window_extent().y0


def test_pictures_of_ones_own_show_themselves_in_a_notebook() -> None:
    for ax in (performance_profile(ROWS), staging_losses({"one": LOSSES}, "makespan")):
        assert isinstance(ax, PictureAxes)
        shown = ax._repr_png_()
        assert shown is not None
        assert shown.startswith(b"\x89PNG")
