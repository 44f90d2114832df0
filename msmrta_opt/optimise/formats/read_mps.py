"""Reading programs in MPS format, free or fixed.

Fields are told apart by blanks, so names have none. What readers are known to differ in is refused;
see `Draft` for bounds. Entries of a variable may stand apart, but none twice. The constant of the
objective is the negative of its right-hand side, and an integer variable without any bound is binary,
as most readers have it. Rows of type ``N`` after the first have no effect.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from ...mission.errors import InputError, shown
from ..program import Program, Sense
from .draft import Column, Draft, Row, limit, number
from .mps import NEGATED

_SENSES: dict[str, Sense] = {"MAX": "max", "MAXIMIZE": "max", "MIN": "min", "MINIMIZE": "min"}
_INFINITE = {"inf": math.inf, "infinity": math.inf}
_NO_SIDE = (("L", True), ("G", False))
_NO_VALUE = ("FR", "MI", "PL", "BV")


def read_mps(text: str) -> Program:
    """The program in the text of an MPS file.

    Raises
    ------
    InputError
        Naming the line, what is wrong with it and what would be right.
    """
    reader = _Reader()
    for number_, line in enumerate(text.split("\n"), start=1):
        try:
            reader.line(line)
        except InputError as error:
            raise InputError(error.problem, field=f"line {number_}") from None
    return reader.program()


class _Reader:
    def __init__(self) -> None:
        self.draft = Draft()
        self.section = ""
        self.seen: set[str] = set()
        self.sets: dict[str, str] = {}
        self.objective: str | None = None
        self.without_effect: set[str] = set()
        self.kinds: dict[str, str] = {}
        self.sides: dict[str, float] = {}
        self.ranges: dict[str, float] = {}
        self.entries: set[tuple[str, str]] = set()
        self.integer = False
        self.negated = False
        self.sections: dict[str, Callable[[list[str]], None]] = {
            "OBJSENSE": self.sense,
            "ROWS": self.row,
            "COLUMNS": self.column,
            "RHS": self.side,
            "RANGES": self.range,
            "BOUNDS": self.bound,
        }

    def line(self, line: str) -> None:
        if line.startswith("*") or not line.strip():
            self.negated = self.negated or line.rstrip() == NEGATED
            return
        if self.section == "ENDATA":
            raise InputError(f"{shown(line)} after ENDATA; one program a file")
        fields = line.split()
        for field in fields:
            if field.startswith("$"):
                raise InputError("a remark behind fields; give it a line that begins with *")
        if not line[0].isspace():
            self.begin(fields)
        elif self.section in self.sections:
            self.sections[self.section](fields)
        else:
            raise InputError(f"{shown(line)} in no section; the first is NAME, then ROWS")

    def begin(self, fields: list[str]) -> None:
        section, *more = fields
        if section not in (*self.sections, "NAME", "ENDATA"):
            raise InputError(
                f"{shown(section)} is no section of a linear program; known are NAME, "
                f"{', '.join(self.sections)} and ENDATA, and lines of data begin with a blank"
            )
        if section in self.seen:
            raise InputError(f"a second section {section}; give one")
        if more and section not in ("NAME", "OBJSENSE"):
            raise InputError(f"{shown(' '.join(more))} behind {section}; give it a line of its own")
        self.seen.add(section)
        self.section = section
        if section == "OBJSENSE" and more:
            self.sense(more)

    def sense(self, fields: list[str]) -> None:
        sense = _SENSES.get(" ".join(fields).upper())
        if sense is None or self.negated:
            raise InputError(f"{shown(' '.join(fields))}; give MAX or MIN, once")
        if self.sets.setdefault("OBJSENSE", sense) != sense:
            raise InputError("a second sense; give one")
        self.draft.sense = sense

    def row(self, fields: list[str]) -> None:
        if len(fields) != 2 or fields[0] not in ("N", "L", "G", "E"):
            raise InputError(
                f"{shown(' '.join(fields))}; give N, L, G or E and a name without blanks"
            )
        kind, name = fields
        if name in self.kinds:
            raise InputError(f"a second row {shown(name)}; names differ")
        self.kinds[name] = kind
        if kind != "N":
            self.draft.rows[name] = Row()
        elif self.objective is None:
            self.objective = name
        else:
            self.without_effect.add(name)

    def column(self, fields: list[str]) -> None:
        if len(fields) == 3 and fields[1] == "'MARKER'":
            if fields[2] not in ("'INTORG'", "'INTEND'"):
                raise InputError(f"marker {fields[2]}; give a linear program, 'INTORG' or 'INTEND'")
            self.integer = fields[2] == "'INTORG'"
            return
        name, pairs = fields[0], self.pairs(fields[1:])
        column = self.draft.columns.setdefault(name, Column(integer=self.integer))
        if column.integer != self.integer:
            raise InputError(
                f"variable {shown(name)} is both within and outside the integer markers"
            )
        for row, value in pairs:
            if (name, row) in self.entries:
                raise InputError(f"a second coefficient of {shown(name)} in {shown(row)}; give one")
            self.entries.add((name, row))
            if row == self.objective:
                column.cost = value
            elif row not in self.without_effect and value:
                self.draft.rows[row].terms[name] = value

    def side(self, fields: list[str]) -> None:
        self.once(self.sides, fields)

    def range(self, fields: list[str]) -> None:
        self.once(self.ranges, fields)

    def once(self, values: dict[str, float], fields: list[str]) -> None:
        """Take the values of rows, behind the name of their set where they have one."""
        if len(fields) % 2:
            self.one_set(fields.pop(0))
        for row, value in self.pairs(fields):
            if row in values:
                raise InputError(f"a second value of {shown(row)} in {self.section}; give one")
            values[row] = value

    def one_set(self, name: str) -> None:
        if self.sets.setdefault(self.section, name) != name:
            raise InputError(
                f"{shown(name)} is a second set of {self.section}; give one, for readers differ"
            )

    def pairs(self, fields: list[str]) -> list[tuple[str, float]]:
        if len(fields) not in (2, 4):
            raise InputError(
                f"{len(fields)} fields where one or two rows with a number each should be; "
                "names have no blanks"
            )
        for row in fields[::2]:
            if row not in self.kinds:
                raise InputError(f"unknown row {shown(row)}; rows are listed in ROWS")
        return [(row, number(text)) for row, text in zip(fields[::2], fields[1::2], strict=True)]

    def bound(self, fields: list[str]) -> None:
        kind, *rest = fields
        if kind not in ("UP", "LO", "FX", "LI", "UI", *_NO_VALUE):
            raise InputError(f"bound {shown(kind)}; give UP, LO, FX, FR, MI, PL, BV, LI or UI")
        known = [
            place
            for place in (0, 1)
            if rest[place : place + 1] and rest[place] in self.draft.columns
        ]
        values = 0 if kind in _NO_VALUE else 1
        # The set's name may be left out, and a value that says nothing be there.
        fits = [at for at in known if len(rest) - at - 1 in (values, 1)]
        if len(fits) != 1:
            raise InputError(
                f"{shown(' '.join(fields))}; give the kind of bound, the set's name, a variable of "
                f"COLUMNS{' and a number' * values}"
            )
        at = fits[0]
        if at:
            self.one_set(rest[0])
        column, given = self.draft.columns[rest[at]], rest[at + 1 :]
        value = self.limit(given[0]) if given else 0.0
        if kind in _NO_VALUE:
            if value not in (0.0, 1.0):
                raise InputError(f"{kind} with the value {given[0]}; it takes none")
            column.binary = column.binary or kind == "BV"
        low = {"LO": value, "LI": value, "FX": value, "FR": -math.inf, "MI": -math.inf}.get(kind)
        high = {"UP": value, "UI": value, "FX": value, "FR": math.inf, "PL": math.inf}.get(kind)
        column.integer = column.integer or kind in ("BV", "LI", "UI")
        column.lower = _agreed(column.lower, low)
        column.upper = _agreed(column.upper, high)

    def limit(self, text: str) -> float:
        sign = -1.0 if text.startswith("-") else 1.0
        infinite = _INFINITE.get(text.lstrip("+-").lower())
        return limit(number(text)) if infinite is None else sign * infinite

    def program(self) -> Program:
        if self.section != "ENDATA":
            raise InputError("no ENDATA; the file is cut off")
        if self.objective is None:
            raise InputError("no row of type N, which is the objective", field="ROWS")
        if "COLUMNS" not in self.seen:
            raise InputError("no section COLUMNS")
        draft = self.draft
        draft.offset = 0.0 - self.sides.get(self.objective, 0.0)
        for name, row in draft.rows.items():
            side, spread = limit(self.sides.get(name, 0.0)), self.ranges.get(name)
            try:
                row.lower, row.upper = _sides(self.kinds[name], side, spread)
            except InputError as error:
                raise InputError(error.problem, field=f"row {name}") from None
        for name in self.ranges:
            if self.kinds[name] == "N":
                raise InputError("of type N, with a range; give it none", field=f"row {name}")
        for column in draft.columns.values():
            if column.integer and column.lower is None and column.upper is None:
                column.binary = True
            if self.negated:
                column.cost = 0.0 - column.cost
        if self.negated:
            draft.sense, draft.offset = "max", 0.0 - draft.offset
        return draft.program()


def _agreed(old: float | None, new: float | None) -> float | None:
    """A bound that was `old`, now that it is `new`; one that is given twice is no better than none."""
    if old is None or new is None or math.isinf(old):
        return old if new is None else new
    if old != new:
        raise InputError(
            f"bound {new:g} where {old:g} was given before; give one, for readers differ"
        )
    return old


def _sides(kind: str, side: float, spread: float | None) -> tuple[float, float]:
    """The minimum and the maximum activity of a row."""
    if math.isinf(side) and (spread is not None or (kind, side > 0) not in _NO_SIDE):
        raise InputError(f"side {side:g}; give one that a number can meet")
    if spread is None:
        return -math.inf if kind == "L" else side, math.inf if kind == "G" else side
    if kind == "L":
        return side - abs(spread), side
    if kind == "G":
        return side, side + abs(spread)
    return (side, side + spread) if spread >= 0 else (side + spread, side)
