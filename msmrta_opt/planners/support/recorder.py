"""Keeps a search's incumbent and bound over time, for the plan that comes of it."""

from __future__ import annotations

import math
import time

from ...mission.convergence import SearchRecord, SearchStep
from ...routing.bound import Proof
from ...routing.callbacks import Callbacks, SearchState
from ...routing.objectives import Objective


class Recorder(Callbacks):
    """Notes every step of a search that begins now, and passes it on to `others`."""

    def __init__(self, objective: Objective, others: Callbacks | None = None) -> None:
        self.objective, self.others = objective, others or Callbacks()
        self.began = time.monotonic()
        self.steps: list[SearchStep] = []

    def incumbent_found(self, state: SearchState) -> None:
        """Note better routes."""
        self._note(state, "better routes")
        self.others.incumbent_found(state)

    def bound_raised(self, state: SearchState, proof: Proof) -> None:
        """Note a better bound."""
        self._note(state, proof)
        self.others.bound_raised(state, proof)

    def phase_began(self, state: SearchState, phase: str) -> None:
        """Note what begins."""
        self._note(state, phase)
        self.others.phase_began(state, phase)

    def ended(self, state: SearchState) -> SearchRecord:
        """All that was noted; the last step is the end, now."""
        self._note(state, "end")
        return SearchRecord(
            objective=self.objective.name, unit=self.objective.unit, steps=tuple(self.steps)
        )

    def _note(self, state: SearchState, event: str) -> None:
        self.steps.append(
            SearchStep(
                seconds=time.monotonic() - self.began,
                incumbent=state.value,
                bound=state.bound if math.isfinite(state.bound) else None,
                event=event,
            )
        )
