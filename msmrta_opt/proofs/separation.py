"""The search for mixed-integer rounding cuts, in floating-point numbers.

A cut comes of an equation Σ a t = b in terms t ≥ 0 (`rounding` says which, and proves it). Equations are
sums of rows of two kinds: rows of the simplex tableau in which an integer column has a fraction (Gomory
1960), and tight rows from which continuous columns between their bounds are eliminated by other rows,
one after another (Marchand and Wolsey 2001, *Aggregation and mixed integer rounding to solve MIPs*).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Bools, Floats, Ints
from .derivation import Box, Side
from .exact import ExactProgram, Row
from .networks import networks
from .relaxation import Relaxation
from .rounding_choice import INSIDE, Equation

MAX_ROWS = 6
"""Rows that are added up by elimination."""
STARTS = 300
"""Rows to begin with, each time that cuts are looked for."""
TABLEAU = 80
"""Rows of the tableau."""
MAX_WEIGHTS = 150
"""Rows that a row of the tableau is a sum of."""
MIN_EFFICACY = 1e-3
"""Violation over the length of the cut's coefficients."""
PARALLEL = 0.7
"""Cosine beyond which two cuts are alike."""
LONGEST = 500
"""Columns of a cut, besides a tenth of all."""
WEIGHT_BITS = 28
"""Of the weights of rows that are no simple fractions."""


@dataclass(frozen=True, slots=True)
class VariableBound:
    """``y ≤ at_zero + slope · z`` (or ≥) for a continuous column y, by row `row`, with z integer."""

    row: int
    column: int
    at_zero: Fraction
    slope: Fraction


Nearest = tuple[bool, Side | VariableBound]
"""Whether it is an upper bound, and the bound."""


@dataclass(frozen=True)
class Found:
    """A cut that was found: what `rounding` needs to derive it."""

    weights: dict[int, float]
    """Of rows."""
    at_upper: frozenset[int]
    """Rows whose slack is that of their upper side."""
    nearest: dict[int, Nearest]
    """For continuous columns, the bound from which they are measured."""
    from_upper: frozenset[int]
    """Integer columns that are measured from their upper bounds."""
    delta: float
    efficacy: float
    columns: Ints
    direction: Floats
    """The cut's coefficients on `columns`, of length 1."""


class Separator:
    """Looks for cuts of a program that points of its relaxation violate."""

    def __init__(self, program: ExactProgram, box: Box) -> None:
        self.program = program
        self.box = box
        self.rows: list[Row] = []
        n = program.n_columns
        self._integer: Bools = np.array(program.integer, dtype=bool)
        self._lower = _floats(box.lower, -math.inf)
        self._upper = _floats(box.upper, math.inf)
        self._longest = LONGEST + n // 10
        self._columns: list[Ints] = []
        self._coefficients: list[Floats] = []
        self._sides: list[tuple[float, float]] = []
        self._whole: list[bool] = []
        self._with: dict[int, list[int]] = defaultdict(list)
        self._bounds: dict[int, list[tuple[bool, VariableBound]]] = defaultdict(list)
        self.add_rows(program.rows)
        for i, row in enumerate(program.rows):
            self._note_bound(i, row)
        opened_by = {
            y: bound.column
            for y, bounds in self._bounds.items()
            for is_upper, bound in bounds
            if is_upper and not bound.at_zero
        }
        self._networks = networks(program, program.rows, box, opened_by)

    def add_rows(self, rows: Sequence[Row]) -> None:
        """Rows that cuts may come of, in the order of the relaxation's."""
        for i, row in enumerate(rows, len(self.rows)):
            self.rows.append(row)
            columns: Ints = np.array(row.columns, dtype=np.int64)
            self._columns.append(columns)
            self._coefficients.append(np.array([float(a) for a in row.coefficients]))
            self._sides.append((
                -math.inf if row.lower is None else float(row.lower),
                math.inf if row.upper is None else float(row.upper),
            ))  # fmt: skip
            continuous = columns[~self._integer[columns]].tolist()
            self._whole.append(not continuous)
            if len(columns) != 2 or len(continuous) != 1:
                for j in continuous:
                    self._with[j].append(i)

    def remove_rows(self, rows: Sequence[int]) -> None:
        """Forget cuts, which are the last of the rows."""
        gone = set(rows)
        kept = [row for i, row in enumerate(self.rows) if i not in gone]
        first = min(gone)
        for lines in (self.rows, self._columns, self._coefficients, self._sides, self._whole):
            del lines[first:]
        for numbers in self._with.values():
            numbers[:] = [i for i in numbers if i < first]
        self.add_rows(kept[first:])

    def _note_bound(self, i: int, row: Row) -> None:
        """A row of a continuous column and an integer one bounds the first by the second."""
        continuous = [j for j in row.columns if not self.program.integer[j]]
        if len(row.columns) != 2 or len(continuous) != 1:
            return
        y = continuous[0]
        of = dict(zip(row.columns, row.coefficients, strict=True))
        (z,) = (j for j in row.columns if j != y)
        for is_upper, side in ((of[y] > 0, row.upper), (of[y] < 0, row.lower)):
            if side is not None:
                bound = VariableBound(i, z, Fraction(side, of[y]), Fraction(-of[z], of[y]))
                self._bounds[y].append((is_upper, bound))

    # At a point.

    def cuts(self, x: Floats, relaxation: Relaxation, limit: int) -> list[Found]:
        """Cuts that `x`, the relaxation's solution, violates; the best first, and no two alike."""
        self._look_at(x)
        found = [
            self._rounded({i: sign * weight for i, weight in weights.items()})
            for network in self._networks
            for weights in network.sets(x)
            for sign in (1.0, -1.0)
        ]
        if any(cut is not None for cut in found):
            return self._chosen([cut for cut in found if cut is not None], limit)
        found += [self._rounded(weights) for weights in self._tableau(x, relaxation)]
        found += [
            self._by_elimination(start, sign) for start in self._starts() for sign in (1.0, -1.0)
        ]
        return self._chosen([cut for cut in found if cut is not None], limit)

    def _look_at(self, x: Floats) -> None:
        """What all cuts at `x` share: how far columns and rows are from their bounds, and which."""
        n = self.program.n_columns
        self._x = x
        # Of continuous columns, first from below, then from above.
        self._near: tuple[dict[int, Nearest], dict[int, Nearest]] = ({}, {})
        self._from, self._side = np.full((2, n), np.inf), np.zeros((2, n))
        self._slope, self._by = np.zeros((2, n)), np.full((2, n), -1)
        for j in np.flatnonzero(~self._integer).tolist():
            for is_upper in (False, True):
                self._measure(j, is_upper)
        self._distance = self._from.min(axis=0)
        nearer = np.abs(x - self._upper) < np.abs(x - self._lower)
        self._from_upper: Bools = self._integer & nearer
        self._end = np.where(self._from_upper, self._upper, self._lower)
        self._activity = [
            float(a @ x[j]) for j, a in zip(self._columns, self._coefficients, strict=True)
        ]
        self._fraction = np.where(self._integer, np.abs(x - np.round(x)), self._distance)

    def _measure(self, j: int, is_upper: bool) -> None:
        """Choose the bound of continuous column `j` that is nearest, rather a variable one."""
        x, minimum = self._x, math.inf
        best: Side | VariableBound | None = None
        for way, bound in self._bounds[j]:
            end = float(bound.at_zero) + float(bound.slope) * x[bound.column]
            if way == is_upper and abs(end - x[j]) < minimum - 1e-9:
                best, minimum = bound, abs(end - x[j])
        side = self.box.upper[j] if is_upper else self.box.lower[j]
        if side is not None and abs(float(side.bound) - x[j]) < minimum - 1e-6:
            best, minimum = side, abs(float(side.bound) - x[j])
        if best is None:
            return
        which = int(is_upper)
        self._from[which, j] = minimum
        self._near[which][j] = (is_upper, best)
        if isinstance(best, VariableBound):
            self._side[which, j], self._slope[which, j] = float(best.at_zero), float(best.slope)
            self._by[which, j] = best.column
        else:
            self._side[which, j] = float(best.bound)

    def _tableau(self, x: Floats, relaxation: Relaxation) -> Iterator[dict[int, float]]:
        """Weights of the rows of the tableau of integer columns with a fraction."""
        ranked = sorted(
            (abs(x[j] - math.floor(x[j]) - 0.5), place)
            for place, j in relaxation.basic_columns()
            if self._integer[j]
        )
        for far, place in ranked[:TABLEAU]:
            if far > 0.49:
                break
            weights = relaxation.tableau_row(place)
            used = np.flatnonzero(np.abs(weights) > 1e-9 * np.abs(weights).max(initial=0.0))
            if 0 < len(used) <= MAX_WEIGHTS:
                scale = 2.0**WEIGHT_BITS
                short = np.round(weights[used] * scale) / scale
                for sign in (1.0, -1.0):
                    yield {int(i): sign * float(w) for i, w in zip(used, short, strict=True) if w}

    def _starts(self) -> list[int]:
        """Tight rows with something between its bounds, in the order of how much."""
        ranked = []
        for i, (columns, coefficients) in enumerate(
            zip(self._columns, self._coefficients, strict=True)
        ):
            if not 2 <= len(columns) <= self._longest:
                continue
            inside = int((self._fraction[columns] > INSIDE).sum())
            if inside:
                size = float(np.abs(coefficients).max())
                slack = min(abs(self._activity[i] - side) for side in self._sides[i]) / size
                if slack <= 0.1:
                    ranked.append((slack - inside / len(columns), i))
        return [i for _, i in sorted(ranked)[:STARTS]]

    def _by_elimination(self, start: int, sign: float) -> Found | None:
        """The first cut of sums of rows that begin with row `start`."""
        weights = {start: sign / float(np.abs(self._coefficients[start]).max())}
        for _ in range(MAX_ROWS):
            found = self._rounded(weights)
            if found is not None:
                return found
            if not self._eliminate(weights):
                return None
        return None

    def _eliminate(self, weights: dict[int, float]) -> bool:
        """Add a row that takes out the continuous column that is farthest from its bounds."""
        total = self._total
        inside = np.flatnonzero((total != 0) & ~self._integer & (self._distance > INSIDE))
        for j in inside[np.argsort(-self._distance[inside], kind="stable")].tolist():
            best, minimum = -1, math.inf
            for i in self._with[j]:
                if i in weights:
                    continue
                low, high = self._sides[i]
                slack = 0.0 if low == high else min(abs(self._activity[i] - s) for s in (low, high))
                rank = len(self._columns[i]) + 1000 * (low != high) + 1e4 * min(slack, 1.0)
                if rank < minimum:
                    best, minimum = i, rank
            if best >= 0:
                own = float(self._coefficients[best][self._columns[best] == j][0])
                weights[best] = -float(total[j]) / own
                return True
        return False

    def _rounded(self, weights: dict[int, float]) -> Found | None:
        """The best cut of the sum of rows by `weights`, if it is violated enough."""
        total = np.zeros(self.program.n_columns)
        side = 0.0
        whole: list[tuple[float, float]] = []
        slacks: list[tuple[float, float]] = []
        ends: set[int] = set()
        for i, weight in weights.items():
            total[self._columns[i]] += weight * self._coefficients[i]
            low, high = self._sides[i]
            activity = self._activity[i]
            at_upper = abs(high - activity) <= abs(low - activity)
            side += weight * (high if at_upper else low)
            if at_upper:
                ends.add(i)
            if low != high:
                distance = high - activity if at_upper else activity - low
                (whole if self._whole[i] else slacks).append(
                    (weight if at_upper else -weight, max(distance, 0.0))
                )
        total[np.abs(total) < 1e-11 * np.abs(total).max()] = 0.0
        self._total = total
        used = np.flatnonzero(total)
        if len(used) > self._longest:
            return None
        return self._best(weights, frozenset(ends), used, total, side, whole, slacks)

    def _best(
        self,
        weights: dict[int, float],
        at_upper: frozenset[int],
        used: Ints,
        total: Floats,
        side: float,
        whole: list[tuple[float, float]],
        slacks: list[tuple[float, float]],
    ) -> Found | None:
        rest_of = self._measured(used[~self._integer[used]], total)
        if not np.isfinite(rest_of.distance).all():
            return None
        on_integers = np.where(self._integer, total, 0.0)
        side -= float(rest_of.a @ rest_of.side)
        varying = rest_of.by >= 0
        np.add.at(on_integers, rest_of.by[varying], (rest_of.a * rest_of.slope)[varying])
        columns = np.flatnonzero(np.abs(on_integers) > 1e-11)
        if not len(columns) or not np.isfinite(self._end[columns]).all():
            return None
        a = on_integers[columns]
        turned = self._from_upper[columns]
        room = self._upper[columns] - self._lower[columns]
        t = np.abs(self._x[columns] - self._end[columns])
        side -= float(a @ self._end[columns])
        a = np.where(turned, -a, a)
        rest = np.minimum(np.concatenate([rest_of.of_terms, [c for c, _ in slacks]]), 0.0)
        rest_t = np.concatenate([rest_of.distance, [d for _, d in slacks]])
        base = Equation(
            np.concatenate([a, [c for c, _ in whole]]),
            np.concatenate([t, [d for _, d in whole]]),
            np.concatenate([room, [math.inf] * len(whole)]),
            side, float(rest @ rest_t), float(rest @ rest),
        )  # fmt: skip
        rounding = base.best_rounding()
        if rounding is None or rounding[2] < MIN_EFFICACY:
            return None
        flipped, delta, _ = rounding
        from_upper = columns[turned ^ flipped[: len(columns)]]
        direction, violation = self._cut(
            weights, at_upper, rest_of, columns, turned, base, rounding
        )
        support = np.flatnonzero(direction)
        length = math.sqrt(float(direction[support] @ direction[support]))
        if not length or violation / length < MIN_EFFICACY:
            return None
        near = {
            j: self._near[int(is_upper)][j]
            for j, is_upper in zip(rest_of.columns.tolist(), rest_of.is_upper.tolist(), strict=True)
        }
        return Found(
            dict(weights), at_upper, near, frozenset(from_upper.tolist()), delta, violation / length,
            support, direction[support] / length,
        )  # fmt: skip

    def _measured(self, columns: Ints, total: Floats) -> Continuous:
        """Measure continuous columns from bounds such that their terms can be left out, if near."""
        a = total[columns]
        friendly = (a < 0).astype(np.int64)
        near = self._from[friendly, columns] <= self._from[1 - friendly, columns] + INSIDE
        way = np.where(near, friendly, 1 - friendly)
        return Continuous(
            columns, a, way == 1, self._from[way, columns], self._side[way, columns],
            self._slope[way, columns], self._by[way, columns],
        )  # fmt: skip

    def _cut(
        self,
        weights: dict[int, float],
        at_upper: frozenset[int],
        rest_of: Continuous,
        columns: Ints,
        turned: Bools,
        base: Equation,
        rounding: tuple[Bools, float, float],
    ) -> tuple[Floats, float]:
        """The coefficients of all columns in the cut, and by how much it is violated."""
        flipped, delta, _ = rounding
        side, fraction, g = base.rounding(flipped, delta)
        n_columns = len(columns)
        direction = np.zeros(self.program.n_columns)
        own = np.where(flipped, -g, g)
        np.add.at(direction, columns, np.where(turned, -own[:n_columns], own[:n_columns]))
        scale = 1 / (delta * (1 - fraction))
        rest = np.minimum(rest_of.of_terms, 0.0) * scale
        signed = np.where(rest_of.is_upper, -rest, rest)
        direction[rest_of.columns] += signed
        varying = rest_of.by >= 0
        np.add.at(direction, rest_of.by[varying], -(signed * rest_of.slope)[varying])
        whole = iter(own[n_columns:].tolist())
        for i, weight in weights.items():
            low, high = self._sides[i]
            if low == high:
                continue
            upper = i in at_upper
            signed_weight = weight if upper else -weight
            times = next(whole) if self._whole[i] else min(signed_weight, 0.0) * scale
            if times:
                direction[self._columns[i]] += (-times if upper else times) * self._coefficients[i]
        t = np.where(flipped, base.room - base.t, base.t)
        violation = float(g @ t) + base.rest * scale - math.floor(side)
        return direction, violation

    def _chosen(self, found: list[Found], limit: int) -> list[Found]:
        chosen: list[Found] = []
        dense = np.zeros((limit, self.program.n_columns))
        for cut in sorted(found, key=lambda item: -item.efficacy):
            cosines = dense[: len(chosen)][:, cut.columns] @ cut.direction
            if not len(chosen) or float(np.abs(cosines).max()) < PARALLEL:
                dense[len(chosen), cut.columns] = cut.direction
                chosen.append(cut)
                if len(chosen) == limit:
                    break
        return chosen


@dataclass(frozen=True)
class Continuous:
    """Continuous columns of a sum of rows, and the bounds that they are measured from."""

    columns: Ints
    a: Floats
    is_upper: Bools
    distance: Floats
    side: Floats
    slope: Floats
    by: Ints

    @property
    def of_terms(self) -> Floats:
        """The coefficients of the distances."""
        return np.where(self.is_upper, -self.a, self.a)


def _floats(sides: Sequence[Side | None], infinity: float) -> Floats:
    return np.array([infinity if side is None else float(side.bound) for side in sides])
