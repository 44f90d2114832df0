"""The search tree: open nodes, the one in work, and the bound that all of them prove together."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from heapq import heappop, heappush

from .duals import Duals
from .ng_network import Network
from .path_program import Path


@dataclass(order=True)
class Node:
    """A part of all solutions."""

    bound: float
    """None of them is worth less."""
    number: int
    """Of when it was made, 0 for the root."""
    networks: list[Network] = field(compare=False)
    paths: list[Path] = field(compare=False)
    duals: Duals = field(compare=False)
    """To begin with."""


class Tree:
    """Nodes by their bounds, the lowest first."""

    def __init__(self) -> None:
        self._open: list[Node] = []
        self._n_nodes = 0
        self._left = math.inf
        self.current = math.inf
        """The bound of the node in work."""

    def __bool__(self) -> bool:
        return bool(self._open)

    def open(self, networks: list[Network], paths: list[Path], duals: Duals, bound: float) -> None:
        """Open a node."""
        heappush(self._open, Node(bound, self._n_nodes, networks, paths, duals))
        self._n_nodes += 1

    def next(self) -> Node:
        """Take the open node of the lowest bound into work."""
        node = heappop(self._open)
        self.current = node.bound
        return node

    def raise_current(self, bound: float) -> None:
        """A bound on the node in work."""
        self.current = max(self.current, bound)

    def leave(self) -> None:
        """Leave the node in work undecided, for good."""
        self._left = min(self._left, self.current)

    def close(self) -> None:
        """The node in work has no more to it than was found, opened or left."""
        self.current = math.inf

    @property
    def bound(self) -> float:
        """No solution of any node is worth less."""
        return min([self.current, self._left, *(node.bound for node in self._open[:1])])
