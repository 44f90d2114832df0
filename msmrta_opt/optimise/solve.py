"""From a formulation and data to one checked `Solution`.

The solver ``auto`` (the default) lets the matrix decide: a program proven to be an assignment goes to
an assignment algorithm, one proven totally unimodular to the simplex method; any other is relaxed
first, and goes to HiGHS' branch and bound only if the relaxation's vertex is not integral. A solver
asked for by name gets the integer program as it stands.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Bools, Floats
from ..interruption import interruptible
from ..mission.errors import InputError, SolverError, UnsupportedError
from .assignment import solve_assignment
from .check import (
    ROUNDING,
    TOLERANCE,
    dual_bound,
    is_badly_scaled,
    largest_violation,
    proves_infeasible,
    settled,
    violations,
)
from .compile import compile_for, parameter_values
from .program import Program
from .registry import Formulation
from .scaling import scaled, scaling
from .settle import Settled, settle
from .solution import Solution
from .solvers import Options, Outcome, get, solvers
from .solvers.highs import infeasible_ray
from .solvers.outcomes import PROVEN
from .structure import Structure, integral_relaxation, recognise

AUTO = "auto"
TIGHT = 1e-9
"""Difference up to which a bound equals the objective, relative to it or to the unit of `scaling`."""
PROVED = ("optimal", "feasible", "infeasible", "claimed")
BY_HAND = "a contradiction within one row or pair of bounds"
_CERTIFIED = (BY_HAND,)
BY_MATRIX = ("assignment algorithm", "simplex", "integral vertex")
"""How a matrix is told to be solved without branching, by duality."""


def solve(
    formulation: str | Formulation,
    data: Any,
    *,
    solver: str = AUTO,
    structure: bool = True,
    time_limit: float | None = None,
    gap: float | None = None,
    seed: int | None = None,
    threads: int | None = None,
    start: dict[str, Floats] | None = None,
    verbose: bool = False,
    **parameters: float,
) -> Solution:
    """Solve `formulation` on `data`.

    Parameters
    ----------
    formulation : str or Formulation
        Its name in the registry, or itself.
    data
        What its stage takes, for instance `ClusterData`.
    solver : str
        ``auto``, or the name of a solver (`solvers.solvers`).
    structure : bool
        Whether ``auto`` may use what the matrix proves; without it, HiGHS gets the integer program.
    time_limit : float, optional
        Seconds for the solver.
    gap : float, optional
        Relative gap to stop at; by default optimality is proven.
    seed, threads, verbose
        See `solvers.Options`.
    start : dict of str to array, optional
        A point to start from, by variable name.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Returns
    -------
    Solution
        With values only if they passed the independent check.

    Raises
    ------
    InputError
        If a name, an option or a parameter is wrong.
    ModelError
        If the formulation cannot be built as a linear integer program.
    SolverError
        If the solver is missing, or cannot do what is asked.
    """
    options = Options(time_limit=time_limit, gap=gap, seed=seed, threads=threads, verbose=verbose)
    began = time.perf_counter()
    compiled = compile_for(formulation, data)
    program = compiled.program(**parameters)
    canonicalised = time.perf_counter() - began
    if start is not None:
        options = replace(options, start=_start(program, start))
    return replace(
        solve_program(
            program,
            solver=solver,
            structure=structure,
            options=options,
            recognised=lambda: compiled.structure(program),
        ),
        formulation=compiled.formulation.name,
        parameters=parameter_values(compiled.formulation, parameters),
        canonicalise_seconds=canonicalised,
    )


def solve_program(
    program: Program,
    *,
    solver: str = AUTO,
    structure: bool = True,
    options: Options | None = None,
    recognised: Callable[[], Structure | None] | None = None,
) -> Solution:
    """Solve arrays, from wherever they come; see `solve`.

    `recognised` tells the structure of the arrays, if the caller knows it already.
    """
    options = options or Options()
    began = time.perf_counter()
    program = program.with_whole_bounds()
    name = "highs" if solver == AUTO else solver
    contradiction = _contradiction(program)
    with interruptible():
        if contradiction:
            get(name)
            outcome = Outcome("infeasible", proof=BY_HAND, message=contradiction)
        else:
            task = _Task(program, program.with_tight_coefficients(), options, began)
            known = recognised if task.tight is program else None
            name, outcome = task.solved(solver, structure, known)
    solution = Solution(
        formulation="",
        status=outcome.status,
        sense=program.sense,
        bound=outcome.bound,
        proof=outcome.proof if outcome.status in PROVED else "",
        solver=name,
        solver_version=get(name).version,
        message=outcome.message,
        options=options.given(),
        tolerances={
            "row": TOLERANCE,
            "row of whole-number columns": ROUNDING,
            **get(name).tolerances,
        },
        solve_seconds=time.perf_counter() - began,
        nodes=outcome.nodes,
        n_variables=program.n_columns,
        n_rows=program.n_rows,
        offset=program.offset,
        blocks=(*program.columns, *program.rows),
    )
    if options.start is not None:
        solution = replace(solution, start=_use_of(program, options.start, name, outcome))
    if outcome.duals is not None:
        solution = _with_duals(solution, program, outcome.duals)
    if outcome.x is None or outcome.status not in ("optimal", "feasible", "claimed"):
        return solution
    return _checked(solution, program, outcome.x)


@dataclass(frozen=True)
class _Task:
    """A program, the same with tight big-Ms, and what was asked of it."""

    program: Program
    tight: Program
    options: Options
    began: float

    def solved(
        self, solver: str, structure: bool, recognised: Callable[[], Structure | None] | None
    ) -> tuple[str, Outcome]:
        """The solver that solved it, and its outcome, as far as that can be believed."""
        name = "highs" if solver == AUTO else solver
        try:
            if solver == AUTO and structure:
                known = recognised or (lambda: recognise(self.tight))
                name, outcome = _by_structure(self.tight, self.options, known)
            else:
                outcome = get(name).solve(self.tight, self.options)
        except UnsupportedError:
            truth = settle(self.program) if solver == AUTO else None
            if truth is None:
                raise
            return name, self._as_settled(truth, "")
        outcome = self._repaired(outcome)
        if outcome.status in ("error", "skipped", "no_solution") and solver != AUTO:
            return name, outcome
        if outcome.proof in _CERTIFIED and outcome.status in PROVED:
            return name, outcome
        by_duality = outcome.status == "optimal" and any(w in outcome.proof for w in BY_MATRIX)
        if by_duality and self.program.integer.all() and self._holds(outcome.x):
            return name, outcome
        truth = settle(self.program)
        if truth is not None:
            return name, self._against(truth, name, outcome, own=solver == AUTO)
        if outcome.status == "infeasible":
            return self._certified(name, outcome, own=solver == AUTO)
        if solver == AUTO and outcome.status == "optimal" and is_badly_scaled(self.tight):
            return self._agreed(name, outcome)
        return name, outcome

    def _left(self, atleast: float = 0.0) -> Options:
        left = self.options.time_limit
        if left is not None:
            left = max(left - (time.perf_counter() - self.began), atleast)
        return replace(self.options, time_limit=left, start=None)

    def _holds(self, x: Floats | None) -> bool:
        return x is not None and not violations(self.program, settled(self.program, x))

    def _repaired(self, outcome: Outcome) -> Outcome:
        """The outcome with integers made whole, and then what is continuous solved again."""
        program = self.program
        if outcome.x is None or outcome.status not in ("optimal", "feasible"):
            return outcome
        if program.integer.all() or not program.integer.any() or self._holds(outcome.x):
            return outcome
        whole = np.where(program.integer, np.round(outcome.x), 0.0)
        fixed = replace(
            program.relaxed(),
            lower=np.where(program.integer, whole, program.lower),
            upper=np.where(program.integer, whole, program.upper),
        )
        again = get("highs").solve(fixed, self._left())
        if not self._holds(again.x):
            return outcome
        # The bound may still be the solver's own; whether it proves this point is for the check.
        return replace(outcome, x=again.x)

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
        unit = 1e-9 * max(_unit(self.program), abs((right.bound or 0.0) - self.program.offset))
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
        asked = [(name, replace(self._left(), presolve=False))] if name == "highs" else []
        asked += [(other, self._left()) for other in _others(name, self.program)]
        agree = []
        for other, options in asked:
            try:
                second = self._repaired(get(other).solve(self.tight, options))
            except SolverError:
                continue
            if self._holds(second.x):
                said = f"{name} calls it infeasible, but {other} has a feasible point"
                if own or other == name:
                    return other, replace(second, message=said)
                return name, Outcome("contradicted", message=said)
            if second.status == "infeasible":
                agree.append(f"{other} without presolve" if other == name else other)
            if agree and agree[-1] != f"{name} without presolve":
                break
        if agree:
            return name, replace(outcome, proof=f"{name}, and {' and '.join(agree)}")
        return name, Outcome("no_solution", message=f"{name} alone claims that it is infeasible")

    def _agreed(self, name: str, outcome: Outcome) -> tuple[str, Outcome]:
        """An optimum of numbers of very different size, with a second solver's opinion."""
        if outcome.x is None or outcome.bound is None:
            return name, outcome
        value, sign = self.program.value(settled(self.program, outcome.x)), self.program.sign
        slack = 1e-6 * max(_unit(self.program), abs(value - self.program.offset))
        limit = max(10.0, 10 * (time.perf_counter() - self.began))
        for other in _others(name, self.program):
            options = self._left()
            options = replace(options, time_limit=min(options.time_limit or limit, limit))
            try:
                second = self._repaired(get(other).solve(self.tight, options))
            except SolverError:
                continue
            if not self._holds(second.x) or second.x is None or second.status != "optimal":
                continue
            theirs = self.program.value(settled(self.program, second.x))
            if abs(theirs - value) <= slack:
                return name, replace(outcome, proof=f"{outcome.proof}; {other} agrees")
            said = f"{name} claims {value:g}, {other} {theirs:g}"
            if sign * (theirs - value) < 0:
                return other, replace(second, status="claimed", message=said)
            return name, replace(outcome, status="claimed", message=said)
        said = "claimed by one solver: coefficients of very different size"
        return name, replace(outcome, status="claimed", message=said)


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


def _unit(program: Program) -> float:
    """The size of objective from which differences count; see `scaling`."""
    return scaling(program).unit


def _use_of(program: Program, start: Floats, name: str, outcome: Outcome) -> str:
    """What became of a MIP start."""
    if any(word in outcome.proof for word in BY_MATRIX):
        return "not used: the relaxation has an integral vertex"
    if not np.isfinite(start).all():
        return f"partial: {name} may complete it or not"
    wrong = violations(program, settled(program, start))
    return f"not used: {wrong[0]}" if wrong else f"feasible, worth {program.value(start):g}"


def _contradiction(program: Program) -> str:
    """A row without entries that asks for something, or bounds that cross; empty if there is none.

    Solvers differ in what they make of these.
    """
    empty = np.diff(program.matrix.tocsr().indptr) == 0
    asks = np.maximum(program.row_lower, -program.row_upper) > ROUNDING
    for i in np.flatnonzero(empty & asks):
        return f"row '{program.row_name(int(i))}' holds no variable and is not satisfied"
    for i in np.flatnonzero(_cross(program.row_lower, program.row_upper)):
        return f"the sides of row '{program.row_name(int(i))}' cross"
    for j in np.flatnonzero(_cross(program.lower, program.upper)):
        return f"the bounds of {program.column_name(int(j))} cross"
    return ""


def _cross(lower: Floats, upper: Floats) -> Bools:
    """Where sides cross by more than rounding."""
    return np.asarray(lower > upper + TOLERANCE * (1.0 + np.abs(upper)))


def _by_structure(
    program: Program, options: Options, recognised: Callable[[], Structure | None]
) -> tuple[str, Outcome]:
    """The name of the solver that answered, and what it said."""
    highs = get("highs")
    if not program.integer.any():
        return highs.name, highs.solve(program, replace(options, start=None))
    began = time.perf_counter()
    structure = recognised()
    if structure is not None:
        relaxed = integral_relaxation(program, structure)
        answer = solve_assignment(program, structure)
        if answer is not None:
            x, duals = answer
            bound = dual_bound(relaxed, duals)
            if _is_tight(program, x, bound):
                proof = f"{structure.description}; assignment algorithm, dual values"
                return "lsa", Outcome("optimal", x, bound, duals=duals, proof=proof)
        proof = f"{structure.description}; simplex, dual values"
    else:
        relaxed = program.relaxed()
        proof = "integral vertex of the relaxation, dual values"
    outcome = highs.solve(relaxed, replace(options, start=None, gap=None))
    if outcome.status == "optimal" and outcome.x is not None:
        x = settled(program, outcome.x)
        if not violations(program, x):
            proven = None if outcome.duals is None else dual_bound(relaxed, outcome.duals)
            if proven is not None and _is_tight(program, x, proven):
                return highs.name, replace(outcome, x=x, bound=proven, proof=proof)
    if outcome.status == "infeasible":
        return highs.name, replace(outcome, message="the relaxation is infeasible")
    if options.time_limit is not None:
        left = max(options.time_limit - (time.perf_counter() - began), 0.0)
        options = replace(options, time_limit=left)
    return highs.name, highs.solve(program, options)


def _is_tight(program: Program, x: Floats, bound: float) -> bool:
    value = program.value(x) - program.offset
    return abs(value + program.offset - bound) <= TIGHT * max(_unit(program), abs(value))


def _with_duals(solution: Solution, program: Program, duals: Floats) -> Solution:
    named = {
        block.name: duals[block.start : block.stop].reshape(block.shape, order="F")
        for block in program.rows
    }
    bound = solution.bound
    if bound is None:
        bound = dual_bound(program, duals)
    named = {label: program.sign * values for label, values in named.items()}
    return replace(solution, duals=named, bound=bound if np.isfinite(bound) else None)


def _checked(solution: Solution, program: Program, x: Floats) -> Solution:
    """The solution with its incumbent, if it passes the independent check."""
    x = settled(program, x)
    wrong = violations(program, x)
    if wrong:
        return _failed(solution, wrong[0])
    objective = program.value(x)
    bound, size = solution.bound, max(_unit(program), abs(objective - program.offset))
    if bound is not None:
        if program.sign * (bound - objective) > PROVEN * size:
            return _failed(solution, f"the bound {bound:g} contradicts the objective {objective:g}")
        # What is on the wrong side, or differs, by rounding alone leaves no gap.
        if program.sign * (bound - objective) > 0 or abs(bound - objective) <= TIGHT * size:
            bound = objective
    # A solver that stops at a gap it was allowed calls that optimal; here it is an incumbent.
    closed = bound is None or abs(bound - objective) <= PROVEN * size
    return replace(
        solution,
        status="feasible" if solution.status == "optimal" and not closed else solution.status,
        objective=objective,
        bound=bound,
        values=program.shaped(x),
        check="passed",
        violation=largest_violation(program, x),
    )


def _failed(solution: Solution, check: str) -> Solution:
    """The solution whose incumbent failed its check: nothing of it is shown."""
    return replace(solution, status="error", bound=None, proof="", duals={}, check=check)


def _start(program: Program, values: dict[str, Floats]) -> Floats:
    known = {block.name: block.shape for block in program.columns}
    for name, array in values.items():
        if name not in known:
            raise InputError(f"no variable {name!r}; there are {', '.join(known)}", field="start")
        if np.shape(array) != known[name]:
            raise InputError(
                f"shape {np.shape(array)} where {name} has {known[name]}", field=f"start.{name}"
            )
    return program.flat(values)
