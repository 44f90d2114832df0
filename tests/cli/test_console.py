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


@pytest.mark.parametrize("width", WIDTHS)
def test_no_name_is_broken_at_any_width(monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    words = printed(monkeypatch, width).split()
    assert {"cluster_one_to_one", "a_long_name_of_one's_own_model"} <= set(words)


def test_where_columns_do_not_fit_the_values_of_each_row_stand_together_its_name_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert printed(monkeypatch, 60).split("\n\n")[1].splitlines() == [
        "formulation: cluster_one_to_one   solver: auto",
        "  objective: 6.25   bound: 6.25   gap: 0   status: optimal",
        "  seconds: 0.0123456   proof: simplex, dual values",
    ]


def test_texts_share_the_width_so_that_no_row_takes_more_lines_than_it_must(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = StringIO()
    narrow = Console(file=text, width=40, highlight=False)
    monkeypatch.setattr(console, "console", lambda: narrow)
    # 40 columns less 3 a column leave 31, of which "row" takes 3: in one line the others need 41, in two
    # 14 and 12.
    console.table(
        "T", ["n", "what", "why"], [("row", "aaaa bbbb cccc dddd eeee", "ff gg hh ii jj kk")]
    )
    lines = [line.rstrip() for line in text.getvalue().splitlines() if line.strip()]
    assert [line.split() for line in lines[3:]] == [
        ["row", "aaaa", "bbbb", "cccc", "ff", "gg", "hh", "ii"], ["dddd", "eeee", "jj", "kk"],
    ]  # fmt: skip
