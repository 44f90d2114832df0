"""Minimum cuts by shortest augmenting paths, compiled.

Source: Edmonds and Karp, Journal of the ACM 19 (1972).
"""

from __future__ import annotations

import numpy as np

from ...arrays import Bools, Int32s, Ints
from ...compiled import inlined, kernel


@inlined
def _reached(rest: Ints, start: int, goal: int, queue: Ints, before: Ints) -> int:
    """Vertices that arcs with capacity left lead to from `start`, until `goal` is one.

    The first ones of `queue`, as many as are returned; `before` is the way to each, -1 for all others.
    """
    before[:] = -1
    before[start] = start
    queue[0] = start
    head, tail = 0, 1
    while head < tail:
        here = queue[head]
        head += 1
        for onward in range(len(rest)):
            if rest[here, onward] > 0 and before[onward] < 0:
                before[onward] = here
                queue[tail] = onward
                tail += 1
                if onward == goal:
                    return tail
    return tail


@kernel("boolean[:,::1](int32[:,::1], int64, int64)")
def sides(capacity: Int32s, source: int, sink: int) -> Bools:
    """As `min_cut.sides`, both in one array, ``(2, n)``."""
    n = len(capacity)
    rest = capacity.astype(np.int64)
    queue, before = np.empty(n, np.int64), np.empty(n, np.int64)
    while True:
        _reached(rest, source, sink, queue, before)
        if before[sink] < 0:
            break
        least, here = rest[before[sink], sink], sink
        while here != source:
            least = min(least, rest[before[here], here])
            here = before[here]
        here = sink
        while here != source:
            rest[before[here], here] -= least
            rest[here, before[here]] += least
            here = before[here]
    found = np.zeros((2, n), np.bool_)
    for i in range(n):
        found[0, i] = before[i] >= 0
    _reached(rest.T.copy(), sink, -1, queue, before)
    for i in range(n):
        found[1, i] = before[i] >= 0
    return found
