"""The tree of a proof, and when to stop growing it."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..interruption import interrupted
from .derivation import Leaf

NODES = "node limit"
"""Why a search stops that was to look at so many nodes only."""
INTERRUPTED = "interrupted"
FOUND = "a point was found"
"""Why a search stops that was to find any point."""


@dataclass(slots=True, eq=False)
class Node:
    """A node of the tree: a leaf if it has one, else branched on ``column ≤ split``, ``≥ split + 1``."""

    parent: Node | None = None
    is_high: bool = False
    """Which side of the parent's disjunction it is."""
    estimate: float = -math.inf
    basis: Any = None
    column: int = -1
    split: int = 0
    fraction: float = 0.5
    """How far the relaxation's value of the column is above `split`."""
    low: Node | None = None
    high: Node | None = None
    leaf: Leaf | None = None

    def path(self) -> list[Node]:
        """The nodes from the root to this one."""
        found: list[Node] = [self]
        while (parent := found[-1].parent) is not None:
            found.append(parent)
        return found[::-1]


def leaves(root: Node) -> Iterator[Node]:
    """The leaves below `root`."""
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if node.low is not None and node.high is not None:
            waiting += [node.high, node.low]
        else:
            yield node


@dataclass
class Limits:
    """When a search stops."""

    deadline: float = math.inf
    """By `time.perf_counter`."""
    size: float = math.inf
    """Bytes of derivations."""
    nodes: float = math.inf

    def reached(self, size: int, nodes: int = 0) -> str:
        """Which of them is reached, in words; empty if none is."""
        if interrupted():
            return INTERRUPTED
        if nodes >= self.nodes:
            return NODES
        if time.perf_counter() >= self.deadline:
            return "time limit"
        return "size limit" if size >= self.size else ""
