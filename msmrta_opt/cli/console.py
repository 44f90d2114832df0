"""How the command line shows things: one console, plain tables, short numbers, and JSON.

Every command that prints a table takes ``--json FILE``, and writes there what it is made of, as one
document: a list of records, one a row, or an object where there is more than one list. ``-`` is standard
output, which then holds nothing else. Ids are numbers, what is not known is null.
"""

from __future__ import annotations

import json
import math
import sys
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..mission.counting import in_full

if TYPE_CHECKING:
    from rich.console import Console

STANDARD_OUTPUT = Path("-")

WIDTH_OF_FILES = 10_000
"""Columns where the output is not a terminal: as many as any table takes."""
NARROWEST, MAX_LINES = 12, 6
"""Columns of a terminal that a text is given at least, and lines that a row takes at most, before a
table becomes a list of records."""
INDENT = "  "
BETWEEN = 3
"""Columns between two of a table's."""


_only_json: ContextVar[bool] = ContextVar("only_json", default=False)
"""Whether standard output is to hold JSON alone."""


def console() -> Console:
    """The console that all commands print to; where it is no terminal, lines are never broken."""
    return _console(_only_json.get())


@cache
def _console(quiet: bool) -> Console:
    from rich.console import Console

    width = None if sys.stdout is not None and sys.stdout.isatty() else WIDTH_OF_FILES
    return Console(width=width, highlight=False, quiet=quiet)


def json_asked(path: Path | None) -> Path | None:
    """What ``--json`` is given; for standard output, everything else that is printed is left out."""
    _only_json.set(path == STANDARD_OUTPUT)
    return path


Json = Annotated[
    Path | None,
    typer.Option(
        "--json",
        help="Write the result here, as JSON; - for standard output, and nothing else there.",
        callback=json_asked,
        metavar="FILE",
    ),
]


_unwritten: ContextVar[list[Exception] | None] = ContextVar("unwritten", default=None)
"""Why files of the command that runs were not written."""


@contextmanager
def put_off() -> Iterator[list[Exception]]:
    """Within it `writing` keeps why a file is not written, in the list that is given, and goes on."""
    failures: list[Exception] = []
    before = _unwritten.set(failures)
    try:
        yield failures
    finally:
        _unwritten.reset(before)


@contextmanager
def writing(what: str, file: Path) -> Iterator[None]:
    """Write `file` within it; then `what` is said to be written, where that is not empty.

    Where it cannot be written, that is said once the command has ended: other files are written and
    tables shown all the same.
    """
    from ..mission.errors import InputError

    failures = _unwritten.get()
    try:
        yield
    except (InputError, OSError) as error:
        if failures is None:
            raise
        failures.append(error)
    else:
        if what:
            say(f"{what} written to {file}")


def write_json(path: Path | None, document: object, *, what: str = "") -> None:
    """Write a document where ``--json`` asks for it, and say so of `what` in a file."""
    from ..mission.files import write_text

    if path is None:
        return
    text = json.dumps(_plain(document), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    if path == STANDARD_OUTPUT:
        sys.stdout.write(text)
        return
    with writing(what, path):
        write_text(path, text)


def _plain(value: Any) -> Any:
    """The value as JSON has it: numbers that are not finite are null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


def say(text: str = "") -> None:
    """Print a line."""
    console().print(text, markup=False, soft_wrap=True)


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Print a table, its first column what a row is of; columns of numbers are aligned to the right.

    Where the width does not suffice, texts are broken between words, so that no row takes more lines
    than it must; names and numbers never are. Where a row would take more than `MAX_LINES`, there is
    one record below another.
    """
    body = [[_cell(value) for value in row] for row in rows]
    numeric = [bool(body) and all(_is_number(row[i]) for row in body) for i in range(len(columns))]
    widths = _widths(columns, body, numeric)
    console().print(title, style="bold", markup=False)
    if widths is None:
        _print_records(columns, body)
    else:
        _print_columns(columns, body, numeric, widths)


def _widths(
    columns: Sequence[str], body: Sequence[Sequence[str]], numeric: Sequence[bool]
) -> list[int] | None:
    """Columns of the terminal for each of the table's; ``None`` if they do not fit."""
    from rich.cells import cell_len

    room = console().width - BETWEEN * len(columns)
    cells = [dict.fromkeys([column, *(row[i] for row in body)]) for i, column in enumerate(columns)]
    widest = [max(map(cell_len, texts)) for texts in cells]
    for lines in range(1, MAX_LINES + 1):
        widths = [
            width if numeric[i] else min(width, _width_for(cells[i], lines))
            for i, width in enumerate(widest)
        ]
        spare = room - sum(widths)
        if spare >= 0:
            for i, width in enumerate(widest):
                more = min(width - widths[i], spare)
                widths[i] += more
                spare -= more
            return widths
    return None


def _width_for(texts: Iterable[str], lines: int) -> int:
    """The least width at which each text takes no more than so many lines, no word broken."""
    from rich.cells import cell_len

    width = NARROWEST
    for text in texts:
        words = [cell_len(word) for word in text.split()]
        width = max([width, *words])
        if _lines(words, width) > lines:
            wider = range(width + 1, sum(words) + len(words))
            width = wider[bisect_left(wider, -lines, key=lambda w: -_lines(words, w))]
    return width


def _lines(words: Sequence[int], width: int) -> int:
    """The lines that words of those lengths take."""
    lines, used = 1, 0
    for length in words:
        if used and used + 1 + length > width:
            lines, used = lines + 1, 0
        used += length + (1 if used else 0)
    return lines


def _print_columns(
    columns: Sequence[str],
    body: Sequence[Sequence[str]],
    numeric: Sequence[bool],
    widths: Sequence[int],
) -> None:
    # A table of rich looks the same, and takes longer for thousands of rows than to plan them.
    side, between, n = " ", " " * BETWEEN, len(columns)
    whole = sum(widths) + BETWEEN * (n - 1)
    empty, rule = side + " " * whole + side, side + "─" * whole + side

    def lines_of(row: Sequence[str], *, is_head: bool = False) -> Iterator[str]:
        broken = [_broken(value, width) for value, width in zip(row, widths, strict=True)]
        if is_head:  # stands on the rule
            most = max(map(len, broken))
            broken = [[""] * (most - len(lines)) + lines for lines in broken]
        for parts in zip_longest(*broken, fillvalue=""):
            told = [
                _padded(part, width, is_number)
                for part, width, is_number in zip(parts, widths, numeric, strict=True)
            ]
            yield side + between.join(told) + side

    say(empty)
    head = "\n".join(lines_of(columns, is_head=True))
    console().print(head, style="bold", markup=False, soft_wrap=True)
    say("\n".join([rule, *(line for row in body for line in lines_of(row)), empty]))


def _broken(text: str, width: int) -> list[str]:
    """The lines of a text at a width, broken between words, and within those that are longer."""
    from rich.cells import cell_len
    from rich.control import strip_control_codes
    from rich.text import Text

    text = strip_control_codes(text)
    if cell_len(text) <= width and "\n" not in text and "\t" not in text:
        return [text]
    return [line.plain for line in Text(text).wrap(console(), width, overflow="fold")]


def _padded(text: str, width: int, to_the_right: bool) -> str:
    from rich.cells import cell_len

    space = " " * (width - cell_len(text))
    return space + text if to_the_right else text + space


def _print_records(columns: Sequence[str], body: Sequence[Sequence[str]]) -> None:
    """One row below another: its values in their order, as many in a line as fit."""
    from rich.cells import cell_len

    width = console().width
    say()
    for row in body:
        line = ""
        for column, value in zip(columns, row, strict=True):
            told = f"{column}: {value}"
            if not value:
                continue
            if line.strip() and cell_len(line) + BETWEEN + cell_len(told) > width:
                say(line)
                line = INDENT
            line += (" " * BETWEEN if line.strip() else "") + told
            while cell_len(line) > width:
                first = len(line) - len(line.lstrip())
                end = line.rfind(" ", first, width)
                if end < 0:  # a word that is longer than the line
                    end = line.find(" ", first)
                if end < 0:
                    break
                say(line[:end])
                line = 2 * INDENT + line[end:].lstrip()
        say(line)
        say()


def number(value: float | None, digits: int = 6) -> str:
    """A number in `digits` significant digits, as `in_full`; a dash for none."""
    return "–" if value is None else in_full(value, digits)


def seconds(value: float) -> str:
    """A duration with its unit."""
    return f"{value * 1e3:.1f} ms" if value < 1 else f"{value:.2f} s"


def _cell(value: object) -> str:
    if isinstance(value, float):
        return number(value)
    return "–" if value is None else str(value)


def _is_number(text: str) -> bool:
    if text in ("–", ""):
        return True
    try:
        float(text)
    except ValueError:
        return False
    return True
