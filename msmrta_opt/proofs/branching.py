"""Branch and bound for a proof: a tree whose leaves are all derived in exact numbers.

The node with the lowest bound is next, but of two children one is looked at at once. Branching variables
are chosen by pseudo-costs, and by solving both children for a few iterations while these are not
reliable (Achterberg, Koch and Martin 2005, *Branching rules revisited*): the fewer leaves, the smaller
the proof. A node is a leaf as soon as its bound is derived to reach the target, or its contradiction;
what floating-point numbers say of it only decides what is tried.
"""

from __future__ import annotations

import heapq
import math
import time
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import count
from typing import Any

import numpy as np

from ..arrays import Bools, Floats
from .basis import exact_duals
from .derivation import Box, Combination, Leaf, Side, Spool
from .exact import ExactProgram
from .multipliers import Bounds
from .pseudo_costs import PseudoCosts, product
from .relaxation import Relaxation, Relaxed
from .tree import FOUND, Limits, Node, leaves

CANDIDATES = 24
"""Columns that are tried at a node at most; so many in a row without a better one end the trials."""
IN_VAIN = 6
TRIAL_ITERATIONS = 60
FRACTIONAL = 1e-7
"""Distance from an integer beyond which a value asks for branching."""


class Search:
    """The search for a proof of `target`, in the sense of the minimisation.

    Parameters
    ----------
    program, relaxation, bounds, box
        The program, its live relaxation, how its bounds are derived, and its columns' bounds.
    spool : Spool
        Where derivations are put down.
    found : callable
        Told of each point whose integers are whole, with its value by the relaxation; returns the new
        target if the point is feasible and below the target, else ``None``.
    first : callable, optional
        Told of a relaxation's solution, which columns to branch on before others: sets of them, as bool
        arrays of shape ``(n_columns,)``, the first of which that has a fractional one is taken.
    """

    def __init__(
        self,
        program: ExactProgram,
        relaxation: Relaxation,
        bounds: Bounds,
        box: Box,
        spool: Spool,
        target: Fraction | None,
        found: Callable[[Floats], Fraction | None],
        first: Callable[[Relaxed], Sequence[Bools]] | None = None,
    ) -> None:
        self.program = program
        self.relaxation = relaxation
        self.bounds = bounds
        self.box = box
        self.spool = spool
        self.target = target
        self.root = Node()
        self.n_nodes = 0
        self._found = found
        self._root_leaf: Leaf | None = None
        self._integers = np.flatnonzero(program.integer)
        self._first = first
        self._pseudo = PseudoCosts()
        self._open: list[tuple[float, int, Node]] = []
        self._order = count()
        self._at: list[Node] = [self.root]
        self._undo: list[tuple[int, bool, Side | None]] = []
        self.unproved: list[Node] = []
        """Leaves whose bound is below the target, because numbers failed."""

    def run(self, limits: Limits, *, any_point: bool = False) -> str:
        """Search until all is proved or a limit is reached; says which, or nothing.

        With `any_point` it stops as soon as a feasible point is found.
        """
        if self._leaf(self.root, self.bounds.evident(self.box)):
            return ""
        self._push(self.root)
        while self._open:
            if stopped := limits.reached(self.spool.size, self.n_nodes):
                return stopped
            node: Node | None = heapq.heappop(self._open)[2]
            while node is not None:
                node = self._visit(node, limits)
                if any_point and self.target is not None:
                    return FOUND
                if node is not None and limits.reached(self.spool.size, self.n_nodes):
                    self._push(node)
                    node = None
        return ""

    def reset(self) -> None:
        """Go back to the root."""
        self._move_to(self.root)

    def open_nodes(self) -> list[Node]:
        """The nodes that are neither leaves nor branched."""
        return [node for _, _, node in sorted(self._open, key=lambda item: item[:2])]

    def shallowest(self, value: float) -> list[Node]:
        """Cut the tree off where relaxations are worth `value` or more; the nodes that are to be closed.

        Nodes that are leaves by a derivation stay so, except those of `unproved`.
        """
        for node in self.unproved:
            node.leaf = None
        self.unproved, self._open = [], []
        found: list[Node] = []
        waiting = [self.root]
        while waiting:
            node = waiting.pop()
            if node.leaf is not None:
                continue
            if node.low is None or node.high is None or node.estimate >= value:
                if node.basis is None and node.low is not None:
                    node.basis = node.low.basis
                node.low = node.high = None
                found.append(node)
            else:
                waiting += [node.high, node.low]
        return found

    def bound(self) -> float:
        """What the relaxations of the nodes prove that are neither leaves nor branched."""
        open_nodes = [node for node in leaves(self.root) if node.leaf is None]
        return min((node.estimate for node in [*self.unproved, *open_nodes]), default=math.inf)

    def close(self, node: Node, limits: Limits) -> bool:
        """Make an open node a leaf with the bound that its relaxation proves; whether that worked."""
        relaxed = self._solve(node, limits)
        if relaxed.status == "infeasible" and relaxed.duals is not None:
            return self._leaf(node, self.bounds.contradiction(relaxed.duals, self.box))
        if relaxed.duals is None:
            return False
        return self._leaf(node, self._derived(relaxed.duals, None))

    def root_alone(self) -> Node | None:
        """The root as a leaf; ``None`` if no bound could be derived there."""
        return Node(leaf=self._root_leaf) if self._root_leaf is not None else None

    def _push(self, node: Node) -> None:
        heapq.heappush(self._open, (node.estimate, next(self._order), node))

    def _solve(self, node: Node, limits: Limits) -> Relaxed:
        self._move_to(node)
        left = None
        if limits.deadline < math.inf:
            left = limits.deadline - time.perf_counter()
        return self.relaxation.solve(time_limit=left)

    def _visit(self, node: Node, limits: Limits) -> Node | None:
        """Make `node` a leaf or branch on it; the child to go on with, if there is one."""
        relaxed = self._solve(node, limits)
        if relaxed.status == "unknown" and limits.reached(self.spool.size, self.n_nodes):
            self._push(node)
            return None
        self.n_nodes += 1
        if relaxed.status == "unknown":
            self.relaxation.forget_basis()
            relaxed = self._solve(node, limits)
        if relaxed.status == "infeasible" and relaxed.duals is not None:
            if self._leaf(node, self.bounds.contradiction(relaxed.duals, self.box)):
                return None
        elif relaxed.status == "optimal":
            assert relaxed.duals is not None
            self._learn(node, relaxed.value)
            node.estimate = max(relaxed.value, node.estimate)
            if self._reaches(node, relaxed):
                return None
            if node is self.root:
                found = self._derived(relaxed.duals, None)
                self._root_leaf = None if found is None else self.spool.put(found)
        return self._branch(node, relaxed)

    def _reaches(self, node: Node, relaxed: Relaxed) -> bool:
        """Whether `node` became a leaf whose bound reaches the target."""
        if self.target is None or relaxed.duals is None:
            return False
        target = float(self.target)
        if relaxed.value < target - 1e-6 * max(abs(target), abs(relaxed.value)):
            return False
        return self._leaf(node, self._derived(relaxed.duals, self.target))

    def _derived(self, duals: Floats, target: Fraction | None) -> Combination | None:
        """A derivation from rounded duals, or from exact ones of the basis at hand."""
        found = self.bounds.derive(duals, self.box, target)
        if found is None:
            exact = exact_duals(self.program, self.bounds.rows, self.relaxation)
            found = None if exact is None else self.bounds.exactly(exact, self.box)
            if target is not None and found is not None and found.value is not None:
                found = found if found.value >= target else None
        return found

    def _leaf(self, node: Node, found: Combination | None) -> bool:
        if found is None:
            return False
        node.leaf, node.basis = self.spool.put(found), None
        return True

    def _learn(self, node: Node, value: float) -> None:
        parent = node.parent
        if parent is not None and math.isfinite(parent.estimate):
            gain = max(value - parent.estimate, 0.0)
            distance = 1 - parent.fraction if node.is_high else parent.fraction
            self._pseudo.learn(parent.column, node.is_high, gain, distance)

    # Branching.

    def _branch(self, node: Node, relaxed: Relaxed) -> Node | None:
        column, split = -1, 0
        if relaxed.x is not None:
            values = relaxed.x[self._integers]
            far = np.abs(values - np.round(values))
            fractional = self._integers[far > FRACTIONAL]
            if len(fractional):
                sets = [] if self._first is None else self._first(relaxed)
                preferred = (fractional[some[fractional]] for some in sets)
                some = next((some for some in preferred if len(some)), fractional)
                column, split = self._chosen(some, relaxed)
            else:
                target = self._found(relaxed.x)
                relaxed = self.relaxation.solve()
                if target is not None:
                    self.target = target
                    if self._reaches(node, relaxed):
                        return None
        if column < 0:
            column, split = self._any_column(relaxed)
        if column < 0:
            self._settle(node, relaxed)
            return None
        node.column, node.split = column, split
        if relaxed.x is not None:
            node.fraction = min(max(float(relaxed.x[column]) - split, 0.0), 1.0)
        node.basis = self.relaxation.basis()
        children = [Node(node, is_high, node.estimate, node.basis) for is_high in (False, True)]
        node.low, node.high = children
        node.basis = None
        first = node.fraction > 0.5  # the one that is nearer to the relaxation's point
        self._push(children[not first])
        return children[first]

    def _any_column(self, relaxed: Relaxed) -> tuple[int, int]:
        """An integer column that is not fixed yet, where no value asks for branching."""
        best, maximum = (-1, 0), -1.0
        for j in self._integers.tolist():
            low, high = self.box.lower[j], self.box.upper[j]
            if low is not None and high is not None and low.bound >= high.bound:
                continue
            value = 0.0 if relaxed.x is None else float(relaxed.x[j])
            far = abs(value - round(value))
            if far > maximum:
                split = round(value)
                if high is not None and split >= high.bound:
                    split = math.ceil(high.bound) - 1
                if low is not None:
                    split = max(split, math.floor(low.bound))
                best, maximum = (j, split), far
        return best

    def _settle(self, node: Node, relaxed: Relaxed) -> None:
        """Make a node that cannot be branched on a leaf with the best bound that can be derived."""
        found = None
        if relaxed.status == "infeasible" and relaxed.duals is not None:
            found = self.bounds.contradiction(relaxed.duals, self.box)
        elif relaxed.duals is not None:
            found = self._derived(relaxed.duals, None)
        self._leaf(node, found)
        self.unproved.append(node)

    def _chosen(self, fractional: np.ndarray, relaxed: Relaxed) -> tuple[int, int]:
        """The column to branch on, and the integer below its value."""
        assert relaxed.x is not None
        ranked = sorted(
            ((j, relaxed.x[j] - math.floor(relaxed.x[j])) for j in fractional.tolist()),
            key=lambda item: (-self._pseudo.score(*item), abs(item[1] - 0.5), item[0]),
        )
        basis, tried, in_vain = None, 0, 0
        best, maximum = ranked[0][0], -1.0
        for column, fraction in ranked:
            score = self._pseudo.score(column, fraction)
            if not self._pseudo.reliable(column):
                if tried >= CANDIDATES or in_vain >= IN_VAIN:
                    continue
                basis = basis or self.relaxation.basis()
                score = self._tried(column, fraction, relaxed, basis)
                tried += 1
            if score > maximum * (1 + 1e-9):
                best, maximum, in_vain = column, score, 0
            else:
                in_vain += 1
        if basis is not None:
            self.relaxation.start_from(basis)
        return best, math.floor(relaxed.x[best])

    def _tried(self, column: int, fraction: float, relaxed: Relaxed, basis: Any) -> float:
        """The score of branching on `column`, by a few iterations on either side."""
        assert relaxed.x is not None
        low, high = self.relaxation.bounds[column]
        below = math.floor(relaxed.x[column])
        room = math.inf if self.target is None else max(float(self.target) - relaxed.value, 0.0)
        if not math.isfinite(room):
            room = 1e6 * max(1.0, abs(relaxed.value))
        gains = []
        for up, distance in ((False, fraction), (True, 1 - fraction)):
            if up:
                self.relaxation.set_bounds(column, below + 1, high)
            else:
                self.relaxation.set_bounds(column, low, below)
            result = self.relaxation.solve(iterations=TRIAL_ITERATIONS)
            gain = room
            if result.status != "infeasible":
                gain = (
                    max(result.value - relaxed.value, 0.0) if result.value == result.value else 0.0
                )
                self._pseudo.learn(column, up, gain, distance)
            gains.append(min(gain, room))
            self.relaxation.set_bounds(column, low, high)
            self.relaxation.start_from(basis)
        return product(*gains)

    # Where the relaxation stands.

    def _move_to(self, node: Node) -> None:
        """Set the bounds of the box and of the relaxation to those of `node`."""
        path = node.path()
        shared = 0
        while shared < min(len(path), len(self._at)) and path[shared] is self._at[shared]:
            shared += 1
        while len(self._at) > shared:
            self._at.pop()
            column, is_high, before = self._undo.pop()
            (self.box.lower if is_high else self.box.upper)[column] = before
            self._pass_on(column)
        jump = len(path) - shared > 1 or node.parent is not self._at[-1]
        for depth, step in enumerate(path[shared:], shared):
            parent = path[depth - 1]
            sides = self.box.lower if step.is_high else self.box.upper
            self._undo.append((parent.column, step.is_high, sides[parent.column]))
            sides[parent.column] = Side(parent.split + step.is_high, -depth)
            self._at.append(step)
            self._pass_on(parent.column)
        if jump and node.basis is not None:
            self.relaxation.start_from(node.basis)

    def _pass_on(self, column: int) -> None:
        self.relaxation.set_bounds(column, *self.box.bounds(column))
