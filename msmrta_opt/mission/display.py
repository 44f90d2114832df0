"""How results show themselves in a notebook: a heading, and tables in plain HTML."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence

MAX_ROWS = 30
"""Of a table; of a longer one the first are shown, and how many there are."""


def page(heading: str, *parts: str) -> str:
    """A heading and what stands below it."""
    return "\n".join([f"<p><strong>{html.escape(heading)}</strong></p>", *filter(None, parts)])


def paragraph(text: str) -> str:
    """A paragraph of plain text; nothing for an empty one."""
    return f"<p>{html.escape(text)}</p>" if text else ""


def table(caption: str, rows: Sequence[Mapping[str, object]], *, maximum: int = MAX_ROWS) -> str:
    """The rows as a table, its columns the keys of the first; nothing if there are none."""
    if not rows:
        return ""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in rows[0])
    body = [f"<tr>{''.join(map(_cell, row.values()))}</tr>" for row in rows[:maximum]]
    more = f" (the first {maximum} of {len(rows)})" if len(rows) > maximum else ""
    return "\n".join(
        [
            "<table>",
            f"<caption>{html.escape(caption + more)}</caption>",
            f"<thead><tr>{head}</tr></thead>",
            "<tbody>",
            *body,
            "</tbody>",
            "</table>",
        ]
    )


def short(value: object) -> str:
    """A value in a few characters: six digits of a number, a dash for none."""
    if value is None:
        return "–"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)) and not isinstance(value, str):
        return ", ".join(map(short, value))
    return str(value)


def listed(values: Iterable[object], maximum: int = 8) -> str:
    """The first of `values`, and how many more there are."""
    every = [short(value) for value in values]
    more = f" and {len(every) - maximum} more" if len(every) > maximum else ""
    return ", ".join(every[:maximum]) + more


def counted(number: int, noun: str) -> str:
    """``1 robot``, ``4 robots``."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


def _cell(value: object) -> str:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    align = ' style="text-align: right"' if is_number else ' style="text-align: left"'
    return f"<td{align}>{html.escape(short(value))}</td>"
