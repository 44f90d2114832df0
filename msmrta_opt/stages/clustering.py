"""Clustering of victims by location (Algorithm 1, Clustering): K-means, seeded, several starts.

An instance may pin its clusters. A cluster's centre is the mean location of its members; for
distances the nearest free cell stands for it from which a member can be reached.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..mission.grid import Cell
from .k_means import k_means
from .options import StagedOptions
from .situation import Situation


@dataclass(frozen=True, eq=False)
class Clustering:
    """A partition of the victims.

    Parameters
    ----------
    labels : int array, shape (n_victims,)
        The cluster of each victim, 0 to K - 1, none empty.
    centres : float array, shape (K, 2)
        Mean ``(row, col)`` of each cluster's members.
    cells : list of cell, length K
        The free cell that stands for each centre.
    pinned : bool
        Whether the instance gave the labels.
    """

    labels: NDArray[np.int64]
    centres: NDArray[np.float64]
    cells: list[Cell]
    pinned: bool

    @property
    def n_clusters(self) -> int:
        """K."""
        return len(self.cells)

    def members(self, cluster: int) -> list[int]:
        """Positions of the victims of a cluster."""
        return [int(v) for v in np.flatnonzero(self.labels == cluster)]

    def inertia(self, locations: NDArray[np.float64]) -> float:
        """Sum of squared distances of `locations`, shape ``(n_victims, 2)``, to their centres."""
        return float(((locations - self.centres[self.labels]) ** 2).sum())


def clustering(situation: Situation, options: StagedOptions) -> Clustering:
    """Group the victims into ``min(n_robots, number of distinct victim cells)`` clusters.

    Parameters
    ----------
    situation : Situation
        The known victims.
    options : StagedOptions
        ``seed`` of the starts of K-means; ``pinned_clusters``.
    """
    instance = situation.instance
    if not instance.n_victims:
        return Clustering(np.empty(0, dtype=np.int64), np.empty((0, 2)), [], pinned=False)
    locations = np.array(instance.cells, dtype=float)
    pinned = options.pinned_clusters and instance.clusters is not None
    k = min(instance.n_robots, len(set(instance.cells)))
    labels = np.array(instance.clusters) if pinned else k_means(locations, k, options.seed)
    # Scouts may not have found any member of a pinned cluster, so labels are made consecutive.
    _, labels = np.unique(labels, return_inverse=True)
    count = np.bincount(labels)
    centres = np.stack([np.bincount(labels, weights=axis) / count for axis in locations.T], axis=1)
    cells = [_centre_cell(situation, centres[c], labels == c) for c in range(len(count))]
    return Clustering(labels.astype(np.int64), centres, cells, pinned)


def _centre_cell(
    situation: Situation, centre: NDArray[np.float64], members: NDArray[np.bool_]
) -> Cell:
    """The nearest cell to `centre` from which a member can be reached; ties: row, then column."""
    grid = situation.instance.map
    cells = np.argwhere(grid.free)
    order = np.argsort(((cells - centre) ** 2).sum(axis=1), kind="stable")
    fields = [
        situation.distances.field(situation.instance.cells[v]) for v in np.flatnonzero(members)
    ]
    for row, col in cells[order]:
        if any(np.isfinite(field[row, col]) for field in fields):
            return int(row), int(col)
    raise AssertionError("a victim's own cell can be reached from itself")
