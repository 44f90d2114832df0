"""What a search tells of itself while it runs."""

from __future__ import annotations

from dataclasses import dataclass

from .bound import Proof
from .problem import Routes
from .stop import relative_gap


@dataclass(frozen=True)
class SearchState:
    """How far a search has come."""

    routes: Routes
    """The incumbent."""
    value: float
    """What the incumbent is worth."""
    bound: float
    """No routes are worth less."""

    @property
    def gap(self) -> float:
        """Share of the value that the bound leaves open."""
        return relative_gap(self.value, self.bound)


class Callbacks:
    """Told of a search's progress; override the methods of interest.

    An exception that one of them raises ends the search.
    """

    def incumbent_found(self, state: SearchState) -> None:
        """Better routes were found."""

    def bound_raised(self, state: SearchState, proof: Proof) -> None:
        """A better bound was proved, by `proof`."""

    def phase_began(self, state: SearchState, phase: str) -> None:
        """The search goes on to `phase`, for instance ``"root relaxation"``."""
