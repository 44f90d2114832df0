"""Reading and writing maps in the MovingAI formats (``.map`` grids and ``.scen`` scenarios).

Source: N. Sturtevant, "Benchmarks for grid-based pathfinding" (2012). Of its terrain, ``.`` and ``G``
are passable, ``S`` is a swamp, which is passable from there; ``@`` and ``O`` are out of bounds, ``T``
are trees, and ``W`` is water, which nobody enters from land.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .counting import counted
from .errors import InputError, shown
from .files import read_text, write_text
from .grid import Cell, GridMap

FREE = ".GS"
BLOCKED = "@OTW"


def grid_from_rows(rows: Sequence[str], *, name: str = "", source: Path | None = None) -> GridMap:
    """A map from its text, one string per row.

    Raises
    ------
    InputError
        If there is no row, rows differ in length, or a character is neither free nor blocked.
    """
    if not any(rows):
        raise InputError("the map is empty; give at least one row of one cell", field="rows")
    width = len(rows[0])
    for i, row in enumerate(rows):
        if len(row) != width:
            raise InputError(
                f"{len(row)} cells where row 0 has {width}; all rows must be equally long",
                field=f"rows[{i}]",
            )
        if unknown := set(row).difference(FREE, BLOCKED):
            j = min(map(row.index, unknown))
            raise InputError(
                f"unknown map character {row[j]!r}; free cells are {' '.join(FREE)}"
                f" and blocked ones {' '.join(BLOCKED)}",
                field=f"rows[{i}][{j}]",
            )
    letters = np.frombuffer("".join(rows).encode("ascii"), dtype=np.uint8).reshape(len(rows), width)
    return GridMap(np.isin(letters, list(FREE.encode())), name=name, source=source)


def read_map(path: str | Path) -> GridMap:
    """Read a ``.map`` file.

    Raises
    ------
    InputError
        If the file is missing, its header is wrong, or its grid does not match the header.
    """
    path = Path(path)
    lines = [line.rstrip() for line in read_text(path).rstrip().split("\n")]
    try:
        header, first = _header(lines)
        rows = lines[first:]
        _, width = header["width"]
        uneven = len(set(map(len, rows))) > 1
        for i, row in enumerate(rows):
            if uneven and len(row) != width:
                raise InputError(
                    f"{counted(len(row), 'cell')}, where the header's width is {width}; correct either",
                    field=f"rows[{i}]",
                )
        grid = grid_from_rows(rows, name=path.stem, source=path)
        for (key, (line, given)), actual in zip(header.items(), grid.shape, strict=True):
            if given != actual:
                raise InputError(
                    f"{key} {given}, where the grid below has {actual}; correct either",
                    field=f"line {line}",
                )
    except InputError as error:
        raise error.within(path) from None
    return grid


def _header(lines: Sequence[str]) -> tuple[dict[str, tuple[int, int]], int]:
    """Height and width, each with the number of its line, and the index of the first row."""
    found: dict[str, tuple[int, int]] = {}
    for number, line in enumerate(lines, start=1):
        key, *values = line.lower().split() or [""]
        if key == "map" and not values:
            for name in ("height", "width"):
                if name not in found:
                    raise InputError("is missing; give it above the line 'map'", field=name)
            return {name: found[name] for name in ("height", "width")}, number
        if key in ("height", "width"):
            if key in found:
                raise InputError(f"a second {key}; give one", field=f"line {number}")
            if len(values) != 1 or not re.fullmatch(r"[0-9]{1,9}", values[0]):
                raise InputError(
                    f"{shown(line)}; give {key} and a whole number", field=f"line {number}"
                )
            found[key] = number, int(values[0])
    # Nothing of the file is shown: it may be any file, and none of the reader's.
    raise InputError(
        "no line 'map' before the grid; give a MovingAI map, whose header is type, height, width, map",
        field="header",
    )


def write_map(grid: GridMap, path: str | Path) -> None:
    """Write `grid` as a ``.map`` file, whole or not at all."""
    n_rows, n_cols = grid.shape
    header = f"type octile\nheight {n_rows}\nwidth {n_cols}\nmap\n"
    write_text(path, header + "\n".join(grid.rows) + "\n")


@dataclass(frozen=True)
class Query:
    """One line of a scenario: a start and a goal, with the published 8-connected length."""

    start: Cell
    goal: Cell
    octile_length: float


def read_scenario(path: str | Path) -> list[Query]:
    """Read a ``.scen`` file (its columns are x then y; here cells are ``(row, col)``)."""
    queries = []
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        parts = line.split()
        if not parts or parts[0] == "version":
            continue
        try:
            # Bucket, map, width and height come before; a map's name may hold spaces.
            if len(parts) < 9:
                raise ValueError("too few columns")
            x0, y0, x1, y1, length = parts[-5:]
            queries.append(Query((int(y0), int(x0)), (int(y1), int(x1)), float(length)))
        except ValueError:
            raise InputError(
                f"{line!r} is not bucket, map, width, height, start x y, goal x y, length",
                field=f"line {number}",
                file=path,
            ) from None
    return queries
