"""What can be proved of a program: an exactly feasible solution, a tree, and the bound that it gives."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ..arrays import Floats
from ..interruption import interruptible
from ..optimise.program import Program
from ..optimise.scaling import scaling
from ..optimise.solution import Solution
from .basis import exact_point
from .branching import Search
from .cutting_plane import strengthen
from .derivation import Lemmas, Spool
from .exact import ExactProgram, Numbers, Rational, Violation, exact_program
from .grid import Grid, grid_of
from .implied import implied_bounds
from .multipliers import Bounds
from .relaxation import Relaxation
from .tree import FOUND, INTERRUPTED, NODES, Limits, Node, leaves

TIGHT = 1e-9
"""Difference, relative to the objective without its constant, up to which bound and value agree."""
ROUNDING = 1e-9
"""Share of a row's terms by which a claimed solution may miss it in exact numbers, and no more is wrong
with it than rounding."""
INTEGRAL = 1e-5
"""Distance from an integer up to which a solver may call a value one."""
NODES_WITHOUT_CUTS = 50
"""Of a tree that is tried before cuts are looked for."""
CLOSING_SECONDS = 5.0
"""For making leaves of what a limit left open."""


@dataclass(frozen=True)
class Proved:
    """What a search has come to, in the sense of the minimisation."""

    root: Node | None
    """The tree; ``None`` if there is none whose leaves all have bounds."""
    infeasible: bool = False
    derived: Fraction | None = None
    """The bound that the tree derives."""
    bound: Fraction | None = None
    """What follows from it on the objective's grid."""
    grid: Grid | None = None
    """``None`` if nothing follows on it."""
    remark: str = ""
    """Why it is not more."""


class Prover:
    """One program being proved.

    Parameters
    ----------
    program : Program
        The arrays.
    claim : Solution
        What a solver says of it: where to begin, and what to look for.
    limits : Limits
        When to stop.
    numbers : str
        What floats stand for; see `exact_program`.
    """

    def __init__(self, program: Program, claim: Solution, limits: Limits, numbers: Numbers) -> None:
        self.claim = claim
        self.limits = limits
        self.numbers = numbers
        self.program: ExactProgram = exact_program(program, numbers)
        self.lemmas = Lemmas()
        self.box = implied_bounds(self.program, self.lemmas)
        self.relaxation = Relaxation(self.program, scaling(program))
        for j, integer in enumerate(self.program.integer):
            if integer:
                self.relaxation.set_bounds(j, *self.box.bounds(j))
        self.rows = list(self.program.rows)
        self.bounds = Bounds(self.program, self.rows)
        self.spool = Spool(self.program.sign)
        self.grid = grid_of(self.program, self.box)
        self.value: Fraction | None = None
        """Of the best solution that is feasible in exact numbers."""
        self.point: Sequence[Rational] | None = None
        self.violated: Violation | None = None
        """What the claimed solution violates in exact numbers."""
        self._target: Fraction | None = None
        if claim.values:
            x = np.concatenate([claim.values[block.name].ravel("F") for block in program.columns])
            if self._found(x) is None:
                self.violated = self.program.violated(self._read(x))
            if self.is_rounded and claim.objective is not None:
                self._target = self._below(Fraction(self.program.sign * claim.objective))
        self.search = self._new_search()

    @property
    def is_rounded(self) -> bool:
        """Whether the claimed solution is infeasible in exact numbers, but by rounding only."""
        return self.violated is not None and self.violated.relative <= ROUNDING

    # Solutions.

    def _found(self, x: Floats) -> Fraction | None:
        """The new target, if the point `x` of whole integers is exactly feasible and the best."""
        point = self._exactly(x)
        if point is None:
            return None
        value = self.program.value(point)
        if self.value is not None and value >= self.value:
            return None
        self.value, self.point = value, point
        on_grid = self.grid is not None
        self._target = self.grid.target(point) if on_grid and self.grid else self._below(value)
        return self._target

    def _below(self, value: Fraction) -> Fraction:
        """A bound that is as good as `value`."""
        size = max(abs(value - self.program.constant), self.program.largest_cost)
        return value - size * Fraction(TIGHT) / 2

    def _exactly(self, x: Floats) -> Sequence[Rational] | None:
        """`x` in exact numbers, if that is feasible, maybe with other values of continuous columns."""
        point = self._read(x)
        if not self.program.violated(point):
            return point
        if all(self.program.integer):
            return None
        better = self._at_a_basis(point)
        return None if better is None or self.program.violated(better) else better

    def _read(self, x: Floats) -> list[Rational]:
        """`x` as fractions, integers rounded where that is slight, and the constant's column."""
        point: list[Rational] = []
        for value, whole in zip(x.tolist(), self.program.integer, strict=False):
            near = round(value)
            is_near = value == near or (whole and abs(value - near) <= INTEGRAL)
            point.append(near if is_near else Fraction(value))
        return point + [1] * (self.program.n_columns - len(point))

    def _at_a_basis(self, point: list[Rational]) -> list[Rational] | None:
        """`point` with continuous columns from a basic solution, its integers kept."""
        before = list(self.relaxation.bounds)
        for j, whole in enumerate(self.program.integer):
            if whole:
                self.relaxation.set_bounds(j, point[j], point[j])
        found = exact_point(self.rows, self.relaxation)
        for j, (low, high) in enumerate(before):
            self.relaxation.set_bounds(j, low, high)
        return found

    # The search.

    def run(self) -> Proved:
        """Search until all is proved, or as far as the limits allow."""
        if self.claim.status == "unbounded":
            return Proved(None, remark="an unbounded program has no optimum to prove")
        with interruptible():
            try:
                remark = self._run()
            except KeyboardInterrupt:  # a second one
                remark = INTERRUPTED
            if remark:
                self._close()
        if not remark and self.search.unproved:
            remark = "floating-point relaxations are too coarse for it"
        elif not remark and self.value is None and self.violated is not None:
            remark = f"in exact numbers, {self.violated.what} by the claimed solution"
        root: Node | None = self.search.root
        if any(node.leaf is None for node in leaves(self.search.root)):
            root = self.search.root_alone()
        return self._proved(root, remark)

    def _run(self) -> str:
        """Search; why it stopped early, if it did."""
        if self.claim.status == "infeasible":
            self.relaxation.forget_cost()
            stopped = self._branch_and_cut(any_point=True)
            self.relaxation.restore_cost()
            if stopped != FOUND:
                return stopped
            self.search.reset()
            self.search = self._new_search()
        return self._branch_and_cut()

    def _branch_and_cut(self, *, any_point: bool = False) -> str:
        """A small tree; if that is not enough, cuts, and a tree of any size."""
        stopped = self.search.run(
            replace(self.limits, nodes=NODES_WITHOUT_CUTS), any_point=any_point
        )
        if stopped != NODES:
            return stopped
        self.search.reset()
        strengthen(
            self.program,
            self.relaxation,
            self.rows,
            self.box,
            self.lemmas,
            self._target,
            self.limits,
        )
        self.search = self._new_search()
        return self.search.run(self.limits, any_point=any_point)

    def _new_search(self) -> Search:
        return Search(
            self.program,
            self.relaxation,
            self.bounds,
            self.box,
            self.spool,
            self._target,
            self._found,
        )

    def _close(self) -> None:
        """Make leaves of open nodes, as long as that takes little time."""
        limits = Limits(time.perf_counter() + CLOSING_SECONDS)
        try:
            for node in self.search.open_nodes():
                if limits.reached(0) or not self.search.close(node, limits):
                    return
        except KeyboardInterrupt:
            return

    def _proved(self, root: Node | None, remark: str) -> Proved:
        if root is None:
            return Proved(None, remark=remark)
        bounds = [node.leaf.value for node in leaves(root) if node.leaf is not None]
        finite = [bound for bound in bounds if bound is not None]
        if not finite:
            return Proved(root, infeasible=True, remark=remark)
        minimum = min(finite)
        if self.value is not None and minimum >= self.value:
            return Proved(root, False, self.value, self.value, None, remark)
        if self.grid is None:
            size = abs(minimum - self.program.constant)
            derived = _short(minimum, minimum - size * Fraction(TIGHT) / 1024)
            return Proved(root, False, derived, derived, None, remark)
        below = self.grid.step * (self.grid.minimum(minimum) - 1) + self.grid.above
        derived = _short(minimum, below)
        return Proved(root, False, derived, self.grid.proved(derived), self.grid, remark)


def _short(bound: Fraction, floor: Fraction) -> Fraction:
    """A number of few digits above `floor`, and not above `bound`; `bound` if there is no room."""
    bits = 0
    while floor < bound:
        short = Fraction(math.floor(bound * (1 << bits)), 1 << bits)
        if short > floor:
            return short
        bits += 1
    return bound
