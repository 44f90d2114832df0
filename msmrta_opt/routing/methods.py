"""The exact methods, by the names that the table of objectives gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from .bound import Bound, Proof
from .branch_and_cut.search import branch_and_cut
from .branch_and_cut.tree import solvers
from .branch_and_price.search import branch_and_price
from .callbacks import Callbacks, SearchState
from .incumbent import Progress
from .parameters import Parameters
from .run_highs import highs_version
from .scaling import in_convenient_units


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
    data = in_convenient_units(progress.data, progress.objective, progress.routes)
    if data is progress.data:
        return method.close_in(progress, seed=seed, parameters=parameters)
    objective = progress.objective
    unit = objective.unit_of(data) / objective.unit_of(progress.data)
    inner = Progress(
        data,
        objective,
        progress.routes,
        stop=progress.until_done(),
        callbacks=_InUnits(progress, unit),
    )
    bound = method.close_in(inner, seed=seed, parameters=parameters)
    return Bound(progress.bound, progress.proof, progress.step.step, bound.root)


class _InUnits(Callbacks):
    """Passes on to `progress` what a search in other units tells, of which 1 is `unit` there."""

    def __init__(self, progress: Progress, unit: float) -> None:
        self.progress, self.unit = progress, unit

    def incumbent_found(self, state: SearchState) -> None:
        """Take over the better routes."""
        self.progress.offer(state.routes)

    def bound_raised(self, state: SearchState, proof: Proof) -> None:
        """Take over the better bound."""
        self.progress.raise_bound(state.bound * self.unit, proof)

    def phase_began(self, state: SearchState, phase: str) -> None:
        """Tell what happens now."""
        self.progress.begin(phase)
