"""One type of answer for all solvers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..mission.errors import CheckError
from .program import Sense

Status = Literal[
    "optimal",  # proven
    "feasible",  # stopped with an incumbent
    "no_solution",  # stopped without one
    "infeasible",  # proven
    "unbounded",  # proven
    "error",  # see the message
    "skipped",  # not attempted; see the message
]


@dataclass(frozen=True)
class Solution:
    """What is known after solving one formulation on one data set. Plain and picklable.

    Objective and bound are in the model's own sense and include its constants; times are in seconds.
    """

    formulation: str
    status: Status
    sense: Sense
    objective: float | None = None
    """Value of the incumbent, worked out again from the arrays."""
    bound: float | None = None
    """No feasible point is better than this."""
    values: dict[str, NDArray[np.float64]] = field(default_factory=dict, repr=False)
    """The incumbent, by variable name."""
    proof: str = ""
    """How the bound was obtained."""
    check: str = ""
    """Verdict of the independent check: ``passed``, what failed, or empty without an incumbent."""
    solver: str = ""
    solver_version: str = ""
    message: str = ""
    parameters: dict[str, float] = field(default_factory=dict)
    options: dict[str, object] = field(default_factory=dict)
    canonicalise_seconds: float = 0.0
    solve_seconds: float = 0.0
    nodes: int | None = None
    n_variables: int = 0
    n_rows: int = 0
    duals: dict[str, NDArray[np.float64]] = field(default_factory=dict, repr=False)
    """Dual values by constraint label, where the proof is LP duality."""

    @property
    def gap(self) -> float | None:
        """Relative gap, ``|objective - bound| / max(|objective|, 1e-9)``; 0 when proven optimal."""
        if self.objective is None or self.bound is None:
            return None
        difference = abs(self.objective - self.bound)
        return difference / max(abs(self.objective), 1e-9) if difference else 0.0

    @property
    def found(self) -> bool:
        """Whether there is an incumbent that passed its check."""
        return self.objective is not None and self.check == "passed"

    def require(self) -> Solution:
        """The solution itself, if it holds a checked incumbent.

        Raises
        ------
        CheckError
            If it does not, saying what is known instead.
        """
        if not self.found:
            reason = self.message or self.check or "no feasible point"
            raise CheckError(f"{self.formulation}: {self.status}: {reason}")
        return self
