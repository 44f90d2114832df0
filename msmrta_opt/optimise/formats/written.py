"""A program as files have it: names and numbers that every reader takes, the same in both formats.

What HiGHS, SCIP, GLPK and CBC do not read alike is written in a way in which they do:

- the constant of the objective, of which GLPK turns the sign in MPS files and CBC in some LP files, is
  the coefficient of one more variable, fixed at 1;
- a row with two different sides, which none of them reads in LP files, is two rows;
- a row with coefficients beyond what they keep (HiGHS drops 1e-9 and refuses 1e15) is multiplied by a
  power of two, or refused;
- a program without rows, which GLPK does not read, gets one that always holds.

`draft` undoes all but the powers of two.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
from scipy.sparse import csr_array, diags_array

from ...arrays import Bools, Floats
from ...mission.errors import ModelError, shown
from ..program import INFINITE, LARGEST, SMALLEST, Block, Program

CONSTANT = "objective_constant"
"""The variable that is fixed at 1 and whose cost is the constant of the objective."""

NO_ROWS = "no_rows"
"""The row of a program without rows."""

ENDINGS = ("_lo", "_up")
"""Of the names of the two rows of one with two sides."""

LONGEST = 96
"""Characters of a name: CBC takes 100, and endings come to it."""

WIDEST = 1e10
"""Ratio of the coefficients of a row that is scaled; of a wider one the small ones lose their effect."""

_GIVE_LESS = f"give numbers below {INFINITE:g}, which readers take for infinite"

RESERVED = frozenset(
    """
    bin binaries binary bound bounds columns csection end endata free gen general generals inf
    infinity int integer integers lazy marker max maximise maximize maximum min minimise minimize
    minimum name nan no_rows obj objective_constant objsense qcmatrix qsection quadobj range ranges
    rhs rows s.t. semi semis sin sos sos1 sos2 st st. subject such user
    """.split()  # noqa: SIM905 - a list of as many strings reads worse
)
"""Words that a reader of either format takes for something else than a name."""


@dataclass(frozen=True)
class Written:
    """A program to write; all rows are of the form ``terms (≤, ≥, =) side``."""

    title: str
    maximise: bool
    columns: list[str]
    cost: Floats
    lower: Floats
    upper: Floats
    integer: list[bool]
    rows: list[str]
    relation: list[str]
    """``<=``, ``>=`` or ``=``."""
    side: list[float]
    matrix: csr_array


def written(program: Program, title: str) -> Written:
    """`program` as its file will have it.

    Raises
    ------
    ModelError
        If a number is beyond what readers take, naming its row and variable.
    """
    matrix = program.matrix.copy()
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    columns = _names(program.columns, program.n_columns, "x")
    rows = _names(program.rows, program.n_rows, "row")
    _check_columns(program, columns)
    matrix, low, high = _scaled(program, matrix, columns, rows)
    columns, rows = _unique(columns), _unique(rows, endings=("", *ENDINGS))

    relation, side, which, names = [], [], [], []
    for i, name in enumerate(rows):
        for said in _relations(low[i], high[i]):
            relation.append(said[0])
            side.append(float(said[1]) + 0.0)  # no file has -0.0
            which.append(i)
            names.append(name + said[2])
    matrix = matrix[which]
    matrix.sort_indices()
    cost, lower, upper = program.cost + 0.0, program.lower + 0.0, program.upper + 0.0
    integer = program.integer.tolist()
    if program.offset or not columns:
        columns, integer = [*columns, CONSTANT], [*integer, False]
        cost, lower, upper = (
            np.append(values, more)
            for values, more in ((cost, program.offset), (lower, 1.0), (upper, 1.0))
        )
    if not names:
        names, relation, side = [NO_ROWS], ["<="], [0.0]
    matrix.resize(len(names), len(columns))
    return Written(
        legal_name(title), program.sense == "max", columns, cost, lower, upper, integer,
        names, relation, side, matrix,
    )  # fmt: skip


def as_modelled(program: Program) -> Program:
    """`program` with the signs of rows turned that have no positive coefficient.

    Modelling languages turn ``x + y ≥ 1`` into ``-x - y ≤ -1``; a file to be read by people has the
    former.
    """
    matrix = program.matrix
    turned = ((matrix > 0).sum(axis=1) == 0) & ((matrix < 0).sum(axis=1) > 0)
    return replace(
        program,
        matrix=(diags_array(np.where(turned, -1.0, 1.0)) @ matrix).tocsr(),
        row_lower=np.where(turned, -program.row_upper, program.row_lower),
        row_upper=np.where(turned, -program.row_lower, program.row_upper),
    )


def digits(value: float) -> str:
    """All digits of a number, whatever the locale, and no more."""
    return repr(float(value)).removesuffix(".0")


def legal_name(name: str) -> str:
    """`name` in characters that both formats take: ``x(0,2)`` for ``x[0,2]``.

    By the narrowest readers' rules: ASCII letters, digits and ``_.,()``; no more than `LONGEST`; first
    a letter or ``_``, but not what begins a number: E, Inf or NaN.
    """
    name = name.replace("[", "(").replace("]", ")")
    name = re.sub(r"[^A-Za-z0-9_.,()]+", "_", name).strip("_")
    if not re.match(r"(?!inf|nan)[a-df-z]", name, re.IGNORECASE) or name.lower() in RESERVED:
        name = f"_{name}"
    return name[:LONGEST].rstrip("_") or "_"


def _names(blocks: Iterable[Block], n: int, default: str) -> list[str]:
    """The names of `n` columns or rows, by their blocks."""
    names = [f"{default}_{i}" for i in range(n)]
    for block in blocks:
        for position in range(block.start, block.stop):
            names[position] = block.element(position)
    return names


def _unique(names: Iterable[str], *, endings: Sequence[str] = ("",)) -> list[str]:
    """The names made legal, and made to differ even with any of `endings` behind them."""
    taken: set[str] = set()
    numbers: dict[str, count[int]] = {}
    unique = []
    for name in map(legal_name, names):
        candidate = name
        while not taken.isdisjoint(candidate + ending for ending in endings):
            ending = f"_{next(numbers.setdefault(name, count(2)))}"
            candidate = name[: LONGEST - len(ending)] + ending
        taken.update(candidate + ending for ending in endings)
        unique.append(candidate)
    return unique


def _check_columns(program: Program, names: list[str]) -> None:
    for what, values, right in (
        ("cost", program.cost, np.abs(program.cost) < INFINITE),
        ("lower bound", program.lower, _is_side(program.lower, -np.inf)),
        ("upper bound", program.upper, _is_side(program.upper, np.inf)),
    ):
        if not right.all():
            j = int(np.argmin(right))
            raise ModelError(f"variable {shown(names[j])}: {what} {values[j]:g}; {_GIVE_LESS}")
    if not abs(program.offset) < INFINITE:
        raise ModelError(f"the objective's constant {program.offset:g}; {_GIVE_LESS}")


def _is_side(values: Floats, none: float) -> Bools:
    """Which are numbers that readers take for such, or `none`, which is no side at all."""
    right: Bools = (np.abs(values) < INFINITE) | (values == none)
    return right


def _scaled(
    program: Program, matrix: csr_array, columns: list[str], rows: list[str]
) -> tuple[csr_array, Floats, Floats]:
    """The rows with all coefficients between `SMALLEST` and `LARGEST`."""
    low, high, size = program.row_lower, program.row_upper, np.abs(matrix.data)
    outside = ~((size > SMALLEST) & (size < LARGEST))
    where = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    scale = np.ones(matrix.shape[0])
    for i in np.unique(where[outside]):
        terms = slice(matrix.indptr[i], matrix.indptr[i + 1])
        sizes, at = size[terms], matrix.indices[terms]
        smallest, largest = int(np.argmin(sizes)), int(np.argmax(sizes))
        # The two are brought to the same distance from 1.
        exponents = np.log2([sizes[smallest], sizes[largest]])
        scale[i] = 2.0 ** -round(exponents.mean()) if np.isfinite(exponents).all() else np.nan
        if not sizes[largest] <= WIDEST * sizes[smallest]:
            one, other = (smallest, largest) if sizes[largest] < LARGEST else (largest, smallest)
            raise ModelError(
                f"row {shown(rows[i])}: coefficient {sizes[one]:g} of {shown(columns[at[one]])} "
                f"beside {sizes[other]:g} of {shown(columns[at[other]])}; solvers take none beyond "
                f"{SMALLEST:g} and {LARGEST:g}, and no scaling helps; give other units"
            )
    low, high = low * scale, high * scale
    wrong = ~(_is_side(low, -np.inf) & _is_side(high, np.inf))
    if wrong.any():
        i = int(np.argmax(wrong))
        raise ModelError(
            f"row {shown(rows[i])}: its sides {low[i]:g} and {high[i]:g}; {_GIVE_LESS}"
        )
    return (diags_array(scale) @ matrix).tocsr(), low, high


def _relations(low: float, high: float) -> Iterator[tuple[str, float, str]]:
    """What a row says, by relation and side, and the ending of its name."""
    if low == high:
        yield "=", low, ""
        return
    lo, up = ENDINGS if np.isfinite(low) and np.isfinite(high) else ("", "")
    if np.isfinite(low):
        yield ">=", low, lo
    if np.isfinite(high):
        yield "<=", high, up
