r"""Column generation for latency: the best dual values, and what they rule out.

At any dual values, these of all tasks and the cheapest path of every robot bound the latency from
below (weak duality), so neither an early stop nor the linear solver's tolerances can make a bound too
high. They are those of the master program on the paths known so far, smoothed towards the best so
far; each round adds the cheapest paths that they ask for.

Source: Desaulniers, Desrosiers and Solomon (eds.), *Column generation* (2005); Wentges, *Weighted
Dantzig-Wolfe decomposition for linear mixed-integer programming* (1997) for smoothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from ...arrays import Floats
from ..parameters import BranchAndPriceParameters
from ..stop import StoppingCriterion
from .duals import Duals, Round
from .master import Master
from .ng_network import Network
from .path_program import Path
from .pricing import CheapestPaths, reduced_costs
from .reduced_cost_fixing import fix

_UNSERVED = 1e-6
"""How much may be left unserved in a relaxation that counts as one of routes."""


class Watch(Protocol):
    """Who follows the bound of `ColumnGeneration.converge`."""

    @property
    def stop(self) -> StoppingCriterion:
        """When to end."""

    def proved(self, bound: float) -> bool:
        """Told of the bound after every pricing; whether to go on."""


class ColumnGeneration:
    """Column generation on the networks of all robots.

    Parameters
    ----------
    networks : sequence of Network
        One for each robot that can serve something; changed in place.
    master : Master
        With paths of these networks.
    duals : Duals
        To begin with.
    largest_artificial_cost : float
        Up to which to raise the cost of leaving tasks unserved.
    parameters : BranchAndPriceParameters
        How to generate.
    """

    def __init__(
        self,
        networks: Sequence[Network],
        master: Master,
        duals: Duals,
        largest_artificial_cost: float,
        parameters: BranchAndPriceParameters,
    ) -> None:
        self.networks, self.master, self.parameters = networks, master, parameters
        self.largest_artificial_cost = largest_artificial_cost
        self._by_robot = {network.robot: network for network in networks}
        self.duals = duals
        """The best so far; after `converge`, they prove `proven`."""
        self.proven = -math.inf
        self.cheapest: list[float] = []
        """What the cheapest path of each network costs at those dual values; at most 0."""

    def converge(self, tolerance: float, watch: Watch) -> bool:
        """Raise the bound to within `tolerance` of the best; whether it got there."""
        best = self.duals.on(tuple(self.master.breakpoints))
        self.proven = -math.inf
        self._price(best)
        if not watch.proved(self.proven):
            return False
        smoothing = self.parameters.smoothing
        while True:
            current = self.master.solve(watch.stop)
            if current is None:
                return False
            n_new = self._price(current.towards(self.duals, smoothing))
            if not watch.proved(self.proven):
                return False
            close = self.master.value - self.proven <= tolerance
            if close or (n_new == 0 and smoothing == 0.0):
                served = self.master.unserved <= _UNSERVED
                if served or self.master.artificial_cost >= self.largest_artificial_cost:
                    return True
                self.master.raise_artificial_cost(self.parameters.artificial_factor)
            elif n_new == 0:
                smoothing = max(smoothing - self.parameters.smoothing / 2, 0.0)

    def round(self) -> Round:
        """What proves `proven`."""
        neighbours = {n.robot: (n.victims, n.neighbours) for n in self.networks}
        return Round(self.duals, neighbours)

    def _price(self, duals: Duals) -> int:
        """The bound that `duals` prove, and the paths that they ask for; how many are new."""
        cheapest: list[float] = []
        found: list[Path] = []
        for network in self.networks:
            cost = reduced_costs(network, duals)
            try:
                there = CheapestPaths(network, cost)
            except TimeoutError:
                return 0
            cheapest.append(min(there.minimum(), 0.0))
            paths = there.paths(0.5 * cheapest[-1], self.parameters.paths_per_pricing)
            found += [(network.robot, stops) for stops in paths]
        proven = float(duals.value.sum()) + sum(cheapest)
        if proven > self.proven:
            self.proven, self.duals, self.cheapest = proven, duals, cheapest
        return self.master.add(found)

    def allowed_costs(self, maximum: float) -> list[tuple[Network, Floats, float]]:
        """Per network its costs, and what its path may cost in a solution worth at most `maximum`."""
        return [
            (network, reduced_costs(network, self.duals), cheapest + maximum - self.proven)
            for network, cheapest in zip(self.networks, self.cheapest, strict=True)
        ]

    def fix(self, maximum: float) -> None:
        """Rule out what no solution worth at most `maximum` does."""
        for network, cost, allowed in self.allowed_costs(maximum):
            fix(network, cost, allowed)
        self.forget()

    def forget(self) -> None:
        """Forget the paths that the networks do not have."""
        self.master.keep(lambda path: self._by_robot[path[0]].allows(path[1]))

    def grow_neighbourhoods(self) -> bool:
        """Keep cycles like those of the last relaxation from coming back; whether any did."""
        wanted = {network.robot: network.neighbours.copy() for network in self.networks}
        for share, (robot, stops) in self.master.used:
            cycle = _shortest_cycle([v for v, _, _ in stops])
            if share > self.parameters.notable_share and cycle:
                place = {int(v): i for i, v in enumerate(self._by_robot[robot].victims)}
                for between in cycle:
                    wanted[robot][place[between], place[cycle[0]]] = True
        grown = False
        for network in self.networks:
            neighbours = wanted[network.robot]
            more = bool((neighbours != network.neighbours).any())
            largest = int(neighbours.sum(axis=1).max())
            small = network.n_states * network.last <= self.parameters.maximum_cells
            if more and largest <= self.parameters.largest_neighbourhood and small:
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
