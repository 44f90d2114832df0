"""The rows of a program by name, as statements that do not depend on how they are written."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from ..mission.counting import in_full
from ..optimise.program import Program
from .signs import signs

SAME = 1e-9
"""Relative difference of numbers that is none."""

Statement = tuple[tuple[tuple[str, float], ...], float, float]


@dataclass(frozen=True)
class Row:
    """``lower ≤ Σ coefficients · variables ≤ upper``, with the signs in which it is told."""

    label: str
    terms: dict[str, float]
    """By variable, its coefficient; none is 0."""
    lower: float
    upper: float

    @cached_property
    def statement(self) -> Statement:
        """What it says, whatever its scale and its sign."""
        terms = sorted(self.terms.items())
        scale = terms[0][1] if terms else 1.0
        sides = (self.lower / scale, self.upper / scale)
        lower, upper = sides if scale > 0 else sides[::-1]
        return tuple((n, _rounded(a / scale)) for n, a in terms), _rounded(lower), _rounded(upper)

    def changes(self, other: Row) -> tuple[str, ...]:
        """What is another in `other`, sides first; empty if both say the same."""
        if self.statement == other.statement:
            return ()
        plain, turned = self._changes(other), self._changes(other._negated)
        return turned if len(turned) < len(plain) else plain

    def _changes(self, other: Row) -> tuple[str, ...]:
        found = []
        if not (_same(self.lower, other.lower) and _same(self.upper, other.upper)):
            found.append(f"{self._sides} → {other._sides}")
        for name in dict.fromkeys((*self.terms, *other.terms)):
            old, new = self.terms.get(name, 0.0), other.terms.get(name, 0.0)
            if not _same(old, new):
                found.append(f"{name}: {in_full(old)} → {in_full(new)}")
        return tuple(found)

    @property
    def _negated(self) -> Row:
        """The same statement with the other sign."""
        terms = {name: -a for name, a in self.terms.items()}
        return Row(self.label, terms, -self.upper + 0.0, -self.lower + 0.0)

    @property
    def _sides(self) -> str:
        if self.lower == self.upper:
            return f"= {in_full(self.upper)}"
        parts = [f"≥ {in_full(self.lower)}"] * math.isfinite(self.lower)
        parts += [f"≤ {in_full(self.upper)}"] * math.isfinite(self.upper)
        return " and ".join(parts) or "free"


def named_rows(program: Program) -> dict[str, Row]:
    """The rows of `program`; of those with one name, the later ones have a number behind."""
    matrix, told = program.matrix, signs(program).tolist()
    columns = program.column_names
    starts, indices, data = matrix.indptr.tolist(), matrix.indices.tolist(), matrix.data.tolist()
    all_sides = list(zip(program.row_lower.tolist(), program.row_upper.tolist(), strict=True))
    found: dict[str, Row] = {}
    for block in program.rows:
        for i in range(block.start, block.stop):
            sign = told[i]
            entries = slice(starts[i], starts[i + 1])
            pairs = zip(indices[entries], data[entries], strict=True)
            terms = {columns[j]: float(sign * a) for j, a in pairs if a}
            sides = all_sides[i]
            lower, upper = sides if sign > 0 else (-sides[1], -sides[0])
            name, number = block.element(i), 2
            while name in found:
                name = f"{block.element(i)} ({number})"
                number += 1
            found[name] = Row(block.name, terms, lower + 0.0, upper + 0.0)
    return found


def _same(a: float, b: float) -> bool:
    return a == b or (math.isfinite(a - b) and abs(a - b) <= SAME * max(abs(a), abs(b)))


def _rounded(number: float) -> float:
    """To nine digits, for comparison."""
    return float(f"{number:.9e}") + 0.0
