"""What changes from one solve of a formulation to the next, as its file is edited."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..mission.counting import in_full
from ..optimise.assigned import Assigned, assigned
from ..optimise.compile import compile_for
from ..optimise.program import Program
from ..optimise.registry import Formulation
from ..optimise.solution import Solution
from ..optimise.solve import AUTO, solve_program
from ..optimise.solvers import Options
from .lists import under
from .rows import Row, named_rows

LISTED = 6
"""Rows, columns or costs that changed in one way and are told."""


@dataclass(frozen=True, eq=False)
class Built:
    """A formulation on its data, as a program, not yet solved."""

    program: Program
    structure: str
    """What its matrix proves, in words; empty for nothing."""
    rows: dict[str, Row]
    columns: dict[str, str]
    """By name, the bounds and whether it is integer, in words."""
    costs: dict[str, float]

    @property
    def lines(self) -> list[str]:
        """All of it, as the first thing that is shown."""
        structure = self.structure or "no structure recognised"
        return [f"{len(self.columns)} variables, {len(self.rows)} rows; {structure}"]


@dataclass(frozen=True, eq=False)
class Solved:
    """What a solver found of it."""

    solution: Solution
    gets: Assigned

    @property
    def lines(self) -> list[str]:
        """All of it, as what is shown first."""
        return [
            _result(self.solution),
            *(f"{who}: {_list(what)}" for who, what in self.gets.items()),
        ]


def built(formulation: Formulation, data: Any, **parameters: float) -> Built:
    """Compile `formulation` for `data`; the parameters that it does not have are left out.

    Raises
    ------
    MsmrtaError
        If it cannot be built.
    """
    compiled = compile_for(formulation, data)
    program = compiled.program(**formulation.takes(**parameters))
    structure = compiled.structure(program)
    names = program.column_names
    kinds = ("continuous", "integer")
    domains = (
        f"{in_full(low)} to {in_full(high)}, {kinds[whole]}"
        for low, high, whole in zip(
            program.lower.tolist(), program.upper.tolist(), program.integer.tolist(), strict=True
        )
    )
    return Built(
        program,
        structure.description if structure else "",
        named_rows(program),
        dict(zip(names, domains, strict=True)),
        dict(zip(names, program.cost.tolist(), strict=True)),
    )


def solved(program: Program, *, solver: str = AUTO, time_limit: float | None = None) -> Solved:
    """Solve `program`.

    Raises
    ------
    MsmrtaError
        If it cannot be solved.
    """
    solution = solve_program(program, solver=solver, options=Options(time_limit=time_limit))
    return Solved(solution, assigned(program, solution) if solution.found else {})


def program_changes(before: Built, after: Built) -> list[str]:
    """What the program `after` has that `before` had not, and the other way round."""
    lines = []
    if before.structure != after.structure:
        if not after.structure:
            lines.append(f"structure lost: {before.structure}")
        else:
            lines.append(
                f"structure {'kept, now' if before.structure else 'won'}: {after.structure}"
            )
    lines += _parts("rows", before.rows, after.rows)
    lines += _parts("columns", before.columns, after.columns)
    costs = [
        f"{n}: {in_full(before.costs[n])} → {in_full(after.costs[n])}"
        for n in before.costs
        if n in after.costs and before.costs[n] != after.costs[n]
    ]
    return lines + under("costs changed", costs, LISTED)


def solution_changes(before: Solved, after: Solved) -> list[str]:
    """What `after` says that `before` did not: status, objective, bound, and who gets what."""
    old, new = before.solution, after.solution
    lines = [
        f"{what}: {a} → {b}"
        for what, a, b in (
            ("status", old.status, new.status),
            ("sense", old.sense, new.sense),
            ("objective", _number(old.objective), _number(new.objective)),
            ("bound", _number(old.bound), _number(new.bound)),
        )
        if a != b
    ]
    for who in dict.fromkeys((*before.gets, *after.gets)):
        had, has = before.gets.get(who), after.gets.get(who)
        if had != has:
            lines.append(f"{who}: {_list(had)} → {_list(has)}")
    return lines


def _parts(what: str, a: dict[str, Any], b: dict[str, Any]) -> list[str]:
    return [
        *under(f"{what} gone", [name for name in a if name not in b], LISTED),
        *under(f"{what} added", [name for name in b if name not in a], LISTED),
        *under(f"{what} changed", _changed(a, b), LISTED),
    ]


def _changed(a: dict[str, Any], b: dict[str, Any]) -> list[str]:
    found = []
    for name in a:
        if name in b and a[name] != b[name]:
            if isinstance(a[name], Row):
                changes = a[name].changes(b[name])
                if changes:
                    found.append(f"{name}: {'; '.join(changes[:3])}{'; …' * (len(changes) > 3)}")
            else:
                found.append(f"{name}: {a[name]} → {b[name]}")
    return found


def _result(found: Solution) -> str:
    if not found.found:
        return f"{found.status}{f': {found.message}' if found.message else ''}"
    return (
        f"{found.status}: {_number(found.objective)} ({found.sense}), bound {_number(found.bound)}"
        f", by {found.solver}"
    )


def _number(value: float | None) -> str:
    return "none" if value is None else in_full(value)


def _list(names: tuple[str, ...] | None) -> str:
    return ", ".join(names) if names else "nothing"
