"""A proven bound, with what is needed to check it again."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from ..arrays import Floats
from ..optimise.check import dual_bound
from ..optimise.program import Program
from .branch_and_cut.edge_formulation import Columns
from .branch_and_cut.separation import Cut
from .branch_and_price.duals import LatencyRoot

Proof = Literal[
    "combinatorial",
    "root LP",
    "branch and cut",
    "column generation",
    "route enumeration",
    "branch and price",
]


@dataclass(frozen=True, eq=False)
class Bound:
    """No answer is better than `value`.

    The root relaxation is stored whole: whoever solves `program` with any solver, or multiplies it
    with `prices` by hand (`root`), sees what it proves. What branching adds to that rests on the
    tree; what rounding adds, on `step`.
    """

    value: float
    """In time units, offset included."""
    proof: Proof
    step: float = 0.0
    """Answers are worth the program's offset plus multiples of this; 0 if that is not known."""
    columns: Columns | None = None
    """Of the root relaxation."""
    cuts: tuple[Cut, ...] = ()
    """Its cuts."""
    prices: Floats | None = None
    """Duals of its first rows, then of `cuts`, ``(n_rows,)``."""
    latency: LatencyRoot | None = None
    """In place of these, for latency: what proves its bound before branching."""

    @cached_property
    def program(self) -> Program | None:
        """The root relaxation with its cuts."""
        return None if self.columns is None else self.columns.program(list(self.cuts)).relaxed()

    def root(self) -> float | None:
        """What the stored relaxation proves, computed from it and its prices, without a solver."""
        if self.program is None or self.prices is None:
            return None
        return dual_bound(self.program, self.prices)
