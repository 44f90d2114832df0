"""A* on a grid, compiled: shortest walks, and how long they are. Maps are arrays as in `breadth_first`.

The search goes from the goal to the start, whose Manhattan distance is its heuristic. A move leaves the
estimate of the whole walk as it is or adds two, so that two stacks do for a priority queue: one for the
estimate that is looked at, one for the next. Source: Hart, Nilsson and Raphael (1968).
"""

from __future__ import annotations

import numpy as np

from ..arrays import Int32s, Ints
from ..compiled import inlined, kernel
from .breadth_first import BLOCKED, UNSEEN

FAR = 2**31 - 1
"""The distance of free cells that are not seen yet."""
ROW = 32
"""The bits of a place on a stack that hold its column; its row is in those above."""


@inlined
def _search(
    distance: Int32s,
    width: int,
    start: int,
    goal: int,
    stacks: tuple[Ints, Ints],
    seen: Int32s,
    every: bool,
) -> int:
    """The distance of `start` from `goal`, in `distance`; returns how many cells are `seen`.

    If so wished, `every` other cell on a shortest walk has its distance, too. A place is put on a stack
    only with a new distance, and all that a stack holds have one estimate: so none is on it twice.
    """
    now, after = stacks
    to_row, to_col = start // width, start % width
    row, col = goal // width, goal % width
    estimate = abs(row - to_row) + abs(col - to_col)
    distance[goal], seen[0], now[0] = 0, goal, (row << ROW) + col
    n_seen, n_now, n_after = 1, 1, 0
    while n_now:
        while n_now and (every or distance[start] == FAR):
            n_now -= 1
            place = now[n_now]
            row, col = place >> ROW, place & ((1 << ROW) - 1)
            cell = row * width + col
            if distance[cell] + abs(row - to_row) + abs(col - to_col) < estimate:
                continue  # it has been looked at: another walk to it was shorter
            there = distance[cell] + 1
            for near, its_place, is_nearer in (
                (cell - width, place - (1 << ROW), row > to_row),
                (cell + width, place + (1 << ROW), row < to_row),
                (cell - 1, place - 1, col > to_col),
                (cell + 1, place + 1, col < to_col),
            ):
                # No branch: what comes of it cannot be foretold, and to guess wrong takes longer.
                known = distance[near]
                is_better = known > there
                distance[near] = there if is_better else known
                seen[n_seen], now[n_now], after[n_after] = near, its_place, its_place
                n_seen += known == FAR
                n_now += is_better & is_nearer
                n_after += is_better & (not is_nearer)
        if distance[start] != FAR:
            break
        now, after = after, now
        n_now, n_after, estimate = n_after, 0, estimate + 2
    return n_seen


@inlined
def _begin(cells: Int32s) -> tuple[Int32s, tuple[Ints, Ints], Int32s]:
    """Distances, all of them far, the two stacks, and a list for what is seen."""
    distance = cells.copy()
    distance[cells == UNSEEN] = FAR
    size = len(cells) + 1
    return distance, (np.empty(size, np.int64), np.empty(size, np.int64)), np.empty(size, np.int32)


@inlined
def _forget(distance: Int32s, seen: Int32s, n_seen: int) -> None:
    for i in range(n_seen):
        distance[seen[i]] = FAR


@kernel("int32[::1](int32[::1], int64, int64[::1], int64[::1])")
def lengths(cells: Int32s, width: int, starts: Ints, goals: Ints) -> Int32s:
    """Distance of each start from its goal, ``(n_walks,)``; negative if none."""
    found = np.full(len(starts), UNSEEN, np.int32)
    distance, stacks, seen = _begin(cells)
    for i in range(len(starts)):
        start, goal = starts[i], goals[i]
        if distance[start] != BLOCKED and distance[goal] != BLOCKED:
            n_seen = _search(distance, width, start, goal, stacks, seen, False)
            if distance[start] != FAR:
                found[i] = distance[start]
            _forget(distance, seen, n_seen)
    return found


@kernel("Tuple((int32[::1], int64[::1]))(int32[::1], int64, int64[::1], int64[::1])")
def walks(cells: Int32s, width: int, starts: Ints, goals: Ints) -> tuple[Int32s, Ints]:
    """Shortest walks: their cells, one walk after the other, and where each ends among them.

    A walk goes down the distances from its goal, and of several ways takes the first: up, down, left,
    right. A walk that there is not has no cells.
    """
    walked, size = np.empty(1024, np.int32), 0
    ends = np.empty(len(starts), np.int64)
    distance, stacks, seen = _begin(cells)
    for i in range(len(starts)):
        cell, left, n_seen = starts[i], -1, 0
        if distance[cell] != BLOCKED and distance[goals[i]] != BLOCKED:
            n_seen = _search(distance, width, cell, goals[i], stacks, seen, True)
            if distance[cell] != FAR:
                left = distance[cell]
        if size + left + 1 > len(walked):
            longer = np.empty(2 * (size + left + 1), np.int32)
            longer[:size] = walked[:size]
            walked = longer
        if left >= 0:
            walked[size] = cell
            size += 1
        while left > 0:
            left -= 1
            for near in (cell - width, cell + width, cell - 1, cell + 1):
                if distance[near] == left:
                    cell = near
                    break
            walked[size] = cell
            size += 1
        ends[i] = size
        _forget(distance, seen, n_seen)
    return walked[:size].copy(), ends
