"""What reading a cvxpy problem gives: numbers for any values of its parameters, and raw names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import count
from typing import NamedTuple

import cvxpy as cp
from scipy.sparse import csr_array

from ...arrays import Bools, Floats
from ..program import Block

AUXILIARY = "auxiliary"
"""Name of columns and rows that cvxpy adds, for instance for a maximum in the objective."""
UNLABELLED = "constraint {}"
"""Name of the rows of a constraint without a label, by its place among the problem's, from 1."""


class Numbers(NamedTuple):
    """Costs, rows and bounds at some values of the parameters, in the problem's own sense.

    Rows are ``matrix @ x = right`` for the first `Canonical.n_equations`, ``≤ right`` for the others.
    """

    cost: Floats
    offset: float
    matrix: csr_array
    right: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, eq=False)
class Canonical:
    """A problem restated in arrays."""

    numbers: Callable[[], Numbers]
    """The numbers at the present values of the problem's parameters."""
    n_equations: int
    integer: Bools
    columns: tuple[Block, ...]
    rows: tuple[Block, ...]


def variable_blocks(
    variables: list[cp.Variable], starts: list[int], own: dict[int, cp.Variable]
) -> tuple[Block, ...]:
    """The columns, by the names of those that the problem has of its own."""
    blocks: list[Block] = []
    for variable, start in zip(variables, starts, strict=True):
        label = own[variable.id].name() if variable.id in own else AUXILIARY
        blocks.append(Block(_free(label, blocks), start, variable.shape))
    return tuple(sorted(blocks, key=lambda block: block.start))


def constraint_blocks(problem: cp.Problem, constraints: list[cp.Constraint]) -> tuple[Block, ...]:
    """The rows of `constraints`, by the labels or places of those that the problem has of its own."""
    own = {constraint.id: constraint for constraint in problem.constraints}
    place = {constraint.id: i + 1 for i, constraint in enumerate(problem.constraints)}
    blocks: list[Block] = []
    start = 0
    for constraint in constraints:
        original = own.get(constraint.id)
        if original is None:
            block = Block(_free(AUXILIARY, blocks), start, (constraint.size,))
        elif original.label is None:
            block = Block(UNLABELLED.format(place[original.id]), start, original.shape)
        else:
            block = Block(original.label, start, original.shape)
        blocks.append(block)
        start += constraint.size
    return tuple(blocks)


def _free(name: str, blocks: list[Block]) -> str:
    """`name`, with a number where a block has it already."""
    taken = {block.name for block in blocks}
    numbered = (f"{name}_{number}" for number in count(2))
    return name if name not in taken else next(n for n in numbered if n not in taken)


def place_of(problem: cp.Problem, constraint: cp.Constraint) -> str:
    """A constraint by its label, or by its place in the problem."""
    if constraint.label is not None:
        return f"constraint '{constraint.label}'"
    return f"constraint {[item.id for item in problem.constraints].index(constraint.id) + 1}"
