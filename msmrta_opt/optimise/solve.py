"""From a formulation and data, or any linear integer program, to one checked `Solution`.

The solver ``auto`` (the default) lets the matrix decide (`by_structure`); one asked for by name gets
the integer program as it stands. What either claims is believed as far as `verify` goes, and what comes
out is shown only if it passes `check`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import Floats
from ..interruption import interruptible
from ..mission.errors import InputError, UnsupportedError
from .by_structure import is_by_matrix, solve_by_structure
from .check import TIGHT, TOLERANCE, Point, dual_bound, settled, violations
from .contradiction import BY_HAND, contradiction
from .program import ROUNDING, Program
from .ray import unbounded_along
from .scaling import objective_size, scaling
from .solution import Solution
from .solvers import Options, Outcome, get
from .solvers.base import refuse_infinite_costs
from .solvers.outcomes import PROVEN
from .structure import Structure, recognise
from .subject import subject
from .verify import PROVED, Verifier

AUTO = "auto"


def solve(
    what: Any,
    data: Any = None,
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
    """Solve a formulation on data, or a linear integer program from elsewhere.

    Parameters
    ----------
    what : str, Formulation, path, cvxpy.Problem or Program
        A formulation, by its name or itself, which takes `data`; a file in MPS or LP format; any linear
        (integer) problem of cvxpy; or arrays.
    data
        What the formulation's stage takes, for instance `ClusterData`.
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
        If it cannot be built as a linear integer program.
    SolverError
        If the solver is missing, or cannot do what is asked.
    """
    options = Options(time_limit=time_limit, gap=gap, seed=seed, threads=threads, verbose=verbose)
    began = time.perf_counter()
    asked = subject(what, data, **parameters)
    program, compiled = asked.program, asked.compiled
    canonicalised = time.perf_counter() - began
    if start is not None:
        options = replace(options, start=_start(program, start))
    solution = solve_program(
        program,
        solver=solver,
        structure=structure,
        options=options,
        recognised=None if compiled is None else lambda: compiled.structure(program),
    )
    broken = compiled.broken(solution.values) if compiled is not None and solution.found else ""
    if broken:
        solution = replace(_failed(solution, broken), objective=None, values={})
    return replace(
        solution,
        formulation=asked.name,
        digest="" if compiled is None else compiled.formulation.digest,
        parameters=dict(asked.parameters),
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
    refuse_infinite_costs(program)
    program = program.with_whole_bounds()
    name = "highs" if solver == AUTO else solver
    wrong = contradiction(program)
    tight = program if wrong else program.with_tight_coefficients()
    verifier = Verifier(program, tight, options, began)
    with interruptible():
        if wrong:
            get(name)
            outcome = Outcome("infeasible", proof=BY_HAND, message=wrong)
        else:
            known = recognised if tight is program else None
            name, outcome = _asked(verifier, solver, structure, known)
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
        offset=program.constant,
        unit=scaling(program).unit,
        blocks=(*program.columns, *program.rows),
    )
    if outcome.status == "unbounded":
        solution = replace(solution, message=unbounded_along(program) or outcome.message)
    if options.start is not None:
        solution = replace(solution, start=_use_of(program, options.start, name, outcome))
    # Of smaller coefficients they would be another program's: a row with a big M binds there alone.
    if outcome.duals is not None and tight is program:
        solution = _with_duals(solution, program, outcome.duals)
    if outcome.x is None or outcome.status not in ("optimal", "feasible", "claimed"):
        return solution
    return _checked(solution, program, verifier.look_at(outcome.x))


def _asked(
    verifier: Verifier,
    solver: str,
    structure: bool,
    recognised: Callable[[], Structure | None] | None,
) -> tuple[str, Outcome]:
    """The solver that solved it, and its outcome, as far as that can be believed."""
    name = "highs" if solver == AUTO else solver
    tight, options = verifier.tight, verifier.options
    try:
        if solver == AUTO and structure:
            known = recognised or (lambda: recognise(tight))
            name, outcome = solve_by_structure(tight, options, known)
        else:
            outcome = get(name).solve(tight, options)
    except UnsupportedError:
        truth = verifier.settled() if solver == AUTO else None
        if truth is None:
            raise
        return name, truth
    return verifier.believed(name, outcome, own=solver == AUTO)


def _use_of(program: Program, start: Floats, name: str, outcome: Outcome) -> str:
    """What became of a MIP start."""
    if is_by_matrix(outcome.proof):
        return "not used: the relaxation has an integral vertex"
    if not np.isfinite(start).all():
        return f"partial: {name} may complete it or not"
    wrong = violations(program, settled(program, start))
    return f"not used: {wrong[0]}" if wrong else f"feasible, worth {program.value(start):g}"


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


def _checked(solution: Solution, program: Program, point: Point) -> Solution:
    """The solution with its incumbent, if it passes the independent check."""
    x = point.x
    if point.wrong:
        return _failed(solution, point.wrong[0])
    objective = program.value(x)
    bound, size = solution.bound, objective_size(program, objective)
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
        violation=point.violation,
    )


def _failed(solution: Solution, check: str) -> Solution:
    """The solution whose incumbent failed its check: nothing of it is shown."""
    return replace(solution, status="error", bound=None, proof="", duals={}, check=check)


def _start(program: Program, values: Mapping[str, Floats]) -> Floats:
    known = {block.name: block.shape for block in program.columns}
    if not isinstance(values, Mapping):
        given = type(values).__name__
        raise InputError(f"{given}; give arrays by variable, of {', '.join(known)}", field="start")
    for name, array in values.items():
        if name not in known:
            raise InputError(f"no variable {name!r}; there are {', '.join(known)}", field="start")
        if np.shape(array) != known[name]:
            raise InputError(
                f"shape {np.shape(array)} where {name} has {known[name]}", field=f"start.{name}"
            )
    return program.flat(values)
