r"""Branch and cut over the edge formulation: incumbent and bound close in on each other.

1. The cutting-plane relaxation bounds from below (`cutting_plane`).
2. Better incumbents are looked for where the relaxation goes (`incumbent_search`).
3. Reduced costs fix most columns, and a search tree takes the rest, for better solutions only
   (`reduced_cost_fixing`, `tree`).

It may be stopped at any moment.
"""

from __future__ import annotations

from ...mission.errors import InputError
from ..bound import Bound
from ..incumbent import Progress
from ..parameters import Parameters
from ..problem import RoutingData
from .cutting_plane import Relaxation
from .edge_formulation import EdgeFormulation
from .incumbent_search import IncumbentSearch
from .root import Root
from .root_proof import RootRelaxation
from .symmetry import in_order


def branch_and_cut(
    progress: Progress, *, seed: int = 0, parameters: Parameters | None = None
) -> Bound:
    """Close in on the best routes; they are then the incumbent of `progress`.

    Parameters
    ----------
    progress : Progress
        The joint problem with feasible routes, and when to stop; the better these routes are, the
        sooner the gap closes. Travel times should satisfy the triangle inequality, as walking does:
        without it solutions and bounds hold, but may not meet.
    seed : int
        Of all random choices.
    parameters : Parameters, optional
        How to search.

    Raises
    ------
    InputError
        If the edge formulation does not state the objective.
    SolverError
        If a bound exceeds the value of feasible routes: a bug, never to be passed over.
    """
    if progress.objective.method != "branch and cut":
        raise InputError(
            f"{progress.objective.name!r} is solved by {progress.objective.method}",
            field="objective",
        )
    return _close_in(progress, seed, parameters or Parameters(), whole=True)


def _close_in(progress: Progress, seed: int, parameters: Parameters, *, whole: bool) -> Bound:
    """As `branch_and_cut`; unless `whole`, for a subset of another mission's robots."""
    progress.bound_at_once()
    tuning = parameters.branch_and_cut
    if progress.done() or _n_edges(progress.data) > tuning.maximum_edges:
        return Bound(progress.bound, progress.proof, progress.step.step)
    formulation = EdgeFormulation.of(
        progress.data, progress.objective, progress.value, maximum_weight=tuning.time_weight
    )

    progress.begin("root relaxation")
    relaxation = Relaxation(formulation, routes=progress.routes, parameters=tuning)
    relaxed = relaxation.solve(
        progress.until_done(), proved=lambda bound: progress.raise_bound(bound, "root LP")
    )
    root = Root(progress, formulation, relaxed, relaxation.seen, seed, parameters)

    if not progress.done():
        IncumbentSearch(root).run(
            lambda inner: _close_in(inner, seed, parameters, whole=False), whole=whole
        )

    if not progress.done():
        progress.begin("branch and cut")
        known = progress.value

        def proved(bound: float) -> None:
            progress.raise_bound(min(bound, known, progress.value), "branch and cut")

        tree = root.search(
            formulation.upper,
            stop=progress.until_done(),
            rows=in_order(formulation),
            proved=proved,
        )
        proved(tree.bound)

    evidence = RootRelaxation(formulation, relaxed.cuts, relaxed.dual_values)
    return Bound(progress.bound, progress.proof, progress.step.step, evidence)


def _n_edges(data: RoutingData) -> int:
    """Number of edges of all robots."""
    n_victims = data.can_visit.sum(axis=1)
    return int((n_victims * (n_victims - 1) // 2).sum())
