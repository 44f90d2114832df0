"""Names of rows and columns in the ids of the data: which axis each of their dimensions is.

cvxpy knows shapes, not axes, so what a dimension is, is read from the program itself. The variables that
a stage reads have declared axes. A dimension of a constraint along which the index on one of these axes
is a different one at each place runs over that axis, or over the part of it that its places have: the
rows of ``cp.sum(x, axis=0) <= 1`` hold one cluster each and every robot, so they run over clusters.
Where the rows hold none of these variables, lengths decide, then the order of the data's axes.

A label is filled by the names in its braces, in whatever order the sentence has them. What a brace names
must be an axis of the constraint, or the label is refused. Rows without any variable of the stage may
have axes of the modeller's own, under other names; these are numbered.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.sparse import csr_array

from ...arrays import Ints
from ...mission.errors import ModelError
from ..axes import Ids, StageData
from ..program import BRACES, Block
from .canonical import AUXILIARY

Letters = tuple[str, ...]
"""The axis of each dimension, empty where none is known."""
Places = dict[str, Ints]
"""By axis that a dimension runs over, the place on it at each place of the dimension."""


@dataclass(frozen=True)
class _Placed(Block):
    """A block whose ids are those at `places` along axes, a `source` for each dimension."""

    places: tuple[tuple[int, ...], ...] = ()
    sources: Letters = ()

    def filled(self, ids: Mapping[str, Ids]) -> Block:
        """With the ids along the axes."""
        along = tuple(
            tuple([ids[source][place] for place in places]) if source else places
            for source, places in zip(self.sources, self.places, strict=True)
        )
        return Block(self.name, self.start, self.shape, self.letters, self.nouns, along)


@dataclass(frozen=True, eq=False)
class Named:
    """The blocks of a program with their axes, for whatever ids stand along these.

    ``given`` and ``matrix`` are what they were found from.
    """

    given: tuple[object, ...]
    matrix: csr_array
    columns: tuple[Block, ...]
    rows: tuple[Block, ...]

    def filled(self, data: object) -> tuple[tuple[Block, ...], tuple[Block, ...]]:
        """Columns and rows with the ids of `data`, if it has any."""
        if not isinstance(data, StageData):
            return self.columns, self.rows
        ids = {letter: data.along(letter) for letter in data.letters}
        columns, rows = (
            tuple(b.filled(ids) if isinstance(b, _Placed) else b for b in blocks)
            for blocks in (self.columns, self.rows)
        )
        return columns, rows


def named(
    name: str,
    columns: tuple[Block, ...],
    rows: tuple[Block, ...],
    matrix: csr_array,
    data: object,
    before: Named | None = None,
) -> Named:
    """The blocks of a formulation's program on `data`, with axes.

    Parameters
    ----------
    name : str
        The formulation's.
    columns, rows : tuple of Block
        With variables' names and constraints' labels.
    matrix : sparse array, shape (n_rows, n_columns)
        The program's.
    data
        Without declared axes all keep their positions, and braces stand in the order of dimensions.
    before : Named, optional
        That of another program, which is that of this one if both are alike.

    Raises
    ------
    ModelError
        If a label names what is no axis of its constraint.
    """
    if not isinstance(data, StageData):
        for block in rows:
            if len(BRACES.findall(block.name)) > len(block.shape):
                raise ModelError(
                    f"{name}: label {block.name!r} has more braces than its constraint, of shape"
                    f" {block.shape}, has axes; leave out what is none"
                )
        return Named((), matrix, columns, rows)
    given = (name, columns, rows, type(data), *map(len, data.ids.values()))
    if before is not None and before.matrix is matrix and before.given == given:
        return before
    names = _Names(name, data, matrix)
    declared = [names.declared(block) for block in columns]
    read = [block for block in declared if block.letters]
    found = tuple(b if _is_added(b) else names.row(b, read) for b in rows)
    rest = (b if b.letters or _is_added(b) else names.column(b, found) for b in declared)
    return Named(given, matrix, tuple(rest), found)


def _is_added(block: Block) -> bool:
    return block.name.startswith(AUXILIARY)


class _Names:
    """Finds axes in one program on one data set."""

    def __init__(self, name: str, data: StageData, matrix: csr_array) -> None:
        self.name, self.data, self.matrix = name, data, matrix
        self.ids: Mapping[str, Ids] = {letter: data.along(letter) for letter in data.letters}

    def declared(self, block: Block) -> Block:
        """A variable that the stage reads with its axes; another as it is."""
        letters = self.data.solution.get(block.name, ())
        fits = block.shape == tuple(len(self.ids[letter]) for letter in letters)
        return self._with(block, letters, [{}] * len(letters)) if fits else block

    def row(self, block: Block, read: Sequence[Block]) -> Block:
        """A constraint with its axes, by its label and by the variables `read` in its rows."""
        braces = set(BRACES.findall(block.name))
        own = not any(self._along(block, variable) for variable in read)
        if not braces <= self.ids.keys() and own and len(braces) <= len(block.shape):
            return block  # axes of the modeller's own, which have no ids
        if not braces <= self.ids.keys():
            raise ModelError(
                f"{self.name}: label {block.name!r} names {{{min(braces - self.ids.keys())}}}; the"
                f" axes of {type(self.data).__name__} are {self._described(tuple(self.ids))}"
            )
        places: list[Places] = [{} for _ in block.shape]
        several: list[set[str]] = [set() for _ in block.shape]
        for variable in read:
            for (d, e), found in self._along(block, variable).items():
                letter = variable.letters[e]
                if found is None or not np.array_equal(places[d].setdefault(letter, found), found):
                    several[d].add(letter)
        for of, mixed in zip(places, several, strict=True):
            for letter in [x for x, found in of.items() if x in mixed or not len(found)]:
                del of[letter]
        choices = [
            ["", *(x for x in self.ids if self._may_be(x, n, of, mixed))]
            for n, of, mixed in zip(block.shape, places, several, strict=True)
        ]
        letters = self._best(choices, places, braces)
        if letters is None:
            runs = self._described(self._best(choices, places, set()) or ())
            raise ModelError(
                f"{self.name}: label {block.name!r} does not fit its constraint, of shape"
                f" {block.shape}; name in braces what that runs over: {runs or 'nothing'}"
            )
        return self._with(block, letters, places)

    def column(self, block: Block, rows: Sequence[Block]) -> Block:
        """A variable that the stage does not read, with the axes of the rows that hold it."""
        places: list[Places] = [{} for _ in block.shape]
        for row in rows:
            for (d, e), found in self._along(row, block).items():
                same = found is not None and np.array_equal(found, np.arange(block.shape[e]))
                if found is not None and same and d < len(row.letters) and row.letters[d]:
                    places[e][row.letters[d]] = found
        choices = [
            ["", *(x for x in self.ids if len(self.ids[x]) == n and (not of or x in of))]
            for n, of in zip(block.shape, places, strict=True)
        ]
        return self._with(block, self._best(choices, places, set()) or (), places)

    def _along(self, rows: Block, variable: Block) -> dict[tuple[int, int], Ints | None]:
        """For a dimension of rows and one of a variable, the index of this at each place of that.

        ``None`` where a place holds several, empty where several places hold the same; no item where
        the rows do not hold the variable at all.
        """
        if not (rows.size and rows.shape and variable.shape):
            return {}
        ends = self.matrix.indptr[rows.start : rows.stop + 1]
        column = self.matrix.indices[ends[0] : ends[-1]] - variable.start
        row = np.repeat(np.arange(rows.size), ends[1:] - ends[:-1])
        if variable.size < self.matrix.shape[1]:
            own = (column >= 0) & (column < variable.size)
            column, row = column[own], row[own]
        if not len(row):
            return {}
        at = np.unravel_index(row, rows.shape, order="F") if len(rows.shape) > 1 else (row,)
        index = np.unravel_index(column, variable.shape, order="F")
        return {
            (d, e): _one_each(at[d], index[e], n, length)
            for d, n in enumerate(rows.shape)
            for e, length in enumerate(variable.shape)
        }

    def _may_be(self, letter: str, n: int, places: Places, several: set[str]) -> bool:
        """Whether a dimension of length `n` that runs over `places` can be the axis `letter`.

        What a row holds `several` of is not what the row is about, if something else is.
        """
        if self._family(letter) in {self._family(other) for other in places}:
            return True
        return len(self.ids[letter]) == n and not (places and letter in several)

    def _best(
        self, choices: Sequence[Sequence[str]], places: Sequence[Places], braces: set[str]
    ) -> Letters | None:
        """Of all choices of different axes with all of `braces` the one that `places` tell best."""
        best: tuple[tuple[int, ...], Letters] | None = None
        order = list(self.ids)
        for letters in product(*choices):
            own = [letter for letter in letters if letter]
            if len(set(own)) < len(own) or not braces <= set(own):
                continue
            score = (
                sum(letter in of for letter, of in zip(letters, places, strict=True)),
                len(own),
                int(own == sorted(own, key=order.index)),
            )
            if best is None or score > best[0]:
                best = score, letters
        return best[1] if best else None

    def _with(self, block: Block, letters: Letters, places: Sequence[Places]) -> Block:
        along: list[tuple[int, ...]] = []
        sources: list[str] = []
        for letter, n, of in zip(letters, block.shape, places, strict=False):
            near = [x for x in of if letter and self._family(x) == self._family(letter)]
            source = letter if letter in of or not near else near[0]
            along.append(tuple(of[source].tolist()) if source in of else tuple(range(n)))
            sources.append(source)
        nouns = tuple(self.data.axes[letter].noun if letter else "" for letter in letters)
        return _Placed(
            block.name, block.start, block.shape, letters, nouns, (), tuple(along), tuple(sources)
        )

    def _family(self, letter: str) -> str:
        """The axis whose things `letter` runs over."""
        return self.data.axes[letter].of or letter

    def _described(self, letters: Letters) -> str:
        return ", ".join(f"{{{x}}} ({self.data.axes[x].noun})" for x in letters if x)


def _one_each(at: Ints, index: Ints, n: int, length: int) -> Ints | None:
    """The one `index`, below `length`, at each place of 0 to n - 1; see `_Names._along`."""
    found = np.full(n, -1)
    found[at] = index
    if (found[at] != index).any():
        return None
    if found.min() >= 0:
        return found if len(set(found.tolist())) == n else found[:0]
    used = found >= 0
    # Coefficients of 0 leave gaps, which are filled if all else is in order.
    in_order = n <= length and (found[used] == np.flatnonzero(used)).all()
    return np.arange(n) if in_order else found[:0]
