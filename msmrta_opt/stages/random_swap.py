"""Starts for K-means, compiled: Lloyd's algorithm improved by random swaps.

Again and again one centre is moved to a point, both chosen at random, and Lloyd's algorithm goes on from
there for a few iterations; where that gives a better partition it is kept, and followed to its end.

Source: Fränti, *Efficiency of random swap clustering* (2018).
"""

# ruff: noqa: NPY002 - in machine code this is a stream of its own, the same on every machine

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Ints
from ..compiled import inlined, kernel

TRIAL, LONGEST = 3, 300
"""Iterations of Lloyd's algorithm after a swap, and of one that is followed to its end."""


@inlined
def _lloyd(points: Floats, centres: Floats, labels: Ints, iterations: int) -> float:
    """Move `centres` for so many iterations, or to their end; the sum of squares before the last.

    A cluster without points gets the point that is farthest from its centre.
    """
    total = np.inf
    for _ in range(iterations):
        sums, count = np.zeros_like(centres), np.zeros(len(centres), np.int64)
        changed, total, longest, farthest = False, 0.0, -1.0, 0
        for i in range(len(points)):
            nearest, least = 0, np.inf
            for c in range(len(centres)):
                dx, dy = points[i, 0] - centres[c, 0], points[i, 1] - centres[c, 1]
                square = dx * dx + dy * dy
                if square < least:
                    nearest, least = c, square
            changed |= labels[i] != nearest
            labels[i] = nearest
            count[nearest] += 1
            sums[nearest, 0] += points[i, 0]
            sums[nearest, 1] += points[i, 1]
            total += least
            if least > longest:
                longest, farthest = least, i
        if not changed:
            break
        for c in range(len(centres)):
            if count[c]:
                centres[c] = sums[c] / count[c]
            else:
                centres[c] = points[farthest]
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
    labels = np.full(len(points), -1)
    least = _lloyd(points, best, labels, LONGEST)
    for _ in range(swaps):
        trial = best.copy()
        trial[np.random.randint(k)] = points[np.random.randint(len(points))]
        labels[:] = -1
        total = _lloyd(points, trial, labels, TRIAL)
        # Rounding must not make of equal partitions better ones.
        if total < least * (1 - 1e-9):
            best, least = trial, _lloyd(points, trial, labels, LONGEST)
    return best
