"""One program on many solvers, each in a process of its own: who says what of it, and how fast."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..isolation import Failure, Limits, run_isolated
from ..mission.errors import SolverError
from ..optimise.program import Program
from ..optimise.scaling import objective_size
from ..optimise.solution import Solution
from ..optimise.solve import AUTO, solve_program
from ..optimise.solvers import Options, get, solvers
from ..optimise.subject import subject
from .comparison import GRACE_SECONDS

if TYPE_CHECKING:
    import pandas as pd

AGREE = 1e-6
"""Relative difference of two optimal values that is none."""


def compare_solvers(
    what: Any,
    data: Any = None,
    *,
    solvers: Sequence[str] | None = None,
    time_limit: float | None = 60.0,
    memory_limit: float | None = None,
    gap: float | None = None,
    seed: int | None = None,
    **parameters: float,
) -> pd.DataFrame:
    """Solve one program with many solvers.

    Parameters
    ----------
    what : cvxpy.Problem, str, Formulation, path or Program
        Any linear (integer) problem of cvxpy; a formulation, which takes `data`; a file in MPS or LP
        format; or arrays.
    data
        What the formulation's stage takes, for instance `ClusterData`.
    solvers : sequence of str, optional
        Names; by default ``auto`` and every one that is installed and can do it.
    time_limit : float, optional
        Seconds for each.
    memory_limit : float, optional
        MiB for each.
    gap : float, optional
        Relative gap to stop at.
    seed : int, optional
        Of the solvers' random choices.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Returns
    -------
    DataFrame
        A row for each solver: ``solver``, ``version``, ``status``, ``objective``, ``bound``, ``gap``,
        ``check`` (of its solution, apart from it), ``agrees`` (with the best that is known; ``None``
        where it claims nothing), ``nodes``, ``seconds``, ``message``.

    Raises
    ------
    InputError
        If a name, a limit or a parameter is wrong.
    ModelError
        If it cannot be built as a linear integer program.
    """
    import pandas as pd

    program = subject(what, data, **parameters).program
    options = Options(time_limit=time_limit, gap=gap, seed=seed)
    names = list(solvers) if solvers else _able(program)
    for name in names:
        if name != AUTO:
            get(name)
    found = dict(zip(names, _solutions(program, names, options, memory_limit), strict=True))
    best = _best(program, list(found.values()))
    rows = [_row(program, name, solution, best) for name, solution in found.items()]
    return pd.DataFrame(rows)


def _able(program: Program) -> list[str]:
    """`AUTO` and the installed solvers that take `program`."""
    able = [AUTO]
    for name, solver in solvers().items():
        if solver.installed and (program.integer.all() or "lp" in solver.abilities):
            able.append(name)
    return able


def _solutions(
    program: Program, names: list[str], options: Options, memory_limit: float | None
) -> list[Solution]:
    deadline = None if options.time_limit is None else options.time_limit + GRACE_SECONDS
    found = [Solution("", "error", program.sense)] * len(names)
    results = run_isolated(
        _solved,
        [(program, name, options) for name in names],
        limits=Limits(deadline, memory_limit),
        preload=("msmrta_opt.studies.solver_comparison",),
    )
    with closing(results):
        for place, result in results:
            if isinstance(result, Failure):
                refused = isinstance(result.error, SolverError)
                result = replace(
                    found[place], status="skipped" if refused else "error", message=result.message
                )
            found[place] = result
    return found


def _solved(program: Program, name: str, options: Options) -> Solution:
    return solve_program(program, solver=name, options=options)


def _best(program: Program, found: list[Solution]) -> float | None:
    """The best value of all solutions that passed their check."""
    values = [item.objective for item in found if item.found and item.objective is not None]
    return min(values, key=lambda value: program.sign * value) if values else None


def _row(program: Program, name: str, found: Solution, best: float | None) -> dict[str, Any]:
    agrees: bool | None = None
    if found.status == "infeasible":
        agrees = best is None
    elif found.found and found.bound is not None and best is not None:
        slack = AGREE * objective_size(program, best)
        agrees = program.sign * (found.bound - best) <= slack
    return {
        "solver": name,
        "version": found.solver_version,
        "status": found.status,
        "objective": found.objective,
        "bound": found.bound,
        "gap": found.gap,
        "check": found.check,
        "agrees": agrees,
        "nodes": found.nodes,
        "seconds": found.solve_seconds,
        "message": found.message,
    }
