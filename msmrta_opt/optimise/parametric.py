"""A program whose cost is linear in a parameter, solved for all values of the parameter at once.

For a cost ``(1 − t) f₀(x) + t f₁(x)`` with t in [0, 1] each feasible x is a line over t, and the optimal
value is their envelope: piecewise linear, with finitely many pieces. Two lines that are optimal at two
values of t bound everything between: solving where they cross either gives a better line, or proves
that there is none (Eisner and Severance 1976). So the pieces are complete, not sampled; and where the
data are rational, costs are scaled to whole numbers, breakpoints are fractions and the proof is exact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..interruption import interrupted
from ..mission.errors import CheckError, ModelError, MsmrtaError, SolverError
from ..mission.exact import exact
from .compile import Compiled
from .program import Program
from .solution import Solution
from .solve import solve_program

LARGEST_DENOMINATOR = 1000
"""Of a cost that is taken for a rational number rather than a rounded one."""
LARGEST_SCALE = 10**6
"""Common denominator up to which costs are scaled to whole numbers."""
LARGEST_EXACT = 2**52
"""Sums of whole numbers up to this are exact in floating point."""
TOLERANCE = 1e-9
"""Relative difference of values that counts as none where the data are not rational."""


@dataclass(frozen=True, eq=False)
class Line:
    """One feasible point, as a line over the parameter.

    ``at_zero`` and ``at_one`` are its objective at t = 0 and t = 1; `x` has shape ``(n_columns,)``.
    """

    at_zero: Fraction
    at_one: Fraction
    x: Floats

    @property
    def slope(self) -> Fraction:
        """Change of the objective over the unit interval."""
        return self.at_one - self.at_zero

    def value(self, t: Fraction) -> Fraction:
        """The objective at `t`."""
        return self.at_zero + t * self.slope

    def same_line(self, other: Line) -> bool:
        """Whether both have the same objective at every t."""
        return self.at_zero == other.at_zero and self.at_one == other.at_one


@dataclass(frozen=True, eq=False)
class Piece:
    """An interval of the parameter over which one line is optimal."""

    low: Fraction
    high: Fraction
    line: Line


@dataclass(frozen=True, eq=False)
class Envelope:
    """The optimal value over [0, 1].

    Parameters
    ----------
    pieces : tuple of Piece
        In the order of t, from 0 without gaps; to 1, unless `interruption` ended it before.
    exact : bool
        Whether the data are rational, so that breakpoints and values are exact; otherwise they hold
        to `TOLERANCE`.
    n_solves : int
        Programs solved to find and to close the pieces.
    """

    pieces: tuple[Piece, ...]
    exact: bool
    n_solves: int

    @property
    def breakpoints(self) -> list[Fraction]:
        """Where one piece ends and the next begins."""
        return [piece.low for piece in self.pieces[1:]]

    def at(self, t: Fraction | float) -> Piece:
        """The piece that holds `t`; at a breakpoint the left one."""
        return next(piece for piece in self.pieces if t <= piece.high)


class Family:
    """The programs that a formulation gives as one parameter runs over its range.

    The range is that which the formulation declares; along it t runs from 0 to 1.

    Parameters
    ----------
    compiled : Compiled
        The formulation on its data.
    parameter : str
        The parameter that runs.
    **others : float
        Values of the other parameters.

    Raises
    ------
    ModelError
        If the parameter does more than weigh two costs: if it enters rows or bounds; or if its range
        has no two finite ends.
    """

    def __init__(self, compiled: Compiled, parameter: str, **others: float) -> None:
        name = self.name = compiled.formulation.name
        self.over = parameter
        if parameter not in compiled.formulation.spec.parameters:
            raise ModelError(f"{name} has no parameter {parameter!r}")
        declared = compiled.formulation.spec.parameters[parameter]
        low, high = declared.low, declared.high
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise ModelError(f"{name}: {parameter} has no range with two finite ends")
        self.low, self.high = exact(low), exact(high)
        middle = low + (high - low) / 2
        ends = [compiled.program(**{**others, parameter: end}) for end in (low, high, middle)]
        if not all(ends[0].differs_in_cost_alone(other) for other in ends[1:]):
            raise ModelError(
                f"{name}: {parameter} enters the rows, so the value is not its envelope"
            )
        if not np.allclose(ends[2].cost, (ends[0].cost + ends[1].cost) / 2, rtol=1e-9, atol=1e-9):
            raise ModelError(f"{name}: the cost is not linear in {parameter}")
        self.program = ends[0]
        self.costs = ends[0].cost, ends[1].cost
        self.offsets = ends[0].offset, ends[1].offset
        whole = _whole_numbers(np.concatenate([*self.costs, self.offsets]))
        self.exact = whole is not None and bool(ends[0].integer.all())
        numbers, self.scale = whole if whole and self.exact else (None, 1)
        n = len(ends[0].cost)
        self._whole = None if numbers is None else (numbers[:n], numbers[n : 2 * n])
        self._whole_offsets = None if numbers is None else numbers[2 * n :]
        self.n_solves = 0

    def parameter(self, t: Fraction) -> Fraction:
        """The value of the parameter at the weight `t`."""
        return self.low + t * (self.high - self.low)

    def line(self, x: Floats) -> Line:
        """The line of a feasible point."""
        if self._whole is None or self._whole_offsets is None:
            values = [
                Fraction(float(cost @ x) + offset)
                for cost, offset in zip(self.costs, self.offsets, strict=True)
            ]
        else:
            point = np.round(x).astype(np.int64)
            values = [
                Fraction(int(cost @ point) + int(offset), self.scale)
                for cost, offset in zip(self._whole, self._whole_offsets, strict=True)
            ]
        return Line(values[0], values[1], x)

    def whole_offset(self, end: int) -> int:
        """The scaled offset at t = 0 or 1; only of an exact family."""
        return 0 if self._whole_offsets is None else int(self._whole_offsets[end])

    def at(self, t: Fraction) -> Program:
        """The program at `t`, without its offset.

        Its cost is scaled to whole numbers where that is exact.
        """
        if self._whole is not None:
            p, q = t.numerator, t.denominator
            largest = max(int(np.abs(cost).max(initial=0)) for cost in self._whole)
            if q * largest * max(self.program.n_columns, 1) < LARGEST_EXACT:
                whole = (q - p) * self._whole[0] + p * self._whole[1]
                return replace(self.program, cost=whole.astype(float), offset=0.0)
        weight = float(t)
        cost = (1 - weight) * self.costs[0] + weight * self.costs[1]
        return replace(self.program, cost=cost, offset=0.0)

    def solve(self, t: Fraction) -> Line:
        """An optimal line at `t`.

        Raises
        ------
        CheckError
            If it has no optimum.
        SolverError
            If none was proved.
        """
        self.n_solves += 1
        solution = replace(solve_program(self.at(t)), formulation=self.name)
        if solution.status != "optimal" or not solution.found:
            raise self._none_at(t, solution)
        return self.line(self.program.flat(solution.values))

    def best_with(self, x: Floats, t: Fraction) -> Fraction:
        """The best value at `t` of all points with the integers of the point `x`."""
        if self.program.integer.all():
            return self.line(x).value(t)
        self.n_solves += 1
        program, whole = self.at(t), self.program.integer
        fixed = replace(
            program.relaxed(),
            lower=np.where(whole, np.round(x), program.lower),
            upper=np.where(whole, np.round(x), program.upper),
        )
        solution = solve_program(fixed)
        if not solution.found:
            raise self._none_at(t, replace(solution, formulation=self.name))
        return self.line(self.program.flat(solution.values)).value(t)

    def _none_at(self, t: Fraction, solution: Solution) -> MsmrtaError:
        """What to say where `t` has no proven optimum."""
        kind = CheckError if solution.status in ("infeasible", "unbounded") else SolverError
        where = f"{self.name} at {self.over} = {float(self.parameter(t)):g}"
        return kind(f"{where}: {solution.status}: {solution.reason}")

    def better(self, a: Fraction, b: Fraction) -> bool:
        """Whether the objective `a` is really better than `b`."""
        gain = (b - a) if self.program.sense == "min" else (a - b)
        return gain > 0 if self.exact else float(gain) > TOLERANCE * max(1.0, abs(float(b)))


def stays_optimal(
    family: Family, x: Floats, value: Fraction, *, until: Callable[[], bool] = interrupted
) -> tuple[Fraction, Fraction]:
    """The values of the parameter, around `value`, at which what the point `x` decides stays optimal.

    That is its integer variables; the others follow. The optimal value is linear on each piece, and the
    best value with these integers is concave and never better. So they are equal all over a piece, or
    nowhere within it, and a look at its middle decides.

    Parameters
    ----------
    family : Family
        The programs.
    x : float array, shape (n_columns,)
        A solution that is optimal at `value`.
    value : Fraction
        The parameter's value there.
    until : callable
        Whether to stop.

    Raises
    ------
    SolverError
        If a program has no proven optimum, or it was to stop.
    """
    width = family.high - family.low
    ends = []
    for far in (Fraction(0), Fraction(1)):
        here = (value - family.low) / width
        while here != far:
            end, line = _piece_from(family, here, far, until)
            middle = (here + end) / 2
            if family.better(line.value(middle), family.best_with(x, middle)):
                break
            here = end
        ends.append(family.low + here * width)
    return ends[0], ends[1]


def _piece_from(
    family: Family, here: Fraction, far: Fraction, until: Callable[[], bool]
) -> tuple[Fraction, Line]:
    """How far towards `far` the piece goes that begins at `here`, and its line."""
    line, end = family.solve(here), far
    while not until():
        other = family.solve(end)
        if not family.better(other.value(end), line.value(end)):
            return end, line
        cross = _crossing(line, other)
        if cross is None or (cross - here) * (far - here) <= 0:
            line = other  # as good at `here`, and better from there on
        else:
            end = cross
    raise SolverError("stopped before it was known")


def envelope(family: Family) -> Envelope:
    """All pieces of the optimal value over [0, 1].

    Raises
    ------
    SolverError
        If the program has no proven optimum at some value of the parameter.
    """
    before = family.n_solves
    zero, one = Fraction(0), Fraction(1)
    lines, are_all = _between(family, family.solve(zero), family.solve(one))
    pieces: list[Piece] = []
    low = zero
    for i, line in enumerate(lines if are_all else lines[:-1]):
        high = _crossing(line, lines[i + 1]) if i + 1 < len(lines) else one
        if high is None or high <= low:
            continue  # optimal at one value only, where its neighbours are too
        pieces.append(Piece(low, min(high, one), line))
        low = high
    return Envelope(tuple(pieces), family.exact, family.n_solves - before)


def _between(family: Family, left: Line, right: Line) -> tuple[list[Line], bool]:
    """The optimal lines from `left` to `right`, both included, in the order of t, and whether all.

    Once interrupted, the last is optimal where it begins, but nobody knows how far.
    """
    # A stack, not a recursion: a program can have more pieces than Python has stack frames.
    found, todo = [left], [right]
    while todo and not interrupted():
        t = _crossing(found[-1], todo[-1])
        if t is None or not 0 <= t <= 1:
            found.append(todo.pop())
            continue
        try:
            middle = family.solve(t)
        except SolverError:
            if not interrupted():
                raise
            break
        if family.better(middle.value(t), found[-1].value(t)):
            todo.append(middle)
        else:
            found.append(todo.pop())
    lines = [line for i, line in enumerate(found) if i == 0 or not line.same_line(found[i - 1])]
    return lines, not todo


def _crossing(a: Line, b: Line) -> Fraction | None:
    """Where two lines cross, or ``None`` if they are parallel."""
    if a.slope == b.slope:
        return None
    return (b.at_zero - a.at_zero) / (a.slope - b.slope)


def _whole_numbers(values: Floats) -> tuple[NDArray[np.int64], int] | None:
    """`values` times their common denominator, and that; ``None`` if they are not rational."""
    unique, inverse = np.unique(values, return_inverse=True)
    fractions = [Fraction(float(value)).limit_denominator(LARGEST_DENOMINATOR) for value in unique]
    near = [
        abs(float(fraction) - value) <= 1e-12 * max(1.0, abs(value))
        for fraction, value in zip(fractions, unique, strict=True)
    ]
    scale = math.lcm(*(fraction.denominator for fraction in fractions))
    if not all(near) or scale > LARGEST_SCALE:
        return None
    whole = np.array([int(fraction * scale) for fraction in fractions], dtype=np.int64)
    return whole[inverse], scale
