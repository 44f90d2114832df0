"""The search tree, by whichever solver is installed."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable

from ..parameters import BranchAndCutParameters
from ..problem import Routes
from ..run_highs import highs_version
from ..stop import StoppingCriterion
from .subproblem import Subproblem, Tree


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
