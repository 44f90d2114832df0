"""The lowest of many bids, again and again, while few of them change."""

from __future__ import annotations

import numpy as np

from ...arrays import Bools, Floats


class LowestBids:
    """Bids of robots for things; ``inf`` where there is none.

    Parameters
    ----------
    bids : float array, shape (n_robots, n_things)
        It is changed.
    """

    def __init__(self, bids: Floats) -> None:
        self.bids = bids
        self._thing, self._lowest = np.zeros(len(bids), np.int64), np.full(len(bids), np.inf)
        for robot in range(len(bids) if bids.size else 0):
            self._look(robot)

    def next(self) -> tuple[int, int]:
        """The robot and the thing of the lowest bid; ties: the first robot, then the first thing."""
        robot = int(self._lowest.argmin())
        return robot, int(self._thing[robot])

    def withdraw(self, thing: int, robots: Bools) -> None:
        """Take back the bids of `robots`, given by truth, for a thing."""
        self.bids[robots, thing] = np.inf
        for robot in np.flatnonzero(robots & (self._thing == thing)):
            self._look(int(robot))

    def bid(self, robot: int, bids: Floats) -> None:
        """New bids of a robot for all things."""
        self.bids[robot] = bids
        self._look(robot)

    def _look(self, robot: int) -> None:
        self._thing[robot] = self.bids[robot].argmin()
        self._lowest[robot] = self.bids[robot, self._thing[robot]]
