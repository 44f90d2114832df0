"""What a search tree proved."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Tree:
    """The outcome of branch and cut within given bounds of the columns."""

    bound: float
    """No answer within them costs less, unless it costs what was asked to be bettered."""
    complete: bool
    """Whether the tree was searched to its end."""
    nodes: int
