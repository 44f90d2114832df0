"""Tables at any width: numbers whole, lines that fit, everything there."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table
from rich.text import Text

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


WORDS = [
    "a",
    "水火 木",
    "[1, 2]",
    "",
    " lead",
    "trail ",
    "tab\tbed",
    "two\nlines",
    "bell\x07",
    "x" * 20,
]


@pytest.mark.parametrize("width", [60, 90, 10_000])
def test_a_table_looks_as_one_of_rich(monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    columns = ["number", "水 of many words that are broken", "x" * 15]
    rows = [[str(n), " ".join(WORDS[: n + 1]), WORDS[-n - 1]] for n in range(len(WORDS))]
    numeric = [True, False, False]
    text, oracle = StringIO(), StringIO()
    ours = Console(file=text, width=width, highlight=False)
    monkeypatch.setattr(console, "console", lambda: ours)
    widths = console._widths(columns, rows, numeric)
    assert widths is not None
    console._print_columns(columns, rows, numeric, widths)
    table = Table(box=SIMPLE, pad_edge=False)
    for column, of_column, is_number in zip(columns, widths, numeric, strict=True):
        side = "right" if is_number else "left"
        table.add_column(column, justify=side, overflow="fold", width=of_column)  # type: ignore[arg-type]
    for row in rows:
        table.add_row(*map(Text, row))
    Console(file=oracle, width=width, highlight=False).print(table)
    assert text.getvalue() == oracle.getvalue()


@pytest.mark.parametrize("width", [12, 20, 30])
def test_a_word_that_is_longer_than_the_line_stands_in_one_of_its_own(
    monkeypatch: pytest.MonkeyPatch, width: int
) -> None:
    text = StringIO()
    narrow = Console(file=text, width=width, highlight=False)
    monkeypatch.setattr(console, "console", lambda: narrow)
    console.table("T", ["row", "what"], [("a", f"some {'x' * 50} words")])
    lines = text.getvalue().splitlines()
    assert len(lines) < 12
    assert [line.strip() for line in lines if "xx" in line] == ["x" * 50]


@pytest.mark.parametrize("lines", [1, 2, 3, 6])
def test_a_text_of_thousands_of_ids_has_the_least_width_at_which_its_lines_suffice(
    lines: int,
) -> None:
    """Words of one letter: n in a line take 2 n - 1 columns."""
    each = -(-3000 // lines)
    assert console._width_for(["v " * 3000], lines) == 2 * each - 1
