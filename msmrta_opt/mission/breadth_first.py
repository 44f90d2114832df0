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


@inlined
def _search(
    distance: Int32s, width: int, queue: Int32s, head: int, tail: int, goal: int, move: int = 1
) -> tuple[int, int]:
    """Go on until `goal` is seen or the search is at its end; the new ends of the queue."""
    while head < tail and distance[goal] == UNSEEN:
        cell = queue[head]
        head += 1
        there = distance[cell] + move
        for near in (cell - width, cell + width, cell - 1, cell + 1):
            # No branch: whether a cell is new cannot be foretold, and to guess wrong takes longer.
            known = distance[near]
            new = known == UNSEEN
            queue[tail] = near
            tail += new
            distance[near] = there if new else known
    return head, tail


@inlined
def _begin(distance: Int32s, queue: Int32s, tail: int, source: int) -> tuple[int, int]:
    """Forget the search before, whose queue ended at `tail`, and begin one; the ends of the queue."""
    for i in range(tail):
        distance[queue[i]] = UNSEEN
    if distance[source] == BLOCKED:
        return 0, 0
    distance[source] = 0
    queue[0] = source
    return 0, 1


@kernel("int32[:,::1](int32[::1], int64, int64[::1])")
def fields(cells: Int32s, width: int, sources: Ints) -> Int32s:
    """Distance of each source from every cell, ``(n_sources, len(cells))``; negative if none."""
    found = np.empty((len(sources), len(cells)), np.int32)
    queue = np.empty(len(cells) + 1, np.int32)
    for s in range(len(sources)):
        found[s] = cells
        head, tail = _begin(found[s], queue, 0, sources[s])
        _search(found[s], width, queue, head, tail, len(cells) - 1)
    return found


@kernel("int32[:,::1](int32[::1], int64, int64[::1], int64[::1])")
def between(cells: Int32s, width: int, sources: Ints, targets: Ints) -> Int32s:
    """Distance of each source from each target, ``(n_sources, n_targets)``; negative if none."""
    found = np.empty((len(sources), len(targets)), np.int32)
    distance, queue, tail = cells.copy(), np.empty(len(cells) + 1, np.int32), 0
    for s in range(len(sources)):
        head, tail = _begin(distance, queue, tail, sources[s])
        for t in range(len(targets)):
            head, tail = _search(distance, width, queue, head, tail, targets[t])
            found[s, t] = distance[targets[t]]
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
        head, tail = _search(owner, width, queue, head, tail, targets[t], 0)
        found[t] = owner[targets[t]]
    return found


@kernel("int32[::1](int32[::1], int64)")
def components(cells: Int32s, width: int) -> Int32s:
    """The connected component of each free cell, from 1 on in the order of first cells; others 0."""
    label = np.zeros(len(cells), np.int32)
    distance, queue, number = cells.copy(), np.empty(len(cells) + 1, np.int32), 0
    for cell in range(len(cells) - 1):
        if distance[cell] == UNSEEN:
            number += 1
            distance[cell] = 0
            queue[0] = cell
            _, tail = _search(distance, width, queue, 0, 1, len(cells) - 1)
            for i in range(tail):
                label[queue[i]] = number
    return label
