"""The tree of a latency's proof, over the lists of routes that are left when branching begins.

The lists are those that the checker makes (`certify.route_lists`). At each node a linear program over
them chooses shares of routes; its dual values close the node, or its shares say what to branch on.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...arrays import Floats
from ...certify.certificates import worth
from ...certify.joint_problem import Joint
from ...certify.latency_proof import Allowed, leaf_bound, sides
from ...certify.ng_routes import Task
from ...certify.pricing_bound import Priced, price
from ...certify.route_lists import RouteList, route_list
from ...mission.errors import CheckError
from ...mission.plan import Plan
from ...mission.proof import Branch, Breakpoints, LatencyLeaf, LatencyProof, PricingRound, TaskDuals
from ...proofs.tree import Limits
from ..branch_and_price.duals import time_in_intervals
from ..branch_and_price.root_proof import rounded_down
from ..run_highs import quiet_highs

BREAKPOINTS = 16
"""Of a victim whose tasks robots may share, at the maximum."""
ARTIFICIAL = 4.0
"""Cost of leaving a task unserved, in plans."""
TINY = 1e-7
_DIGITS = 12


@dataclass(frozen=True)
class Grown:
    """A tree, or why there is none."""

    leaves: tuple[LatencyLeaf, ...]
    nodes: int
    remark: str


def prove_latency(plan: Plan, root: LatencyProof, limits: Limits) -> Grown:
    """A tree that proves the latency of `plan` to be optimal, where `root` does not do so alone."""
    joint, value = Joint.of(plan), worth(plan, "latency")
    try:
        priced = price(joint, root, value)
        if priced is None:
            return Grown((), 0, "")
        lists = [route_list(robot, priced.spare) for robot in priced.robots]
    except CheckError as error:
        return Grown((), 0, str(error))
    return grow(joint, priced, lists, float(value), limits)


@dataclass(frozen=True)
class _Node:
    """A node that is not looked at yet, and the dual values of the one above."""

    place: tuple[bool, ...]
    """The sides of the branches, in whose order leaves stand."""
    branches: tuple[Branch, ...]
    allowed: Allowed
    duals: PricingRound | None = None
    size: int = 0
    """Bytes that it takes as a leaf with these dual values."""

    def leaf(self, duals: PricingRound) -> LatencyLeaf:
        """It as a leaf."""
        return LatencyLeaf(branches=self.branches, duals=duals)


def grow(
    joint: Joint, priced: Priced, lists: list[RouteList], value: float, limits: Limits
) -> Grown:
    """Look for a tree whose leaves all hold no better plan, the node of the least bound first.

    Where a limit comes first, what is open becomes leaves: they prove what the nodes above do.
    """
    program = _Program(joint, priced, lists, value)
    everything = tuple(np.ones(len(routes.option), dtype=bool) for routes in lists)
    waiting: list[tuple[int, int, _Node]] = [(0, 0, _Node((), (), everything))]
    leaves: dict[tuple[bool, ...], LatencyLeaf] = {}
    nodes = size = 0
    while waiting:
        if remark := limits.reached(size, nodes):
            break
        _, _, node = heapq.heappop(waiting)
        nodes += 1
        duals, shares = program.solve(node.allowed)
        leaf = node.leaf(duals)
        own = len(leaf.model_dump_json())
        size += own - node.size
        bound = leaf_bound(joint, priced, lists, node.allowed, leaf, "leaf")
        branch = None
        if bound is not None and bound <= priced.better:
            branch = program.branch(shares)
            if branch is None:
                remark = "routes that are as good in rounded times are left"
        if bound is None or branch is None:
            leaves[node.place] = leaf
            if remark:
                break
            continue
        size += own
        for high in (False, True):
            side = branch.model_copy(update={"high": high})
            allowed = _side(lists, node.allowed, side)
            below = _Node((*node.place, high), (*node.branches, side), allowed, duals, own)
            heapq.heappush(waiting, (bound, 2 * nodes + high, below))
    if remark:
        leaves |= _left([node for _, _, node in waiting])
    return Grown(tuple(leaves[place] for place in sorted(leaves)), nodes, remark)


def _side(lists: list[RouteList], allowed: Allowed, side: Branch) -> Allowed:
    """Those of the routes that are on a side of a branch."""
    task = (side.victim, tuple(sorted(side.kinds)))
    return tuple(
        own & sides(routes, task, side.robot, side.until, side.high)
        for own, routes in zip(allowed, lists, strict=True)
    )


def _left(nodes: list[_Node]) -> dict[tuple[bool, ...], LatencyLeaf]:
    """Open nodes as leaves; where both sides of a branch are open, the node above is one."""
    places = {node.place for node in nodes}
    found = {}
    for node in nodes:
        if node.duals is None:
            continue
        if (*node.place[:-1], not node.place[-1]) in places:
            above = replace(node, branches=node.branches[:-1])
            found[node.place[:-1]] = above.leaf(node.duals)
        else:
            found[node.place] = node.leaf(node.duals)
    return found


class _Program:
    """The linear program over the lists: one route for each robot, every task served."""

    def __init__(self, joint: Joint, priced: Priced, lists: list[RouteList], value: float) -> None:
        self.joint, self.lists = joint, lists
        self.tasks: list[Task] = [task for own in priced.tasks.values() for task in own]
        self.split = {v for v, own in priced.tasks.items() if len(own) > 1}
        steps = [float(routes.network.step) for routes in lists]
        self.when = [[routes.when(task) for routes in lists] for task in self.tasks]
        """By task and robot the step of each route at which it is done, -1 if not."""
        self.times: list[list[Floats]] = [
            [np.where(n >= 0, n * step, -1.0) for n, step in zip(own, steps, strict=True)]
            for own in self.when
        ]
        self.breakpoints = {v: self._chosen(v) for v in self.split}
        self.first_link: dict[Task, int] = {}
        self.highs: Any = quiet_highs()
        self._build(value)

    def _chosen(self, victim: int) -> Floats:
        times = np.unique(
            np.concatenate(
                [
                    part[part >= 0]
                    for task, own in zip(self.tasks, self.times, strict=True)
                    if task[0] == victim
                    for part in own
                ]
            )
        )
        if len(times) > BREAKPOINTS:
            times = times[np.linspace(0, len(times) - 1, BREAKPOINTS).round().astype(int)]
        return np.unique([0.0, *times[:-1]])

    def _build(self, value: float) -> None:
        n_tasks = len(self.tasks)
        lower = [1.0] * (n_tasks + len(self.lists))
        upper = [np.inf] * n_tasks + [1.0] * len(self.lists)
        for task in self.tasks:
            if task[0] in self.split:
                self.first_link[task] = len(lower)
                n = len(self.breakpoints[task[0]])
                lower += [0.0] * n
                upper += [np.inf] * n
        none = np.empty(0, dtype=np.int32)
        self.highs.addRows(
            len(lower), np.array(lower), np.array(upper), 0,
            np.zeros(len(lower), np.int32), none, np.empty(0),
        )  # fmt: skip
        columns = [(ARTIFICIAL * value, {g: 1.0}) for g in range(n_tasks)]
        for victim in sorted(self.split):
            own = [task for task in self.tasks if task[0] == victim]
            priority = float(self.joint.priority[victim])
            columns += [
                (priority, {self.first_link[task] + j: 1.0 for task in own})
                for j in range(len(self.breakpoints[victim]))
            ]
        self.first_route = len(columns)
        for r, routes in enumerate(self.lists):
            columns += self._routes(r, len(routes.option))
        starts = np.cumsum([0, *(len(entries) for _, entries in columns)])
        self.highs.addCols(
            len(columns), np.array([cost for cost, _ in columns]), np.zeros(len(columns)),
            np.full(len(columns), np.inf), int(starts[-1]), starts[:-1].astype(np.int32),
            np.array([i for _, entries in columns for i in entries], dtype=np.int32),
            np.array([a for _, entries in columns for a in entries.values()]),
        )  # fmt: skip

    def _routes(self, r: int, many: int) -> list[tuple[float, dict[int, float]]]:
        columns: list[tuple[float, dict[int, float]]] = [
            (0.0, {len(self.tasks) + r: 1.0}) for _ in range(many)
        ]
        for g, task in enumerate(self.tasks):
            done: Floats = self.times[g][r]
            for p in np.flatnonzero(done >= 0).tolist():
                cost, entries = columns[p]
                entries[g] = 1.0
                if task[0] in self.split:
                    passed = time_in_intervals(self.breakpoints[task[0]], done[p : p + 1])[0]
                    for j in np.flatnonzero(passed > 0).tolist():
                        entries[self.first_link[task] + j] = -float(passed[j])
                else:
                    cost += float(self.joint.priority[task[0]]) * float(done[p])
                columns[p] = cost, entries
        return columns

    def solve(self, allowed: Allowed) -> tuple[PricingRound, list[Floats]]:
        """Dual values, and each robot's shares of its routes."""
        upper = np.where(np.concatenate(allowed), np.inf, 0.0)
        index = np.arange(self.first_route, self.first_route + len(upper), dtype=np.int32)
        self.highs.changeColsBounds(len(upper), index, np.zeros(len(upper)), upper)
        self.highs.run()
        solution = self.highs.getSolution()
        x = np.array(solution.col_value)[self.first_route :]
        ends = np.cumsum([len(routes.option) for routes in self.lists])[:-1]
        return self._duals(np.array(solution.row_dual)), np.split(x, ends)

    def _duals(self, dual: Floats) -> PricingRound:
        density: dict[Task, list[float]] = {}
        for victim in {task[0] for task in self.tasks}:
            own = [task for task in self.tasks if task[0] == victim]
            priority = float(self.joint.priority[victim])
            if victim not in self.split:
                density[own[0]] = [priority]
                continue
            n = len(self.breakpoints[victim])
            raw = np.array([dual[self.first_link[t] : self.first_link[t] + n] for t in own])
            raw = np.maximum(raw, 0.0)
            total = raw.sum(axis=0)
            scaled = raw * np.divide(priority, total, out=np.zeros(n), where=total > TINY)
            even = np.full_like(raw, priority / len(own))
            for task, mu in zip(own, np.where(total > TINY, scaled, even), strict=True):
                density[task] = [rounded_down(x, priority) for x in mu.tolist()]
        return PricingRound(
            tasks=tuple(
                TaskDuals(
                    victim=task[0], kinds=task[1], densities=tuple(density[task]),
                    dual=float(f"{max(dual[g], 0.0):.{_DIGITS}g}"),
                )
                for g, task in enumerate(self.tasks)
            ),
            breakpoints=tuple(
                Breakpoints(victim=v, times=tuple(own[1:].tolist()))
                for v, own in self.breakpoints.items()
                if len(own) > 1
            ),
        )  # fmt: skip

    def branch(self, shares: list[Floats]) -> Branch | None:
        """What the shares are undecided about: who serves a task, or when."""
        best, maximum = None, 1e-6
        for g, (victim, kinds) in enumerate(self.tasks):
            for r, routes in enumerate(self.lists):
                share = float(shares[r][self.when[g][r] >= 0].sum())
                if min(share, 1 - share) > maximum:
                    maximum = min(share, 1 - share)
                    best = Branch(
                        victim=victim, kinds=kinds, robot=routes.network.robot, high=False
                    )
        if best is not None:
            return best
        maximum = 1e-6
        for g, (victim, kinds) in enumerate(self.tasks):
            at: dict[float, float] = defaultdict(float)
            for r, own in enumerate(shares):
                there = (self.when[g][r] >= 0) & (own > TINY)
                for time, part in zip(
                    self.times[g][r][there].tolist(), own[there].tolist(), strict=True
                ):
                    at[time] += part
            total = sum(at.values())
            if len(at) < 2 or not total:
                continue
            mean = sum(time * part for time, part in at.items()) / total
            spread = sum(abs(time - mean) * part for time, part in at.items()) / total
            if spread * float(self.joint.priority[victim] or 1) > maximum:
                maximum = spread * float(self.joint.priority[victim] or 1)
                best = Branch(victim=victim, kinds=kinds, until=mean, high=False)
        return best
