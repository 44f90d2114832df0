"""Breadth-first search on a grid, compiled: distances, nearest cells, connected components.

A map is a flat array of cells, row by row, with a blocked row above and below, and a blocked column to
the right, which is also to the left of the next row: so the four neighbours of a cell are always there,
and always as far away in the array. One more entry at the end is a cell that no walk leads to. `UNSEEN`
marks free cells, `BLOCKED` the others; cells are named by their index. `without_numba` does the same.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Int32s, Ints
from ..compiled import inlined, kernel

UNSEEN, BLOCKED = -1, -2
MANY = 8
"""From one part of so many of the cells on, all are cleared at once."""


@inlined
def _beside(given: Int32s, width: int, queue: Int32s, tail: int, cell: int, value: int) -> int:
    """Give `value` to the cells beside `cell` that are not seen yet, and queue them; the queue's end."""
    for near in (cell - width, cell + width, cell - 1, cell + 1):
        # No branch: whether a cell is new cannot be foretold, and to guess wrong takes longer.
        known = given[near]
        new = known == UNSEEN
        queue[tail] = near
        tail += new
        given[near] = value if new else known
    return tail


@inlined
def _search(distance: Int32s, width: int, queue: Int32s, source: int, goals: Ints) -> int:
    """Go from `source` as far as all `goals` are seen, or to the end; the end of the queue."""
    if distance[source] != UNSEEN:
        return 0
    distance[source], queue[0], head, tail, there, seen = 0, source, 0, 1, 0, 0
    while head < tail:
        while seen < len(goals) and distance[goals[seen]] != UNSEEN:
            seen += 1
        if seen == len(goals):
            break
        there += 1
        for i in range(head, tail):
            tail = _beside(distance, width, queue, tail, queue[i], there)
            head += 1
    return tail


@kernel("int32[:,::1](int32[::1], int64, int64[::1])")
def fields(cells: Int32s, width: int, sources: Ints) -> Int32s:
    """Distance of each source from every cell, ``(n_sources, len(cells))``; negative if none."""
    found = np.empty((len(sources), len(cells)), np.int32)
    queue, nowhere = np.empty(len(cells) + 1, np.int32), np.full(1, len(cells) - 1)
    for s in range(len(sources)):
        found[s] = cells
        _search(found[s], width, queue, sources[s], nowhere)
    return found


@kernel("int32[:,::1](int32[::1], int64, int64[::1], int64[::1])")
def between(cells: Int32s, width: int, sources: Ints, targets: Ints) -> Int32s:
    """Distance of each source from each target, ``(n_sources, n_targets)``; negative if none."""
    found = np.empty((len(sources), len(targets)), np.int32)
    distance, queue = cells.copy(), np.empty(len(cells) + 1, np.int32)
    for s in range(len(sources)):
        tail = _search(distance, width, queue, sources[s], targets)
        for t in range(len(targets)):
            found[s, t] = distance[targets[t]]
        if MANY * tail > len(cells):
            distance[:] = cells
        else:
            for i in range(tail):
                distance[queue[i]] = UNSEEN
    return found


@kernel("int32[::1](int32[::1], int64, int64[::1], int64[::1])")
def nearest(cells: Int32s, width: int, sources: Ints, targets: Ints) -> Int32s:
    """Which source is nearest to each target, ``(n_targets,)``, the first of several; negative if none.

    One search from all sources: where they come first in the queue, so do they all the way.
    """
    found = np.empty(len(targets), np.int32)
    owner, queue, head, tail = cells.copy(), np.empty(len(cells) + 1, np.int32), 0, 0
    for s in range(len(sources)):
        if owner[sources[s]] == UNSEEN:
            owner[sources[s]] = s
            queue[tail] = sources[s]
            tail += 1
    for t in range(len(targets)):
        while head < tail and owner[targets[t]] == UNSEEN:
            tail = _beside(owner, width, queue, tail, queue[head], owner[queue[head]])
            head += 1
        found[t] = owner[targets[t]]
    return found


@kernel("int32[::1](int32[::1], int64)")
def components(cells: Int32s, width: int) -> Int32s:
    """The connected component of each free cell, from 1 on in the order of first cells; others 0."""
    label, queue, number = cells.copy(), np.empty(len(cells) + 1, np.int32), 0
    for cell in range(len(cells) - 1):
        if label[cell] == UNSEEN:
            number += 1
            label[cell], queue[0], head, tail = number, cell, 0, 1
            while head < tail:
                tail = _beside(label, width, queue, tail, queue[head], number)
                head += 1
    return np.maximum(label, np.int32(0))
