"""Places of robots and victims: by cell or in metres, from a CSV file or typed."""

from __future__ import annotations

import csv
import io
import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path

from .errors import InputError, all_of, at, shown
from .files import read_text
from .grid import Cell, GridMap
from .validation import said_of

SPOT = ("x", "y", "row", "col")


class Row(dict[str, str]):
    """Values of a row of a file, and where it stands."""

    def __init__(self, values: Mapping[str, str], file: str | Path, line: int) -> None:
        super().__init__(values)
        self.file, self.line = file, line


def in_its_row(error: InputError, row: Mapping[str, str], field: str = "") -> InputError | None:
    """`error`, said of the line and column of a file that `row` comes from; none if from no file."""
    if not isinstance(row, Row):
        return None
    line = f"line {row.line}" + (f", {field}" if field else "")
    return InputError(error.problem, field=line, file=row.file)


def read_places(path: str | Path, fields: Sequence[str]) -> list[Row]:
    """The rows of a CSV file with a header; empty values are left out.

    Parameters
    ----------
    path : str or path
        Comma- or semicolon-separated, as its header is.
    fields : sequence of str
        The columns that there may be, beside those of a place, `SPOT`.

    Raises
    ------
    InputError
        If the file cannot be read, a column is unknown or given twice, a row has too many values, or
        there is none.
    """
    text = read_text(path)
    first = text.partition("\n")[0]
    reader = csv.reader(
        io.StringIO(text),
        delimiter=";" if first.count(";") > first.count(",") else ",",
        skipinitialspace=True,
        strict=True,
    )
    try:
        rows = [(reader.line_num, [value.strip() for value in row]) for row in reader]
    except csv.Error as error:
        raise InputError(
            f"broken CSV: {error}", field=f"line {reader.line_num}", file=path
        ) from None
    header = rows[0][1] if rows else []
    if not any(header):
        raise InputError("no header; name the columns in the first line", file=path)
    known = (*SPOT, *fields)
    for i, column in enumerate(header):
        if column not in known:
            raise InputError(
                f"unknown column {shown(column)}; known: {', '.join(known)}",
                field="line 1",
                file=path,
            )
        if column in header[:i]:
            raise InputError(f"column {column!r} is given twice", field="line 1", file=path)
    found = []
    for line, row in rows[1:]:
        if len(row) > len(header):
            raise InputError(
                f"{len(row)} values for {len(header)} columns", field=f"line {line}", file=path
            )
        if any(row):
            values = {key: value for key, value in zip(header, row, strict=False) if value}
            found.append(Row(values, path, line))
    if not found:
        raise InputError("no row below the header; give one for each place", file=path)
    return found


def typed_place(text: str, fields: Sequence[str]) -> dict[str, str]:
    """A place as typed: ``x=2.5,y=1,needs=…``; of `fields`, or of `SPOT`.

    Raises
    ------
    InputError
        If a part is not ``name=value``, or its name is unknown or given twice.
    """
    found: dict[str, str] = {}
    for part in text.split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or name not in (*SPOT, *fields):
            raise InputError(f"{shown(part)}; give name=value of {', '.join((*SPOT, *fields))}")
        if name in found:
            raise InputError(f"{name!r} is given twice")
        found[name] = value
    return found


def cell_of(values: Mapping[str, str], grid: GridMap, *, snap: float = 0.0) -> Cell:
    """The free cell of a place, given by ``row`` and ``col`` or by ``x`` and ``y`` in metres.

    Parameters
    ----------
    values : mapping
        As `read_places` gives them.
    grid : GridMap
        The map; it needs a frame for metres.
    snap : float
        Metres by which a place in a wall may be moved, to where a robot in the nearest free cell stands.

    Raises
    ------
    InputError
        If the place is given in neither way or in both, or no free cell is as near.
    """
    given = [name for name in SPOT if name in values]
    if given == ["row", "col"]:
        cell = _whole(values, "row"), _whole(values, "col")
        if not grid.is_free(cell):
            raise InputError(f"row {cell[0]}, col {cell[1]} is {grid.trouble(cell)}")
        return cell
    if given != ["x", "y"]:
        raise InputError(f"has {', '.join(given) or 'no place'}; give x and y, or row and col")
    if grid.frame is None:
        raise InputError("x and y need a map with a frame; give row and col")
    x, y = number(values, "x"), number(values, "y")
    cell = grid.frame.cell(x, y)
    if grid.is_free(cell):
        return cell
    spot = grid.frame.spot(x, y)
    trouble = grid.trouble(cell, spot)
    nearest = grid.nearest_free(spot)
    if snap > 0 and nearest is not None:
        at_x, at_y = grid.frame.position(nearest)
        if ((at_x - x) ** 2 + (at_y - y) ** 2) ** 0.5 <= snap:
            return nearest
    raise InputError(f"x {x:g}, y {y:g} is {trouble}")


def number(values: Mapping[str, str], name: str) -> float:
    """The number in `values` of this name.

    Raises
    ------
    InputError
        If it is none.
    """
    try:
        return float(values[name])
    except ValueError:
        raise InputError(f"{shown(values[name])}; give a number", field=name) from None


def _whole(values: Mapping[str, str], name: str) -> int:
    if not (values[name].isascii() and values[name].isdigit() and len(values[name]) < 10):
        raise InputError(f"{shown(values[name])}; give a whole number, 0 or more", field=name)
    return int(values[name])


def names_in(values: Mapping[str, str], name: str) -> list[str]:
    """The names in a value, between ``+``, ``;``, ``,`` or spaces."""
    text = values.get(name, "")
    for mark in "+;,":
        text = text.replace(mark, " ")
    return text.split()


def with_ids(rows: Sequence[Mapping[str, str]], group: str) -> list[int]:
    """The ids of `rows`, whole numbers; who has none gets the next that is free.

    Raises
    ------
    InputError
        If an id is not a whole number or repeated, naming its place in `group`; `MistakesError` of
        several mistakes.
    """
    given: list[int | None] = []
    wrong = []
    for i, row in enumerate(rows):
        try:
            identity = _whole(row, "id") if "id" in row else None
            if identity is not None and identity in given:
                raise InputError(f"{identity} is repeated; ids differ within a group", field="id")
            given.append(identity)
        except InputError as error:
            wrong.append(said_of(at(group, i), error))
            given.append(None)
    if wrong:
        raise all_of(wrong)
    taken = {one for one in given if one is not None}
    following = (i for i in itertools.count() if i not in taken)
    return [next(following) if one is None else one for one in given]
