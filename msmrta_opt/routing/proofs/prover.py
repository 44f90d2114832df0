"""From routes to a certificate that no others are worth less, checked."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from ...arrays import Floats
from ...interruption import interruptible
from ...mission.files import write_with
from ...mission.instance import Instance
from ...proofs.branching import Search
from ...proofs.certificate import Claim, Cutoff, write
from ...proofs.derivation import Box, Spool
from ...proofs.exact import Row
from ...proofs.tree import INTERRUPTED, Limits, Node, leaves
from ..branch_and_cut.cutting_plane import Relaxation
from ..branch_and_cut.edge_formulation import EdgeFormulation
from ..branch_and_cut.points import routes_of
from ..branch_and_cut.separation import Cut
from ..objectives import Objective
from ..problem import Routes, RoutingData
from ..stop import Interruption, MaximumRuntime
from .priorities import binding_first
from .reduction import Reduction, reached, renumbered
from .separating import CutoffBounds, SeparatingRelaxation
from .statement import Statement

CLOSING_SECONDS = 5.0
CLOSING_SHARE = 0.1
"""For making leaves of what a limit left open: so many seconds, or this share of the search's."""
CLOSING_ATTEMPTS = 3
SLACK = 1e-6
"""Of a relaxation's value in units, within which it may be an integer."""


@dataclass(frozen=True)
class Found:
    """What came of a search for a proof."""

    remark: str
    """Why not all is proved; empty if it is."""
    better: Fraction | None
    """The value of better routes, if there are any that were found: the claim is false then."""
    nodes: int
    leaves: int
    derivations: int


class _BetterError(Exception):
    """Better routes were found, so that the claim is false."""


def prove_routes(
    data: RoutingData,
    objective: Objective,
    routes: Routes,
    instance: Instance,
    path: str | Path,
    *,
    limits: Limits,
    comments: tuple[str, ...] = (),
) -> Found:
    """Write a certificate that no routes are worth less than `routes`, or of the bound that is proved.

    Parameters
    ----------
    data : RoutingData
        The joint problem, in the mission's units.
    objective : Objective
        Total time or makespan.
    routes : Routes
        Feasible ones.
    instance : Instance
        With the known victims, in the order of `data`.
    path : path
        Where the certificate goes.
    limits : Limits
        When to stop.
    comments : tuple of str
        Lines at the beginning of the file.

    Raises
    ------
    InputError
        If the objective is none of these, or the file cannot be written.
    """
    return _Prover(data, objective, routes, instance, limits).run(path, comments)


class _Prover:
    def __init__(
        self,
        data: RoutingData,
        objective: Objective,
        routes: Routes,
        instance: Instance,
        limits: Limits,
    ) -> None:
        self.limits = limits
        self.began = time.perf_counter()
        worth = objective.value(data, routes)
        self.formulation = EdgeFormulation.of(data, objective, worth)
        self.statement = Statement(self.formulation, instance)
        self.routes = routes
        self.point = self.statement.point(routes)
        self.value = int(self.statement.program.value(self.point))
        self.spool = Spool(1)
        self.nodes = 0
        self.n_stated = 0
        """Number of constraints that are stated for the root."""
        self.better: Routes | None = None

    def run(self, path: str | Path, comments: tuple[str, ...]) -> Found:
        """Search and write."""
        with interruptible():
            duals = self._root()
            remark, root, reduction = self._whole(duals)
            if root is None:
                del self.statement.program.stated[self.n_stated :]
                reduction = Reduction(
                    self.statement, min(reached(self.statement.program, duals), self.value)
                )
                found = reduction.fix(duals)
                assert found is not None
                root = Node(leaf=self.spool.put(found))
        return self._written(path, comments, remark, root, reduction)

    def _root(self) -> Floats:
        """Dual values of the statement's rows, once the cuts of the root relaxation are among them."""
        relaxation = Relaxation(self.formulation, routes=self.routes)
        left = self.limits.deadline - time.perf_counter()
        stop = MaximumRuntime(max(left, 0.0)) | Interruption(lambda: bool(self.limits.reached(0)))
        relaxed = relaxation.solve(stop)
        n_rows = len(self.statement.program.rows)
        used = relaxed.dual_values[n_rows:] != 0
        for cut, is_used in zip(relaxed.cuts, used, strict=True):
            if is_used:
                self.statement.add(cut)
        self.n_stated = len(self.statement.program.stated)
        units = np.ones(n_rows + int(used.sum()))
        units[:n_rows] = [float(unit) for unit in self.statement.units]
        duals = np.concatenate([relaxed.dual_values[:n_rows], relaxed.dual_values[n_rows:][used]])
        return np.asarray(duals * units / float(self.statement.unit))

    def _whole(self, duals: Floats) -> tuple[str, Node | None, Reduction]:
        """Why not all could be proved, the tree if it could, and what it rests on."""
        reduction = Reduction(self.statement, self.value)
        evident = reduction.fix(duals)
        if evident is not None:
            return "", Node(leaf=self.spool.put(evident)), reduction
        search, columns = self._search(reduction)
        try:
            remark = search.run(self.limits)
        except _BetterError:
            remark = "there are better routes"
        except KeyboardInterrupt:  # a second one
            remark = INTERRUPTED
        self.nodes = search.n_nodes
        if not remark and search.unproved:
            remark = "floating-point relaxations are too coarse for it"
        if remark and not self._settled(search, reduction, duals):
            return remark, None, reduction
        _rename(search.root, columns)
        return remark, search.root, reduction

    def _settled(self, search: Search, reduction: Reduction, duals: Floats) -> bool:
        """Prove what the open nodes' relaxations do, by a lower goal; whether that exceeds the root's.

        Where the time is not enough, by one that is nearer to the root's, which takes fewer leaves.
        """
        bound = search.bound()
        if not math.isfinite(bound):
            return False
        minimum = reached(self.statement.program, duals)
        goal = min(math.ceil(bound - SLACK), self.value)
        seconds = max(CLOSING_SECONDS, CLOSING_SHARE * (time.perf_counter() - self.began))
        assert isinstance(search.bounds, CutoffBounds)
        try:
            for _ in range(CLOSING_ATTEMPTS):
                if goal <= minimum:
                    break
                search.bounds.goal = goal
                if _closed(search, goal, Limits(time.perf_counter() + seconds)):
                    reduction.lower(goal)
                    return True
                goal = (goal + minimum) // 2
        except KeyboardInterrupt:
            pass
        return False

    def _search(self, reduction: Reduction) -> tuple[Search, list[int]]:
        columns = reduction.columns
        core = reduction.core(columns)
        rows = list(core.rows)
        place = {j: n for n, j in enumerate(columns.tolist())}
        keep = np.zeros(self.formulation.n_columns, dtype=bool)
        keep[columns] = True

        def state(cut: Cut) -> Row:
            return renumbered(reduction.restricted(self.statement.add(cut, keep)), place)

        relaxation = SeparatingRelaxation(core, self.formulation, columns, rows, state)
        bounds = CutoffBounds(core, rows, reduction.goal, reduction.assumption())
        box = Box.of(core)
        if self.statement.is_makespan:
            box.upper[place[self.formulation.start("T")]] = reduction.ceiling()

        def found(x: Floats) -> Fraction | None:
            whole = np.zeros(self.formulation.n_columns)
            whole[columns] = np.round(x)
            routes = routes_of(self.formulation, whole)
            if routes is not None and self.statement.value(routes) < self.value:
                self.better = routes
                raise _BetterError
            return None

        target = Fraction(reduction.goal - 1) + Fraction(1, 64)
        first = binding_first(self.statement, columns) if self.statement.is_makespan else None
        search = Search(core, relaxation, bounds, box, self.spool, target, found, first)
        return search, columns.tolist()

    def _written(
        self,
        path: str | Path,
        comments: tuple[str, ...],
        remark: str,
        root: Node,
        reduction: Reduction,
    ) -> Found:
        statement, goal = self.statement, reduction.goal
        terms = tuple((j, int(c)) for j, c in enumerate(statement.program.cost) if c)
        cutoff = Cutoff(reduction.cutoff, goal, terms, statement.unit, statement.besides)
        claim = Claim(
            False, None, statement.time(goal), statement.time(self.value), self.point, cutoff
        )
        n_derivations: list[int] = []

        def put(temporary: Path) -> None:
            with temporary.open("wb") as file:
                n_derivations.append(
                    write(
                        file, statement.program, claim, root, reduction.lemmas, self.spool, None,
                        comments,
                    )
                )  # fmt: skip

        write_with(path, put)
        return Found(
            remark=remark,
            better=None if self.better is None else statement.time(statement.value(self.better)),
            nodes=self.nodes,
            leaves=sum(1 for _ in leaves(root)),
            derivations=n_derivations[0],
        )


def _closed(search: Search, goal: int, limits: Limits) -> bool:
    """Make leaves of the nodes whose relaxations contradict less than `goal`; whether that is all."""
    for node in search.shallowest(goal - 1 + SLACK):
        if time.perf_counter() > limits.deadline:
            return False
        search.close(node, limits)
        if node.leaf is None or node.leaf.value is not None:
            node.leaf = None
            return False
    return True


def _rename(root: Node, columns: list[int]) -> None:
    """Let the nodes below `root` speak of the whole program's columns."""
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if node.low is not None and node.high is not None:
            node.column = columns[node.column]
            waiting += [node.low, node.high]
