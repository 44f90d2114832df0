"""The search tree: what it is given, what it proves, and which solver searches it."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ...arrays import Floats
from ..parameters import BranchAndCutParameters
from ..problem import Routes
from ..run_highs import highs_version
from ..stop import StoppingCriterion
from .edge_formulation import EdgeFormulation, Row
from .separation import Cut


@dataclass(frozen=True, eq=False)
class Subproblem:
    """The edge formulation within bounds of its columns, for solutions better than one known."""

    formulation: EdgeFormulation
    lower: Floats
    """Lower bounds of the columns, ``(n_columns,)``."""
    upper: Floats
    """Upper bounds, ``(n_columns,)``; columns fixed to 0 stay out."""
    known: float
    """Value of the best solution known."""
    cuts: tuple[Cut, ...] = ()
    """To start with."""
    rows: Sequence[Row] = ()
    """Besides those of the formulation, see `symmetry`."""


@dataclass(frozen=True)
class Tree:
    """The outcome of a search tree."""

    bound: float
    """No solution of the subproblem costs less, unless it costs as much as the one known."""
    complete: bool
    """Whether the tree was searched to its end."""
    nodes: int


def search_tree(
    problem: Subproblem,
    *,
    stop: StoppingCriterion | None = None,
    seed: int = 0,
    parameters: BranchAndCutParameters | None = None,
    improved: Callable[[Routes], object] = lambda routes: None,
    proved: Callable[[float], object] = lambda bound: None,
) -> Tree:
    """Solve `problem` by branch and cut: by SCIP where it is installed, by HiGHS where not.

    Parameters
    ----------
    problem : Subproblem
        What to solve.
    stop : StoppingCriterion, optional
        When to end before the tree is searched.
    seed : int
        Of the solver's random choices.
    parameters : BranchAndCutParameters, optional
        How to separate cuts.
    improved : callable
        Called with the routes of every integral point that satisfies all cuts.
    proved : callable
        Told of the bound now and then.
    """
    if has_scip():
        from .scip_tree import search_by_scip as search
    else:
        from .highs_tree import search_by_highs as search
    return search(
        problem,
        stop=stop or StoppingCriterion(),
        seed=seed,
        parameters=parameters or BranchAndCutParameters(),
        improved=improved,
        proved=proved,
    )


def has_scip() -> bool:
    """Whether SCIP is installed."""
    return importlib.util.find_spec("pyscipopt") is not None


def solvers() -> str:
    """The solvers of relaxation and tree with their versions, for certificates."""
    if not has_scip():
        return highs_version()
    from pyscipopt import Model

    scip = Model()
    number = f"{scip.getMajorVersion()}.{scip.getMinorVersion()}.{scip.getTechVersion()}"
    return f"{highs_version()}, scip {number}"
