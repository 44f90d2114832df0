"""A program as it is being read: variables and rows by name, put together at the end."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from ...mission.errors import InputError, shown
from ..program import INFINITE, Block, Program, Sense
from .written import CONSTANT, ENDINGS, NO_ROWS

NUMBER = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
"""A number without its sign, in the notation that both formats share."""


@dataclass
class Column:
    """A variable; a bound that was not given is ``None``."""

    cost: float = 0.0
    lower: float | None = None
    upper: float | None = None
    integer: bool = False
    binary: bool = False

    def bounds(self) -> tuple[float, float]:
        """The minimum and the maximum.

        Raises
        ------
        InputError
            If readers do not agree on them.
        """
        low = 0.0 if self.lower is None else self.lower
        high = (1.0 if self.binary else math.inf) if self.upper is None else self.upper
        if self.binary and not (low >= 0 and high <= 1):
            raise InputError(
                f"binary, with bounds {low:g} and {high:g}; readers differ, give it bounds within "
                "0 and 1, or make it a general integer"
            )
        if self.lower is None and high < 0:
            raise InputError(
                f"upper bound {high:g} without a lower one; readers differ, give the lower bound"
            )
        if low == math.inf or high == -math.inf:
            raise InputError(f"bounds {low:g} and {high:g}; give bounds that a number can meet")
        return low, high


@dataclass
class Row:
    """A row, its coefficients by variable."""

    terms: dict[str, float] = field(default_factory=dict)
    lower: float = -math.inf
    upper: float = math.inf


@dataclass
class Draft:
    """What has been read so far."""

    sense: Sense = "min"
    offset: float = 0.0
    columns: dict[str, Column] = field(default_factory=dict)
    rows: dict[str, Row] = field(default_factory=dict)

    def program(self) -> Program:
        """The program, without what `written` has put in for other readers.

        Raises
        ------
        InputError
            If readers do not agree on the bounds of a variable.
        """
        rows = _joined(self.rows)
        columns = dict(self.columns)
        used = {name for row in rows.values() for name in row.terms}
        offset = self.offset
        constant = columns.get(CONSTANT)
        if constant and CONSTANT not in used and (constant.lower, constant.upper) == (1.0, 1.0):
            offset += columns.pop(CONSTANT).cost
        place = {name: j for j, name in enumerate(columns)}
        bounds = [_within(name, column) for name, column in columns.items()]
        lower, upper = np.array(bounds, dtype=float).reshape(-1, 2).T
        terms = [(place[name], value) for row in rows.values() for name, value in row.terms.items()]
        indices, values = np.array(terms, dtype=float).reshape(-1, 2).T
        starts = np.cumsum([0, *(len(row.terms) for row in rows.values())])
        return Program(
            sense=self.sense,
            cost=np.array([column.cost for column in columns.values()], dtype=float),
            offset=offset,
            matrix=csr_array(
                (values, indices.astype(np.int32), starts), shape=(len(rows), len(columns))
            ),
            row_lower=np.array([row.lower for row in rows.values()], dtype=float),
            row_upper=np.array([row.upper for row in rows.values()], dtype=float),
            lower=lower,
            upper=upper,
            integer=np.array([c.integer or c.binary for c in columns.values()], dtype=bool),
            columns=tuple(Block(name, j, ()) for name, j in place.items()),
            rows=tuple(Block(name, i, ()) for i, name in enumerate(rows)),
        )


def number(text: str) -> float:
    """The finite number that `text` is, whatever the locale.

    Raises
    ------
    InputError
        If it is none, or beyond the range of a float.
    """
    found = re.fullmatch(rf"[+-]?{NUMBER}", text)
    value = float(text) if found else math.nan
    if not math.isfinite(value) or (value == 0 and re.search("[1-9]", re.split("[eE]", text)[0])):
        raise InputError(f"{shown(text)}; give a number such as -1.5e3, within a float's range")
    return value


def limit(value: float) -> float:
    """A side of a row, or a bound: of size `INFINITE` it is infinite, as other readers have it."""
    return math.copysign(math.inf, value) if abs(value) >= INFINITE else value


def _within(name: str, column: Column) -> tuple[float, float]:
    try:
        return column.bounds()
    except InputError as error:
        raise InputError(error.problem, field=f"variable {name}") from None


def _joined(rows: dict[str, Row]) -> dict[str, Row]:
    """The rows; two that differ in their sides alone, named by `ENDINGS`, are one with both."""
    joined: dict[str, Row] = {}
    last = ""
    for name, row in rows.items():
        stem = name.removesuffix(ENDINGS[1])
        lower = joined.get(last)
        if (
            last == stem + ENDINGS[0]
            and name == stem + ENDINGS[1]
            and stem not in rows
            and lower is not None
            and lower.terms == row.terms
            and (lower.upper, row.lower) == (math.inf, -math.inf)
        ):
            del joined[last]
            joined[stem] = Row(row.terms, lower.lower, row.upper)
        elif name != NO_ROWS or row.terms:
            joined[name] = row
        last = name
    return joined
