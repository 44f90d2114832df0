"""The lowest bid while bids change, against looking at all of them."""

from __future__ import annotations

import numpy as np
import pytest

from msmrta_opt.planners.support.lowest_bids import LowestBids


@pytest.mark.parametrize("seed", range(10))
def test_the_lowest_of_changing_bids_is_the_first_of_all(seed: int) -> None:
    random = np.random.default_rng(seed)
    bids = random.integers(0, 4, (4, 6)).astype(float)
    lowest, every = LowestBids(bids.copy()), bids.copy()
    for _ in range(30):
        assert lowest.next() == np.unravel_index(every.argmin(), every.shape)
        thing, robots = int(random.integers(6)), random.random(4) < 0.5
        lowest.withdraw(thing, robots)
        every[robots, thing] = np.inf
        robot = int(random.integers(4))
        every[robot] = random.integers(0, 4, 6)
        lowest.bid(robot, every[robot].copy())
