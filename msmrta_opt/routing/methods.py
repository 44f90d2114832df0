"""The exact methods, by the names that the table of objectives gives them."""

from __future__ import annotations

from .bound import Bound
from .branch_and_cut.search import branch_and_cut
from .branch_and_price.search import branch_and_price
from .incumbent import Progress
from .parameters import Parameters

METHODS = {"branch and cut": branch_and_cut, "branch and price": branch_and_price}


def close_in(progress: Progress, *, seed: int = 0, parameters: Parameters | None = None) -> Bound:
    """Close in on the best routes from both sides, by the method that fits the objective.

    Parameters
    ----------
    progress : Progress
        The joint problem with feasible routes, and when to stop. It is changed: its incumbent is the
        best routes found.
    seed : int
        Of all random choices.
    parameters : Parameters, optional
        How to search.
    """
    return METHODS[progress.objective.method](progress, seed=seed, parameters=parameters)
