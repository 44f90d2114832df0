"""Flow networks in a program, and sets of their nodes that a point's cuts should be looked for at.

Equations whose continuous columns are each in at most two of them, with opposite signs, say that a flow
is conserved: rows are nodes, columns are arcs. Where an arc can be used only if an integer column is
not 0, adding up the equations of a set of nodes and rounding gives a cut-set inequality. Sets that a
point may violate are its minimum cuts, with the integer columns' values as capacities (Achterberg and
Raack 2010, *The MCF-separator: detecting and exploiting multi-commodity flow structures in MIPs*).
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

from ..arrays import Bools, Floats
from .derivation import Box
from .exact import ExactProgram, Row

UNIT = 1_000_000
"""Capacities are counted in millionths."""
FEWEST = 3
"""Nodes of a network that is worth looking at."""


@dataclass(frozen=True)
class Network:
    """Nodes are rows, each with a sign; arcs go from node to node, -1 being outside."""

    rows: tuple[int, ...]
    signs: tuple[int, ...]
    arcs: tuple[tuple[int, int, int], ...]
    """From, to, and the integer column that opens the arc, -1 if none does."""

    def sets(self, x: Floats) -> Iterator[dict[int, float]]:
        """Weights of the rows of minimum cuts between the outside and each node, both ways."""
        n = len(self.rows)
        seen: set[tuple[int, ...]] = set()
        for inward in (True, False):
            graph = self._graph(x, inward)
            for node in range(n):
                cut = _minimum_cut(graph, n, node)
                key = tuple(np.flatnonzero(cut[:n]).tolist())
                if len(key) > 1 and key not in seen:
                    seen.add(key)
                    yield {self.rows[k]: float(self.signs[k]) for k in key}

    def _graph(self, x: Floats, inward: bool) -> csr_array:
        n = len(self.rows)
        ends: list[tuple[int, int, int]] = []
        for start, end, column in self.arcs:
            capacity = UNIT if column < 0 else round(max(float(x[column]), 0.0) * UNIT)
            if not inward:
                start, end = end, start
            ends.append((start % (n + 1), end % (n + 1), min(capacity, 1000 * UNIT)))
        tails, heads, data = (np.array(part, dtype=np.int32) for part in zip(*ends, strict=True))
        return csr_array((data, (tails, heads)), shape=(n + 1, n + 1))


def _minimum_cut(graph: csr_array, source: int, sink: int) -> Bools:
    """The nodes on the sink's side of a minimum cut, as few as possible."""
    flow = maximum_flow(graph, source, sink).flow
    left = csr_array(graph - flow)
    left.data[left.data < 0] = 0
    left.eliminate_zeros()
    side: Bools = np.zeros(graph.shape[0], dtype=bool)
    side[breadth_first_order(left.T.tocsr(), sink, return_predecessors=False)] = True
    return side


def networks(
    program: ExactProgram, rows: Sequence[Row], box: Box, opened_by: Mapping[int, int]
) -> list[Network]:
    """The flow networks among `rows`; `opened_by` names the integer column of continuous ones."""
    closed = {j for j, side in enumerate(box.upper) if side is not None and not side.bound}
    equations = {
        i: [
            (j, a)
            for j, a in zip(row.columns, row.coefficients, strict=True)
            if not program.integer[j]
        ]
        for i, row in enumerate(rows)
        if row.lower is not None and row.lower == row.upper
    }
    nodes_of: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for i, entries in equations.items():
        if len({abs(a) for _, a in entries}) == 1:
            for j, a in entries:
                nodes_of[j].append((i, 1 if a > 0 else -1))
    arcs = {j: ends for j, ends in nodes_of.items() if len(ends) <= 2 and j not in closed}
    neighbours: dict[int, list[tuple[int, bool]]] = defaultdict(list)
    for ends in arcs.values():
        if len(ends) == 2:
            (one, sign), (other, other_sign) = ends
            neighbours[one].append((other, sign != other_sign))
            neighbours[other].append((one, sign != other_sign))
    signs: dict[int, int] = {}
    found: list[Network] = []
    for start in equations:
        if start in signs or start not in neighbours:
            continue
        signs[start] = 1
        part, waiting = [start], deque([start])
        while waiting:
            here = waiting.popleft()
            for there, opposite in neighbours[here]:
                if there not in signs:
                    signs[there] = signs[here] if opposite else -signs[here]
                    part.append(there)
                    waiting.append(there)
        if len(part) >= FEWEST:
            found.append(_network(part, signs, arcs, opened_by))
    return found


def _network(
    part: list[int],
    signs: Mapping[int, int],
    arcs: Mapping[int, list[tuple[int, int]]],
    opened_by: Mapping[int, int],
) -> Network:
    place = {i: k for k, i in enumerate(part)}
    found: list[tuple[int, int, int]] = []
    for j, ends in arcs.items():
        own = [(place[i], sign * signs[i]) for i, sign in ends if i in place]
        if not own:
            continue
        start, end = -1, -1
        for node, sign in own:
            if sign > 0:
                end = node
            else:
                start = node
        if start != end:
            found.append((start, end, opened_by.get(j, -1)))
    return Network(tuple(part), tuple(signs[i] for i in part), tuple(found))
