"""How the command line shows things: one console, plain tables, short numbers."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

WIDTH_OF_FILES = 160
"""Columns where the output is not a terminal."""


@cache
def console() -> Console:
    """The console that all commands print to."""
    from rich.console import Console

    width = None if sys.stdout.isatty() else WIDTH_OF_FILES
    return Console(width=width, highlight=False)


def say(text: str = "") -> None:
    """Print a line."""
    console().print(text, markup=False, soft_wrap=True)


def table(
    title: str, columns: Sequence[str], rows: Iterable[Sequence[object]], *, wraps: str = ""
) -> None:
    """Print a table; columns of numbers are aligned to the right.

    Only the column `wraps`, by default the last, is broken where the width does not suffice.
    """
    from rich.box import SIMPLE
    from rich.table import Table
    from rich.text import Text

    body = [[_cell(value) for value in row] for row in rows]
    raw = Table(box=SIMPLE, pad_edge=False)
    for i, column in enumerate(columns):
        numeric = bool(body) and all(_is_number(row[i]) for row in body)
        raw.add_column(
            column,
            justify="right" if numeric else "left",
            overflow="fold",
            no_wrap=column != (wraps or columns[-1]),
        )
    for row in body:
        raw.add_row(*(Text(value) for value in row))
    console().print(title, style="bold", markup=False)
    console().print(raw)


def number(value: float | None, digits: int = 6) -> str:
    """A number in at most `digits` significant digits; a dash for none."""
    return "–" if value is None else f"{value:.{digits}g}"


def seconds(value: float) -> str:
    """A duration with its unit."""
    return f"{value * 1e3:.1f} ms" if value < 1 else f"{value:.2f} s"


def _cell(value: object) -> str:
    if isinstance(value, float):
        return number(value)
    return "–" if value is None else str(value)


def _is_number(text: str) -> bool:
    return text in ("–", "") or text.replace(".", "", 1).replace("-", "", 1).isdigit()
