"""Why a solution is not as someone would have it: the rows that forbid that, or what it costs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import Floats
from ..mission.counting import in_full
from ..optimise.check import row_misses
from ..optimise.program import Program
from ..optimise.solve import solve_program
from ..optimise.solvers import Options
from .clock import Clock
from .conflict import find_conflict
from .fixings import Fixings, fixing_name, with_bounds, with_rows
from .forbidden import Forbidden
from .lists import shortened
from .terms import Summands

SAME = 1e-9
"""Relative difference of objectives that is none."""


@dataclass(frozen=True)
class Term:
    """A variable of the objective, or a summand of it, that is another in the alternative."""

    name: str
    before: float
    """What it adds to the objective at the optimum."""
    after: float
    """What it adds in the alternative."""

    @property
    def change(self) -> float:
        """What the alternative adds."""
        return self.after - self.before

    @property
    def text(self) -> str:
        """For instance ``x[2,1]: 0 to 5 (+5)``."""
        return (
            f"  {self.name}: {in_full(self.before)} to {in_full(self.after)} ({self.change:+.9g})"
        )


@dataclass(frozen=True)
class WhyNot:
    """What stands against values that were asked for."""

    asked: tuple[str, ...]
    status: Literal["forbidden", "costs", "optimal", "unknown"]
    """``optimal`` if they cost nothing."""
    against: tuple[str, ...] = ()
    """Rows and bounds that forbid them."""
    conflicting: tuple[str, ...] = ()
    """Those of the values that conflict with these."""
    integrality: bool = False
    """Whether fractional values would satisfy them all."""
    irreducible: bool = False
    """Whether it is proven that all of these are needed."""
    objective: float | None = None
    """The best with these values; ``status`` is ``unknown`` if that is not proven."""
    optimum: float | None = None
    terms: tuple[Term, ...] = ()
    """The variables in which the objective differs, the largest difference first."""
    binding: tuple[str, ...] = ()
    """Rows that bind variables of the objective which are not counts, in the alternative alone: where a
    maximum comes from."""
    summands: tuple[Term, ...] = ()
    """The same by the summands of the objective as it is written, if it is a sum."""
    moved: tuple[str, ...] = ()
    """What else changes: integer variables, ``x[2,0]: 1 to 0``."""
    is_so: bool = False
    """Whether the optimum has these values already."""

    @property
    def cost(self) -> float | None:
        """By how much the objective is worse than the optimum, or better if that is not proven."""
        if self.objective is None or self.optimum is None:
            return None
        return abs(self.objective - self.optimum)

    @property
    def text(self) -> str:
        """The reason in words."""
        asked = " and ".join(self.asked[:4]) + (", …" if len(self.asked) > 4 else "")
        if self.status == "forbidden":
            words = "in whole numbers" if self.integrality else "together"
            need = "" if self.irreducible else " (maybe not all of these)"
            lines = shortened([*self.conflicting, *self.against])
            return "\n".join(
                [f"Why not {asked}: these cannot hold {words}{need}:", *(f"  {x}" for x in lines)]
            )
        if self.objective is None or self.optimum is None:
            return f"Why not {asked}: stopped before it was known."
        with_it, without = in_full(self.objective), in_full(self.optimum)
        if self.is_so:
            return f"Why not {asked}: it is so in the optimum, {with_it}."
        if self.status == "optimal":
            head = f"Why not {asked}: it costs nothing, {with_it} is the optimum, too."
        elif self.status == "unknown":
            head = (
                f"Why not {asked}: {with_it} was found with it, {without} without; not both are"
                " proven to be the best."
            )
        else:
            head = (
                f"Why not {asked}: it costs {self.cost:.9g}, for the best with it is {with_it} where"
                f" {without} is the optimum."
            )
        parts = [head]
        for title, terms in (("summands", self.summands), ("variables", self.terms)):
            if terms:
                parts += [f"By {title} of the objective:", *_first([t.text for t in terms])]
        if self.binding:
            parts += [
                "What binds it there:",
                *(f"  {row}" for row in shortened(list(self.binding))),
            ]
        if self.moved:
            parts += ["What else changes:", *_first([f"  {item}" for item in self.moved])]
        return "\n".join(parts)


def _first(lines: list[str], maximum: int = 12) -> list[str]:
    more = len(lines) - maximum
    return [*lines[:maximum], f"  … and {more} more"] if more > 0 else lines


def why_not(
    program: Program,
    given: Fixings,
    optimum: Floats,
    *,
    summands: Summands | None = None,
    is_proven: bool = True,
    reasons: Mapping[str, Forbidden] | None = None,
    time_limit: float | None = None,
) -> WhyNot:
    """What stands against the values `given`.

    Parameters
    ----------
    program : Program
        A feasible one.
    given : dict of int to float
        By column, the value that is asked for.
    optimum : float array, shape (n_columns,)
        Its optimal solution.
    summands : callable, optional
        The summands of its objective at a point; see `terms`.
    is_proven : bool
        Whether that is known to be optimal.
    reasons : dict of str to Forbidden, optional
        By bounds what they come from, to be said with them; see `forbidden`.
    time_limit : float, optional
        Seconds.
    """
    clock = Clock(time_limit)
    asked = tuple(f"{program.column_name(j)} = {in_full(value)}" for j, value in given.items())
    best = program.value(optimum)
    if is_proven and all(abs(optimum[j] - value) <= SAME for j, value in given.items()):
        return WhyNot(asked, "optimal", objective=best, optimum=best, is_so=True)
    fixed = with_bounds(program, given)
    outside = [
        j
        for j, value in given.items()
        if not program.lower[j] <= value <= program.upper[j]
        or (program.integer[j] and value != round(value))
    ]
    solution = None
    if not outside:
        solution = solve_program(fixed, options=Options(time_limit=clock.left))
    if solution is None or solution.status not in ("optimal", "feasible", "claimed"):
        found = find_conflict(with_rows(program, given), time_limit=clock.left)
        if found.status != "infeasible":
            return WhyNot(asked, "unknown")
        mine = {fixing_name(program, j, value) for j, value in given.items()}
        why = reasons or {}
        bounds = (f"{x}: {why[x].text}" if x in why else x for x in found.bounds)
        return WhyNot(
            asked,
            "forbidden",
            against=(*(row for row in found.rows if row not in mine), *bounds),
            conflicting=tuple(row for row in found.rows if row in mine),
            integrality=found.integrality,
            irreducible=found.irreducible,
        )
    x = fixed.flat(solution.values)
    value = program.value(x)
    loss = program.sign * (value - best)
    unit = SAME * max(abs(value - program.offset), abs(best - program.offset), 1e-9)
    if abs(loss) <= unit and is_proven:
        status: Literal["optimal", "costs", "unknown"] = "optimal"
    else:
        is_known = is_proven and solution.status == "optimal" and loss > 0
        status = "costs" if is_known else "unknown"
    terms = _terms(program, optimum, x)
    return WhyNot(
        asked,
        status,
        objective=value,
        optimum=best,
        terms=terms,
        summands=_summands(summands, optimum, x),
        binding=_binding(program, optimum, x),
        moved=tuple(
            f"{program.column_name(int(j))}: {in_full(optimum[j])} to {in_full(x[j])}"
            for j in np.flatnonzero(program.integer & (optimum != x) & (program.cost == 0))
        ),
    )


def _terms(program: Program, before: Floats, after: Floats) -> tuple[Term, ...]:
    """The terms of the objective that differ; their changes add up to the difference."""
    change = program.cost * (after - before)
    order = np.argsort(-np.abs(change), kind="stable")
    return tuple(
        Term(
            program.column_name(int(j)),
            float(program.cost[j] * before[j]),
            float(program.cost[j] * after[j]),
        )
        for j in order
        if change[j] != 0
    )


def _summands(at: Summands | None, before: Floats, after: Floats) -> tuple[Term, ...]:
    if at is None:
        return ()
    both = zip(at(before), at(after), strict=True)
    return tuple(Term(name, old, new) for (name, old), (_, new) in both if old != new)


def _binding(program: Program, before: Floats, after: Floats) -> tuple[str, ...]:
    """Rows that hold continuous variables whose terms differ, tight at `after` alone."""
    differ = ~program.integer & (program.cost != 0) & (before != after)
    if not differ.any():
        return ()
    holds = np.asarray((np.abs(program.matrix) @ differ.astype(float)) > 0)
    tight = [np.abs(row_misses(program, x)[0]) <= 1e-7 * (1 + np.abs(program.matrix) @ np.abs(x))
             for x in (before, after)]  # fmt: skip
    return tuple(program.row_name(int(i)) for i in np.flatnonzero(holds & tight[1] & ~tight[0]))
