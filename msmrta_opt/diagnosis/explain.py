"""Why a program has no solution, or the one that it has, in the modeller's words and ids."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from ..interruption import interruptible
from ..mission.counting import in_full
from ..optimise.program import Program
from ..optimise.solution import Solution
from ..optimise.solve import solve_program
from ..optimise.solvers import Options
from ..optimise.subject import Subject, subject
from .clock import Clock
from .conflict import Conflict, find_conflict
from .fixings import Asked, fixings
from .forbidden import forbidden, in_words
from .numerics import Hazard, hazards, hazards_text
from .optimum import Optimum, optimum
from .repair import Repair, repair
from .terms import summands
from .why_not import WhyNot
from .why_not import why_not as find_why_not

SHARE = 0.5
"""Of the time limit that goes to the first solve; the rest is for what follows from it."""


@dataclass(frozen=True)
class Explanation:
    """What can be said of a program and its solution."""

    name: str
    status: Literal["infeasible", "optimal", "feasible", "unbounded", "unknown"]
    """``feasible`` if a solution is known, but not that it is the best; ``unknown`` if there was neither
    a proof nor a point when the time was up."""
    solution: Solution
    hazards: tuple[Hazard, ...] = ()
    """What is numerically dangerous."""
    conflict: Conflict | None = None
    """Why there is no solution."""
    repair: Repair | None = None
    """What would have to give way."""
    optimum: Optimum | None = None
    """Why the solution is the best."""
    why_not: WhyNot | None = None
    """Why it is not as was asked for."""

    @property
    def text(self) -> str:
        """All of it in words."""
        return "\n".join(part for part in self._parts() if part)

    def __str__(self) -> str:
        return self.text

    def _parts(self) -> list[str]:
        found = self.solution
        parts = []
        if self.conflict is not None and self.conflict.status == "infeasible":
            parts.append(self.conflict.text)
        elif self.status == "unknown":
            parts.append(f"{self.name}: stopped before it was known to have a solution.")
        elif self.status == "unbounded":
            parts.append(f"{self.name} is unbounded. {found.message}".strip())
        elif found.objective is None:
            parts.append(f"{self.name} is feasible; no solution was found in time.")
        else:
            bound = "none" if found.bound is None else in_full(found.bound)
            best = "optimal" if self.status == "optimal" else f"the best found, bound {bound}"
            parts.append(
                f"{self.name} is feasible: {in_full(found.objective)} ({found.sense}) is {best}, by"
                f" {found.solver}{f', {found.proof}' if found.proof else ''}."
            )
        if self.repair is not None:
            parts.append(self.repair.text)
        if self.why_not is not None:
            parts.append(self.why_not.text)
        elif self.optimum is not None:
            parts.append(self.optimum.text)
        parts.append(hazards_text(self.hazards))
        return parts

    def as_dict(self) -> dict[str, Any]:
        """All of it, ready for JSON; exact numbers as text."""
        found = self.solution
        optimal = None if self.optimum is None else asdict(self.optimum)
        if optimal is not None:
            del optimal["solution"]
        mended = None if self.repair is None else asdict(self.repair)
        if mended is not None:
            del mended["point"]
        found_all: dict[str, Any] = _plain(
            {
                "name": self.name,
                "status": self.status,
                "objective": found.objective,
                "bound": found.bound,
                "sense": found.sense,
                "proof": found.proof,
                "solution": dict(found.nonzero()),
                "conflict": None if self.conflict is None else asdict(self.conflict),
                "repair": mended,
                "optimum": optimal,
                "why_not": None if self.why_not is None else asdict(self.why_not),
                "hazards": [asdict(item) for item in self.hazards],
            }
        )
        return found_all


def explain(
    what: Any,
    data: Any = None,
    *,
    why_not: Asked | None = None,
    weights: Mapping[str, float] | None = None,
    time_limit: float | None = None,
    **parameters: float,
) -> Explanation:
    """Say why a program has no solution, or why it has the one that it has.

    Parameters
    ----------
    what : cvxpy.Problem, str, Formulation, path or Program
        Any linear (integer) problem of cvxpy; a formulation, which takes `data`; a file in MPS or LP
        format; or arrays.
    data
        What the formulation's stage takes, for instance `ClusterData`.
    why_not : str, mapping, list or path, optional
        Values that one would rather have: ``"x[2,1]=1"``, ``{"x[2,1]": 1}``, or a file of them.
    weights : dict of str to float, optional
        Of a repair: what a unit of relaxation costs by the label of rows (by default 1), or by the name
        of a variable for its bounds (by default they stay); ``inf`` for what must stay.
    time_limit : float, optional
        Seconds. When they are over, what is known by then is given.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Returns
    -------
    Explanation
        Print it, or take it apart.

    Raises
    ------
    InputError
        If a name, the time limit, a weight or a parameter is wrong.
    ModelError
        If it cannot be built as a linear integer program.
    """
    clock = Clock(time_limit)
    asked = subject(what, data, **parameters)
    program = asked.described
    given = None if why_not is None else fixings(program, why_not)
    with interruptible():
        return _explained(asked, program, given, weights, clock)


def _explained(
    asked: Subject,
    program: Program,
    given: dict[int, float] | None,
    weights: Mapping[str, float] | None,
    clock: Clock,
) -> Explanation:
    dangerous = hazards(program)
    share = None if clock.left is None else SHARE * clock.left
    solution = solve_program(asked.program, options=Options(time_limit=share))
    if not solution.found and solution.status != "unbounded":
        conflict = find_conflict(program, time_limit=clock.left, name=asked.name)
        if conflict.bounds:
            said = in_words(conflict.bounds, forbidden(program, asked.data))
            conflict = replace(conflict, said=said)
        mended = None
        if conflict.status == "infeasible" and not clock.is_up:
            mended = repair(program, weights=weights, time_limit=clock.left)
        return Explanation(
            asked.name, conflict.status, solution, dangerous, conflict=conflict, repair=mended
        )
    status: Literal["optimal", "unbounded", "feasible"] = "feasible"
    if solution.status in ("optimal", "unbounded"):
        status = solution.status
    if not solution.found:
        return Explanation(asked.name, status, solution, dangerous)
    if given is not None:
        against = find_why_not(
            program,
            given,
            program.flat(solution.values),
            summands=summands(asked),
            is_proven=status == "optimal",
            reasons=forbidden(program, asked.data),
            time_limit=clock.left,
        )
        return Explanation(asked.name, status, solution, dangerous, why_not=against)
    why = optimum(asked, program, solution, time_limit=clock.left)
    return Explanation(asked.name, status, solution, dangerous, optimum=why)


def _plain(value: Any) -> Any:
    """`value` as JSON has it."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, (Fraction, np.ndarray)):
        return str(value)
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    return value
