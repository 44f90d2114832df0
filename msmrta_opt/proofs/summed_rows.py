"""The cut that comes of a sum of rows, at a point that is to violate it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Bools, Floats, Ints
from .derivation import Side
from .numeric_rows import NumericRows, VariableBound
from .rounding_choice import INSIDE, Equation

MIN_EFFICACY = 1e-3
"""Violation over the length of the cut's coefficients."""

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


@dataclass(frozen=True)
class RowSum:
    """A sum of rows, and what rounding needs of it at a point."""

    weights: dict[int, float]
    """Of rows."""
    at_upper: frozenset[int]
    """Rows whose upper side is the nearer one."""
    total: Floats
    """The coefficients of all columns."""
    side: float
    whole: list[tuple[float, float]]
    """Coefficients and values of the slacks of rows of integer columns."""
    slacks: list[tuple[float, float]]
    """The same of the others."""

    @cached_property
    def used(self) -> Ints:
        """The columns in it."""
        return np.flatnonzero(self.total)


class Point:
    """A point, and how far columns and rows are from their bounds there.

    Parameters
    ----------
    rows : NumericRows
        Of which sums are taken.
    x : array, (n_columns,)
        The point.
    """

    def __init__(self, rows: NumericRows, x: Floats) -> None:
        n = rows.n_columns
        self.rows, self.x = rows, x
        # Of continuous columns, first from below, then from above.
        self._near: tuple[dict[int, Nearest], dict[int, Nearest]] = ({}, {})
        self._from, self._side = np.full((2, n), np.inf), np.zeros((2, n))
        self._slope, self._by = np.zeros((2, n)), np.full((2, n), -1)
        for j in np.flatnonzero(~rows.integer).tolist():
            for is_upper in (False, True):
                self._measure(j, is_upper)
        self.distance = self._from.min(axis=0)
        """Of continuous columns from their nearest bounds."""
        nearer = np.abs(x - rows.upper) < np.abs(x - rows.lower)
        self._from_upper: Bools = rows.integer & nearer
        self._end = np.where(self._from_upper, rows.upper, rows.lower)
        self.activity = [
            float(a @ x[j]) for j, a in zip(rows.columns, rows.coefficients, strict=True)
        ]
        """Of rows."""
        self.fraction = np.where(rows.integer, np.abs(x - np.round(x)), self.distance)
        """Of columns: from the nearest whole number, or the nearest bound."""

    def _measure(self, j: int, is_upper: bool) -> None:
        """Choose the bound of continuous column `j` that is nearest, rather a variable one."""
        x, minimum = self.x, math.inf
        best: Side | VariableBound | None = None
        for way, bound in self.rows.variable_bounds[j]:
            end = float(bound.at_zero) + float(bound.slope) * x[bound.column]
            if way == is_upper and abs(end - x[j]) < minimum - 1e-9:
                best, minimum = bound, abs(end - x[j])
        side = self.rows.box.upper[j] if is_upper else self.rows.box.lower[j]
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

    def add_up(self, weights: dict[int, float]) -> RowSum:
        """The sum of rows by `weights`, each from its nearer side."""
        total = np.zeros(self.rows.n_columns)
        side = 0.0
        whole: list[tuple[float, float]] = []
        slacks: list[tuple[float, float]] = []
        ends: set[int] = set()
        for i, weight in weights.items():
            total[self.rows.columns[i]] += weight * self.rows.coefficients[i]
            low, high = self.rows.sides[i]
            activity = self.activity[i]
            at_upper = abs(high - activity) <= abs(low - activity)
            side += weight * (high if at_upper else low)
            if at_upper:
                ends.add(i)
            if low != high:
                distance = high - activity if at_upper else activity - low
                (whole if self.rows.is_whole[i] else slacks).append(
                    (weight if at_upper else -weight, max(distance, 0.0))
                )
        total[np.abs(total) < 1e-11 * np.abs(total).max()] = 0.0
        return RowSum(weights, frozenset(ends), total, side, whole, slacks)

    def cut(self, summed: RowSum) -> Found | None:
        """The best cut of a sum of rows, if it is violated enough."""
        used, total, side = summed.used, summed.total, summed.side
        rest_of = self._measured(used[~self.rows.integer[used]], total)
        if not np.isfinite(rest_of.distance).all():
            return None
        on_integers = np.where(self.rows.integer, total, 0.0)
        side -= float(rest_of.a @ rest_of.side)
        varying = rest_of.by >= 0
        np.add.at(on_integers, rest_of.by[varying], (rest_of.a * rest_of.slope)[varying])
        columns = np.flatnonzero(np.abs(on_integers) > 1e-11)
        if not len(columns) or not np.isfinite(self._end[columns]).all():
            return None
        a = on_integers[columns]
        turned = self._from_upper[columns]
        room = self.rows.upper[columns] - self.rows.lower[columns]
        t = np.abs(self.x[columns] - self._end[columns])
        side -= float(a @ self._end[columns])
        a = np.where(turned, -a, a)
        rest = np.minimum(np.concatenate([rest_of.of_terms, [c for c, _ in summed.slacks]]), 0.0)
        rest_t = np.concatenate([rest_of.distance, [d for _, d in summed.slacks]])
        base = Equation(
            np.concatenate([a, [c for c, _ in summed.whole]]),
            np.concatenate([t, [d for _, d in summed.whole]]),
            np.concatenate([room, [math.inf] * len(summed.whole)]),
            side, float(rest @ rest_t), float(rest @ rest),
        )  # fmt: skip
        rounding = base.best_rounding()
        if rounding is None or rounding[2] < MIN_EFFICACY:
            return None
        flipped, delta, _ = rounding
        from_upper = columns[turned ^ flipped[: len(columns)]]
        direction, violation = self._cut(summed, rest_of, columns, turned, base, rounding)
        support = np.flatnonzero(direction)
        length = math.sqrt(float(direction[support] @ direction[support]))
        if not length or violation / length < MIN_EFFICACY:
            return None
        near = {
            j: self._near[int(is_upper)][j]
            for j, is_upper in zip(rest_of.columns.tolist(), rest_of.is_upper.tolist(), strict=True)
        }
        return Found(
            dict(summed.weights), summed.at_upper, near, frozenset(from_upper.tolist()),
            delta, violation / length, support, direction[support] / length,
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
        summed: RowSum,
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
        direction = np.zeros(self.rows.n_columns)
        own = np.where(flipped, -g, g)
        np.add.at(direction, columns, np.where(turned, -own[:n_columns], own[:n_columns]))
        scale = 1 / (delta * (1 - fraction))
        rest = np.minimum(rest_of.of_terms, 0.0) * scale
        signed = np.where(rest_of.is_upper, -rest, rest)
        direction[rest_of.columns] += signed
        varying = rest_of.by >= 0
        np.add.at(direction, rest_of.by[varying], -(signed * rest_of.slope)[varying])
        whole = iter(own[n_columns:].tolist())
        for i, weight in summed.weights.items():
            low, high = self.rows.sides[i]
            if low == high:
                continue
            upper = i in summed.at_upper
            signed_weight = weight if upper else -weight
            times = next(whole) if self.rows.is_whole[i] else min(signed_weight, 0.0) * scale
            if times:
                own_sign = -times if upper else times
                direction[self.rows.columns[i]] += own_sign * self.rows.coefficients[i]
        t = np.where(flipped, base.room - base.t, base.t)
        violation = float(g @ t) + base.rest * scale - math.floor(side)
        return direction, violation
