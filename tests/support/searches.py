"""The exact methods called in one line, and callbacks that keep what they are told."""

from __future__ import annotations

from collections.abc import Callable

from msmrta_opt.routing.bound import Bound
from msmrta_opt.routing.callbacks import Callbacks, SearchState
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.methods import close_in
from msmrta_opt.routing.parameters import BranchAndCutParameters
from msmrta_opt.routing.problem import Routes, RoutingData
from msmrta_opt.routing.stop import StoppingCriterion


def closed_in(
    data: RoutingData,
    objective: str,
    incumbent: Routes,
    stop: StoppingCriterion | None = None,
    callbacks: Callbacks | None = None,
) -> tuple[Routes, Bound]:
    """The best routes found, and the bound proved, by the method of the objective."""
    progress = Progress(data, objective, incumbent, stop=stop, callbacks=callbacks)
    bound = close_in(progress)
    return progress.routes, bound


class Told(Callbacks):
    """Passes on every improvement, with what brought it about."""

    def __init__(self, tell: Callable[[SearchState, str], None]) -> None:
        self.tell = tell

    def incumbent_found(self, state: SearchState) -> None:
        self.tell(state, "better routes")

    def bound_raised(self, state: SearchState, proof: str) -> None:
        self.tell(state, proof)


def exactly(neighbours: int = 6) -> BranchAndCutParameters:
    """Parameters with which the root relaxation is solved to its end."""
    return BranchAndCutParameters(neighbours=neighbours, root_tolerance=1e-6, tailing_off_gain=0.0)
