"""Two programs side by side: variables, rows and coefficients that differ, and what that does.

Variables and rows are matched by their names, in ids; rows of other names that say the same are told as
renamed. Then each optimum is tried in the other program: its integers are kept, what is continuous may
follow; without integers the point is kept as it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..arrays import Floats
from ..interruption import interruptible
from ..mission.counting import in_full
from ..optimise.check import row_misses, violations
from ..optimise.compile.canonical import AUXILIARY
from ..optimise.program import Program
from ..optimise.scaling import objective_size
from ..optimise.solution import Solution
from ..optimise.solve import solve_program
from ..optimise.solvers import Options
from ..optimise.subject import Subject, own_parameters, subject
from .clock import Clock
from .conflict import find_conflict
from .fixings import fixing_name, with_bounds, with_rows
from .lists import shortened, under
from .rows import Row, named_rows
from .why_not import SAME

LISTED, CHANGES = 12, 4
"""Rows or columns that differ in one way, and changes of one of them, that are told."""
KINDS = {
    "optimal": "has a solution",
    "feasible": "has a solution",
    "infeasible": "infeasible",
    "unbounded": "unbounded",
}
"""What is known of a program whose solve ended with a status; of others nothing is."""


@dataclass(frozen=True)
class Changed:
    """A variable or a row that both have, but not alike."""

    name: str
    label: str
    """Of the row; the name of the variable's array."""
    changes: tuple[str, ...]
    """For instance ``≤ 1 → ≤ 2`` or ``x[0,2]: 1 → 3``."""


@dataclass(frozen=True)
class Transfer:
    """The optimum of one program, tried in the other."""

    value: float | None
    """Its own optimal value; ``None`` if it has none, or none was found in time."""
    status: str
    """Of its own solution."""
    is_feasible: bool | None = None
    """In the other program; ``None`` if it was not found out."""
    value_there: float | None = None
    """Of the best with its integers, in the other program."""
    loss: float | None = None
    """By how much that is worse than the other's optimum."""
    broken: tuple[str, ...] = ()
    """Rows and bounds of the other program that it breaks."""


@dataclass(frozen=True)
class Difference:
    """What differs between two programs, ``a`` and ``b``."""

    a: str
    b: str
    sense: tuple[str, str]
    variables_a: tuple[str, ...]
    """Variables of `a` alone."""
    variables_b: tuple[str, ...]
    domains: tuple[Changed, ...]
    """Variables with other bounds, or integer in one alone."""
    costs: tuple[Changed, ...]
    rows_a: tuple[str, ...]
    """Rows of `a` alone."""
    rows_b: tuple[str, ...]
    rows: tuple[Changed, ...]
    """Rows with other sides or coefficients."""
    renamed: tuple[tuple[str, str], ...]
    """Rows that say the same under two names."""
    a_in_b: Transfer
    b_in_a: Transfer

    @property
    def is_none(self) -> bool:
        """Whether both are the same program, up to names of rows and order."""
        parts = (self.variables_a, self.variables_b, self.domains, self.costs)
        return not any((*parts, self.rows_a, self.rows_b, self.rows)) and len(set(self.sense)) == 1

    @property
    def optima_differ(self) -> bool | None:
        """Whether an optimum of one is none of the other; ``None`` if it was not found out."""
        both = (self.a_in_b, self.b_in_a)
        kinds = {KINDS.get(item.status, "") for item in both}
        if "" not in kinds and len(kinds) == 2:
            return True
        if any(item.is_feasible is False or item.loss for item in both):
            return True
        if all(item.loss == 0 for item in both) or kinds in ({"infeasible"}, {"unbounded"}):
            return False
        return None

    @property
    def text(self) -> str:
        """The difference in words."""
        if self.is_none:
            parts = [f"{self.a} and {self.b} are the same program."]
        else:
            parts = [f"{self.a} against {self.b}:"]
        if self.sense[0] != self.sense[1]:
            parts.append(f"  the objective: {self.sense[0]} → {self.sense[1]}")
        for title, names in (
            (f"Variables of {self.a} alone", self.variables_a),
            (f"Variables of {self.b} alone", self.variables_b),
            (f"Rows of {self.a} alone", self.rows_a),
            (f"Rows of {self.b} alone", self.rows_b),
        ):
            parts += under(title, list(names), LISTED)
        for title, items in (
            ("Bounds that differ", self.domains),
            ("Costs that differ", self.costs),
            ("Rows that differ", self.rows),
        ):
            parts += under(
                title, [f"{x.name}: {'; '.join(_few(x.changes))}" for x in items], LISTED
            )
        parts += under("Rows renamed", [f"{old} → {new}" for old, new in self.renamed], LISTED)
        parts.append(_transfer(self.a, self.b, self.a_in_b))
        parts.append(_transfer(self.b, self.a, self.b_in_a))
        return "\n".join(parts)

    def __str__(self) -> str:
        return self.text

    def as_dict(self) -> dict[str, Any]:
        """All of it, ready for JSON."""
        found = asdict(self)
        found["is_none"], found["optima_differ"] = self.is_none, self.optima_differ
        return found


def _few(changes: tuple[str, ...]) -> list[str]:
    more = len(changes) - CHANGES
    return [*changes[:CHANGES], f"and {more} more"] if more > 0 else list(changes)


def _transfer(a: str, b: str, found: Transfer) -> str:
    if found.value is None:
        return f"{a} has no optimum to try in {b}: {found.status}."
    head = f"The optimum of {a}, {in_full(found.value)},"
    if found.is_feasible is False:
        lines = "\n".join(f"  {item}" for item in shortened(list(found.broken)))
        return f"{head} is not feasible in {b}, where it breaks:\n{lines}"
    if found.value_there is None:
        return f"{head} was not tried in {b} in time."
    worth = f"{head} is feasible in {b}, worth {in_full(found.value_there)} there"
    if found.loss is None:
        return f"{worth}."
    if found.loss == 0:
        return f"{worth}, and optimal."
    return f"{worth}, {in_full(found.loss)} worse than the optimum of {b}."


def diff(
    a: Any,
    b: Any,
    data: Any = None,
    *,
    time_limit: float | None = None,
    **parameters: float,
) -> Difference:
    """What differs between two programs, and whether the optimum of each is one of the other.

    Parameters
    ----------
    a, b : cvxpy.Problem, str, Formulation, path or Program
        Any linear (integer) problems of cvxpy; formulations, which take `data`; files in MPS or LP
        format; or arrays.
    data
        What the formulations' stage takes, for instance `ClusterData`.
    time_limit : float, optional
        Seconds for solving. When they are over, what is known by then is given.
    **parameters : float
        The formulations' parameters, for instance ``psi``; each takes those that it has.

    Raises
    ------
    InputError
        If a name, a file, the time limit or a parameter is wrong.
    ModelError
        If one cannot be built as a linear integer program.
    """
    clock = Clock(time_limit)
    first, second = _subjects((a, b), data, parameters)
    with interruptible():
        return _difference(first, second, clock)


def _subjects(programs: Sequence[Any], data: Any, parameters: Mapping[str, float]) -> list[Subject]:
    from ..optimise import registry
    from ..optimise.export import is_program

    found = [registry.get(x) if isinstance(x, str) and not is_program(x) else x for x in programs]
    own = own_parameters(found, parameters)
    return [subject(x, data, **values) for x, values in zip(found, own, strict=True)]


def _difference(a: Subject, b: Subject, clock: Clock) -> Difference:
    names = (a.name, b.name) if a.name != b.name else (f"{a.name} (first)", f"{b.name} (second)")
    one, two = a.described, b.described
    columns = _column_places(one), _column_places(two)
    both = [name for name in columns[0] if name in columns[1]]
    rows = named_rows(one), named_rows(two)
    alone = [[name for name in rows[i] if name not in rows[1 - i]] for i in (0, 1)]
    renamed = _renamed(rows, alone)
    gone, new = {old for old, _ in renamed}, {name for _, name in renamed}
    solutions = [_solved(item.program, clock) for item in (a, b)]
    return Difference(
        *names,
        sense=(one.sense, two.sense),
        variables_a=tuple(name for name in columns[0] if name not in columns[1]),
        variables_b=tuple(name for name in columns[1] if name not in columns[0]),
        domains=_domains(one, two, both, columns),
        costs=_costs(one, two, both, columns),
        rows_a=tuple(name for name in alone[0] if name not in gone),
        rows_b=tuple(name for name in alone[1] if name not in new),
        rows=tuple(
            Changed(name, rows[0][name].label, rows[0][name].changes(rows[1][name]))
            for name in rows[0]
            if name in rows[1] and rows[0][name].changes(rows[1][name])
        ),
        renamed=renamed,
        a_in_b=_tried(one, solutions[0], two, solutions[1], columns, clock),
        b_in_a=_tried(two, solutions[1], one, solutions[0], columns[::-1], clock),
    )


def _column_places(program: Program) -> dict[str, int]:
    return {name: j for j, name in enumerate(program.column_names)}


Places = tuple[dict[str, int], dict[str, int]] | tuple[dict[str, int], ...]


def _domains(a: Program, b: Program, both: list[str], places: Places) -> tuple[Changed, ...]:
    found = []
    for name in both:
        (i, j), changes = (places[0][name], places[1][name]), []
        for sign, old, new in (
            ("≥", a.lower[i], b.lower[j]),
            ("≤", a.upper[i], b.upper[j]),
        ):
            if old != new:
                changes.append(f"{sign} {in_full(old)} → {sign} {in_full(new)}")
        if a.integer[i] != b.integer[j]:
            words = ["continuous", "integer"]
            changes.append(f"{words[bool(a.integer[i])]} → {words[bool(b.integer[j])]}")
        if changes:
            found.append(Changed(name, name.partition("[")[0], tuple(changes)))
    return tuple(found)


def _costs(a: Program, b: Program, both: list[str], places: Places) -> tuple[Changed, ...]:
    found = []
    for name in both:
        old, new = float(a.cost[places[0][name]]), float(b.cost[places[1][name]])
        if abs(old - new) > SAME * max(abs(old), abs(new)):
            found.append(
                Changed(name, name.partition("[")[0], (f"{in_full(old)} → {in_full(new)}",))
            )
    if abs(a.offset - b.offset) > SAME * max(abs(a.offset), abs(b.offset)):
        found.append(
            Changed("constant", "constant", (f"{in_full(a.offset)} → {in_full(b.offset)}",))
        )
    return tuple(found)


def _renamed(
    rows: tuple[dict[str, Row], dict[str, Row]], alone: list[list[str]]
) -> tuple[tuple[str, str], ...]:
    """Pairs of names, one of each program, whose rows say the same."""
    open_: dict[Any, list[str]] = {}
    for name in alone[1]:
        open_.setdefault(rows[1][name].statement, []).append(name)
    found = []
    for name in alone[0]:
        same = open_.get(rows[0][name].statement)
        if same:
            found.append((name, same.pop(0)))
    return tuple(found)


def _solved(program: Program, clock: Clock) -> Solution:
    if clock.is_up:
        return Solution("", "no_solution", program.sense)
    share = None if clock.left is None else clock.left / 3
    return solve_program(program, options=Options(time_limit=share))


def _tried(
    a: Program, solution: Solution, b: Program, other: Solution, places: Places, clock: Clock
) -> Transfer:
    """The optimum of `a` in `b`."""
    if not solution.found:
        return Transfer(None, solution.status)
    x = a.flat(solution.values)
    value = a.value(x)
    if clock.is_up:
        return Transfer(value, solution.status)
    common = [n for n in places[0] if n in places[1] and not n.startswith(AUXILIARY)]
    point = _point(x, b, common, places)
    if point is not None:
        broken = _broken(b, point)
        if broken:
            return Transfer(value, solution.status, False, broken=broken)
        return _feasible(value, solution, b, point, other)
    whole = [n for n in common if b.integer[places[1][n]] and a.integer[places[0][n]]]
    given = {places[1][n]: float(x[places[0][n]]) for n in whole or common}
    inside = all(b.lower[j] <= v <= b.upper[j] for j, v in given.items())
    fixed = with_bounds(b, given)
    if inside:
        found = solve_program(fixed, options=Options(time_limit=clock.left))
        if found.found:
            return _feasible(value, solution, b, b.flat(found.values), other)
    conflict = find_conflict(with_rows(b, given), time_limit=clock.left)
    if conflict.status != "infeasible":
        return Transfer(value, solution.status)
    mine = {fixing_name(b, j, v) for j, v in given.items()}
    broken = (*(row for row in conflict.rows if row not in mine), *conflict.bounds)
    return Transfer(value, solution.status, False, broken=broken)


def _point(x: Floats, b: Program, common: list[str], places: Places) -> Floats | None:
    """`x` as a point of `b`, if its variables say all and none of them may follow others."""
    if len(common) < b.n_columns or (b.integer.any() and not b.integer.all()):
        return None
    point = np.zeros(b.n_columns)
    for name in common:
        point[places[1][name]] = x[places[0][name]]
    return point


def _broken(program: Program, x: Floats) -> tuple[str, ...]:
    """Every row that `x` breaks, by how much, and the bounds."""
    missed, allowed = row_misses(program, x)
    rows = [
        f"{program.row_name(int(i))}, by {missed[i]:.6g}"
        for i in np.flatnonzero(~(missed <= allowed))
    ]
    if not rows:
        return tuple(violations(program, x))
    outside = np.flatnonzero((x < program.lower - 1e-6) | (x > program.upper + 1e-6))
    return (
        *rows,
        *(f"{program.column_name(int(j))} = {in_full(x[j])}, beyond its bounds" for j in outside),
    )


def _feasible(
    value: float, solution: Solution, b: Program, point: Floats, other: Solution
) -> Transfer:
    there, loss = b.value(point), None
    if other.status == "optimal" and other.objective is not None:
        loss = b.sign * (there - other.objective)
        loss = 0.0 if loss <= SAME * objective_size(b, other.objective) else loss
    return Transfer(value, solution.status, True, there, loss)
