"""What is believed of a solver's claim.

Solvers certify falsehoods now and then. Few points are all looked at; an infeasibility needs Farkas
multipliers or a second opinion, and so does an optimum of large whole numbers. Of coefficients of very
different size it is a claim, whoever agrees. What a checked point refutes is a contradiction, and is
shown as one.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Floats
from ..mission.counting import told_apart
from ..mission.errors import SolverError
from .by_structure import is_by_matrix
from .check import (
    TIGHT,
    Point,
    has_large_integers,
    is_badly_scaled,
    proves_infeasible,
    settled,
)
from .compile.bound_tightening import tightened
from .contradiction import BY_HAND
from .program import Program
from .scaling import objective_size, scaled, scaling
from .settle import Settled, settle
from .solvers import Options, Outcome, get, solvers
from .solvers.highs import infeasible_ray
from .solvers.outcomes import PROVEN

PROVED = ("optimal", "feasible", "infeasible", "claimed")
"""Statuses of which an outcome may say how they are proved."""
VERY_DIFFERENT = "coefficients of very different size"
LARGE_INTEGERS = "whole numbers so large that solvers' cuts are not to be relied on"


@dataclass
class Verifier:
    """A program, the same with tight big-Ms, and what was asked of it and when."""

    program: Program
    tight: Program
    options: Options
    began: float
    _seen: tuple[Floats, Point] | None = None

    def settled(self) -> Outcome | None:
        """The outcome by looking at all points; ``None`` if they are not few."""
        truth = settle(self.program)
        return None if truth is None else self._as_settled(truth, "")

    def believed(self, name: str, outcome: Outcome, *, own: bool) -> tuple[str, Outcome]:
        """Who is believed, and what.

        Parameters
        ----------
        name : str
            The solver.
        outcome : Outcome
            What it claims of `tight`.
        own : bool
            Whether the solver was chosen here, so that another may answer in its place.
        """
        outcome = self._repaired(outcome)
        if outcome.status in ("error", "skipped", "no_solution") and not own:
            return name, outcome
        if outcome.proof == BY_HAND and outcome.status in PROVED:
            return name, outcome
        by_duality = outcome.status == "optimal" and is_by_matrix(outcome.proof)
        if by_duality and self.program.integer.all() and self._holds(outcome.x):
            return name, outcome
        truth = settle(self.program)
        if truth is not None:
            return name, self._against(truth, name, outcome, own=own)
        if outcome.status == "infeasible":
            return self._certified(name, outcome, own=own)
        if outcome.status == "unbounded" and self._has_bounds():
            said = f"{name} calls it unbounded, but all variables with a cost have bounds"
            return name, Outcome("contradicted", message=said)
        if outcome.status not in ("optimal", "feasible") or outcome.x is None:
            return name, outcome
        if not self._holds(outcome.x):
            return self._another(name, outcome) if own else (name, outcome)
        doubt = self._doubt(outcome.x)
        if outcome.duals is not None or not doubt:
            return name, outcome
        if outcome.status == "feasible":
            said = f"{outcome.message}; without its bound: {doubt}"
            return name, replace(outcome, bound=None, message=said)
        if own:
            return self._compared(name, outcome, doubt)
        return name, _claimed(f"{name} alone", outcome, doubt)

    def _left(self) -> Options:
        left = self.options.time_limit
        if left is not None:
            left = max(left - (time.perf_counter() - self.began), 0.0)
        return replace(self.options, time_limit=left, start=None)

    def look_at(self, x: Floats) -> Point:
        """`x` as a solution of the program, looked at once."""
        if self._seen is None or self._seen[0] is not x:
            self._seen = x, Point.of(self.program, x)
        return self._seen[1]

    def _holds(self, x: Floats | None) -> bool:
        return x is not None and not self.look_at(x).wrong

    def _for_a_second_opinion(self) -> Options:
        """What is left, and no more than some ten times of what the first opinion took."""
        options = self._left()
        limit = max(10.0, 10 * (time.perf_counter() - self.began))
        left = limit if options.time_limit is None else min(options.time_limit, limit)
        return replace(options, time_limit=left)

    @cached_property
    def _is_badly_scaled(self) -> bool:
        """Whether it is so as solvers get it, within the bounds that rows imply."""
        return is_badly_scaled(scaled(tightened(self.tight), scaling(self.tight)))

    def _doubt(self, x: Floats) -> str:
        """Why an optimum at `x` is more than a solver can be relied on for; empty if it is not."""
        if self._is_badly_scaled:
            return VERY_DIFFERENT
        return LARGE_INTEGERS if has_large_integers(self.program, x) else ""

    def _has_bounds(self) -> bool:
        """Whether the bounds alone keep the objective from being unbounded."""
        cost = self.program.sign * self.program.cost
        ends = np.where(cost > 0, self.program.lower, self.program.upper)
        return bool(np.isfinite(ends[cost != 0]).all())

    def _repaired(self, outcome: Outcome) -> Outcome:
        """The outcome with integers made whole, and then what is continuous solved again."""
        program = self.program
        if outcome.x is None or outcome.status not in ("optimal", "feasible"):
            return outcome
        if program.integer.all() or not program.integer.any() or self._holds(outcome.x):
            return outcome
        x = np.where(program.integer, np.round(outcome.x), 0.0)
        again = get("highs").solve(program.at_integers(x), self._left())
        if again.x is None:
            return outcome
        x[~program.integer] = again.x
        # The bound may still be the solver's own; whether it proves this point is for the check.
        return replace(outcome, x=x) if self._holds(x) else outcome

    def _as_settled(self, truth: Settled, message: str) -> Outcome:
        if truth.x is None:
            return Outcome(
                "infeasible", proof=truth.proof, message=message or "no point is feasible"
            )
        value = self.program.value(truth.x)
        return Outcome("optimal", truth.x, value, proof=truth.proof, message=message)

    def _against(self, truth: Settled, name: str, outcome: Outcome, *, own: bool) -> Outcome:
        """The outcome, if it agrees with what all points say."""
        right = self._as_settled(truth, "")
        unit = 1e-9 * objective_size(self.program, right.bound or 0.0)
        wrong = ""
        if outcome.status in ("optimal", "feasible"):
            holds = self._holds(outcome.x)
            if not (holds or own):
                return outcome  # the check names what is wrong with it
            value = None
            if holds and outcome.x is not None:
                value = self.program.value(settled(self.program, outcome.x))
            if not holds:
                wrong = f"{name} gives a point that is not feasible"
            elif truth.x is None or value is None or right.bound is None:
                wrong = f"{name} calls an infeasible program {outcome.status}"
            else:
                bound = value if outcome.bound is None else outcome.bound
                if self.program.sign * (bound - value) > 1e3 * unit:
                    return self._as_settled(truth, "bound against value") if own else outcome
                if abs(bound - value) <= 1e3 * unit and abs(value - right.bound) > unit:
                    wrong = f"{name} calls {value:g} optimal, where {right.bound:g} is feasible"
                elif self.program.sign * (bound - right.bound) > 1e3 * unit:
                    wrong = f"the bound {bound:g} of {name} is beyond {right.bound:g}"
        elif outcome.status == "infeasible" and truth.x is not None:
            wrong = f"{name} calls a feasible program infeasible"
        elif outcome.status in ("unbounded", "error"):
            wrong = f"{name}: {outcome.message or outcome.status}"
        if own and wrong:
            return replace(right, message=wrong, nodes=outcome.nodes)
        if wrong:
            return Outcome("contradicted", message=f"{wrong}; {truth.proof} were looked at")
        if outcome.status in ("optimal", "infeasible"):
            return replace(
                outcome, bound=right.bound, proof=f"{outcome.proof}; {truth.proof}".strip("; ")
            )
        return outcome

    def _certified(self, name: str, outcome: Outcome, *, own: bool) -> tuple[str, Outcome]:
        """An infeasibility with its certificate, or what contradicts it."""
        factors = scaling(self.tight)
        ray = infeasible_ray(scaled(self.tight, factors), self._left())
        ray = np.zeros(self.tight.n_rows) if ray is None else ray * factors.row
        if proves_infeasible(self.tight, ray):
            return name, replace(
                outcome, proof="Farkas multipliers of the relaxation, in fractions"
            )
        limited = self._for_a_second_opinion()
        asked = [(name, replace(limited, presolve=False))] if name == "highs" else []
        asked += [(other, limited) for other in _others(name, self.program)]
        agree = []
        for other, options in asked:
            try:
                second = self._repaired(get(other).solve(self.tight, options))
            except SolverError:
                continue
            if self._holds(second.x):
                said = f"{name} calls it infeasible, but {other} has a feasible point"
                if own or other == name:
                    second = replace(second, message=said)
                    if second.status == "optimal" and self._is_badly_scaled:
                        second = replace(second, status="claimed")
                    return other, second
                return name, Outcome("contradicted", message=said)
            if second.status == "infeasible":
                agree.append(f"{other} without presolve" if other == name else other)
            if agree and agree[-1] != f"{name} without presolve":
                break
        if not agree:
            return name, Outcome(
                "no_solution", message=f"{name} alone claims that it is infeasible"
            )
        who = f"{name}, and {' and '.join(agree)}"
        if self._is_badly_scaled:
            said = f"claimed to be infeasible by {who}: {VERY_DIFFERENT}"
            return name, Outcome("no_solution", message=said)
        return name, replace(outcome, proof=who)

    def _second_opinions(self, name: str) -> Iterator[tuple[str, Outcome]]:
        """Other solvers, and what each of them says with a point that holds."""
        options = self._for_a_second_opinion()
        for other in _others(name, self.program):
            try:
                second = self._repaired(get(other).solve(self.tight, options))
            except SolverError:
                continue
            if self._holds(second.x) and second.status in ("optimal", "feasible"):
                yield other, second

    def _another(self, name: str, outcome: Outcome) -> tuple[str, Outcome]:
        """Another solver's outcome where a point does not hold, if there is one."""
        for other, second in self._second_opinions(name):
            said = f"the point of {name} is not feasible; claimed by {other} alone"
            status = "claimed" if second.status == "optimal" else second.status
            return other, replace(second, status=status, message=said)
        return name, outcome

    def _compared(self, name: str, outcome: Outcome, doubt: str) -> tuple[str, Outcome]:
        """An optimum that there is `doubt` of, with a second solver's opinion.

        Of very different coefficients two may be wrong alike, so that it stays a claim.
        """
        if outcome.x is None or outcome.bound is None:
            return name, outcome
        value, sign = self.program.value(settled(self.program, outcome.x)), self.program.sign
        is_whole = self.program.integer[self.program.varying != 0].all()
        slack = (TIGHT if is_whole else PROVEN) * objective_size(self.program, value)
        for other, second in self._second_opinions(name):
            if second.x is None or second.status != "optimal":
                continue
            theirs = self.program.value(settled(self.program, second.x))
            if abs(theirs - value) <= slack:
                if doubt == LARGE_INTEGERS:
                    return name, replace(outcome, proof=f"{outcome.proof}, and {other} agrees")
                return name, _claimed(f"{name} and {other}", outcome, doubt)
            mine, his = told_apart(value, theirs)
            said = f"{name} claims {mine}, {other} {his}"
            if sign * (theirs - value) < 0:
                return other, replace(second, status="claimed", message=said)
            return name, replace(outcome, status="claimed", message=said)
        return name, _claimed(f"{name} alone", outcome, doubt)


def _claimed(who: str, outcome: Outcome, doubt: str) -> Outcome:
    return replace(outcome, status="claimed", message=f"claimed by {who}: {doubt}")


def _others(name: str, program: Program) -> list[str]:
    """Installed solvers for a second opinion on `program`, the free ones first."""
    return [
        other
        for other, solver in solvers().items()
        if other not in (name, "lsa")
        and solver.installed
        and (program.integer.all() or "lp" in solver.abilities)
        and "time_limit" in solver.abilities
    ]
