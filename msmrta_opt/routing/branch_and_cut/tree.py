"""The search tree, by whichever solver is installed."""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from ...mission.errors import MsmrtaError
from ...optimise.solvers.scip import version as scip_version
from ..parameters import BranchAndCutParameters
from ..problem import Routes
from ..run_highs import highs_version
from ..stop import StoppingCriterion
from .subproblem import Subproblem, Tree, TreeError


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

    HiGHS solves it, too, where SCIP fails. Where HiGHS does, nothing is proved; either failure is
    said in the outcome.

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
    search = partial(
        _search,
        problem,
        stop=stop or StoppingCriterion(),
        seed=seed,
        parameters=parameters or BranchAndCutParameters(),
        improved=improved,
        proved=proved,
    )
    failures: tuple[str, ...] = ()
    for by_scip in (True, False) if has_scip() else (False,):
        try:
            return replace(search(by_scip=by_scip), failures=failures)
        except TreeError as error:
            failures += (str(error),)
    return Tree(-math.inf, complete=False, nodes=0, failures=failures)


def _search(problem: Subproblem, *, by_scip: bool, **options: Any) -> Tree:
    try:
        if by_scip:
            from .scip_tree import search_by_scip

            return search_by_scip(problem, **options)
        from .highs_tree import search_by_highs

        return search_by_highs(problem, **options)
    except (MsmrtaError, TreeError):
        raise
    except Exception as error:
        # Of whatever kind: what a solver does not take loses no plan.
        said = str(error).removeprefix("SCIP: ") or type(error).__name__
        raise TreeError(f"{'SCIP' if by_scip else 'HiGHS'} failed: {said}") from error


def has_scip() -> bool:
    """Whether SCIP is installed."""
    return importlib.util.find_spec("pyscipopt") is not None


def solvers() -> str:
    """The solvers of relaxation and tree with their versions, for certificates."""
    if not has_scip():
        return highs_version()
    return f"{highs_version()}, scip {scip_version()}"
