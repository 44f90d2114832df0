r"""Branch and price: the minimum latency, by a solution and a bound that close in on each other.

1. Dual values decompose the objective into one problem per robot (`duals`); the cheapest paths of the
   robots' networks (`pricing`) at any of them bound the latency from below.
2. The best are those of a linear program on the paths found so far (`master`), solved by
   `column_generation`. `breakpoints`, and victims that paths remember, are added where its solution
   shows that they are missing.
3. Between rounds, what only paths of too high a cost for a better solution do is ruled out
   (`reduced_cost_fixing`), and whole routes are chosen among the paths known (`route_selection`).
4. When little is open, all routes that a better solution may use are listed (`enumeration`), and an
   integer program on the list closes the gap; else the node is divided in two (`branching`).

Limits on how long or far robots go may be left out of the networks: bounds stay valid, since limits
only make plans worse. It may be stopped at any moment.

Source: Desaulniers, Desrosiers and Solomon (eds.), *Column generation* (2005).
"""

from __future__ import annotations

import math
from itertools import count

import numpy as np

from ...arrays import Floats
from ..bound import Bound, Proof
from ..heuristics.ruin_and_recreate import ruin_and_recreate
from ..incumbent import ROUNDING, Progress
from ..parameters import Parameters
from ..problem import Routes, RoutingData
from ..stop import StoppingCriterion
from .branching import decision
from .breakpoints import refine
from .column_generation import ColumnGeneration
from .duals import Duals, LatencyRoot, Round
from .enumeration import enumerate_routes
from .master import Master
from .ng_network import Network
from .path_program import Path, PathProgram, paths_of, routes_of
from .root_proof import LatencyEvidence
from .route_selection import select_routes
from .tasks import Tasks
from .tree import Node, Tree

LEEWAY = 0.1 * ROUNDING
"""Share by which bounds are lowered, for the sums of floats that they are."""


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
    progress.leeway = LEEWAY
    progress.bound_at_once()
    evidence = None
    if not progress.done():
        search = _Search(progress, seed, parameters or Parameters())
        search.run()
        evidence = search.evidence()
    return Bound(progress.bound, progress.proof, progress.step.step, root=evidence)


class _Search:
    """One run of branch and price."""

    def __init__(self, progress: Progress, seed: int, parameters: Parameters) -> None:
        self.progress, self.seed = progress, seed
        self.heuristics, self.parameters = parameters.heuristics, parameters.branch_and_price
        self.data = progress.data
        self.tasks = Tasks.from_data(self.data)
        mean = progress.value / self.data.n_victims
        self.master = Master(self.data, self.tasks, self.parameters.artificial_cost * mean)
        self.tree = Tree()
        self.proof: Proof = "column generation"
        self.time_steps: dict[int, float] = {}
        self.rounds: list[Round] = []
        """Of the root."""
        self.proved_at_root = -math.inf

    @property
    def stop(self) -> StoppingCriterion:
        """When to end."""
        return self.progress.stop

    def run(self) -> None:
        """Bound, enumerate and branch until done."""
        if not self.open_root():
            return
        while self.tree and not self.progress.done():
            node = self.tree.next()
            if not self.progress.can_be_pruned(node.bound):
                self.process(node)
            if self.progress.done():
                return
            self.tree.close()
            self.tell()

    def open_root(self) -> bool:
        """Open the root, if networks of a size and time to work with order the visits in time."""
        data, p = self.data, self.parameters
        robots = [r for r in range(data.n_robots) if data.can_visit[r].any()]
        if any(
            2 ** self.tasks.in_one_visit(r, v) > p.maximum_options
            for r in robots
            for v in range(data.n_victims)
        ):
            return False
        deadline = _deadlines(data, self.progress.value)
        left = self.progress.left
        try:
            networks = [
                Network(data, self.tasks, r, deadline, p.maximum_steps, left) for r in robots
            ]
            if any(network.timeless for network in networks):
                return False
            self.time_steps = {network.robot: network.step for network in networks}
            for network in networks:
                network.remember(network.nearest(p.first_neighbourhood))
        except TimeoutError:
            return False
        duals = Duals.zero(data.priority, tuple(self.master.breakpoints), self.tasks.victim)
        self.tree.open(networks, self.paths_of(self.progress.routes), duals, -math.inf)
        return True

    def process(self, node: Node) -> None:
        """Bound a node; close it by enumeration or divide it in two, unless time runs out."""
        try:
            self.work_on(node)
        except TimeoutError:
            self.leave()

    def work_on(self, node: Node) -> None:
        """As `process`; where a network is cut short, TimeoutError says so."""
        generation = ColumnGeneration(
            node.networks,
            self.master,
            node.duals,
            self.parameters.largest_artificial_cost * self.progress.value,
            self.parameters,
        )
        self.master.paths = node.paths
        generation.forget()
        used = self.converge(generation, root=node.number == 0)
        if used is None:
            self.leave()
        elif not self.enumerate(generation):
            if self.progress.done():
                self.leave()
            else:
                self.branch(generation, used)

    def converge(
        self, generation: ColumnGeneration, *, root: bool
    ) -> list[tuple[float, Path]] | None:
        """Column generation in rounds, each on a better relaxation and a smaller network.

        Returns the shares of paths in the last relaxation; ``None`` if there is nothing more to do.
        """
        p = self.parameters
        tolerance, last = p.first_tolerance, p.last_tolerance
        if not root:
            tolerance = last = p.node_tolerance
        for n in count():
            converged = generation.converge(tolerance * self.progress.value, self)
            if root and generation.proven > -math.inf:
                self.rounds.append(generation.round())
                self.proved_at_root = max(self.proved_at_root, generation.proven)
            if not converged:
                return None
            gain = refine(self.master, generation.duals, p.maximum_breakpoints)
            if root and n == 1:
                self.polish()
            if n > 0 or not root:
                self.select()
            if not self.proved(generation.proven):
                return None
            used = self.master.used
            generation.fix(self.cutoff())
            # Before, relaxations are too far from their end to tell what is worth remembering.
            grown = tolerance <= p.growing_tolerance and generation.grow_neighbourhoods()
            open_ = self.progress.value - self.tree.current
            if tolerance <= last and gain <= p.breakpoint_gain * open_ and not grown:
                return used
            tolerance = max(p.tolerance_factor * tolerance, p.last_tolerance)
        raise AssertionError("counting never ends")

    def enumerate(self, generation: ColumnGeneration) -> bool:
        """List all routes that matter and choose among them; whether that closed the node."""
        paths: list[Path] = []
        for network, cost, allowed in generation.allowed_costs(self.cutoff()):
            own = enumerate_routes(self.data, self.tasks, network, cost, allowed, self.parameters)
            if own is None or len(paths) + len(own) > self.parameters.maximum_routes:
                return False
            paths += own
        if self.proof == "column generation":
            self.proof = "route enumeration"
        seconds = max(self.parameters.enumeration_share * self.progress.left(), 1.0)
        bound = self.choose(paths, seconds, tell=True)
        return not self.proved(bound)

    def branch(self, generation: ColumnGeneration, used: list[tuple[float, Path]]) -> None:
        """Open two nodes for the two sides of a decision that the relaxation leaves open."""
        sides = decision(self.data, self.tasks, used, self.parameters.undecided_share)
        if not sides:
            # The paths agree on everything: they are routes, worth what the relaxation says.
            self.offer(routes_of(self.data, self.tasks, (path for _, path in used)))
            self.leave()
            return
        self.proof = "branch and price"
        paths = self.master.paths
        for restrict in sides:
            networks = [network.copy() for network in generation.networks]
            for network in networks:
                restrict(network)
            self.tree.open(networks, paths, generation.duals, self.tree.current)

    # The bound

    def proved(self, bound: float) -> bool:
        """Take note of a bound on the node in work; whether to go on with it."""
        self.tree.raise_current(bound)
        self.tell()
        return not self.progress.done() and not self.progress.can_be_pruned(self.tree.current)

    def tell(self) -> None:
        """Raise the bound to that of all nodes."""
        if self.tree.bound > -math.inf:
            self.progress.raise_bound(self.tree.bound, self.proof, of_better=True)

    def leave(self) -> None:
        """Leave the node in work as it is, unless it can be pruned."""
        if not self.progress.can_be_pruned(self.tree.current):
            self.tree.leave()

    def cutoff(self) -> float:
        """What solutions that are better than the incumbent are worth at most, with some leeway."""
        return self.progress.better() + ROUNDING * self.progress.value

    def evidence(self) -> LatencyEvidence | None:
        """What was proved at the root, if it is more than what follows at once."""
        if not self.rounds or self.progress.proof == "combinatorial":
            return None
        value = self.progress.possible(self.proved_at_root)
        root = LatencyRoot(value, self.tasks, self.time_steps, tuple(self.rounds))
        return LatencyEvidence(root, self.data)

    # The incumbent

    def select(self) -> None:
        """Choose whole routes among the paths known."""
        if not self.progress.done():
            self.choose(self.master.paths, self.parameters.selection_share * self.progress.left())

    def choose(self, paths: list[Path], seconds: float, *, tell: bool = False) -> float:
        """The bound of the best choice of `paths`, which may be a better incumbent."""
        selection = select_routes(
            PathProgram(self.data, self.tasks, self.master.breakpoints, seed=self.seed),
            paths,
            self.progress.until_done(seconds),
            self.cutoff(),
            self.proved if tell else None,
        )
        if selection.routes is not None:
            self.offer(selection.routes)
        return selection.bound

    def polish(self) -> None:
        """Ruin and recreate on the incumbent."""
        progress, p = self.progress, self.parameters
        seconds = min(p.polish_share * progress.left(), progress.spent(), p.polish_seconds)
        self.offer(
            ruin_and_recreate(
                self.data,
                progress.routes,
                progress.objective,
                stop=progress.until_done(seconds),
                seed=self.seed + 1,
                parameters=self.heuristics,
            )
        )

    def offer(self, routes: Routes) -> None:
        """Routes that may be better than the incumbent."""
        if self.progress.offer(routes):
            self.master.add(self.paths_of(routes))

    def paths_of(self, routes: Routes) -> list[Path]:
        """The paths that `routes` are."""
        return paths_of(self.data, self.tasks, routes)


def _deadlines(data: RoutingData, value: float) -> Floats:
    """No solution better than `value` completes a victim later, ``(n_victims,)``."""
    alone = np.where(data.able, _shortest_ways(data)[:, :, None] + data.service[None], np.inf)
    soonest = np.where(data.required, alone.min(axis=0), 0.0).max(axis=1)
    spare = value - float(data.priority @ soonest)
    later: Floats = np.full(len(data.priority), np.inf)
    np.divide(spare, data.priority, out=later, where=data.priority > 0)
    return np.asarray(soonest + later)


def _shortest_ways(data: RoutingData) -> Floats:
    """Shortest travel of r to v, by whatever detour, ``(n_robots, n_victims)``."""
    way: Floats = np.where(data.can_visit, data.leave, np.inf)
    if data.is_metric:
        return way
    pair = data.can_visit[:, :, None] & data.can_visit[:, None, :]
    between = np.where(pair, data.between, np.inf)
    while True:
        shorter: Floats = np.minimum(way, (way[:, :, None] + between).min(axis=1))
        if np.array_equal(shorter, way):
            return way
        way = shorter
