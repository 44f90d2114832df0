"""What is numerically dangerous in a program: numbers that tolerances of solvers slip through.

Solvers call a value whole within 1e-6, and a row satisfied within 1e-6 of its terms. Where numbers
differ by more than that, a solution may be none: a binary variable of 1e-7 times a big-M of 1e9 lets
through 100.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import Ints
from ..optimise.check import TOLERANCE, WIDE
from ..optimise.program import TIGHTENED_FROM, Program

SLIPS = 1e-2
"""Share of another variable's unit from which a tolerance that slips through is told."""
DROPPED = 1e-9
"""Coefficients below this are dropped by solvers."""
TOO_LARGE = 1e15
"""Numbers from this on are refused, or taken for infinite."""
FAR = 1e9
"""Bounds of integers from this on are as good as none."""

MAX = 12
"""Hazards that are told in words."""

Kind = Literal["big-M", "range", "costs", "dropped", "too large", "free integer"]


@dataclass(frozen=True)
class Hazard:
    """One kind of danger in the rows of one label, or in one variable."""

    kind: Kind
    label: str
    """Of the rows; a variable's name for `free integer`, ``objective`` for `costs`."""
    where: str
    """The worst row or variable."""
    text: str
    """What is wrong there, and what would be right."""
    count: int = 1
    """How many rows or variables of the label are so."""


def hazards(program: Program) -> tuple[Hazard, ...]:
    """Everything dangerous in `program`, in the order of `Kind`; one for each label and kind."""
    found: dict[tuple[str, str], list[tuple[float, Hazard]]] = {}
    for size, hazard in (*_rows(program), *_costs(program), *_free(program)):
        found.setdefault((hazard.kind, hazard.label), []).append((size, hazard))
    result = []
    for same in found.values():
        worst = max(same, key=lambda item: item[0])[1]
        result.append(Hazard(worst.kind, worst.label, worst.where, worst.text, len(same)))
    order = ("big-M", "range", "costs", "dropped", "too large", "free integer")
    return tuple(sorted(result, key=lambda hazard: order.index(hazard.kind)))


def hazards_text(found: tuple[Hazard, ...]) -> str:
    """The hazards in words, a line each."""
    if not found:
        return "Numerically, nothing is dangerous."
    lines = []
    for item in found:
        more = f" (and {item.count - 1} more of '{item.label}')" if item.count > 1 else ""
        lines.append(f"  {item.where}: {item.text}{more}")
    rest = [f"  … and {len(lines) - MAX} more"] if len(lines) > MAX else []
    return "\n".join(["Numerically dangerous:", *lines[:MAX], *rest])


def _rows(program: Program) -> Iterator[tuple[float, Hazard]]:
    matrix = program.matrix
    label = _labels(program)
    tight = program.with_tight_coefficients().matrix.data
    rows = np.repeat(np.arange(program.n_rows), np.diff(matrix.indptr))
    sides = np.stack([program.row_lower, program.row_upper])
    for i in _suspects(program, rows):
        entries = np.arange(matrix.indptr[i], matrix.indptr[i + 1])
        entries = entries[matrix.data[entries] != 0]
        size = np.abs(matrix.data[entries])
        name = program.row_name(int(i))

        def hazard(kind: Kind, text: str, i: int = i, name: str = name) -> Hazard:
            return Hazard(kind, label[i], name, text)

        side = np.abs(sides[:, i][np.isfinite(sides[:, i])]).max(initial=0.0)
        largest = max(float(size.max(initial=0.0)), float(side))
        if largest >= TOO_LARGE:
            text = f"a number of {largest:g}, which solvers refuse or take for infinite"
            yield largest, hazard("too large", text)
        if size.size and size.min() < DROPPED:
            column = program.column_name(int(matrix.indices[entries[size.argmin()]]))
            text = f"{size.min():g} for {column}, which solvers drop; state it in another unit"
            yield 1 / size.min(), hazard("dropped", text)
        big = _big_m(program, entries, tight)
        if big is not None:
            yield big[0], hazard("big-M", big[1])
        elif size.size and size.max() > WIDE * size.min():
            text = f"coefficients from {size.min():g} to {size.max():g}; state them in other units"
            yield size.max() / size.min(), hazard("range", text)


def _suspects(program: Program, rows: Ints) -> Ints:
    """Rows with numbers that are worth a look."""
    size = np.abs(program.matrix.data)
    low, high = np.full(program.n_rows, np.inf), np.zeros(program.n_rows)
    np.minimum.at(low, rows[size > 0], size[size > 0])
    np.maximum.at(high, rows, size)
    sides = np.stack([program.row_lower, program.row_upper])
    side = np.where(np.isfinite(sides), np.abs(sides), 0.0).max(axis=0)
    odd = (high > TIGHTENED_FROM * low) | (low < DROPPED) | (np.maximum(high, side) >= TOO_LARGE)
    return np.flatnonzero(odd)


def _big_m(program: Program, entries: Ints, tight: np.ndarray) -> tuple[float, str] | None:
    """How far what an integer switches slips at a tolerance from whole, and in words."""
    matrix = program.matrix
    columns, size = matrix.indices[entries], np.abs(matrix.data[entries])
    switches = np.where(program.integer[columns], size, 0.0)
    if len(entries) < 2 or not switches.any():
        return None
    k = int(switches.argmax())
    others = np.delete(size, k)
    slip = switches[k] * TOLERANCE / others.min()
    if slip < SLIPS:
        return None
    column = program.column_name(int(columns[k]))
    other = program.column_name(int(np.delete(columns, k)[others.argmin()]))
    new = abs(float(tight[entries[k]]))
    advice = (
        f"{new:g} would do"
        if new != size[k]
        else "take the least that is needed; bounds of the others would say it"
    )
    text = (
        f"big-M {size[k]:g} on {column}: at {column} = {TOLERANCE:g}, whole to a solver, {other} may "
        f"move by {slip:.3g}; {advice}"
    )
    return float(slip), text


def _costs(program: Program) -> Iterator[tuple[float, Hazard]]:
    size = np.abs(program.cost)
    there = np.flatnonzero(size)
    if not len(there):
        return
    minimum, maximum = (int(there[f(size[there])]) for f in (np.argmin, np.argmax))
    ratio = size[maximum] / size[minimum]
    if ratio > WIDE:
        text = (
            f"costs from {size[minimum]:g} ({program.column_name(minimum)}) to {size[maximum]:g} "
            f"({program.column_name(maximum)}): differences of the small ones are below a solver's gap"
        )
        yield float(ratio), Hazard("costs", "objective", "objective", text)


def _free(program: Program) -> Iterator[tuple[float, Hazard]]:
    for block in program.columns:
        for j in range(block.start, block.stop):
            low, high = program.lower[j], program.upper[j]
            missing = [side for side, end in (("lower", -low), ("upper", high)) if end >= FAR]
            if program.integer[j] and missing:
                text = (
                    f"an integer without {' and '.join(missing)} bound"
                    if np.isinf([low, high]).any()
                    else f"an integer from {low:g} to {high:g}"
                )
                text += ": branching need not end, and no big-M can be tightened; give a nearer one"
                yield (
                    float(len(missing)),
                    Hazard("free integer", block.name, block.element(j), text),
                )


def _labels(program: Program) -> list[str]:
    found = ["row"] * program.n_rows
    for block in program.rows:
        found[block.start : block.stop] = [block.name] * block.size
    return found
