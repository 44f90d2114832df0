"""What a search tree is given and what it proves, whichever solver searches it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...arrays import Floats
from .edge_formulation import EdgeFormulation, Row
from .separation import Cut


@dataclass(frozen=True, eq=False)
class Subproblem:
    """The edge formulation within bounds of its columns, for solutions better than one known."""

    formulation: EdgeFormulation
    lower: Floats
    """Lower bounds of the columns, ``(n_columns,)``."""
    upper: Floats
    """Upper bounds, ``(n_columns,)``; columns fixed to 0 stay out."""
    known: float
    """Value of the best solution known."""
    cuts: tuple[Cut, ...] = ()
    """To start with."""
    rows: Sequence[Row] = ()
    """Besides those of the formulation, see `symmetry`."""


@dataclass(frozen=True)
class Tree:
    """The outcome of a search tree."""

    bound: float
    """No solution of the subproblem costs less, unless it costs as much as the one known."""
    complete: bool
    """Whether the tree was searched to its end."""
    nodes: int
    failures: tuple[str, ...] = ()
    """What solvers that failed said, each with its name."""


class TreeError(Exception):
    """A solver of the tree ended with an error of its own."""
