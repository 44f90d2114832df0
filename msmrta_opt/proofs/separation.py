"""The search for mixed-integer rounding cuts, in floating-point numbers.

A cut comes of an equation Σ a t = b in terms t ≥ 0 (`rounding` says which, and proves it). Equations are
sums of rows of two kinds: rows of the simplex tableau in which an integer column has a fraction (Gomory
1960), and tight rows from which continuous columns between their bounds are eliminated by other rows,
one after another (Marchand and Wolsey 2001, *Aggregation and mixed integer rounding to solve MIPs*).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..arrays import Floats
from .derivation import Box
from .exact import ExactProgram, Row
from .networks import networks
from .numeric_rows import NumericRows
from .relaxation import Relaxation
from .rounding_choice import INSIDE
from .summed_rows import Found, Point

MAX_ROWS = 6
"""Rows that are added up by elimination."""
STARTS = 300
"""Rows to begin with, each time that cuts are looked for."""
TABLEAU = 80
"""Rows of the tableau."""
MAX_WEIGHTS = 150
"""Rows that a row of the tableau is a sum of."""
PARALLEL = 0.7
"""Cosine beyond which two cuts are alike."""
LONGEST = 500
"""Columns of a cut, besides a tenth of all."""
WEIGHT_BITS = 28
"""Of the weights of rows that are no simple fractions."""


class Separator:
    """Looks for cuts of a program that points of its relaxation violate."""

    def __init__(self, program: ExactProgram, box: Box) -> None:
        self.rows = NumericRows(program, box)
        self._longest = LONGEST + program.n_columns // 10
        opened_by = {
            y: bound.column
            for y, bounds in self.rows.variable_bounds.items()
            for is_upper, bound in bounds
            if is_upper and not bound.at_zero
        }
        self._networks = networks(program, program.rows, box, opened_by)

    def add_rows(self, rows: Sequence[Row]) -> None:
        """Rows that cuts may come of, in the order of the relaxation's."""
        self.rows.add(rows)

    def remove_rows(self, rows: Sequence[int]) -> None:
        """Forget cuts, which are the last of the rows."""
        self.rows.remove(rows)

    def cuts(self, x: Floats, relaxation: Relaxation, limit: int) -> list[Found]:
        """Cuts that `x`, the relaxation's solution, violates; the best first, and no two alike."""
        point = Point(self.rows, x)
        found = [
            self._cut_of(point, {i: sign * weight for i, weight in weights.items()})
            for network in self._networks
            for weights in network.sets(x)
            for sign in (1.0, -1.0)
        ]
        if any(cut is not None for cut in found):
            return self._chosen([cut for cut in found if cut is not None], limit)
        found += [self._cut_of(point, weights) for weights in self._tableau(x, relaxation)]
        found += [
            self._by_elimination(point, start, sign)
            for start in self._starts(point)
            for sign in (1.0, -1.0)
        ]
        return self._chosen([cut for cut in found if cut is not None], limit)

    def _cut_of(self, point: Point, weights: dict[int, float]) -> Found | None:
        """The best cut of the sum of rows by `weights`, unless it has too many columns."""
        rows = point.add_up(weights)
        return point.cut(rows) if len(rows.used) <= self._longest else None

    def _tableau(self, x: Floats, relaxation: Relaxation) -> Iterator[dict[int, float]]:
        """Weights of the rows of the tableau of integer columns with a fraction."""
        ranked = sorted(
            (abs(x[j] - math.floor(x[j]) - 0.5), place)
            for place, j in relaxation.basic_columns()
            if self.rows.integer[j]
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

    def _starts(self, point: Point) -> list[int]:
        """Tight rows with something between its bounds, in the order of how much."""
        ranked = []
        for i, (columns, coefficients) in enumerate(
            zip(self.rows.columns, self.rows.coefficients, strict=True)
        ):
            if not 2 <= len(columns) <= self._longest:
                continue
            inside = int((point.fraction[columns] > INSIDE).sum())
            if inside:
                size = float(np.abs(coefficients).max())
                slack = min(abs(point.activity[i] - side) for side in self.rows.sides[i]) / size
                if slack <= 0.1:
                    ranked.append((slack - inside / len(columns), i))
        return [i for _, i in sorted(ranked)[:STARTS]]

    def _by_elimination(self, point: Point, start: int, sign: float) -> Found | None:
        """The first cut of sums of rows that begin with row `start`."""
        weights = {start: sign / float(np.abs(self.rows.coefficients[start]).max())}
        for _ in range(MAX_ROWS):
            total = point.add_up(weights)
            found = point.cut(total) if len(total.used) <= self._longest else None
            if found is not None:
                return found
            if not self._eliminate(point, total.total, weights):
                return None
        return None

    def _eliminate(self, point: Point, total: Floats, weights: dict[int, float]) -> bool:
        """Add a row that takes out the continuous column that is farthest from its bounds."""
        inside = np.flatnonzero((total != 0) & ~self.rows.integer & (point.distance > INSIDE))
        for j in inside[np.argsort(-point.distance[inside], kind="stable")].tolist():
            best, minimum = -1, math.inf
            for i in self.rows.with_column[j]:
                if i in weights:
                    continue
                low, high = self.rows.sides[i]
                slack = 0.0 if low == high else min(abs(point.activity[i] - s) for s in (low, high))
                rank = len(self.rows.columns[i]) + 1000 * (low != high) + 1e4 * min(slack, 1.0)
                if rank < minimum:
                    best, minimum = i, rank
            if best >= 0:
                own = float(self.rows.coefficients[best][self.rows.columns[best] == j][0])
                weights[best] = -float(total[j]) / own
                return True
        return False

    def _chosen(self, found: list[Found], limit: int) -> list[Found]:
        chosen: list[Found] = []
        dense = np.zeros((limit, self.rows.n_columns))
        for cut in sorted(found, key=lambda item: -item.efficacy):
            cosines = dense[: len(chosen)][:, cut.columns] @ cut.direction
            if not len(chosen) or float(np.abs(cosines).max()) < PARALLEL:
                dense[len(chosen), cut.columns] = cut.direction
                chosen.append(cut)
                if len(chosen) == limit:
                    break
        return chosen
