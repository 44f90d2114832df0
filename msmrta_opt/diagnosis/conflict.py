"""Why a program is infeasible: an irreducible set of its constraints, in the modeller's words.

No point satisfies all members of the set, and without any one of them some point satisfies the rest.
Members are rows and single bounds of variables; that a variable is integer is taken as given.

The set is found by a deletion filter (Chinneck, *Feasibility and Infeasibility in Optimization*, 2008,
ch. 6): whatever the others conflict without is dropped. It tries all rows at once, and halves what it
cannot drop, between two labels where it can. So each member of the result has been left out alone,
and the others had a point. Where already the LP relaxation is infeasible, it starts from what has a part
in the Farkas multipliers of HiGHS, and needs linear programs only. (HiGHS has an irreducible conflict of
its own, ``getIis``, which takes many times the time, and crashes now and then.)
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from ..arrays import Bools, Ints
from ..interruption import interrupted, interruptible
from ..mission.counting import in_full
from ..optimise.check import (
    LARGEST_EXACT,
    Point,
    is_badly_scaled,
    kinds_of_rows,
    proves_infeasible,
)
from ..optimise.contradiction import asks_of_nothing
from ..optimise.program import ROUNDING, Program
from ..optimise.scaling import scaled, scaling
from ..optimise.settle import settle
from ..optimise.solve import solve_program
from ..optimise.solvers import Options, highs, solvers
from ..optimise.solvers.base import refuse_dropped
from .lists import shortened

NODES = 1_000
"""Branch-and-bound nodes to try one deletion: without its bounds an integer program may need
infinitely many. Where they do not suffice, the member stays."""
NODES_OF_FREE_INTEGERS = 20_000
"""The same for the whole program, if it has integers without bounds. Where they do not suffice, it is
not known whether it is infeasible."""
TINY = 1e-9
"""Share of its terms up to which a multiplier, or what multipliers leave of a column, is rounding."""


@dataclass(frozen=True)
class Conflict:
    """Why a program has no feasible point, if it has none."""

    name: str
    status: Literal["infeasible", "feasible", "unknown"]
    """``unknown`` if there was neither a proof nor a point when the time was up."""
    method: str = ""
    rows: tuple[str, ...] = ()
    """Rows that conflict, for instance ``cluster 2 has at most one robot``."""
    bounds: tuple[str, ...] = ()
    """Bounds of variables that conflict with them, for instance ``x[0,2] ≤ 0``."""
    labels: tuple[str, ...] = ()
    """Labels of the rows' constraints, for instance ``cluster {c} has at most one robot``."""
    integrality: bool = False
    """Whether fractional values would satisfy them all."""
    irreducible: bool = False
    """Whether it is proven that all of them are needed."""
    said: tuple[str, ...] = ()
    """The bounds in words, where the mission says what they come from."""

    @property
    def text(self) -> str:
        """The explanation in words, a line per member; many of a kind are counted."""
        if self.status == "feasible":
            return f"{self.name} is feasible."
        if self.status == "unknown":
            return f"{self.name}: stopped before it was known to be infeasible."
        if not self.irreducible:
            claim = "it is not known whether all of them are needed"
        elif self.integrality:
            claim = "without any one of them, whole numbers satisfy the others"
        else:
            claim = "without any one of them, fractional values satisfy the others"
        members = shortened([*self.rows, *(self.said or self.bounds)])
        return "\n".join(
            [
                f"{self.name} is infeasible. "
                f"These cannot hold together{' in whole numbers' * self.integrality}; {claim}:",
                *(f"  {member}" for member in members),
                f"Found by: {self.method}.",
            ]
        )


def find_conflict(
    program: Program, *, time_limit: float | None = None, name: str = "the program"
) -> Conflict:
    """Say why `program` has no feasible point, if it has none.

    Parameters
    ----------
    program : Program
        The arrays.
    time_limit : float, optional
        Seconds. When they are over, the set found so far is given; it may hold more than is needed.
    name : str
        What to call the program.

    Raises
    ------
    InputError
        If the time limit is negative.
    """
    options = Options(time_limit=time_limit)
    deadline = np.inf if time_limit is None else time.perf_counter() + time_limit
    with interruptible():
        return _found(program, options, deadline, name)


def _found(program: Program, options: Options, deadline: float, name: str) -> Conflict:
    truth = None if time.perf_counter() >= deadline else settle(program)
    if truth is not None and truth.x is not None:
        return Conflict(name, "feasible")
    for integrality in (False, True):
        system = _System(program, options, deadline, relaxed=not integrality)
        if integrality and not program.integer.any():
            break
        conflict = system.everything
        verdict = system.is_infeasible(conflict)
        if verdict is None and truth is None:
            return Conflict(name, "unknown")
        if not verdict:
            continue
        what = "integer" if integrality else "linear"
        method = f"deletion filter with {what} programs"
        if not integrality:
            found = system.conflict_by_multipliers()
            if system.is_infeasible(found):
                conflict, method = found, f"Farkas multipliers, then {method}"
        conflict, irreducible = _filtered(system, conflict)
        if system.certifies(conflict):
            return _conflict(program, name, method, conflict, irreducible, integrality=integrality)
        if truth is None:
            solution = solve_program(program, options=system.left)
            return Conflict(name, "feasible" if solution.found else "unknown")
        break
    if truth is not None:
        return _conflict(program, name, truth.proof, system.everything, False, integrality=True)
    return Conflict(name, "feasible")


class _System:
    """A live HiGHS model of which any members can be left out.

    Members are numbered: ``n_rows`` rows, then ``n_columns`` lower bounds, then the upper ones.
    """

    def __init__(
        self, program: Program, options: Options, deadline: float, *, relaxed: bool
    ) -> None:
        import highspy

        self.integer = program.integer
        program = program.relaxed() if relaxed else program
        self.own = with_whole_sides(replace(program, cost=np.zeros(program.n_columns)))
        self.program = scaled(self.own, scaling(self.own))
        refuse_dropped("highs", self.own, self.program)
        self.deadline = deadline
        self._statuses = highspy.HighsModelStatus
        self._highs: Any = highs.new_highs()
        is_whole = bool(program.integer.any())
        # The presolve of integer programs is wrong now and then, and may not end.
        highs.set_options(self._highs, replace(options, presolve=not is_whole), integer=is_whole)
        if is_whole:
            self._highs.setOptionValue(*highs.WITHOUT_JUMPS)
        else:
            self._highs.setOptionValue("primal_feasibility_tolerance", highs.STRICTEST)
        highs.heed_interruption(self._highs)
        self._highs.passModel(highs.model(highspy, self.program))

    @property
    def everything(self) -> Bools:
        """Which members say something, shape ``(n_rows + 2 * n_columns,)``."""
        program = self.program
        bounded = np.isfinite(program.row_lower) | np.isfinite(program.row_upper)
        return np.concatenate([bounded, np.isfinite(program.lower), np.isfinite(program.upper)])

    @property
    def time_is_up(self) -> bool:
        """Whether the deadline has passed, or the user wants an end."""
        return time.perf_counter() >= self.deadline or interrupted()

    @property
    def left(self) -> Options:
        """What is left of the time."""
        left = max(self.deadline - time.perf_counter(), 0.0)
        return Options(time_limit=left if np.isfinite(left) else None)

    def is_infeasible(self, members: Bools, *, is_trial: bool = False) -> bool | None:
        """Whether no point satisfies `members`; ``None`` if it was not found out.

        The trial of a deletion has few nodes, and its point no tolerance but rounding: what tolerances
        allow may be no point at all.
        """
        if self.time_is_up:
            return None
        if self._contradicts_itself(members):
            return True
        self._restrict(members)
        self._highs.setOptionValue("time_limit", max(self.deadline - time.perf_counter(), 0.0))
        free = self.own.integer & ~(np.isfinite(self.own.lower) & np.isfinite(self.own.upper))
        maximum = NODES_OF_FREE_INTEGERS if free.any() else 2**31 - 1
        self._highs.setOptionValue("mip_max_nodes", NODES if is_trial else maximum)
        self._highs.run()
        status = self._highs.getModelStatus()
        if status == self._statuses.kInfeasible:
            return True
        if status == self._statuses.kModelEmpty:
            return False
        if status == self._statuses.kOptimal:
            x = np.array(self._highs.getSolution().col_value) * scaling(self.own).column
            point = Point.of(self.part(members), x)
            return None if point.wrong or (is_trial and point.violation > ROUNDING) else False
        return None

    def _contradicts_itself(self, members: Bools) -> bool:
        """Whether a row among `members` cannot hold, whatever the variables are."""
        wrong = (self.own.row_lower > self.own.row_upper) | asks_of_nothing(self.own)
        return bool((wrong & members[: self.own.n_rows]).any())

    def part(self, members: Bools) -> Program:
        """The program with `members` alone."""
        program = self.own
        rows, lower, upper = np.split(members, [program.n_rows, program.n_rows + program.n_columns])
        return replace(
            program,
            row_lower=np.where(rows, program.row_lower, -np.inf),
            row_upper=np.where(rows, program.row_upper, np.inf),
            lower=np.where(lower, program.lower, -np.inf),
            upper=np.where(upper, program.upper, np.inf),
        )

    def certifies(self, members: Bools) -> bool:
        """Whether it is beyond HiGHS' word that no point satisfies `members`."""
        part = self.part(members).with_whole_bounds()
        if self._contradicts_itself(members) or (part.lower > part.upper).any():
            return True
        if not part.integer.any():
            ray = highs.infeasible_ray(scaled(part, scaling(part)), Options())
            ray = np.zeros(part.n_rows) if ray is None else ray * scaling(part).row
            # Rows of whole numbers have no rounding, but leave none to the multipliers either.
            exactly = replace(part, integer=self.integer)
            return proves_infeasible(part, ray) or proves_infeasible(exactly, ray)
        truth = settle(part)
        if truth is not None:
            return truth.x is None
        if is_badly_scaled(scaled(part, scaling(part))):
            return False
        other = solvers()["scip"]
        if not other.installed:
            return True
        left = self.deadline - time.perf_counter()
        limit = min(max(left, 0.0), 30.0)
        return other.solve(part, Options(time_limit=limit)).status in ("infeasible", "no_solution")

    def conflict_by_multipliers(self) -> Bools:
        """The members with a part in Farkas multipliers, not verified and not all needed."""
        ray = highs.infeasible_ray(self.program, self.left)
        if ray is None:
            return np.zeros_like(self.everything)
        matrix = self.program.matrix
        parts, weight = abs(matrix).T @ np.abs(ray), np.abs(matrix.T @ ray)
        rows, bounds = np.abs(ray) > TINY * np.abs(ray).max(), weight > TINY * parts
        return np.concatenate([rows, bounds, bounds]) & self.everything

    def _restrict(self, members: Bools) -> None:
        program = self.program
        rows, lower, upper = np.split(members, [program.n_rows, program.n_rows + program.n_columns])
        self._highs.changeRowsBounds(
            program.n_rows,
            np.arange(program.n_rows, dtype=np.int32),
            np.where(rows, program.row_lower, -np.inf),
            np.where(rows, program.row_upper, np.inf),
        )
        self._highs.changeColsBounds(
            program.n_columns,
            np.arange(program.n_columns, dtype=np.int32),
            np.where(lower, program.lower, -np.inf),
            np.where(upper, program.upper, np.inf),
        )


def with_whole_sides(program: Program) -> Program:
    """`program` with the sides of whole rows moved to multiples of their greatest common divisors.

    ``2 x - 2 y ≤ 1`` is ``≤ 0`` in whole numbers; branching alone might never find that out.
    """
    whole, _ = kinds_of_rows(program)
    lower, upper = program.row_lower.copy(), program.row_upper.copy()
    matrix = program.matrix
    for i in np.flatnonzero(whole):
        entries = matrix.data[matrix.indptr[i] : matrix.indptr[i + 1]]
        if not entries.any() or np.abs(entries).max() >= LARGEST_EXACT:
            continue
        divisor = float(np.gcd.reduce(np.abs(entries[entries != 0]).astype(np.int64)))
        if divisor > 1:
            lower[i] = np.ceil(lower[i] / divisor) * divisor
            upper[i] = np.floor(upper[i] / divisor) * divisor
    return replace(program, row_lower=lower, row_upper=upper)


def _filtered(system: _System, conflict: Bools) -> tuple[Bools, bool]:
    """An infeasible part of `conflict`, and whether it is proven that it has no smaller one."""
    members = np.flatnonzero(conflict)
    n_rows = system.program.n_rows
    borders = np.array([block.start for block in system.program.rows] + [n_rows], dtype=int)
    # Rows come first: as long as all bounds are there, integer programs are easy.
    chunks = [members[members >= n_rows], members[members < n_rows]]
    irreducible = True
    while chunks:
        chunk = chunks.pop()
        if system.time_is_up:
            return conflict, False
        rest = conflict.copy()
        rest[chunk] = False
        verdict = system.is_infeasible(rest, is_trial=True)
        if verdict:
            conflict = rest
        elif len(chunk) > 1:
            middle = _middle(chunk, borders)
            chunks += [chunk[middle:], chunk[:middle]]
        elif verdict is None:
            irreducible = False
    return conflict, irreducible


def _middle(chunk: Ints, borders: Ints) -> int:
    """Where to cut `chunk`: at the border nearest to its middle, or there if it has none."""
    cuts = np.searchsorted(chunk, borders)
    cuts = cuts[(cuts > 0) & (cuts < len(chunk))]
    half = len(chunk) // 2
    return int(cuts[np.abs(cuts - half).argmin()]) if len(cuts) else half


def _conflict(
    program: Program,
    name: str,
    method: str,
    conflict: Bools,
    irreducible: bool,
    *,
    integrality: bool,
) -> Conflict:
    rows, lower, upper = np.split(conflict, [program.n_rows, program.n_rows + program.n_columns])
    labels = [block.name for block in program.rows if rows[block.start : block.stop].any()]
    return Conflict(
        name=name,
        status="infeasible",
        method=method,
        rows=tuple(program.row_name(int(i)) for i in np.flatnonzero(rows)),
        bounds=tuple(
            bound_name(program, int(j), bool(lower[j]), bool(upper[j]))
            for j in np.flatnonzero(lower | upper)
        ),
        labels=tuple(dict.fromkeys(labels)),
        integrality=integrality,
        irreducible=irreducible,
    )


def bound_name(program: Program, column: int, lower: bool, upper: bool) -> str:
    """The sides of a variable's bounds that conflict: ``x[0,2] ≤ 0``."""
    name, minimum, maximum = (
        program.column_name(column),
        program.lower[column],
        program.upper[column],
    )
    if lower and upper:
        return (
            f"{name} = {in_full(minimum)}"
            if minimum == maximum
            else f"{in_full(minimum)} ≤ {name} ≤ {in_full(maximum)}"
        )
    return f"{name} ≥ {in_full(minimum)}" if lower else f"{name} ≤ {in_full(maximum)}"
