"""Writing programs in LP format, in the part of it that all readers know."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np

from ...arrays import Floats
from .written import Written, digits

WIDEST = 100
"""Characters of a line, where names allow; some readers take no more than 255."""


def as_lp(program: Written) -> str:
    """The text of an LP file."""
    return "\n".join(_lines(program)) + "\n"


def _lines(program: Written) -> Iterator[str]:
    names, matrix = program.columns, program.matrix
    yield f"\\ {program.title}"
    yield "Maximize" if program.maximise else "Minimize"
    # All variables, so that they are read in their order, and none is unknown.
    yield from _wrapped(" obj:", _terms(program.cost, names))
    yield "Subject To"
    for i, ((first, last), name) in enumerate(
        zip(pairwise(matrix.indptr.tolist()), program.rows, strict=True)
    ):
        columns = [names[j] for j in matrix.indices[first:last]]
        values = matrix.data[first:last]
        terms = _terms(values, columns) if columns else [f"0 {names[0]}"]
        side = f"{program.relation[i]} {digits(program.side[i])}"
        yield from _wrapped(f" {name}:", [*terms, side])
    yield "Bounds"
    binary = [
        integer and (low, high) == (0.0, 1.0)
        for integer, low, high in zip(program.integer, program.lower, program.upper, strict=True)
    ]
    for j, name in enumerate(names):
        if not binary[j]:
            yield from _bounds(name, program.lower[j], program.upper[j])
    for title, chosen in (
        ("Generals", [i and not b for i, b in zip(program.integer, binary, strict=True)]),
        ("Binaries", binary),
    ):
        if any(chosen):
            yield title
            yield from (f" {name}" for name, is_one in zip(names, chosen, strict=True) if is_one)
    yield "End"


def _terms(values: Floats, names: Iterable[str]) -> Iterator[str]:
    signs = ("", "- ")
    for value, name in zip(values.tolist(), names, strict=True):
        factor = "" if abs(value) == 1 else f"{digits(abs(value))} "
        yield f"{signs[value < 0]}{factor}{name}"
        signs = ("+ ", "- ")


def _wrapped(first: str, words: Iterable[str]) -> Iterator[str]:
    line = first
    for word in words:
        if len(line) + len(word) >= WIDEST and line.strip():
            yield line
            line = " "
        line += f" {word}"
    yield line


def _bounds(name: str, low: float, high: float) -> Iterator[str]:
    if low == high:
        yield f" {name} = {digits(low)}"
    elif low == -np.inf:
        yield f" {name} free" if high == np.inf else f" -inf <= {name} <= {digits(high)}"
    elif high != np.inf:
        yield f" {digits(low)} <= {name} <= {digits(high)}"
    elif low:
        yield f" {name} >= {digits(low)}"
