"""Explanations held against programs: that they conflict, and that no member can be spared."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from support.programs import INF

from msmrta_opt.diagnosis.conflict import Conflict
from msmrta_opt.optimise.program import Program

FAR = 6000.0
"""A box that holds a point if there is one, for `programs`.

Whatever of such a program is feasible has an integer point no farther from 0 than (n + 1) Δ, with Δ
the largest subdeterminant of its inequalities with their right-hand sides (Schrijver, *Theory of
Linear and Integer Programming*, 1986, theorem 17.1). With n = 3 and entries up to 3, Hadamard's
inequality gives Δ ≤ (3 · 2)⁴ = 1296.
"""


@dataclass(frozen=True)
class Part:
    """Some rows and some sides of bounds of a program, as an explanation names them."""

    rows: frozenset[int]
    lower: frozenset[int]
    upper: frozenset[int]

    @classmethod
    def named_by(cls, found: Conflict) -> Part:
        """Read from names such as ``row 2``, ``x[1] ≤ 3``, ``0 ≤ x[1] ≤ 3`` and ``x[1] = 3``."""
        lower, upper = set(), set()
        for text in found.bounds:
            match = re.fullmatch(r"(\S+ ≤ )?x\[(\d+)\]( [≤≥=] \S+)?", text)
            assert match, text
            minimum, column, other = match[1], int(match[2]), match[3] or ""
            if minimum or "≥" in other or "=" in other:
                lower.add(column)
            if "≤" in other or "=" in other:
                upper.add(column)
        rows = frozenset(int(text.removeprefix("row ")) for text in found.rows)
        return cls(rows, frozenset(lower), frozenset(upper))

    def without_one(self) -> list[Part]:
        """Every part that is this one without one member."""
        return [
            *(replace(self, rows=self.rows - {i}) for i in self.rows),
            *(replace(self, lower=self.lower - {j}) for j in self.lower),
            *(replace(self, upper=self.upper - {j}) for j in self.upper),
        ]

    def has_a_point(self, program: Program, *, whole: bool) -> bool:
        """Whether some point, integer where the program asks for it, satisfies this part."""
        lower, upper = np.full((2, program.n_columns), FAR)
        lower = -lower
        for j in self.lower:
            lower[j] = program.lower[j]
        for j in self.upper:
            upper[j] = program.upper[j]
        if (lower > upper).any():
            return False
        rows = sorted(self.rows)
        answer = milp(
            np.zeros(program.n_columns),
            constraints=LinearConstraint(
                program.matrix.toarray()[rows], program.row_lower[rows], program.row_upper[rows]
            )
            if rows
            else None,
            bounds=Bounds(lower, upper),
            integrality=program.integer.astype(int) * whole,
        )
        assert answer.status in (0, 2), answer.message
        return bool(answer.status == 0)


def everything(program: Program) -> Part:
    columns = range(program.n_columns)
    return Part(
        frozenset(range(program.n_rows)),
        frozenset(j for j in columns if program.lower[j] > -INF),
        frozenset(j for j in columns if program.upper[j] < INF),
    )


def assert_explained(program: Program, found: Conflict, *, irreducible: bool = True) -> None:
    """What is found conflicts, by another program's word, and so does no part of it."""
    assert found.status == "infeasible"
    part = Part.named_by(found)
    assert not part.has_a_point(program, whole=found.integrality)
    assert found.irreducible or not irreducible
    if irreducible:
        for less in part.without_one():
            assert less.has_a_point(program, whole=found.integrality), (found, less)
