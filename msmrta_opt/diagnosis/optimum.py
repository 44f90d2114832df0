"""Why a solution is optimal: rows that bind it, dual values, parameters for which it stays so."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Bools, Floats
from ..mission.counting import in_full
from ..mission.errors import ModelError, SolverError
from ..mission.exact import exact
from ..optimise.by_structure import is_by_matrix
from ..optimise.check import TOLERANCE
from ..optimise.parametric import Family, stays_optimal
from ..optimise.program import Block, Program
from ..optimise.solution import Solution
from ..optimise.subject import Subject
from .clock import Clock
from .signs import signs


@dataclass(frozen=True)
class Constraint:
    """The rows of one label, at the optimum."""

    label: str
    n_rows: int
    is_equation: bool
    n_binding: int
    least_slack: float | None
    """Of the rows that do not bind; ``None`` if all do."""
    duals: tuple[float, float] | None
    """The smallest and the largest dual value, where they exist."""


@dataclass(frozen=True)
class BindingRow:
    """A row without slack at the optimum."""

    name: str
    side: float
    dual: float | None
    """The rate at which the optimal value changes with its side, where that is known; by weak duality a
    change of any size gains no more than at that rate, and costs no less."""


@dataclass(frozen=True)
class Range:
    """For which values of a parameter the solution stays optimal, the others as they are."""

    parameter: str
    value: float
    low: Fraction | None = None
    high: Fraction | None = None
    is_exact: bool = False
    """Whether the ends are exact fractions of rational data."""
    message: str = ""
    """Why there is no range."""

    @property
    def text(self) -> str:
        """The range in words."""
        if self.low is None or self.high is None:
            return f"{self.parameter} = {in_full(self.value)}: {self.message}"
        exactly = "" if self.is_exact else " (to 1e-9)"
        low, high = _number(self.low, self.is_exact), _number(self.high, self.is_exact)
        return f"{self.parameter} = {in_full(self.value)}: optimal from {low} to {high}{exactly}"


def _number(end: Fraction, is_exact: bool) -> str:
    plain = in_full(float(end))
    if not is_exact or end.denominator == 1 or Fraction(plain) == end:
        return plain
    return f"{end} ({plain})"


@dataclass(frozen=True)
class Optimum:
    """A solution, and what makes it optimal."""

    solution: Solution
    constraints: tuple[Constraint, ...]
    binding: tuple[BindingRow, ...]
    """Inequalities without slack, and equations with a dual value that is not 0."""
    ranges: tuple[Range, ...]

    @property
    def text(self) -> str:
        """What binds, with dual values, and the parameters' ranges."""
        lines = []
        if self.constraints:
            lines.append("What binds it:")
        for item in self.constraints:
            count = f"{item.n_binding} of {item.n_rows} bind"
            if item.is_equation:
                count = f"{item.n_rows} equation{'s' * (item.n_rows > 1)}"
            slack = "" if item.least_slack is None else f", others have {item.least_slack:.6g} left"
            dual = ""
            if item.duals is not None:
                low, high = (f"{value:.6g}" for value in item.duals)
                dual = f", dual values {low}" if low == high else f", dual values {low} to {high}"
            lines.append(f"  {item.label}: {count}{slack}{dual}")
        if self.constraints and not self.solution.duals:
            is_reduced = is_by_matrix(self.solution.proof)
            by = "with a big M reduced to what is needed" if is_reduced else "by branching"
            lines.append(f"  No dual values: the optimum was found {by}.")
        with_duals = [row for row in self.binding if row.dual]
        if with_duals:
            lines.append("What one more of a side would gain at most, or cost at least:")
            with_duals.sort(key=lambda row: -abs(row.dual or 0.0))
            lines += [f"  {row.name}: {row.dual:+.6g}" for row in with_duals[:MAX_ROWS]]
            if len(with_duals) > MAX_ROWS:
                lines.append(f"  … and {len(with_duals) - MAX_ROWS} more")
        if self.ranges:
            lines.append("How far the parameters may go:")
            lines += [f"  {item.text}" for item in self.ranges]
        return "\n".join(lines)


MAX_ROWS = 12
"""Rows that the text shows, those with the largest dual values."""


def optimum(
    asked: Subject, program: Program, solution: Solution, *, time_limit: float | None = None
) -> Optimum:
    """What makes `solution`, which has values, the optimum of `program`.

    Parameters
    ----------
    asked : Subject
        What was solved.
    program : Program
        Its arrays, with rows named as they are to be told.
    solution : Solution
        What was found.
    time_limit : float, optional
        Seconds for the parameters' ranges.
    """
    x = program.flat(solution.values)
    told = signs(program)
    activity = program.matrix @ x
    terms = 1.0 + np.abs(program.matrix) @ np.abs(x)
    slack = np.minimum(activity - program.row_lower, program.row_upper - activity)
    binds = slack <= TOLERANCE * terms
    duals = np.full(program.n_rows, np.nan)
    for block, named in zip(program.rows, asked.program.rows, strict=True):
        if named.name in solution.duals:
            duals[block.start : block.stop] = solution.duals[named.name].ravel(order="F")
    duals *= told
    is_equation = program.row_lower == program.row_upper
    shown = [block for block in program.rows if block.size]
    return Optimum(
        solution,
        tuple(_constraint(block, is_equation, binds, slack, duals) for block in shown),
        tuple(
            BindingRow(
                program.row_name(int(i)),
                float(told[i] * _side(program, activity, int(i))) + 0.0,
                _known(duals[i]),
            )
            for i in np.flatnonzero(binds & (~is_equation | (np.nan_to_num(duals) != 0)))
        ),
        _ranges(asked, x, Clock(time_limit)) if solution.status == "optimal" else (),
    )


def _side(program: Program, activity: Floats, row: int) -> float:
    low, high = program.row_lower[row], program.row_upper[row]
    return float(low if activity[row] - low < high - activity[row] else high)


def _known(dual: float) -> float | None:
    return None if np.isnan(dual) else float(dual) + 0.0


def _constraint(
    block: Block, is_equation: Bools, binds: Bools, slack: Floats, duals: Floats
) -> Constraint:
    own = slice(block.start, block.stop)
    loose = slack[own][~binds[own]]
    known = duals[own][~np.isnan(duals[own])] + 0.0
    return Constraint(
        block.name,
        block.size,
        bool(is_equation[own].all()),
        int(binds[own].sum()),
        float(loose.min()) if loose.size else None,
        (float(known.min()), float(known.max())) if known.size else None,
    )


def _ranges(asked: Subject, x: Floats, clock: Clock) -> tuple[Range, ...]:
    return tuple(_range(asked, name, x, clock) for name in asked.parameters)


def _range(asked: Subject, name: str, x: Floats, clock: Clock) -> Range:
    value = float(asked.parameters[name])
    if asked.compiled is None or clock.is_up:
        return Range(name, value, message="stopped before its range was known")
    others = {key: v for key, v in asked.parameters.items() if key != name}
    try:
        family = Family(asked.compiled, name, **others)
        low, high = stays_optimal(family, x, exact(value), until=lambda: clock.is_up)
    except ModelError as error:
        said = str(error).partition(": ")[2]
        return Range(name, value, message=f"no range: {said}")
    except SolverError as error:
        return Range(name, value, message=f"no range: {error}")
    return Range(name, value, low, high, family.exact)
