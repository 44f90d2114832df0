"""What a stage relies on when it reads a solution, shown of the program before anything is solved.

The variables that a stage reads are whole numbers, 0 or 1, and 0 where the data says that they may not
be 1. The last is shown by the bounds of the columns, else by what single rows imply, else by solving for
a point that breaks it; only what even this leaves open is left to the check of the solution. So a
solution never needs rounding into shape, and no assignment is dropped without a word.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bools
from ...mission.errors import ModelError, SolverError
from ..axes import StageData
from ..check import settled, violations
from ..program import Block, Program
from .bound_tightening import tightened

HALF = 0.5
BIG = 1e7
"""Size from which a coefficient of an integer column is looked at as a big M: a solver's tolerance for
whole numbers, 1e-6, times this is no rounding."""
SECONDS = 10.0
"""To look for a point that breaks the contract where bounds and rows do not show that there is none."""


@dataclass(frozen=True, eq=False)
class Reading:
    """A variable that the stage reads: 0 or 1, and 0 where `may_be_one` is false.

    Parameters
    ----------
    block : Block
        Its columns.
    may_be_one : bool array, shape (block.size,)
        In the order of the columns.
    field : str
        The field of the data that says so; empty if every entry may be 1.
    """

    block: Block
    may_be_one: Bools
    field: str

    @property
    def columns(self) -> slice:
        """Where its columns are in the program."""
        return slice(self.block.start, self.block.stop)

    def forbidden(self, place: int) -> str:
        """What is wrong with a 1 at `place` among its columns, and what to do."""
        column = self.block.start + place
        who = ", ".join(
            f"{noun} {i}"
            for noun, i in zip(self.block.nouns, self.block.index(column), strict=False)
        )
        return (
            f"where data.{self.field} is false ({who}); declare {self.block.name} with "
            f"bounds=[0, data.{self.field}]"
        )


def readings(data: object, columns: Sequence[Block]) -> tuple[Reading, ...]:
    """The variables that the stage of `data` reads, among the `columns` of a program."""
    if not isinstance(data, StageData):
        return ()
    found = []
    for block in columns:
        if block.name not in data.solution:
            continue
        field = data.may_be_one.get(block.name, "")
        allowed = np.ones(block.shape, dtype=bool) if not field else getattr(data, field)
        found.append(Reading(block, np.asarray(allowed, bool).ravel(order="F"), field))
    return tuple(found)


def check_program(
    name: str, program: Program, read: Sequence[Reading], *, numbers_are_of_data: bool = False
) -> None:
    """Refuse a program whose solutions a stage could not take as they are.

    With `numbers_are_of_data` large coefficients are the mission's, for instance the travel time of a
    very slow robot, and no big M of the modeller's; solving tightens them.

    Raises
    ------
    ModelError
        Naming the variable or the row, and what to write instead.
    """
    for item in read:
        own = item.columns
        fixed = program.lower[own] == program.upper[own]
        continuous = np.flatnonzero(~program.integer[own] & ~fixed)
        if continuous.size:
            which = program.column_name(item.block.start + int(continuous[0]))
            if not program.integer[own].any():
                which = item.block.name
            raise ModelError(
                f"{name}: {which} is continuous, but the stage reads 0 or 1 and rounds nothing; "
                f"declare {item.block.name} with boolean=True"
            )
    inner = program
    if any(_open(item, program).any() for item in read):
        inner = tightened(program)
        _check_zero_one(name, inner, read)
        _check_allowed(name, inner, read)
    if not numbers_are_of_data:
        _check_big_m(name, program)


def broken(values: Mapping[str, NDArray[np.float64]], read: Sequence[Reading]) -> str:
    """What of a solution's `values` the stage cannot take; empty if it can take all."""
    for item in read:
        x = values[item.block.name].ravel(order="F")
        for place in np.flatnonzero((x > HALF) & ~item.may_be_one):
            element = item.block.element(item.block.start + int(place))
            return f"{element} = 1 {item.forbidden(int(place))}"
    return ""


def _open(item: Reading, program: Program) -> Bools:
    """The columns whose bounds do not keep them to what they may be, over its columns."""
    lower, upper = program.lower[item.columns], program.upper[item.columns]
    return np.asarray(~((lower > -1 + HALF) & (upper < item.may_be_one + HALF)))


def _check_zero_one(name: str, program: Program, read: Sequence[Reading]) -> None:
    for item in read:
        lower, upper = program.lower[item.columns], program.upper[item.columns]
        outside = np.flatnonzero(~((lower > -HALF) & (upper < 1 + HALF)))
        if outside.size:
            column = item.block.start + int(outside[0])
            raise ModelError(
                f"{name}: nothing keeps {program.column_name(column)} to 0 and 1, which the stage "
                f"reads; declare {item.block.name} with boolean=True"
            )


def _check_allowed(name: str, program: Program, read: Sequence[Reading]) -> None:
    """Refuse the program if a point of it has a 1 where there may be none."""
    weight = np.zeros(program.n_columns)
    for item in read:
        weight[item.columns] = _open(item, program)
    if not weight.any() or np.any(program.lower > program.upper):
        return
    x = _point(program.with_row(weight, 1.0, np.inf, "some entry is 1 that may not be"))
    if x is None:
        return
    for item in read:
        for place in np.flatnonzero((x[item.columns] > HALF) & (weight[item.columns] > 0)):
            which = program.column_name(item.block.start + int(place))
            raise ModelError(f"{name}: {which} may be 1 {item.forbidden(int(place))}")


def _point(program: Program) -> NDArray[np.float64] | None:
    """Some point of `program`, checked; ``None`` if there is none, or none is found in time."""
    from ..solvers import Options, get

    nothing = replace(program, cost=np.zeros(program.n_columns), offset=0.0, sense="min")
    try:
        found = get("highs").solve(nothing, Options(time_limit=SECONDS)).x
    except SolverError:
        return None
    if found is None or violations(program, settled(program, found)):
        return None
    return settled(program, found)


def _check_big_m(name: str, program: Program) -> None:
    """Refuse a big M that the tolerances of solvers slip through, where a far smaller one does."""
    data = program.matrix.data
    if not (np.abs(data) >= BIG).any():
        return
    tight = tightened(program).with_tight_coefficients().matrix.data
    for entry in np.flatnonzero((np.abs(data) >= BIG) & (tight != data)):
        row = int(np.searchsorted(program.matrix.indptr, entry, "right")) - 1
        column = program.column_name(int(program.matrix.indices[entry]))
        raise ModelError(
            f"{name}: row '{program.row_name(row)}' has the coefficient {data[entry]:g} of {column}, a "
            f"big M through whose tolerance a solution slips; {abs(tight[entry]):g} is enough"
        )
