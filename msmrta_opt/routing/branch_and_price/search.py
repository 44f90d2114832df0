r"""The least latency: an answer and a bound that close in on each other.

1. Prices take the objective apart into one problem per robot (`latency_prices`); the cheapest paths of
   the robots' networks (`latency_network`) at any prices bound the latency from below.
2. The best prices are the duals of a linear program on the paths found so far (`latency_master`), solved
   by column generation. Breakpoints of the prices, and the victims that paths remember, are added
   where its solution shows that they are missing.
3. Between rounds, what only paths too dear for a better answer do is ruled out, and whole paths are
   chosen among those known, for better answers.
4. When little is open, all routes that a better answer may use are listed (`latency_routes`), and an
   integer program on the list closes the gap.

Limits on how long or far robots go may be left out of the networks: bounds stay valid, since limits
only make plans dearer. It may be stopped at any moment.

Source: Desaulniers, Desrosiers and Solomon (eds.), *Column generation* (2005) for the method; Wentges,
*Weighted Dantzig-Wolfe decomposition for linear mixed-integer programming* (1997) for smoothed prices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count

import numpy as np

from ...arrays import Floats
from ..bound import Bound, Proof
from ..heuristics.ruin_and_recreate import ruin_and_recreate
from ..incumbent import ROUNDING, Progress
from ..parameters import Parameters
from ..problem import Routes, RoutingData
from .branching import decision
from .duals import LatencyRoot, Prices, Round
from .enumeration import all_paths
from .master import Master, Path
from .ng_network import Network
from .pricing import Generation
from .root_proof import LatencyEvidence
from .tasks import Needs

REMEMBERED = 4
"""Victims in a neighbourhood to begin with, itself included."""
MOST_LABELS = 30_000
"""Routes under way, per robot, beyond which listing them all is given up."""
MOST_LISTED = 4_000
"""Routes of all robots that are chosen from."""
FIRST_TOLERANCE, SHRINKING, LAST_TOLERANCE = 2e-2, 0.3, 5e-5
"""Relative to the incumbent's value: how well the rounds of column generation converge at first."""
LATER_TOLERANCE = 3e-4
"""The same after branching."""
MEMORABLE_TOLERANCE = 1e-3
"""The same, from which on paths are kept from coming back."""
ENOUGH = 0.03
"""Share of what is still missing that breakpoints must bring for another round."""
DEAR, DEAREST = 3.0, 4.0
"""The price of leaving a need unserved: at first, in mean completion times; at last, in latencies."""
LEEWAY = 0.1 * ROUNDING
"""Share by which bounds are lowered, for the sums of floats that they are."""
LONGEST_POLISH = 20.0
"""Seconds of local search at a time."""


def branch_and_price(
    progress: Progress, *, seed: int = 0, parameters: Parameters | None = None
) -> Bound:
    """Close in on the minimum latency; the best routes are then the incumbent of `progress`.

    Parameters
    ----------
    progress : Progress
        The joint problem with feasible routes, and when to stop; the better these routes are, the
        sooner the gap closes.
    seed : int
        Of all random choices.
    parameters : Parameters, optional
        How to search.

    Raises
    ------
    SolverError
        If a bound exceeds the value of feasible routes: a bug, never to be passed over.
    """
    data = progress.data
    progress.leeway = LEEWAY
    progress.bound_at_once()
    root = None
    if not progress.done():
        search = _Run(data, progress, seed, parameters or Parameters())
        search.run()
        root = search.root()
    return Bound(
        progress.bound,
        progress.proof,
        progress.step.step,
        root=None if root is None else LatencyEvidence(root, data),
    )


@dataclass(order=True)
class _Node:
    """A part of all answers."""

    bound: float
    """None of them is worth less."""
    number: int
    """Of when it was made."""
    networks: list[Network] = field(compare=False)
    paths: list[Path] = field(compare=False)
    prices: Prices = field(compare=False)
    """To begin with."""


class _Run:
    """Branch and price."""

    def __init__(
        self, data: RoutingData, progress: Progress, seed: int, parameters: Parameters
    ) -> None:
        self.data, self.progress, self.seed = data, progress, seed
        self.parameters = parameters
        self.needs = Needs.from_data(data)
        self.master = Master(data, self.needs, dear=DEAR * progress.value / data.n_victims)
        self.nodes: list[_Node] = []
        """Open ones, as a heap."""
        self.n_nodes = 0
        self.here = -math.inf
        """The bound of the node in work."""
        self.left_open = math.inf
        """The least bound of nodes that were given up."""
        self.proof: Proof = "column generation"
        self.clocks: dict[int, float] = {}
        self.rounds: list[Round] = []
        """Of the first node."""
        self.proved_by_rounds = -math.inf

    def root(self) -> LatencyRoot | None:
        """What was proved by prices without branching, if it is more than what follows at once."""
        if not self.rounds or self.progress.proof == "combinatorial":
            return None
        value = self.progress.possible(self.proved_by_rounds)
        return LatencyRoot(value, self.needs, self.clocks, tuple(self.rounds))

    def run(self) -> None:
        """Close in until done."""
        deadline = _deadlines(self.data, self.progress.value)
        networks = [
            Network(self.data, self.needs, r, deadline)
            for r in range(self.data.n_robots)
            if self.data.can_visit[r].any()
        ]
        if any(network.timeless for network in networks):
            return
        self.clocks = {network.robot: network.step for network in networks}
        for network in networks:
            network.remember(network.nearest(REMEMBERED))
        prices = Prices.without_reward(
            self.data.priority, tuple(self.master.breaks), self.needs.victim
        )
        paths = _paths_of(self.data, self.needs, self.progress.routes)
        self.open(networks, paths, prices, -math.inf)
        while self.nodes and not self.progress.done():
            node = heappop(self.nodes)
            self.here = node.bound
            if not self.progress.can_be_pruned(node.bound):
                self.work(node)
            if self.progress.done():
                return
            self.here = math.inf
            self.tell()

    def open(
        self, networks: list[Network], paths: list[Path], prices: Prices, bound: float
    ) -> None:
        """Open a node."""
        heappush(self.nodes, _Node(bound, self.n_nodes, networks, paths, prices))
        self.n_nodes += 1

    def left(self) -> float:
        """Seconds left; none once someone asked to stop."""
        return self.progress.left()

    def tell(self) -> None:
        """Raise the bound to that of the least open node."""
        least = min([self.here, self.left_open, *(node.bound for node in self.nodes[:1])])
        if least > -math.inf:
            self.progress.raise_bound(least, self.proof, of_better=True)

    def proved(self, bound: float) -> bool:
        """Take note of the bound of the node in work; whether to go on with it."""
        self.here = max(self.here, bound)
        self.tell()
        return not self.progress.done() and not self.progress.can_be_pruned(self.here)

    def work(self, node: _Node) -> None:
        """Bound a node; close it or part it in two, unless time runs out."""
        generation = Generation(
            node.networks, self.master, node.prices, DEAREST * self.progress.value
        )
        self.master.paths = node.paths
        generation.forget()
        root = node.number == 0
        tolerance = FIRST_TOLERANCE if root else LATER_TOLERANCE
        for n in count():
            converged = generation.converge(tolerance * self.progress.value, self)
            if root and generation.proven > -math.inf:
                self.rounds.append(generation.round())
                self.proved_by_rounds = max(self.proved_by_rounds, generation.proven)
            if not converged:
                self.give_up()
                return
            gain = self.master.refine(generation.prices)
            if root and n == 1:
                self.polish()
            if n > 0 or not root:
                self.choose()
            if not self.proved(generation.proven):
                self.give_up()
                return
            used = self.master.used
            generation.rule_out(self.most())
            # Before, relaxations are too far from their end to tell what is worth remembering.
            grown = tolerance <= MEMORABLE_TOLERANCE and generation.remember_more()
            last = tolerance <= (LAST_TOLERANCE if root else LATER_TOLERANCE)
            missing = self.progress.value - self.here
            if last and gain <= ENOUGH * missing and not grown:
                break
            tolerance = max(SHRINKING * tolerance, LAST_TOLERANCE)
        if self.close(generation):
            return
        if self.progress.done():
            self.give_up()
        else:
            self.part(generation, used)

    def give_up(self) -> None:
        """Leave the node in work as it is, unless there is nothing more to it."""
        if not self.progress.can_be_pruned(self.here):
            self.left_open = min(self.left_open, self.here)

    def most(self) -> float:
        """What answers are worth at most that are better than the incumbent, with some leeway."""
        return self.progress.better() + ROUNDING * max(1.0, self.progress.value)

    def choose(self) -> None:
        """Choose whole paths among those known, for better routes."""
        if self.progress.done():
            return
        chosen = self.master.integer(
            cutoff=self.most(),
            time_limit=0.02 * self.progress.left(),
            seed=self.seed,
            should_stop=self.progress.done,
        )
        if chosen.routes is not None:
            self.offer(chosen.routes)

    def polish(self) -> None:
        """Local search on the incumbent."""
        progress = self.progress
        seconds = min(0.1 * progress.left(), progress.spent(), LONGEST_POLISH)
        routes = ruin_and_recreate(
            self.data,
            progress.routes,
            progress.objective,
            stop=progress.until_done(seconds),
            seed=self.seed + 1,
            parameters=self.parameters.heuristics,
        )
        self.offer(routes)

    def offer(self, routes: Routes) -> None:
        """Routes that may be better than the incumbent."""
        if self.progress.offer(routes):
            self.master.add(_paths_of(self.data, self.needs, routes))

    def close(self, generation: Generation) -> bool:
        """List all routes that matter and choose among them; whether that could be done."""
        paths: list[Path] = []
        for network, cost, spare in generation.priced(self.most()):
            own = all_paths(self.data, self.needs, network, cost, spare, MOST_LABELS)
            if own is None or len(paths) + len(own) > MOST_LISTED:
                return False
            paths += own
        if self.proof == "column generation":
            self.proof = "route enumeration"
        chosen = self.master.integer(
            paths=paths,
            cutoff=self.most(),
            time_limit=max(0.2 * self.progress.left(), 1.0),
            seed=self.seed,
            should_stop=self.progress.done,
            proved=self.proved,
        )
        if chosen.routes is not None:
            self.offer(chosen.routes)
        return not self.proved(chosen.bound)

    def part(self, generation: Generation, used: list[tuple[float, Path]]) -> None:
        """Open two nodes for the two sides of a decision that the relaxation leaves open."""
        sides = decision(self.data, self.needs, used)
        if not sides:
            # The paths agree on everything: they are routes, worth what the relaxation says.
            self.offer(self.master.routes(path for _, path in used))
            self.give_up()
            return
        self.proof = "branch and price"
        paths = self.master.paths
        for restrict in sides:
            networks = [network.copy() for network in generation.networks]
            for network in networks:
                restrict(network)
            self.open(networks, paths, generation.prices, self.here)


def _deadlines(data: RoutingData, value: float) -> Floats:
    """No answer better than `value` completes a victim later, ``(n_victims,)``."""
    alone = np.where(data.able, _least_ways(data)[:, :, None] + data.service[None], np.inf)
    soonest = np.where(data.required, alone.min(axis=0), 0.0).max(axis=1)
    spare = value - float(data.priority @ soonest)
    weight = data.priority
    later: Floats = np.full(len(weight), np.inf)
    np.divide(spare, weight, out=later, where=weight > 0)
    return np.asarray(soonest + later)


def _least_ways(data: RoutingData) -> Floats:
    """Least travel of r to v, by whatever detour, ``(n_robots, n_victims)``."""
    pair = data.can_visit[:, :, None] & data.can_visit[:, None, :]
    between = np.where(pair, data.between, np.inf)
    way: Floats = np.where(data.can_visit, data.leave, np.inf)
    while True:
        shorter: Floats = np.minimum(way, (way[:, :, None] + between).min(axis=1))
        if np.array_equal(shorter, way):
            return way
        way = shorter


def _paths_of(data: RoutingData, needs: Needs, routes: Routes) -> list[Path]:
    paths = []
    for r, route in enumerate(routes):
        clock, before, stops = 0.0, -1, []
        for v, kinds in route:
            clock += float(data.leave[r, v] if before < 0 else data.between[r, before, v])
            clock += float(data.service[v, list(kinds)].sum())
            stops.append((v, needs.served(v, kinds), clock))
            before = v
        if stops:
            paths.append((r, tuple(stops)))
    return paths
