"""Two objectives without a weight: every point that no other beats, and every optimum of a tie.

The points that some weight t of ``(1 − t) f₀ + t f₁`` reaches lie on the envelope (`parametric`). Others
that nothing dominates may lie behind it; they are found by bounding one objective and optimising the
other (ε-constraint; Haimes et al. 1971), and are called unsupported.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ..arrays import Floats
from ..interruption import interrupted
from ..mission.errors import MsmrtaError
from .parametric import Envelope, Family, Line
from .program import Program
from .solution import Solution
from .solve import solve_program

STEP = 1e-6
"""Minimum difference of two points, relative, where the data are not rational."""


@dataclass(frozen=True, eq=False)
class Point:
    """A point that nothing dominates; ``supported`` if some weight reaches it."""

    line: Line
    supported: bool


@dataclass(frozen=True, eq=False)
class Frontier:
    """The points that nothing dominates, from the best ``f₀`` to the best ``f₁``.

    ``complete`` is false if the limit on their number was reached, or `interruption` ended it.
    """

    points: tuple[Point, ...]
    complete: bool


def frontier(family: Family, envelope: Envelope, *, maximum: int = 500) -> Frontier:
    """Every point that nothing dominates, up to `maximum`.

    Parameters
    ----------
    family : Family
        The two objectives: the program's at t = 0 and at t = 1.
    envelope : Envelope
        Of the same family; it tells which points are supported.
    """
    points: list[Point] = []
    limit: Fraction | None = None
    is_all = False
    try:
        while not (is_all or interrupted()):
            line = _best(family, limit)
            is_all = line is None
            if line is None or len(points) == maximum:
                break
            points.append(Point(line, _is_supported(line, envelope, family.exact)))
            limit = line.at_one
    except MsmrtaError:  # a solver that was interrupted has no proven optimum
        if not interrupted():
            raise
    return Frontier(tuple(points), complete=is_all)


def _best(family: Family, limit: Fraction | None) -> Line | None:
    """The best ``f₀`` among points whose ``f₁`` beats `limit`, and of those the best ``f₁``."""
    program = family.at(Fraction(0))
    second = family.at(Fraction(1)).cost
    if limit is not None:
        program = _beating(program, second, family, limit)
    first = _solve(family, program)
    if first is None:
        return None
    # Among the best in f₀ the best in f₁; the row keeps the first, up to half a unit if exact.
    best = float(program.cost @ first)
    slack = 0.5 if family.exact else STEP * max(1.0, abs(best))
    kept = _at_least_as_good(program, program.cost, best, slack)
    last = _solve(family, replace(kept, cost=second))
    return family.line(first if last is None else last)


def _beating(program: Program, cost: Floats, family: Family, limit: Fraction) -> Program:
    if family.exact:
        # In whole numbers what is better is better by at least one; half of it leaves room for
        # the solver's tolerance.
        target = float(limit * family.scale) - family.whole_offset(1) - program.sign * 0.5
    else:
        value = float(limit) - family.offsets[1]
        target = value - program.sign * STEP * max(1.0, abs(value))
    return _at_least_as_good(program, cost, target, 0.0)


def _at_least_as_good(program: Program, cost: Floats, value: float, slack: float) -> Program:
    if program.sense == "min":
        return program.with_row(cost, -np.inf, value + slack, "no worse than before")
    return program.with_row(cost, value - slack, np.inf, "no worse than before")


def _solve(family: Family, program: Program) -> Floats | None:
    family.n_solves += 1
    solution: Solution = solve_program(program)
    if solution.status == "infeasible":
        return None
    return program.flat(solution.require().values)


def _is_supported(line: Line, envelope: Envelope, exact: bool) -> bool:
    """Whether the line touches the envelope anywhere."""
    ends = [piece.low for piece in envelope.pieces] + [Fraction(1)]
    for t in ends:
        best = envelope.at(t).line.value(t)
        difference = abs(line.value(t) - best)
        if difference == 0 or (
            not exact and float(difference) <= 1e-9 * max(1.0, abs(float(best)))
        ):
            return True
    return False


def optima(family: Family, t: Fraction, *, maximum: int = 20) -> tuple[list[Line], bool]:
    """All optimal points at `t`, up to `maximum`, and whether these are all.

    Points that differ only in continuous variables count once.
    """
    program = family.at(t)
    first = _solve(family, program)
    if first is None:
        return [], True
    best = float(program.cost @ first)
    slack = 0.5 if family.exact else 1e-9 * max(1.0, abs(best))
    program = _at_least_as_good(program, program.cost, best, slack)
    found: list[Line] = []
    point: Floats | None = first
    while point is not None and len(found) < maximum:
        found.append(family.line(point))
        # At least one binary variable differs from each point found.
        ones = program.integer & (point > 0.5)
        change = np.where(program.integer, np.where(ones, -1.0, 1.0), 0.0)
        program = program.with_row(change, 1.0 - float(ones.sum()), np.inf, "another point")
        point = _solve(family, program)
    return found, point is None
