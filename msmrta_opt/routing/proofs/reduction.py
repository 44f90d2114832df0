r"""What the root relaxation excludes, as derivations: the tree is then over the columns that are left.

Assume that a plan is better than the one at hand: ``c'x ≤ w − 1`` in whole units. With dual values p
of the rows and d = c − A'p, that less the rows is

    Σ_j d_j x_j  ≤  w − 1 − p'b  =:  room

so a column with d_j > room is 0 (reduced-cost fixing): this row rounded, once the other columns, which
are at least 0, are taken out of it. To take them out one by one for each column would be long; instead
half of the columns is taken out, then half of what is left, and so on. Without the columns that are 0,
the rows and the assumption itself are restricted to what is left.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial

import numpy as np

from ...arrays import Floats, Ints
from ...proofs.derivation import LEMMA, Combination, Lemma, Lemmas, Side, Uses
from ...proofs.exact import ExactProgram, Row
from ..branch_and_cut.separation import Cut
from .statement import Statement

BITS = 16
"""Of dual values after the binary point, in units of the objective."""
FINENESS = 4096
"""Of the room that is left, in which reduced costs are counted."""
CHUNK = 6
"""Columns that are not halved any more."""


def reached(program: ExactProgram, duals: Floats) -> int:
    """The largest goal that dual values of the program's first rows, ``(n_rows,)``, reach at once."""
    _, slope, fixed, _ = _combined(program, duals)
    return -(-fixed // slope)


def _combined(program: ExactProgram, duals: Floats) -> tuple[list[int], int, int, dict[int, int]]:
    """What ``Σ d x ≤ room`` is made of, all times 2 to the `BITS`.

    That is d; how often the assumption is in it, and what is left of the room without it; and the
    multipliers of all other constraints but of the lower bounds.
    """
    scale = 1 << BITS
    reduced = [int(c) * scale for c in program.cost]
    slope, fixed = scale, 0
    multipliers: dict[int, int] = {}
    for row, dual in zip(program.rows, duals.tolist(), strict=False):
        weight = round(dual * scale)
        side, at = (row.lower, row.at_lower) if weight > 0 else (row.upper, row.at_upper)
        if not weight or side is None:
            continue
        fixed += weight * side
        multipliers[at] = multipliers.get(at, 0) - weight
        for j, a in zip(row.columns, row.coefficients, strict=True):
            reduced[j] -= weight * a
    for j, d in enumerate(reduced):
        if d < 0 and program.at_upper[j] >= 0:
            fixed += d
            multipliers[program.at_upper[j]] = -d
        elif d < 0:
            slope -= d
    return reduced, slope, fixed, multipliers


@dataclass
class Reduction:
    """The assumption, what is known to be 0 under it, and the program of what is left."""

    statement: Statement
    goal: int
    """What is to be proved, in units: no plan is worth less."""
    lemmas: Lemmas = field(default_factory=Lemmas)
    zero: dict[int, int] = field(default_factory=dict)
    """Reference of ``x ≤ 0`` by column."""
    cutoff: int = field(init=False)
    """Reference of the assumption that a plan is worth less."""
    _restricted: int = -1
    """Reference of the assumption without the columns that are 0."""

    def __post_init__(self) -> None:
        cost = self.statement.program.cost
        terms = tuple((j, int(c)) for j, c in enumerate(cost) if c)
        self.cutoff = self.lemmas.add(Lemma("L", self.goal - 1, terms, "asm"))

    # The root.

    def fix(self, duals: Floats) -> Combination | None:
        """Exclude columns by the dual values of the program's first rows, ``(n_rows,)``.

        Returns a contradiction if they prove the goal at once.
        """
        program = self.statement.program
        reduced, slope, fixed, multipliers = _combined(program, duals)
        # The makespan's reduced cost may need its bound, which is the assumption itself.
        multipliers[self.cutoff] = slope
        room = slope * (self.goal - 1) - fixed
        if room < 0:
            for j, d in enumerate(reduced):
                if d > 0:
                    multipliers[program.at_lower[j]] = -d
            return Combination(None, {at: -a for at, a in multipliers.items()}, 1 << BITS)
        grain = max(1, room // FINENESS)
        room //= grain
        terms = {
            j: d // grain
            for j, d in enumerate(reduced)
            if d // grain > room and program.at_upper[j] >= 0
        }
        for j, d in enumerate(reduced):
            rest = d - grain * terms.get(j, 0)
            if d > 0 and rest:
                multipliers[program.at_lower[j]] = -rest
        uses = tuple((at, Fraction(a, grain)) for at, a in multipliers.items() if a)
        self._split(sorted(terms, key=lambda j: -terms[j]), terms, room, "rnd", uses)
        self._follow()
        return None

    def _split(
        self, columns: list[int], terms: dict[int, int], room: int, rule: str, uses: Uses
    ) -> None:
        """Derive that each of `columns` is 0, from ``Σ terms ≤ room`` by `uses`."""
        if not columns:
            return
        low = self.statement.program.at_lower
        own = tuple((j, terms[j]) for j in sorted(columns))
        at = self.lemmas.add(Lemma("L", room, own, rule, partial(tuple, uses)))
        if len(columns) > CHUNK:
            half = len(columns) // 2
            for some, others in (
                (columns[:half], columns[half:]),
                (columns[half:], columns[:half]),
            ):
                out = tuple((low[j], -terms[j]) for j in others)
                self._split(some, terms, room, "lin", ((at, 1), *out))
            return
        for j in columns:
            rest = tuple((low[k], Fraction(-terms[k], terms[j])) for k in columns if k != j)
            self._zero(j, "rnd", ((at, Fraction(1, terms[j])), *rest))

    def _zero(self, j: int, rule: str, uses: Uses) -> None:
        if j not in self.zero:
            lemma = Lemma("L", 0, ((j, 1),), rule, partial(tuple, uses))
            self.zero[j] = self.lemmas.add(lemma)

    def _follow(self) -> None:
        """Without the visit of a victim, nothing else of it remains."""
        formulation, program = self.statement.formulation, self.statement.program
        start = formulation.start
        robot, n = formulation.pairs[:, 0].tolist(), formulation.n_pairs
        never = {pair for pair in range(n) if start("y") + pair in self.zero}
        if not never:
            return
        alone: dict[tuple[int, int], int] = {}
        for row in program.rows:
            if row.at_upper >= 0 and not row.upper and list(row.coefficients) in ([1, -1], [-1, 1]):
                more, less = row.columns if row.coefficients[0] == 1 else row.columns[::-1]
                alone[more, less] = row.at_upper

        def follow(column: int, pair: int, cut: Cut | None) -> None:
            if column in self.zero:
                return
            visit = start("y") + pair
            at = alone.get((column, visit))
            if at is None:
                assert cut is not None
                at = self.statement.add(cut).at_upper
            self._zero(column, "lin", ((at, 1), (self.zero[visit], 1)))

        for pair in sorted(never):
            v = int(formulation.pairs[pair, 1])
            follow(start("f") + pair, pair, Cut(robot[pair], (v,), first=True))
            follow(start("l") + pair, pair, Cut(robot[pair], (v,), last=True))
        for n_service, (pair, _) in enumerate(formulation.services.tolist()):
            if pair in never:
                follow(start("a") + n_service, pair, None)
        for edge, (r, i, j) in enumerate(formulation.edges.tolist()):
            for here, there in ((i, j), (j, i)):
                pair = int(formulation.pair_of[r, here])
                if pair in never:
                    follow(start("e") + edge, pair, Cut(r, (i, j), vertex=there))
                    break

    def lower(self, goal: int) -> None:
        """Assume that a plan is worth less than a lower `goal`; all that is derived still holds."""
        self.goal = goal
        for place, item in enumerate(self.lemmas.items):
            if item.rule == "asm" or LEMMA + place == self._restricted:
                self.lemmas.items[place] = replace(item, side=goal - 1)

    # What is left.

    @property
    def columns(self) -> Ints:
        """The columns that are not known to be 0."""
        n = self.statement.formulation.n_columns
        return np.array([j for j in range(n) if j not in self.zero], dtype=np.int64)

    def restricted(self, row: Row) -> Row:
        """`row` without the columns that are 0, still by their numbers in the whole program."""
        columns, coefficients, out = [], [], []
        for j, a in zip(row.columns, row.coefficients, strict=True):
            if j in self.zero:
                out.append((j, a))
            else:
                columns.append(j)
                coefficients.append(a)
        if not out:
            return row
        terms = tuple(zip(columns, coefficients, strict=True))
        found = Row(columns, coefficients, row.lower, row.upper)
        for upper in (False, True):
            side, at = (row.upper, row.at_upper) if upper else (row.lower, row.at_lower)
            if side is None:
                continue
            uses = ((at, 1), *((self._bound(j, (a > 0) == upper), -a) for j, a in out))
            sense = "L" if upper else "G"
            new = self.lemmas.add(Lemma(sense, side, terms, "lin", partial(tuple, uses)))
            if upper:
                found.at_upper = new
            else:
                found.at_lower = new
        return found

    def _bound(self, j: int, lower: bool) -> int:
        """Reference of ``x ≥ 0``, or of ``x ≤ 0``."""
        return self.statement.program.at_lower[j] if lower else self.zero[j]

    def assumption(self) -> int:
        """Reference of the assumption without the columns that are 0."""
        program = self.statement.program
        gone = [j for j in self.zero if program.cost[j]]
        if not gone:
            return self.cutoff
        assert self._restricted < 0
        terms = tuple((j, int(c)) for j, c in enumerate(program.cost) if c and j not in self.zero)
        uses = ((self.cutoff, 1), *((program.at_lower[j], -int(program.cost[j])) for j in gone))
        self._restricted = self.lemmas.add(
            Lemma("L", self.goal - 1, terms, "lin", partial(tuple, uses))
        )
        return self._restricted

    def core(self, columns: Ints) -> ExactProgram:
        """The program of `columns`, its rows restricted; rows that are given no more are left out."""
        program = self.statement.program
        kept = columns.tolist()
        found = ExactProgram(
            1,
            [program.names[j] for j in kept],
            [program.at_upper[j] >= 0 for j in kept],
            [program.cost[j] for j in kept],
            [program.lower[j] for j in kept],
            [program.upper[j] for j in kept],
            [program.at_lower[j] for j in kept],
            [program.at_upper[j] for j in kept],
            [],
            [],
        )
        place = {j: n for n, j in enumerate(kept)}
        found.rows = [renumbered(self.restricted(row), place) for row in program.rows]
        return found

    def ceiling(self) -> Side:
        """The assumption as an upper bound of the makespan."""
        return Side(self.goal - 1, self.cutoff)


def renumbered(row: Row, place: dict[int, int]) -> Row:
    """`row` by the places of its columns."""
    return Row(
        [place[j] for j in row.columns], row.coefficients, row.lower, row.upper, row.factor,
        row.at_lower, row.at_upper,
    )  # fmt: skip
