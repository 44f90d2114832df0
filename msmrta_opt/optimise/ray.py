"""Why a program is unbounded: a ray, along which the objective improves without end."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, hstack

from ..mission.errors import SolverError
from .program import Program

NAMED = 3
"""Variables that are named."""
SIZE = 1e-7
"""From which an entry of a ray counts, relative to its largest."""


def unbounded_along(program: Program) -> str:
    """The variables along which the objective improves without end, in a sentence.

    The ray has the fewest and smallest entries: of the relaxation, minimum ``|d|₁`` over directions
    d that no row or bound ends and along which the objective improves by its largest cost. Empty if none
    is found.
    """
    from .solvers import Options, get

    n = program.n_columns
    free = np.isinf
    unit = np.abs(program.cost).max(initial=0.0)
    if not unit:
        return ""
    cost = program.sign / unit * program.cost
    # d is the difference of a forward and a backward part, each 0 or more.
    forward = np.where(free(program.upper), np.inf, 0.0)
    backward = np.where(free(program.lower), np.inf, 0.0)
    rows = program.matrix.tocsr()
    both = csr_array(hstack([rows, -rows]))
    directions = Program(
        sense="min",
        cost=np.ones(2 * n),
        offset=0.0,
        matrix=both,
        row_lower=np.where(free(program.row_lower), -np.inf, 0.0),
        row_upper=np.where(free(program.row_upper), np.inf, 0.0),
        lower=np.zeros(2 * n),
        upper=np.concatenate([forward, backward]),
        integer=np.zeros(2 * n, dtype=bool),
    ).with_row(np.concatenate([cost, -cost]), -np.inf, -1.0, "the objective improves")
    try:
        found = get("highs").solve(directions, Options(time_limit=10.0)).x
    except SolverError:
        return ""
    if found is None:
        return ""
    ray = found[:n] - found[n:]
    places = np.flatnonzero(np.abs(ray) > SIZE * np.abs(ray).max(initial=0.0))
    if not places.size:
        return ""
    named = [
        f"{'more' if ray[j] > 0 else 'less'} {program.column_name(int(j))}" for j in places[:NAMED]
    ]
    others = places.size - len(named)
    rest = f" and {others} more" if others > 0 else ""
    return (
        f"the objective improves without end by {', '.join(named)}{rest}; bound them, or mend the "
        "row that should"
    )
