"""The exact methods, by the names that the table of objectives gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from .bound import Bound
from .branch_and_cut.search import branch_and_cut
from .branch_and_cut.tree import solvers
from .branch_and_price.search import branch_and_price
from .incumbent import Progress
from .parameters import Parameters
from .run_highs import highs_version


@dataclass(frozen=True)
class Method:
    """A method that closes in on the best routes from both sides."""

    title: str
    """For certificates."""
    close_in: Callable[..., Bound]
    solvers: Callable[[], str]
    """Its solvers with their versions, for certificates."""


METHODS: Mapping[str, Method] = MappingProxyType(
    {
        "branch and cut": Method(
            "branch and cut over the edge formulation", branch_and_cut, solvers
        ),
        "branch and price": Method(
            "branch and price over ng-routes", branch_and_price, highs_version
        ),
    }
)


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
    method = METHODS[progress.objective.method]
    return method.close_in(progress, seed=seed, parameters=parameters)
