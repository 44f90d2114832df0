"""Reading and writing maps in the MovingAI formats (``.map`` grids and ``.scen`` scenarios).

Source: N. Sturtevant, "Benchmarks for grid-based pathfinding" (2012).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError
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
    if not rows or not rows[0]:
        raise InputError("the map is empty; give at least one row of one cell", field="rows")
    width = len(rows[0])
    for i, row in enumerate(rows):
        if len(row) != width:
            raise InputError(
                f"{len(row)} cells where row 0 has {width}; all rows must be equally long",
                field=f"rows[{i}]",
            )
        for j, char in enumerate(row):
            if char not in FREE + BLOCKED:
                raise InputError(
                    f"unknown map character {char!r}; free cells are {' '.join(FREE)}"
                    f" and blocked ones {' '.join(BLOCKED)}",
                    field=f"rows[{i}][{j}]",
                )
    free = np.array([[char in FREE for char in row] for row in rows], dtype=bool)
    return GridMap(free, name=name, source=source)


def read_map(path: str | Path) -> GridMap:
    """Read a ``.map`` file.

    Raises
    ------
    InputError
        If the file is missing, its header is wrong, or its grid does not match the header.
    """
    path = Path(path)
    lines = read_text(path).splitlines()
    try:
        at = lines.index("map")
    except ValueError:
        raise InputError("no line 'map' before the grid", field="header", file=path) from None
    header = dict(line.split(maxsplit=1) for line in lines[:at] if len(line.split()) > 1)
    rows = lines[at + 1 :]
    while rows and not rows[-1].strip():
        rows.pop()
    try:
        grid = grid_from_rows(rows, name=path.stem, source=path)
    except InputError as error:
        raise error.within(path) from None
    for key, actual in zip(("height", "width"), grid.shape, strict=True):
        if header.get(key, "").strip() != str(actual):
            raise InputError(
                f"{header.get(key, 'missing')!r} where the grid has {actual}", field=key, file=path
            )
    return grid


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
    for number, line in enumerate(read_text(path).splitlines(), start=1):
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
