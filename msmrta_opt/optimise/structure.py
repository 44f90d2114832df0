"""What the matrix of a program proves about it, whatever the program is called.

An integer program whose rows are totally unimodular and whose bounds are integral is solved exactly
by its linear relaxation. Recognised here, from the matrix alone:

- *bipartite*: each column has at most two entries, all 1, in rows of two kinds that never meet
  within a kind (assignment, semi-assignment, transport), besides rows that hold every column (a
  cardinality): such rows and those of either kind form two laminar families (Edmonds 1970);
- *network*: entries ±1, at most two per column, and rows that can be split so that equal signs of
  a column fall on different sides and unequal ones on the same side (Heller and Tompkins 1956);
  the same of the transposed matrix;
- *interval*: the ones of each column (or of each row) stand in consecutive places (Fulkerson and
  Gross 1965), in the order in which the program has them.

Rows with a single entry are bounds, and columns fixed by their bounds are left out, before any of
this is asked.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import connected_components

from ..arrays import Bools, Floats, Ints
from .program import Program

Kind = Literal["bipartite", "network", "interval"]


@dataclass(frozen=True, eq=False)
class Structure:
    """A proof that a program's relaxation has only integral vertices.

    Parameters
    ----------
    kind : str
        Which of the module's patterns the rows follow.
    description : str
        The proof in a phrase, for people.
    core : Core
        The rows and columns that the proof is about.
    side : int array, shape (n_core_rows,), optional
        For *bipartite*: 0 and 1 for rows of the two kinds, 2 for rows with every column.
    pairs : int array, shape (n_pairs, 2), optional
        For *bipartite*: the row of either kind of each column that has both, in the order of columns.
    """

    kind: Kind
    description: str
    core: Core
    side: Ints | None = None
    pairs: Ints | None = None
    has_negative: bool = False
    """For *bipartite*: whether some row is written with the other sign."""


@dataclass(frozen=True, eq=False)
class Core:
    """A program without its single-entry rows and its fixed columns.

    ``rows`` and ``columns`` are positions in the program; bounds are those of the core.
    """

    rows: Ints
    columns: Ints
    row_lower: Floats
    row_upper: Floats
    lower: Floats
    upper: Floats
    fixed: Floats
    """Values of all the program's columns; those of the core are 0."""
    whole: csr_array
    """The program's matrix, without zeros."""

    @cached_property
    def matrix(self) -> csr_array:
        """The core's own."""
        inner = self.whole
        if len(self.columns) < inner.shape[1]:
            inner = inner[:, self.columns].tocsr()
        return inner[self.rows] if len(self.rows) < inner.shape[0] else inner


@dataclass(frozen=True, eq=False)
class _Sides:
    """How the rows of a matrix, of ±1, are *bipartite*."""

    side: Ints
    """0 and 1 for rows of the two kinds, 2 for rows with every column, ``(n_rows,)``."""
    pairs: Ints
    """The row of either kind of each column, -1 where it has not both, ``(n_columns, 2)``."""
    has_negative: bool


@dataclass(frozen=True, eq=False)
class Frame:
    """What a matrix says of every program with it, whatever the bounds are."""

    given: csr_array
    matrix: csr_array
    """The same without zeros."""
    entries: Ints
    """Number of entries of each row."""
    row: Ints
    """The row of each entry."""
    sides: _Sides | None
    """How its rows but for those of a single entry are bipartite, whichever columns are fixed."""

    @classmethod
    def of(cls, given: csr_array) -> Frame:
        """That of a matrix."""
        matrix = given
        if not given.data.all():
            matrix = given.copy()
            matrix.eliminate_zeros()
        entries = np.diff(matrix.indptr)
        several = np.flatnonzero(entries != 1)
        inner = matrix[several] if len(several) < len(entries) else matrix
        sides = None if np.any(np.abs(inner.data) != 1) else _sides(inner)
        if sides is not None and len(several) < len(entries):
            side = np.zeros(len(entries), np.int64)
            side[several] = sides.side
            pairs = np.append(several, -1)[sides.pairs]
            sides = _Sides(side, pairs, sides.has_negative)
        return cls(given, matrix, entries, np.repeat(np.arange(len(entries)), entries), sides)


def recognise(program: Program, frame: Frame | None = None) -> Structure | None:
    """The structure that proves `program` integral, or ``None`` if none is recognised.

    `frame` is that of its matrix, where it is known.
    """
    frame = frame or Frame.of(program.matrix)
    core = _core(program, frame)
    if core is None:
        return None
    ends = np.concatenate([core.row_lower, core.row_upper, core.lower, core.upper])
    finite = ends[np.isfinite(ends)]
    if np.any(finite != np.round(finite)):
        return None
    if frame.sides is not None:
        return _bipartite(core, frame.sides)
    if np.any(np.abs(core.matrix.data) != 1):
        return None
    own = _sides(core.matrix)
    if own is not None:
        pairs = own.pairs[(own.pairs >= 0).all(axis=1)]
        return _as_bipartite(core, own.side, pairs, own.has_negative)
    return _network(core) or _interval(core)


def _core(program: Program, frame: Frame) -> Core | None:
    """The program without single-entry rows and fixed columns; ``None`` if that shows a conflict."""
    matrix, entries = frame.matrix, frame.entries
    lower, upper = program.lower, program.upper
    single = np.flatnonzero(entries == 1)
    if single.size:
        lower, upper = lower.copy(), upper.copy()
        at = matrix.indptr[single]
        column, factor = matrix.indices[at], matrix.data[at]
        ends = np.stack([program.row_lower[single] / factor, program.row_upper[single] / factor])
        np.maximum.at(lower, column, ends.min(axis=0))
        np.minimum.at(upper, column, ends.max(axis=0))
    # An integer column reaches only the integers between its bounds.
    lower = np.where(program.integer, np.ceil(lower - 1e-9), lower)
    upper = np.where(program.integer, np.floor(upper + 1e-9), upper)
    if np.any(lower > upper):
        return None
    is_fixed = lower == upper
    fixed = np.where(is_fixed, lower, 0.0)
    columns = np.flatnonzero(~is_fixed)
    shift = matrix @ fixed if fixed.any() else np.zeros(len(entries))
    left = entries
    if is_fixed.any():
        left = np.bincount(frame.row[~is_fixed[matrix.indices]], minlength=len(entries))
    decided = left == 0
    missed = np.maximum(program.row_lower - shift, shift - program.row_upper)
    if np.any(missed[decided] > 1e-9):
        return None
    rows = np.flatnonzero((entries != 1) & ~decided)
    return Core(
        rows,
        columns,
        program.row_lower[rows] - shift[rows],
        program.row_upper[rows] - shift[rows],
        lower[columns],
        upper[columns],
        fixed,
        matrix,
    )


def _bipartite(core: Core, sides: _Sides) -> Structure:
    """The core of a matrix with bipartite rows; to leave out rows and columns changes nothing."""
    pairs = sides.pairs[core.columns]
    place = np.zeros(len(sides.side), np.int64)
    place[core.rows] = np.arange(len(core.rows))
    pairs = place[pairs[(pairs >= 0).all(axis=1)]]
    return _as_bipartite(core, sides.side[core.rows], pairs, sides.has_negative)


def _as_bipartite(core: Core, side: Ints, pairs: Ints, has_negative: bool) -> Structure:
    what = "bipartite assignment rows" if len(pairs) else "semi-assignment rows"
    if (side == 2).any():
        what += " and a cardinality"
    return Structure("bipartite", f"{what}: totally unimodular", core, side, pairs, has_negative)


def _sides(matrix: csr_array) -> _Sides | None:
    """How the rows of `matrix`, all of whose entries are ±1, are bipartite, if they are."""
    n_rows, n_columns = matrix.shape
    entries = np.diff(matrix.indptr)
    # A row may be written with the other sign throughout; only mixed signs are another matter.
    has_negative = bool(matrix.data.min(initial=1) < 0)
    if has_negative and np.any(np.abs(matrix @ np.ones(n_columns)) != entries):
        return None
    everything = entries == n_columns
    pairs = _pairs(matrix, ~everything)
    if pairs is None:
        return None
    has_both = pairs[:, 1] >= 0
    both = pairs[has_both]
    side = _two_colours(n_rows, both[:, 0], both[:, 1], np.ones(len(both), dtype=bool))
    if side is None:
        return None
    pairs[has_both] = np.where(side[both[:, :1]] == 0, both, both[:, ::-1])
    return _Sides(np.where(everything, 2, side), pairs, has_negative)


def _pairs(matrix: csr_array, chosen: Bools) -> Ints | None:
    """The two `chosen` rows of each column, -1 where it has not both; ``None`` if it has more."""
    n_rows, n_columns = matrix.shape
    row = np.repeat(np.arange(n_rows), np.diff(matrix.indptr))
    kept = chosen[row]
    row, column = row[kept], matrix.indices[kept]
    count = np.bincount(column, minlength=n_columns)
    if count.max(initial=0) > 2:
        return None
    row = row[np.argsort(column, kind="stable")]
    pairs = np.full((n_columns, 2), -1)
    first = (np.cumsum(count) - count)[count == 2]
    pairs[count == 2] = np.stack([row[first], row[first + 1]], axis=1)
    return pairs


def _network(core: Core) -> Structure | None:
    for matrix, what in ((core.matrix, "columns"), (core.matrix.T, "rows")):
        by_column = csc_array(matrix)
        entries = np.diff(by_column.indptr)
        if entries.size and entries.max() > 2:
            continue
        at = by_column.indptr[:-1][entries == 2]
        first, second = by_column.indices[at], by_column.indices[at + 1]
        differ = by_column.data[at] == by_column.data[at + 1]
        if _two_colours(by_column.shape[0], first, second, differ) is not None:
            description = f"network rows, by {what} with two entries: totally unimodular"
            return Structure("network", description, core)
    return None


def _interval(core: Core) -> Structure | None:
    if np.any(core.matrix.data < 0):
        return None
    for matrix, what in ((core.matrix, "row"), (core.matrix.T, "column")):
        lines = csr_array(matrix)
        lines.sort_indices()
        starts, ends = lines.indptr[:-1], lines.indptr[1:]
        full = ends > starts
        span = lines.indices[ends[full] - 1] - lines.indices[starts[full]] + 1
        if np.array_equal(span, (ends - starts)[full]):
            description = f"interval rows, ones of each {what} consecutive: totally unimodular"
            return Structure("interval", description, core)
    return None


def _two_colours(n: int, first: Ints, second: Ints, differ: Bools) -> Ints | None:
    """Colours 0 and 1 of `n` nodes, or ``None`` if there are none that fit.

    They fit if the ends of each edge differ where ``differ`` says so, and agree elsewhere. In the
    double cover a node is joined to another's copy where they differ; colours exist if and only if
    no node is connected to its own copy.
    """
    other = np.where(differ, second + n, second)
    mirror = np.where(differ, second, second + n)
    ends = (np.concatenate([first, first + n]), np.concatenate([other, mirror]))
    cover = csr_array((np.ones(len(ends[0])), ends), shape=(2 * n, 2 * n))
    _, part = connected_components(cover, directed=False)
    if np.any(part[:n] == part[n:]):
        return None
    colour: Ints = (part[:n] > part[n:]).astype(np.int64)
    return colour


def integral_relaxation(program: Program, structure: Structure) -> Program:
    """The linear program that `structure` proves to have integral vertices."""
    core = structure.core
    lower, upper = core.fixed.copy(), core.fixed.copy()
    lower[core.columns], upper[core.columns] = core.lower, core.upper
    return replace(program.relaxed(), lower=lower, upper=upper)
