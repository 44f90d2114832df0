"""Starts for K-means, compiled: Lloyd's algorithm improved by random swaps.

Again and again one centre is moved to a point, both chosen at random, and Lloyd's algorithm goes on from
there for a few iterations; where that gives a better partition it is kept, and followed to its end.

Source: Fränti, *Efficiency of random swap clustering* (2018).
"""

# ruff: noqa: NPY002 - in machine code this is a stream of its own, the same on every machine

from __future__ import annotations

import numpy as np

from ..arrays import Bools, Floats, Ints
from ..compiled import inlined, kernel

FEW = 32
"""Centres up to which it is not worth while to find the neighbours of each."""
MARGIN = 1e-9
"""By which a square is larger than what no rounding makes it."""
MANY = 4
"""From one part of so many of the centres on, all are looked at."""
TRIAL, LONGEST = 3, 300
"""Iterations of Lloyd's algorithm after a swap, and of one that is followed to its end."""


@inlined
def _neighbours(
    points: Floats, centres: Floats, labels: Ints, minimum: Floats, moved: Bools, near: Ints
) -> Ints:
    """To which centres points may go from each: lists in `near`, one after the other; where they begin.

    From a centre that has not moved, points go only to one that has, and by the triangle inequality no
    farther than twice as far as its farthest point is from it. What `minimum` says of centres that have
    moved is brought up to date.
    """
    k, n = len(centres), 0
    widest, begins = np.zeros(k), np.empty(k + 1, np.int64)
    for i in range(len(points)):
        own = labels[i]
        if own >= 0:
            if moved[own]:
                dx, dy = points[i, 0] - centres[own, 0], points[i, 1] - centres[own, 1]
                minimum[i] = dx * dx + dy * dy
            widest[own] = max(widest[own], minimum[i])
    for own in range(k):
        begins[own] = n
        limit = 4 * widest[own] * (1 + MARGIN) + MARGIN
        for c in range(k):
            if (moved[own] or moved[c]) and c != own:
                dx, dy = centres[c, 0] - centres[own, 0], centres[c, 1] - centres[own, 1]
                near[n] = c
                n += dx * dx + dy * dy <= limit
    begins[k] = n
    return begins


@inlined
def _lloyd(
    points: Floats,
    centres: Floats,
    labels: Ints,
    minimum: Floats,
    moved: Bools,
    iterations: int,
    is_fresh: bool,
) -> float:
    """Move `centres` for so many iterations, or to their end; the sum of squares before the last.

    `labels` and `minimum` are the nearest centres of all points and the squares of their distances, when
    none but those had `moved` that have since: only these, or all if its own has, may be nearer now. A
    cluster without points gets the point that is farthest from its centre. What `is_fresh` does not end
    with its first iteration.
    """
    total = np.inf
    few = len(centres) <= FEW
    near = np.empty(len(centres) if few else len(centres) ** 2, np.int64)
    begins = np.empty(0, np.int64)
    for iteration in range(iterations):
        sums, count = np.zeros_like(centres), np.zeros(len(centres), np.int64)
        changed, total, longest, farthest = is_fresh and iteration == 0, 0.0, -1.0, 0
        n_movers, every = 0, False
        if few:
            for c in range(len(centres)):
                if moved[c]:
                    near[n_movers] = c
                    n_movers += 1
            every = MANY * n_movers > len(centres)  # not worth a look at each
        else:
            begins = _neighbours(points, centres, labels, minimum, moved, near)
        for i in range(len(points)):
            own, x, y = labels[i], points[i, 0], points[i, 1]
            if every or own < 0 or (few and moved[own]):
                nearest, shortest = 0, np.inf
                for c in range(len(centres)):
                    dx, dy = x - centres[c, 0], y - centres[c, 1]
                    square = dx * dx + dy * dy
                    if square < shortest:
                        nearest, shortest = c, square
            else:
                nearest, shortest = own, minimum[i]
                first, last = (0, n_movers) if few else (begins[own], begins[own + 1])
                for m in range(first, last):  # a slice for each point would take longer
                    c = near[m]
                    dx, dy = x - centres[c, 0], y - centres[c, 1]
                    square = dx * dx + dy * dy
                    if square < shortest or (square == shortest and c < nearest):
                        nearest, shortest = c, square
            changed |= own != nearest
            labels[i], minimum[i] = nearest, shortest
            count[nearest] += 1
            sums[nearest, 0] += x
            sums[nearest, 1] += y
            total += shortest
            if shortest > longest:
                longest, farthest = shortest, i
        moved[:] = False
        if not changed:
            break
        for c in range(len(centres)):
            x, y = points[farthest, 0], points[farthest, 1]
            if count[c]:
                x, y = sums[c, 0] / count[c], sums[c, 1] / count[c]
            moved[c] = x != centres[c, 0] or y != centres[c, 1]
            centres[c, 0], centres[c, 1] = x, y
    return total


@kernel("float64[:,::1](float64[:,::1], int64, int64, int64)")
def centres(points: Floats, k: int, swaps: int, seed: int) -> Floats:
    """The centres of a good partition, ``(k, 2)``; the same for the same `seed` on every machine.

    Parameters
    ----------
    points : float array, shape (n_points, 2)
        Locations.
    k : int
        Clusters, no more than there are different points.
    swaps : int
        How many to try.
    """
    np.random.seed(seed)
    best = points[np.random.permutation(len(points))[:k]]
    best_labels, best_least = np.full(len(points), -1), np.zeros(len(points))
    best_moved = np.zeros(k, np.bool_)
    minimum = _lloyd(points, best, best_labels, best_least, best_moved, LONGEST, True)
    for _ in range(swaps):
        trial, labels, squares = best.copy(), best_labels.copy(), best_least.copy()
        moved = best_moved.copy()
        point, c = np.random.randint(len(points)), np.random.randint(k)
        trial[c] = points[point]
        moved[c] = True
        total = _lloyd(points, trial, labels, squares, moved, TRIAL, True)
        # Rounding must not make of equal partitions better ones.
        if total < minimum * (1 - 1e-9):
            minimum = _lloyd(points, trial, labels, squares, moved, LONGEST, False)
            best, best_labels, best_least, best_moved = trial, labels, squares, moved
    return best
