r"""Column generation for latency: the best prices, and what they rule out.

At any prices, the rewards of all needs and the cheapest path of every robot bound the latency from
below (weak duality), so neither an early stop nor the linear solver's tolerances can make a bound too
high. The prices are the duals of the master program on the paths known so far, held back towards the
best so far; each round adds the cheapest paths that they ask for.

Source: Desaulniers, Desrosiers and Solomon (eds.), *Column generation* (2005); Wentges, *Weighted
Dantzig-Wolfe decomposition for linear mixed-integer programming* (1997) for held-back prices; Pessoa,
Uchoa, Poggi and Rodrigues, *Exact algorithm over an arc-time-indexed formulation for parallel machine
scheduling problems* (2010) for fixing by reduced costs in time-expanded networks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ...arrays import Floats
from .duals import Prices, Round
from .master import Master, Path
from .ng_network import MOST_REMEMBERED, Network

SMOOTHING = 0.6
"""How far prices stay with the best so far."""
UNSERVED = 1e-6
"""How much may be left unserved in a relaxation that counts as one of routes."""
RAISE = 4.0
"""Factor on the price of leaving needs unserved where that is too low."""
NOTABLE = 0.01
"""Share of a path from which on it matters where it goes."""
MOST_CELLS = 20_000_000
"""States times steps of one network, beyond which no more is remembered."""


class Watch(Protocol):
    """Who follows the bound of `Generation.converge`."""

    def left(self) -> float:
        """Seconds left."""

    def proved(self, bound: float) -> bool:
        """Told of the bound after every pricing; whether to go on."""


class Generation:
    """Column generation on the networks of all robots.

    Parameters
    ----------
    networks : sequence of Network
        One for each robot that can serve something; changed in place.
    master : Master
        With paths of these networks.
    prices : Prices
        To begin with.
    dearest : float
        The price up to which to raise that of leaving needs unserved.
    """

    def __init__(
        self, networks: Sequence[Network], master: Master, prices: Prices, dearest: float
    ) -> None:
        self.networks, self.master, self.dearest = networks, master, dearest
        self._by_robot = {network.robot: network for network in networks}
        self.prices = prices
        """The best so far; after `converge`, they prove `proven`."""
        self.proven = -math.inf
        self.least: list[float] = []
        """What the cheapest path of each network costs at those prices; at most 0."""

    def converge(self, tolerance: float, watch: Watch) -> bool:
        """Raise the bound to within `tolerance` of the best; whether it got there."""
        best = self.prices.on(tuple(self.master.breaks))
        self.proven = -math.inf
        self._price(best, watch)
        if not watch.proved(self.proven):
            return False
        smoothing = SMOOTHING
        while True:
            current = self.master.solve(max(watch.left(), 0.0))
            if current is None:
                return False
            n_new = self._price(current.towards(self.prices, smoothing), watch)
            if not watch.proved(self.proven):
                return False
            close = self.master.value - self.proven <= tolerance
            if close or (n_new == 0 and smoothing == 0.0):
                if self.master.unserved <= UNSERVED or self.master.dear >= self.dearest:
                    return True
                self.master.raise_price(RAISE)
            elif n_new == 0:
                smoothing = max(smoothing - SMOOTHING / 2, 0.0)

    def round(self) -> Round:
        """What proves `proven`."""
        neighbours = {n.robot: (n.victims, n.neighbours) for n in self.networks}
        return Round(self.prices, neighbours)

    def _price(self, prices: Prices, watch: Watch) -> int:
        """The bound that `prices` prove, and the paths that they ask for; how many are new."""
        least: list[float] = []
        found: list[Path] = []
        for network in self.networks:
            try:
                there = network.forward(self.cost(network, prices), watch.left)
            except TimeoutError:
                return 0
            least.append(min(there.least(), 0.0))
            found += [(network.robot, stops) for stops in there.paths(0.5 * least[-1])]
        proven = float(prices.reward.sum()) + sum(least)
        if proven > self.proven:
            self.proven, self.prices, self.least = proven, prices, least
        return self.master.add(found)

    def cost(self, network: Network, prices: Prices) -> Floats:
        """What serving each option at each time costs at `prices`, ``(m, n_options, last + 1)``."""
        times = network.times
        cost = np.full(network.open.shape, np.inf)
        for i, options in enumerate(network.options):
            charge = {g: prices.charge(g, times) for g in {g for own in options for g in own}}
            for j, own in enumerate(options):
                cost[i, j] = np.sum([charge[g] for g in own], axis=0)
        cost[~network.open] = np.inf
        return cost

    def priced(self, most: float) -> list[tuple[Network, Floats, float]]:
        """Per network its costs, and what its path may cost in an answer worth at most `most`."""
        return [
            (network, self.cost(network, self.prices), least + most - self.proven)
            for network, least in zip(self.networks, self.least, strict=True)
        ]

    def rule_out(self, most: float) -> None:
        """Rule out what no answer worth at most `most` does."""
        for network, cost, spare in self.priced(most):
            network.fix(cost, spare)
        self.forget()

    def forget(self) -> None:
        """Forget the paths that the networks do not have."""
        self.master.keep(lambda path: self._by_robot[path[0]].allows(path[1]))

    def remember_more(self) -> bool:
        """Keep paths like those of the last relaxation from coming back; whether any did."""
        wanted = {network.robot: network.neighbours.copy() for network in self.networks}
        for share, (robot, stops) in self.master.used:
            cycle = _shortest_cycle([v for v, _, _ in stops])
            if share > NOTABLE and cycle:
                place = {int(v): i for i, v in enumerate(self._by_robot[robot].victims)}
                for between in cycle:
                    wanted[robot][place[between], place[cycle[0]]] = True
        grown = False
        for network in self.networks:
            neighbours = wanted[network.robot]
            more = bool((neighbours != network.neighbours).any())
            most = int(neighbours.sum(axis=1).max())
            small = network.n_states * network.last <= MOST_CELLS
            if more and most <= MOST_REMEMBERED and small:
                network.remember(neighbours)
                grown = True
        if grown:
            self.forget()
        return grown


def _shortest_cycle(victims: list[int]) -> list[int]:
    """From a victim to before its next visit, where that is soonest; empty if none is visited twice."""
    last: dict[int, int] = {}
    best: list[int] = []
    for n, v in enumerate(victims):
        if v in last and (not best or n - last[v] < len(best)):
            best = victims[last[v] : n]
        last[v] = n
    return best
