"""A proven bound, with what is needed to check it again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

from ..mission.instance import Instance
from ..mission.proof import LatencyProof, RootProof

Proof = Literal[
    "combinatorial",
    "root LP",
    "branch and cut",
    "column generation",
    "route enumeration",
    "branch and price",
]


class Evidence(Protocol):
    """What was proved before branching, so that it can be proved again."""

    @property
    def size(self) -> tuple[int, int]:
        """Variables and rows of the program that was solved; 0 where it is none."""

    def written(self, instance: Instance, worth: float) -> RootProof | LatencyProof | None:
        """By the ids of `instance`, for routes worth `worth`."""


@dataclass(frozen=True, eq=False)
class Bound:
    """No solution is better than `value`."""

    value: float
    """In the objective's unit, offset included."""
    proof: Proof
    step: float = 0.0
    """Values are an offset plus multiples of this; 0 if that is not known."""
    root: Evidence | None = None
    """None if nothing was solved."""
