"""Victim regions: where they are drawn, and how large they are."""

from __future__ import annotations

import numpy as np
import pytest
from support.joint_random import random_data

from msmrta_opt.routing.heuristics.victim_regions import VictimRegions
from msmrta_opt.routing.parameters import HeuristicsParameters


@pytest.mark.parametrize("seed", range(3))
def test_a_region_is_a_victim_and_those_nearest_to_it(seed: int) -> None:
    data = random_data(seed, 3, 10, 16)
    regions = VictimRegions(data, np.zeros(data.n_victims), seed)
    for _ in range(5):
        inside = set(np.flatnonzero(regions.draw()).tolist())
        assert 0 < len(inside) <= round(regions.size) + 1 < data.n_victims
        assert any(
            inside == {v, *data.nearest[v][: round(regions.size)].tolist()} for v in data.nearest
        )


def test_regions_lie_where_the_relaxation_is_undecided() -> None:
    data = random_data(0, 3, 10, 16)
    undecided = np.zeros(data.n_victims)
    here = list(data.nearest)[:2]
    undecided[here] = 1e6
    regions = VictimRegions(data, undecided)
    regions.size = 1.0
    for _ in range(10):
        (centre,) = np.flatnonzero(regions.draw())
        assert centre in here


def test_regions_grow_until_they_hold_all_and_shrink_to_the_smallest() -> None:
    data = random_data(1, 3, 10, 16)
    regions = VictimRegions(data, np.zeros(data.n_victims))
    needed = set(data.nearest)
    first = regions.size
    regions.shrink()
    assert regions.size == first
    regions.grow()
    assert regions.size == pytest.approx(first * HeuristicsParameters().region_growth)
    regions.shrink()
    assert regions.size == pytest.approx(first)
    while not regions.exhausted:
        regions.grow()
    assert set(np.flatnonzero(regions.draw())) == needed
