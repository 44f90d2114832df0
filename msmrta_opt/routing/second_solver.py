"""A bound on the joint problem proved again by a solver that did not make it.

The root relaxation is what `certify.linear_relaxation` writes out from the instance; the explicit
models are those of the registry. HiGHS makes the root bounds, so it is not asked about them.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import numpy as np
from scipy.sparse import csr_array

from ..arrays import Floats
from ..certify.linear_relaxation import Relaxation
from ..mission.errors import InputError, SolverError
from ..optimise.program import Block, Program
from ..optimise.solution import Solution
from ..optimise.solve import solve_program
from ..optimise.solvers import Options, get, solvers

MAKER = "highs"
"""The solver that root bounds come from."""
PREFERRED = ("glpk", "scip")


def other_solver(name: str | None = None) -> str:
    """A solver for linear programs, other than the one that root bounds come from.

    Raises
    ------
    InputError
        If `name` is that one, cannot solve linear programs, or is unknown.
    SolverError
        If none is installed.
    """
    if name is not None:
        if name == MAKER or "lp" not in get(name).abilities:
            why = "made the bound itself" if name == MAKER else "solves no linear programs"
            raise InputError(f"{name} {why}; give {' or '.join(PREFERRED)}", field="--solver")
        return name
    able = [s.name for s in solvers().values() if "lp" in s.abilities and s.name != MAKER]
    for found in (*PREFERRED, *able):
        if get(found).installed:
            return found
    raise SolverError(f"no solver but {MAKER} is installed; {get(PREFERRED[0]).install}")


def root_again(
    relaxation: Relaxation, *, solver: str | None = None, time_limit: float | None = None
) -> Solution:
    """The solution of the root relaxation by another solver.

    Raises
    ------
    InputError, SolverError
        As `other_solver`, or if the solver is not installed.
    """
    return solve_program(
        arrays(relaxation), solver=other_solver(solver), options=Options(time_limit=time_limit)
    )


def arrays(relaxation: Relaxation) -> Program:
    """The relaxation in arrays, for solvers."""
    column = {name: j for j, name in enumerate(relaxation.cost)}
    rows = [(i, row) for i, row in enumerate(relaxation.rows) if row.entries]
    row_of = np.repeat(
        np.arange(len(rows)), np.array([len(row.entries) for _, row in rows], dtype=np.int64)
    )
    column_of = [column[name] for _, row in rows for name in row.entries]
    weight = [float(w) for _, row in rows for w in row.entries.values()]
    n = len(column)
    return Program(
        sense="min",
        cost=_floats(relaxation.cost.values()),
        offset=float(relaxation.offset),
        matrix=csr_array((weight, (row_of, column_of)), shape=(len(rows), n)),
        row_lower=_floats(-np.inf if row.lower is None else row.lower for _, row in rows),
        row_upper=_floats(np.inf if row.upper is None else row.upper for _, row in rows),
        lower=np.zeros(n),
        upper=_floats(relaxation.upper.values()),
        integer=np.zeros(n, dtype=bool),
        columns=(Block("x", 0, (n,)),),
        rows=tuple(Block(row.name, i, ()) for i, (_, row) in enumerate(rows)),
    )


def _floats(numbers: Iterable[Fraction | float]) -> Floats:
    return np.array([float(number) for number in numbers])
