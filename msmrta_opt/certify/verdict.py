"""What a proof comes to that was checked against its plan."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from .joint_problem import figure


@dataclass(frozen=True)
class Verdict:
    """What is proved of a plan."""

    objective: str
    value: Fraction
    """What the plan is worth."""
    bound: Fraction
    """No plan is worth less."""
    size: str
    """What the proof is made of, in words."""

    @property
    def whole(self) -> bool:
        """Whether the plan is proved to be optimal."""
        return self.bound == self.value

    @property
    def summary(self) -> str:
        """What is proved, in words."""
        if self.whole:
            return f"proved: the {self.objective} of {figure(self.value)} is optimal ({self.size})"
        return (
            f"proved: no plan has a {self.objective} below {figure(self.bound)}; this one has "
            f"{figure(self.value)} ({self.size})"
        )
