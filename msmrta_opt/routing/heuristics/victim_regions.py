"""Fix-and-optimise by victim regions: what lies close together is routed anew, all else stays as it is.

The program restricted to what is between victims of a region, and elsewhere to the incumbent, is small
and mostly easy. Regions are drawn around victims where a relaxation of the whole is undecided, as large
as their programs are still easy: what a smaller one finds, a larger one mostly does.

Source: Taillard and Voss, *POPMUSIC: partial optimization metaheuristic under special intensification
conditions* (2002).
"""

from __future__ import annotations

import numpy as np

from ...arrays import Bools, Floats
from ..parameters import HeuristicsParameters
from ..problem import RoutingData

_DECIDED = 1e-3
"""Weight of victims around which nothing is undecided."""


class VictimRegions:
    """Which region to look at next.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    undecided : array, shape (n_victims,)
        How much is undecided around each victim; 0 or more.
    seed : int
        Of the draws.
    parameters : HeuristicsParameters, optional
        How large regions are.
    """

    def __init__(
        self,
        data: RoutingData,
        undecided: Floats,
        seed: int = 0,
        parameters: HeuristicsParameters | None = None,
    ) -> None:
        self.data = data
        parameters = parameters or HeuristicsParameters()
        self.n_victims = len(data.nearest)
        """That need something."""
        share = parameters.smallest_region_share * self.n_victims
        self.size = self.smallest = max(1.0, min(parameters.smallest_region, share))
        """Victims of a region, not rounded."""
        self._growth = parameters.region_growth
        self._centres = np.array(list(data.nearest), dtype=np.int64)
        weight = _DECIDED + undecided[self._centres]
        self._chance = weight / weight.sum()
        self._rng = np.random.default_rng(seed)

    @property
    def exhausted(self) -> bool:
        """Whether regions have outgrown the mission."""
        return self.size > self.n_victims

    def draw(self) -> Bools:
        """The victims of a region, ``(n_victims,)``."""
        centre = int(self._rng.choice(self._centres, p=self._chance))
        inside = np.zeros(self.data.n_victims, dtype=bool)
        inside[self.data.nearest[centre][: round(self.size)]] = True
        inside[centre] = True
        return inside

    def grow(self) -> None:
        """Larger ones, since the last was easy."""
        self.size *= self._growth

    def shrink(self) -> None:
        """Smaller ones, since the last was too hard."""
        self.size = max(self.smallest, self.size / self._growth)
