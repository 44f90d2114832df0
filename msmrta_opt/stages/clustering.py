"""Clustering of victims by location (Algorithm 1, Clustering): K-means, seeded, several starts.

An instance may pin its clusters, and a formulation may take the place of K-means, so that walls count.
A cluster's centre is the mean location of its members; for distances the nearest free cell stands for
it from which a member can be reached, or the median where a formulation chose one.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Int32s
from ..mission.grid import Cell
from ..optimise import registry
from ..optimise.data import ClusteringData
from ..optimise.solution import Solution
from ..optimise.solve import solve
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
    solution : Solution or None
        Of the formulation that gave them, if one did.
    """

    labels: NDArray[np.int64]
    centres: NDArray[np.float64]
    cells: list[Cell]
    pinned: bool
    solution: Solution | None = None

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
    """Group the victims: as the instance pins them, by a formulation, or else by K-means.

    K is ``min(n_robots, number of distinct victim cells)``; for a formulation see `clustering_data`.

    Parameters
    ----------
    situation : Situation
        The known victims.
    options : StagedOptions
        ``pinned_clusters``; ``clustering_model``; ``seed`` of the starts of K-means.

    Raises
    ------
    InputError
        If ``clustering_model`` is no formulation of clustering.
    CheckError
        If it has no solution that passes its check.
    """
    instance = situation.instance
    if not instance.n_victims:
        return Clustering(np.empty(0, dtype=np.int64), np.empty((0, 2)), [], pinned=False)
    pinned = options.pinned_clusters and instance.clusters is not None
    if options.clustering_model is not None and not pinned:
        return _around_medians(situation, options.clustering_model, options)
    k = min(instance.n_robots, len(set(instance.cells)))
    locations = np.array(instance.cells, dtype=float)
    labels = np.array(instance.clusters) if pinned else k_means(locations, k, options.seed)
    # Scouts may not have found any member of a pinned cluster, so labels are made consecutive.
    _, labels = np.unique(labels, return_inverse=True)
    centres = _means(locations, labels)
    component, places = instance.map.component, locations.astype(np.int64)
    cells = [_centre_cell(component, places[labels == c]) for c in range(len(centres))]
    return Clustering(labels.astype(np.int64), centres, cells, pinned)


def clustering_data(situation: Situation) -> ClusteringData:
    """The victims' distinct cells, by row and column, and the walks between them.

    K is as for K-means, but no less than the number of parts of the map, joined by no walk, that
    hold victims: each of them needs a cluster of its own.
    """
    instance = situation.instance
    cells = sorted(set(instance.cells))
    distance = situation.distances.between(cells, cells)
    can_reach = np.isfinite(distance)
    n_parts = len({int(instance.map.component[cell]) for cell in cells})
    victims_on = Counter(instance.cells)
    return ClusteringData(
        distance=np.where(can_reach, distance, 0.0),
        can_reach=can_reach,
        weight=np.array([victims_on[cell] for cell in cells], dtype=float),
        n_clusters=max(min(instance.n_robots, len(cells)), n_parts),
        ids={"i": [str(cell) for cell in cells]},
        around=situation.around(),
    )


def _around_medians(situation: Situation, name: str, options: StagedOptions) -> Clustering:
    data = clustering_data(situation)
    model = registry.for_plans(name, "clustering")
    solution = solve(model, data, solver=options.solver, **options.values_for(model)).require()
    y = solution.values["y"]
    cells = sorted(set(situation.instance.cells))
    median_of = dict(zip(cells, y.argmax(axis=1), strict=True))
    medians, labels = np.unique(
        [median_of[cell] for cell in situation.instance.cells], return_inverse=True
    )
    return Clustering(
        labels.astype(np.int64),
        _means(np.array(situation.instance.cells, dtype=float), labels),
        [cells[median] for median in medians],
        pinned=False,
        solution=solution,
    )


def _means(locations: NDArray[np.float64], labels: NDArray[np.int64]) -> NDArray[np.float64]:
    """Mean location of each cluster's members, shape ``(K, 2)``."""
    count = np.bincount(labels)
    return np.stack([np.bincount(labels, weights=axis) / count for axis in locations.T], axis=1)


def _centre_cell(component: Int32s, members: NDArray[np.int64]) -> Cell:
    """The nearest cell to the mean of `members` from which one of them can be reached.

    Ties go to the smallest row, then column. It is looked for around the mean, farther and farther.
    """
    own = np.unique(component[members[:, 0], members[:, 1]])
    n, total = len(members), members.sum(axis=0)
    mean, reach = total // n, 4
    while True:
        first = np.maximum(mean - reach, 0)
        near = component[first[0] : mean[0] + reach + 2, first[1] : mean[1] + reach + 2]
        rows, cols = np.nonzero(near == own[0] if len(own) == 1 else np.isin(near, own))
        if len(rows):
            # Whole numbers, since rounding of the mean would break ties at random.
            far = (n * (rows + first[0]) - total[0]) ** 2 + (n * (cols + first[1]) - total[1]) ** 2
            nearest = int(far.argmin())
            if far[nearest] <= (n * reach) ** 2:
                return int(rows[nearest] + first[0]), int(cols[nearest] + first[1])
        reach *= 4
