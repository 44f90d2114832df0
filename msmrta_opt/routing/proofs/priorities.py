"""Which columns a makespan's proof branches on first."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...arrays import Bools, Ints
from ...proofs.relaxation import Relaxed
from .statement import Statement

BINDING = 1e-6
"""Dual value from which on a robot's load is said to bind."""


def binding_first(statement: Statement, columns: Ints) -> Callable[[Relaxed], list[Bools]]:
    """The columns of robots whose loads bind: no other branch raises the bound.

    Of these, what they serve and whom they visit comes before the ways that they walk, which are many
    and much alike; once it is known who serves whom, few are left. Then the same of other robots.

    Parameters
    ----------
    statement : Statement
        Of a makespan.
    columns : int array, shape (n_columns,)
        Those of the formulation's columns that the search has.

    Returns
    -------
    callable
        Of a relaxation's solution, whose first rows are the statement's; the sets to branch on, by the
        places of `columns`.
    """
    formulation = statement.formulation
    robot = np.asarray(formulation.robot)[columns]
    is_assignment = np.zeros(formulation.n_columns, dtype=bool)
    for name, size in (("y", formulation.n_pairs), ("a", len(formulation.services))):
        start = formulation.start(name)
        is_assignment[start : start + size] = True
    assignment = is_assignment[columns]
    stated = statement.program.stated
    load = {
        max(int(formulation.robot[j]) for j in row.columns): i
        for i, row in enumerate(statement.program.rows)
        if row.at_upper >= 0 and stated[row.at_upper].name.startswith("makespan:")
    }

    def first(relaxed: Relaxed) -> list[Bools]:
        if relaxed.duals is None:
            return [assignment]
        binding = [r for r, i in load.items() if abs(relaxed.duals[i]) > BINDING]
        own = np.isin(robot, binding)
        return [own & assignment, own, assignment]

    return first
