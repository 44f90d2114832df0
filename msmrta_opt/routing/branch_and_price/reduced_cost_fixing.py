"""Reduced-cost fixing in a network: services at certain times, and legs, that no cheap path has.

Source: Pessoa, Uchoa, Poggi and Rodrigues, *Exact algorithm over an arc-time-indexed formulation for
parallel machine scheduling problems* (2010) for time-expanded networks.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Floats
from .ng_network import Network
from .pricing import CheapestPaths, costs_to_go

_CELLS = 2**22
"""Numbers that are looked at together."""


def fix(network: Network, cost: Floats, maximum: float) -> None:
    """Rule out what only paths that cost more than `maximum` do.

    Parameters
    ----------
    network : Network
        Of one robot; it is changed.
    cost : array, shape (m, n_options, last + 1)
        Of being done with an option at a time.
    maximum : float
        What paths of interest cost.
    """
    there = CheapestPaths(network, cost)
    after, into = costs_to_go(network, cost)
    through = np.full(network.open.shape, np.inf)
    starts = np.flatnonzero(np.diff(network.at[:-1], prepend=-1))
    for j in range(network.n_options):
        ways = there.before(network.extra[network.at[:-1], j]) + after[:-1]
        through[network.at[starts], j] = np.minimum.reduceat(ways, starts, axis=0)
    removed = network.arc & ~(_through_legs(network, there, into) <= maximum)
    network.open &= through + cost <= maximum
    network.arc &= ~removed
    done = network.open.any(axis=(0, 1))
    network.last = int(np.flatnonzero(done)[-1]) if done.any() else 0
    network.open = network.open[:, :, : network.last + 1]
    if removed.any():
        network.rebuild()


def _through_legs(network: Network, there: CheapestPaths, into: Floats) -> Floats:
    """Minimum cost of a path with each leg, ``(m + 1, m)``."""
    steps = np.arange(network.last + 1)
    cheapest = np.full((network.m + 1, network.m), np.inf)
    n_parts = len(network.tail) * len(steps) // _CELLS + 1
    for some in np.array_split(np.arange(len(network.tail)), n_parts):
        ways = there.values[network.tail[some]]
        onward = np.take_along_axis(
            into[network.head[some]], network.steps[some, None] + steps, axis=1
        )
        legs = (network.at[network.tail[some]], network.at[network.head[some]])
        np.minimum.at(cheapest, legs, (ways + onward).min(axis=1))
    return cheapest
