"""Improvement by regions: what lies close together is routed anew, and best, all else as it is.

The program of `columns` with those between victims of a region, and elsewhere those of the incumbent
only, is small and mostly easy. Regions are drawn around victims where the relaxation of the whole is
undecided, as large as their programs are still easy: what a smaller one finds, a larger one mostly does.

Source: Taillard and Voss, *POPMUSIC: partial optimization metaheuristic under special intensification
conditions* (2002).
"""

from __future__ import annotations

import numpy as np

from ...arrays import Bools, Floats, Ints
from ..branch_and_cut.edge_formulation import Columns

SMALLEST, SMALLEST_SHARE = 40, 0.4
"""Victims of a region to begin with: so many, and at most this share of all."""
GROWTH = 1.1
"""Of the next region, after an easy one; and what it shrinks by after one that was too hard."""
_DECIDED = 1e-3
"""Weight of victims around which nothing is undecided."""


class Regions:
    """Which region to look at next.

    Parameters
    ----------
    columns : Columns
        The program.
    point : array, shape (n_columns,)
        A point of its relaxation.
    seed : int
        Of the draws.
    """

    def __init__(self, columns: Columns, point: Floats, seed: int = 0) -> None:
        self.columns = columns
        data = columns.data
        self.n_victims = len(data.nearest)
        """That need something."""
        self.size = self.smallest = max(1.0, min(SMALLEST, SMALLEST_SHARE * self.n_victims))
        """Victims of a region, not rounded."""
        self._ends = _ends(columns)
        undecided = np.clip(np.minimum(point, 1.0 - point), 0.0, None)
        weight = np.full(data.n_victims + 1, _DECIDED)
        # What has to do with no victim goes to the last place.
        np.add.at(weight, self._ends[:, 0], undecided)
        np.add.at(weight, self._ends[:, 1], undecided)
        self._centres = np.array(list(data.nearest), dtype=np.int64)
        self._chance = weight[self._centres] / weight[self._centres].sum()
        self._rng = np.random.default_rng(seed)

    @property
    def exhausted(self) -> bool:
        """Whether regions have outgrown the mission."""
        return self.size > self.n_victims

    def draw(self) -> Bools:
        """The columns between victims of a region, and those that have to do with none."""
        data = self.columns.data
        centre = int(self._rng.choice(self._centres, p=self._chance))
        inside = np.zeros(data.n_victims + 1, dtype=bool)
        inside[data.nearest[centre][: round(self.size)]] = True
        inside[[centre, -1]] = True
        return np.asarray(inside[self._ends].all(axis=1))

    def grow(self) -> None:
        """Larger ones, since the last was easy."""
        self.size *= GROWTH

    def shrink(self) -> None:
        """Smaller ones, since the last was too hard."""
        self.size = max(self.smallest, self.size / GROWTH)


def _ends(columns: Columns) -> Ints:
    """The victims that each column has to do with, ``(n_columns, 2)``; n_victims for none."""
    ends = np.full((columns.n_columns, 2), columns.data.n_victims)
    victim = columns.pairs[:, 1]
    for name in "yfl":
        first = columns.start(name)
        ends[first : first + columns.n_pairs] = victim[:, None]
    services, first = columns.services, columns.start("a")
    ends[first : first + len(services)] = victim[services[:, 0], None]
    ends[columns.start("e") :] = columns.edges[:, 1:]
    return ends
