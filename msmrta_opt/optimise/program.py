"""A linear integer program as arrays: what solvers, checks, proofs and exports work on."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from operator import attrgetter
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import Bools, Floats

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from .axes import Id, Ids

BRACES = re.compile(r"\{([^{}]*)\}")
TIGHTENED_FROM = 1e4
"""Size of a coefficient from which it is looked at as a big M."""
ROUNDING = 1e-12
"""How far a row may be missed by the rounding of its own decimals, relative to its terms."""
SMALLEST, LARGEST = 1e-9, 1e15
"""Coefficients of rows lie between these, exclusive: solvers drop the others or refuse them."""
INFINITE = 1e20
"""Costs, sides of rows and bounds of this size are infinite to solvers, and to all readers but GLPK."""
Sense = Literal["min", "max"]


@dataclass(frozen=True)
class Block:
    """A named array of consecutive columns or rows, in column-major (Fortran) order."""

    name: str
    """A variable's name, or a constraint's label with its axes in braces."""
    start: int
    shape: tuple[int, ...]
    letters: tuple[str, ...] = ()
    """The axis of each dimension, empty where none is known."""
    nouns: tuple[str, ...] = ()
    """What stands along each dimension in a word, for instance ``victim``."""
    ids: tuple[Ids, ...] = ()
    """The ids along each dimension; positions where none are given."""

    @cached_property
    def size(self) -> int:
        """Number of columns or rows."""
        return math.prod(self.shape)

    @property
    def stop(self) -> int:
        """One past the last column or row."""
        return self.start + self.size

    def index(self, position: int) -> tuple[Id, ...]:
        """The ids of a column or row of this block, by its position in the program."""
        rest, places = position - self.start, []
        for length in self.shape:
            rest, place = divmod(rest, length)
            places.append(place)
        if self.ids:
            return tuple(ids[i] for ids, i in zip(self.ids, places, strict=True))
        return tuple(places)

    def element(self, position: int) -> str:
        """Its readable name: ``x[7,104]``, or the label with its braces filled.

        Braces take the ids of the axes that they name; in a block whose axes are not known, the
        dimensions in their order. What no brace names follows behind.
        """
        index = self.index(position)
        return "".join([x if isinstance(x, str) else str(index[x]) for x in self._name])

    @property
    def words(self) -> str:
        """The name for all of its elements: ``each robot has at most one victim``."""
        nouns = dict(zip(self.letters, self.nouns, strict=False))

        def each(found: re.Match[str]) -> str:
            before, letter = found.group(1) or "", found.group(2)
            noun = nouns.get(letter) or before.strip() or letter
            return f"{'' if before.strip() == noun else before}each {noun}"

        return re.sub(r"(\b\w+ )?\{([^{}]*)\}", each, self.name)

    @cached_property
    def _name(self) -> tuple[str | int, ...]:
        """The name in parts: words, and the dimensions whose ids stand between them."""
        pieces = BRACES.split(self.name)  # words, a brace, words, …
        braces = pieces[1::2]
        letters = self.letters or tuple(dict.fromkeys(braces))
        known = {x: d for d, x in enumerate(letters[: len(self.shape)]) if x}
        parts: list[str | int] = [
            known.get(piece, f"{{{piece}}}") if number % 2 else piece
            for number, piece in enumerate(pieces)
        ]
        rest = [
            d
            for d, n in enumerate(self.shape)
            if not (d < len(letters) and letters[d] in braces) and (n > 1 or not braces)
        ]
        for number, d in enumerate(rest):
            parts += ["," if number else "[", d]
        return (*parts, "]") if rest else tuple(parts)


def element_name(blocks: tuple[Block, ...], position: int) -> str:
    """The readable name of a column or row among `blocks`, which are in order."""
    if not blocks:
        return f"[{position}]"
    block = blocks[max(bisect_right(blocks, position, key=attrgetter("start")) - 1, 0)]
    if not block.start <= position < block.stop:
        raise IndexError(position)
    return block.element(position)


@dataclass(frozen=True, eq=False)
class Program:
    """A linear program in arrays, some of its variables integer.

    ``min`` or ``max`` of ``cost @ x + offset`` over ``row_lower ≤ matrix @ x ≤ row_upper`` and
    ``lower ≤ x ≤ upper``, with ``x`` of shape ``(n_columns,)``, the rows of ``(n_rows,)``.
    Costs, values and bounds are in the program's own sense, offset included.
    """

    sense: Sense
    cost: Floats
    offset: float
    matrix: csr_array
    row_lower: Floats
    row_upper: Floats
    lower: Floats
    upper: Floats
    integer: Bools
    columns: tuple[Block, ...] = field(default=(), repr=False)
    rows: tuple[Block, ...] = field(default=(), repr=False)

    @property
    def n_columns(self) -> int:
        """Number of variables."""
        return len(self.cost)

    @property
    def n_rows(self) -> int:
        """Number of rows; bounds on variables are not rows."""
        return len(self.row_lower)

    @property
    def sign(self) -> float:
        """1 for a minimisation, -1 for a maximisation."""
        return 1.0 if self.sense == "min" else -1.0

    @cached_property
    def varying(self) -> Floats:
        """The costs of the columns that can vary, 0 for the fixed ones."""
        return np.where(self.lower == self.upper, 0.0, self.cost)

    @cached_property
    def constant(self) -> float:
        """The constant of the objective and what fixed columns cost: no part of any gap."""
        fixed = np.flatnonzero((self.lower == self.upper) & (self.cost != 0))
        return float(self.cost[fixed] @ self.lower[fixed]) + self.offset

    def value(self, x: Floats) -> float:
        """The objective at `x`, shape ``(n_columns,)``."""
        return float(self.cost @ x) + self.offset

    def with_whole_bounds(self) -> Program:
        """The same program, bounds of integer columns moved to the integers that they admit.

        Solvers are not to be relied on for this: HiGHS' presolve is known to go wrong without it.
        """
        if all((side == np.rint(side))[self.integer].all() for side in (self.lower, self.upper)):
            return self
        lower = np.where(self.integer, np.ceil(self.lower - 1e-9), self.lower)
        upper = np.where(self.integer, np.floor(self.upper + 1e-9), self.upper)
        return replace(self, lower=lower, upper=upper)

    def with_tight_coefficients(self) -> Program:
        """The same program, big-Ms that are needlessly large replaced by what they have to be.

        A row ``others + a z ≤ b`` with an integer z says nothing where z is not at the end of its bounds
        that makes it tight, if the others cannot reach that far; a is then reduced by how far they
        miss it (Savelsbergh 1994), with the same integer points. Only coefficients that become a
        thousandth of themselves or less are touched: those that a tolerance could slip through.
        The side of a row of decimals keeps the rounding that it had, relative to the larger terms.
        """
        matrix = self.matrix
        size = np.abs(matrix.data)
        if not size.size or size.max() < TIGHTENED_FROM:
            return self
        data, lower, upper = matrix.data.copy(), self.row_lower.copy(), self.row_upper.copy()
        for row in {
            int(np.searchsorted(matrix.indptr, k, "right")) - 1
            for k in np.flatnonzero(size >= TIGHTENED_FROM)
        }:
            if np.isfinite(lower[row]) == np.isfinite(upper[row]):
                continue
            self._tighten(row, data, lower, upper)
        if np.array_equal(data, matrix.data):
            return self
        tight = matrix.copy()
        tight.data = data
        return replace(self, matrix=tight, row_lower=lower, row_upper=upper)

    def _tighten(self, row: int, data: Floats, lower: Floats, upper: Floats) -> None:
        """Tighten the coefficients of a row that has one side, in `data` and in that side."""
        sides, sign = (upper, 1.0) if np.isfinite(upper[row]) else (lower, -1.0)
        entries = slice(self.matrix.indptr[row], self.matrix.indptr[row + 1])
        columns = self.matrix.indices[entries]
        highest, lowest = self.upper[columns], self.lower[columns]
        weight = sign * data[entries]
        is_whole = self.integer[columns].all() and not np.mod([*weight, sides[row]], 1).any()
        rounding = Fraction(0 if is_whole else ROUNDING)
        k = 0
        while (k := self._next_loose(weight, highest, lowest, columns, sign * sides[row], k)) >= 0:
            ends = np.where(weight > 0, highest, lowest)
            others = (columns != columns[k]) & (weight != 0)
            reach = sum(
                (
                    Fraction(float(w)) * Fraction(float(end))
                    for w, end in zip(weight[others], ends[others], strict=True)
                ),
                Fraction(0),
            )
            a, far = Fraction(float(weight[k])), Fraction(float(ends[k]))
            side = Fraction(float(sign * sides[row]))
            spare = side - reach - a * (far - (1 if a > 0 else -1))
            new = a - spare if a > 0 else a + spare
            if spare > 0 and (new < 0) != (a > 0) and abs(new) * 1000 <= abs(a):
                side += (new - a) * far + rounding * max(abs(side), abs(a * far))
                weight[k] = float(new)
                sides[row] = sign * float(side)
            k += 1
        data[entries] = sign * weight

    def _next_loose(
        self,
        weight: Floats,
        highest: Floats,
        lowest: Floats,
        columns: NDArray[np.integer],
        side: float,
        k: int,
    ) -> int:
        """The first entry from the `k`-th on that rounded arithmetic takes for too large, or -1."""
        ends = np.where(weight > 0, highest, lowest)
        if not np.isfinite(ends[weight != 0]).all():
            return -1
        with np.errstate(over="ignore", invalid="ignore"):
            parts = np.where(weight != 0, weight * ends, 0.0)
            which, place = np.unique(columns, return_inverse=True)
            own = np.bincount(place, parts, len(which))[place]
            step = weight * (ends - np.where(weight > 0, 1.0, -1.0))
            spare = side - (parts.sum() - own) - step
            rounding = 1e-9 * (np.abs(parts).sum() + abs(side) + np.abs(step))
            clear = np.abs(spare - np.abs(weight)) > 0.002 * np.abs(weight) + rounding
        found = np.flatnonzero((~clear & (weight != 0) & self.integer[columns])[k:])
        return k + int(found[0]) if len(found) else -1

    def differs_in_cost_alone(self, other: Program) -> bool:
        """Whether `other` has the same rows, bounds and integrality."""
        mine = (self.row_lower, self.row_upper, self.lower, self.upper, self.integer)
        theirs = (other.row_lower, other.row_upper, other.lower, other.upper, other.integer)
        arrays = zip(
            (*mine, self.matrix.indptr, self.matrix.indices, self.matrix.data),
            (*theirs, other.matrix.indptr, other.matrix.indices, other.matrix.data),
            strict=True,
        )
        return all(a is b or np.array_equal(a, b) for a, b in arrays)

    def relaxed(self) -> Program:
        """The same program without integrality."""
        return replace(self, integer=np.zeros(self.n_columns, dtype=bool))

    def at_integers(self, x: Floats) -> Program:
        """What is left of the program where its integer columns are as in `x`: the other columns."""
        rest = ~self.integer
        fixed = self.matrix @ np.where(rest, 0.0, x)
        return Program(
            sense=self.sense,
            cost=self.cost[rest],
            offset=self.offset + float(self.cost[self.integer] @ x[self.integer]),
            matrix=self.matrix[:, np.flatnonzero(rest)].tocsr(),
            row_lower=self.row_lower - fixed,
            row_upper=self.row_upper - fixed,
            lower=self.lower[rest],
            upper=self.upper[rest],
            integer=self.integer[rest],
        )

    def with_row(self, entries: Floats, lower: float, upper: float, name: str) -> Program:
        """The same program with one more row, ``lower ≤ entries @ x ≤ upper``."""
        from scipy.sparse import csr_array, vstack

        return replace(
            self,
            matrix=csr_array(vstack([self.matrix, csr_array(entries[None, :])])),
            row_lower=np.append(self.row_lower, lower),
            row_upper=np.append(self.row_upper, upper),
            rows=(*self.rows, Block(name, self.n_rows, ())),
        )

    def column_name(self, column: int) -> str:
        """For instance ``x[0,2]``."""
        return element_name(self.columns, column)

    @cached_property
    def column_names(self) -> tuple[str, ...]:
        """The names of all columns, in their order."""
        if not self.columns:
            return tuple(self.column_name(j) for j in range(self.n_columns))
        return tuple(b.element(j) for b in self.columns for j in range(b.start, b.stop))

    def row_name(self, row: int) -> str:
        """For instance ``cluster 2 has at most one robot``."""
        return element_name(self.rows, row)

    def shaped(self, x: Floats) -> dict[str, NDArray[np.float64]]:
        """The named variables of a point `x`, each in its own shape."""
        return {
            block.name: x[block.start : block.stop].reshape(block.shape, order="F")
            for block in self.columns
        }

    def flat(self, values: Mapping[str, NDArray[np.float64]]) -> Floats:
        """The point that `shaped` takes apart; columns that are not named are NaN."""
        x = np.full(self.n_columns, np.nan)
        for block in self.columns:
            if block.name in values:
                x[block.start : block.stop] = np.asarray(values[block.name], float).ravel("F")
        return x
