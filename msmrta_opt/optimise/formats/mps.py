"""Writing programs in free MPS format, laid out so that readers of the fixed format find the fields.

A maximisation is written as the minimisation of its negated costs, since readers differ in whether
they know the section ``OBJSENSE``; a comment says so, by which `read_mps` turns it back.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .written import Written, digits

NEGATED = "* A maximisation: the costs are negated, minimise them."
OBJECTIVE = "obj"
TYPES = {"<=": "L", ">=": "G", "=": "E"}


def as_mps(program: Written) -> str:
    """The text of an MPS file."""
    return "\n".join(_lines(program)) + "\n"


def _lines(program: Written) -> Iterator[str]:
    if program.maximise:
        yield NEGATED
    yield f"NAME          {program.title}"
    yield "ROWS"
    yield f" N  {OBJECTIVE}"
    for name, relation in zip(program.rows, program.relation, strict=True):
        yield f" {TYPES[relation]}  {name}"
    yield "COLUMNS"
    yield from _columns(program)
    yield "RHS"
    for name, side in zip(program.rows, program.side, strict=True):
        if side:
            yield _fields("RHS", name, side)
    yield "BOUNDS"
    for j, name in enumerate(program.columns):
        for kind, value in _bounds(program.lower[j], program.upper[j], program.integer[j]):
            yield _fields("BOUND", name, value, kind)
    yield "ENDATA"


def _columns(program: Written) -> Iterator[str]:
    by_column = program.matrix.tocsc()
    cost = np.negative(program.cost) + 0.0 if program.maximise else program.cost
    within = False
    for j, (name, integer) in enumerate(zip(program.columns, program.integer, strict=True)):
        if integer != within:
            within = integer
            yield f"    MARKER                 'MARKER'                 '{_marker(integer)}'"
        at = slice(by_column.indptr[j], by_column.indptr[j + 1])
        # A column must be somewhere to exist.
        if cost[j] or at.start == at.stop:
            yield _fields(name, OBJECTIVE, cost[j])
        for i, value in zip(by_column.indices[at].tolist(), by_column.data[at], strict=True):
            yield _fields(name, program.rows[i], value)
    if within:
        yield f"    MARKER                 'MARKER'                 '{_marker(False)}'"


def _marker(integer: bool) -> str:
    return "INTORG" if integer else "INTEND"


def _bounds(low: float, high: float, integer: bool) -> Iterator[tuple[str, float | None]]:
    """The kinds of bounds of a variable, with their values, that all readers take alike.

    Those of integer ones are always written, as readers have their own for them.
    """
    if low == high:
        yield "FX", low
        return
    if low == -np.inf:
        yield "FR" if high == np.inf else "MI", None
    elif low != 0 or high < 0:
        yield "LO", low
    if high != np.inf:
        yield "UP", high
    elif integer and low != -np.inf:
        yield "PL", None


def _fields(first: str, second: str, value: float | None, kind: str = "") -> str:
    number = "" if value is None else f"  {digits(value):>12}"
    return f" {kind:<2} {first:<8}  {second:<8}{number}".rstrip()
