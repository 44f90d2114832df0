"""Tables at any width: numbers whole, lines that fit, everything there."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from msmrta_opt.cli import console

COLUMNS = ["formulation", "solver", "objective", "bound", "gap", "status", "seconds", "proof"]
ROWS = [
    ("cluster_one_to_one", "auto", 6.25, 6.25, 0.0, "optimal", 0.0123456, "simplex, dual values"),
    ("a_long_name_of_one's_own_model", "highs", -987654.0, None, 1e-9, "feasible", 12.5, ""),
]
NUMBERS = ("6.25", "0.0123456", "-987654", "1e-09", "12.5")
WIDTHS = (40, 60, 80, 100, 120, 200)


def printed(monkeypatch: pytest.MonkeyPatch, width: int) -> str:
    """The table on a terminal of that width."""
    text = StringIO()
    narrow = Console(file=text, width=width, highlight=False)
    monkeypatch.setattr(console, "console", lambda: narrow)
    console.table("Solves", COLUMNS, ROWS)
    return text.getvalue()


@pytest.mark.parametrize("width", WIDTHS)
def test_no_number_is_cropped_or_broken_at_any_width(
    monkeypatch: pytest.MonkeyPatch, width: int
) -> None:
    words = printed(monkeypatch, width).split()
    assert set(NUMBERS) <= set(words)
    assert words.count("6.25") == 2
    assert "…" not in "".join(words)


@pytest.mark.parametrize("width", WIDTHS)
def test_no_text_is_lost_at_any_width(monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    # What is broken goes on below, in its own column: its letters are there in order.
    shown = printed(monkeypatch, width)
    for text in ("cluster_one_to_one", "a_long_name_of_one's_own_model", "optimal", "simplex"):
        left = iter(shown)
        assert all(letter in left for letter in text)


@pytest.mark.parametrize("width", [width for width in WIDTHS if width >= 100])
def test_the_lines_of_a_table_fit(monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    assert max(map(len, printed(monkeypatch, width).splitlines())) <= width


def test_where_columns_do_not_fit_the_numbers_of_each_row_stand_right_below_its_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lines = printed(monkeypatch, 60).split("\n\n")[1].splitlines()
    assert lines == [
        "formulation: cluster_one_to_one",
        "objective: 6.25",
        "bound: 6.25",
        "gap: 0",
        "seconds: 0.0123456",
        "solver: auto",
        "status: optimal",
        "proof: simplex, dual values",
    ]
