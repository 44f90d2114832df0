"""From a formulation and data to one checked `Solution`.

The solver ``auto`` (the default) lets the matrix decide: a program proven to be an assignment goes to
an assignment algorithm, one proven totally unimodular to the simplex method; any other is relaxed
first, and goes to HiGHS' branch and bound only if the relaxation's vertex is not integral. A solver
asked for by name gets the integer program as it stands.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import Bools, Floats
from ..mission.errors import InputError
from .assignment import solve_assignment
from .check import TOLERANCE, dual_bound, settled, violations
from .compile import compile_for, parameter_values
from .program import Program
from .registry import Formulation
from .solution import Solution
from .solvers import Options, Outcome, get
from .structure import Structure, integral_relaxation, recognise

AUTO = "auto"
TIGHT = 1e-9
"""Relative difference up to which a dual bound equals the objective."""


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
    if contradiction:
        get(name)
        outcome = Outcome("infeasible", message=contradiction)
    elif solver == AUTO and structure:
        name, outcome = _by_structure(program, options, recognised or (lambda: recognise(program)))
    else:
        outcome = get(name).solve(program, options)
    seconds = time.perf_counter() - began
    solution = Solution(
        formulation="",
        status=outcome.status,
        sense=program.sense,
        bound=outcome.bound,
        proof=outcome.proof if outcome.status in ("optimal", "feasible") else "",
        solver=name,
        solver_version=get(name).version,
        message=outcome.message,
        options=options.given(),
        solve_seconds=seconds,
        nodes=outcome.nodes,
        n_variables=program.n_columns,
        n_rows=program.n_rows,
        blocks=(*program.columns, *program.rows),
    )
    if outcome.duals is not None:
        solution = _with_duals(solution, program, outcome.duals)
    if outcome.x is None or outcome.status not in ("optimal", "feasible"):
        return solution
    return _checked(solution, program, outcome.x)


def _contradiction(program: Program) -> str:
    """A row without entries that asks for something, or bounds that cross; empty if there is none.

    Solvers differ in what they make of these.
    """
    empty = np.diff(program.matrix.tocsr().indptr) == 0
    asks = np.maximum(program.row_lower, -program.row_upper) > TOLERANCE
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
    value = program.value(x)
    return abs(value - bound) <= TIGHT * max(1.0, abs(value), float(np.abs(program.cost).max()))


def _with_duals(solution: Solution, program: Program, duals: Floats) -> Solution:
    named = {
        block.name: duals[block.start : block.stop].reshape(block.shape, order="F")
        for block in program.rows
    }
    bound = solution.bound
    if bound is None:
        bound = dual_bound(program, duals)
    return replace(solution, duals=named, bound=bound if np.isfinite(bound) else None)


def _checked(solution: Solution, program: Program, x: Floats) -> Solution:
    """The solution with its incumbent, if it passes the independent check."""
    x = settled(program, x)
    wrong = violations(program, x)
    if wrong:
        return _failed(solution, wrong[0])
    objective = program.value(x)
    bound = solution.bound
    if bound is not None:
        slack = 1e-6 * max(1.0, abs(objective))
        if program.sign * (bound - objective) > slack:
            return _failed(solution, f"the bound {bound:g} contradicts the objective {objective:g}")
        # Within rounding, a bound on the wrong side of the incumbent means: no gap.
        if program.sign * (bound - objective) > 0 or abs(bound - objective) <= slack:
            bound = objective
    # A solver that stops at a gap it was allowed calls that optimal; here it is an incumbent.
    proven = solution.status == "optimal" and bound in (None, objective)
    return replace(
        solution,
        status="optimal" if proven else "feasible",
        objective=objective,
        bound=bound,
        values=program.shaped(x),
        check="passed",
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
