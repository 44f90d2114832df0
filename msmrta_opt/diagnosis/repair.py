"""The smallest repair of an infeasible program: which rows to relax by how much, weighted by label.

A program of its own (the elastic program of Brown and Graves 1975): each row may be missed on either
side, by an artificial variable of its own, and the weighted sum of these is minimised; bounds and
integrality stay, but for bounds of variables that are given a weight, too. Its optimum is proved in
exact numbers where that is possible in time (`proofs`), and the amounts are then exact.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Floats
from ..mission.counting import in_full, told_apart
from ..mission.errors import CheckError, InputError, SolverError
from ..optimise.program import Block, Program
from ..optimise.solve import solve_program
from ..optimise.solvers import Options
from .clock import Clock
from .signs import signs

PROOF_SECONDS = 20.0
"""For the proof in exact numbers, where no limit is given."""
WHOLE = 1e-9
"""Amounts up to this are rounding, where they are not exact."""


@dataclass(frozen=True)
class Relaxed:
    """A row, or a bound of a variable, whose side is moved."""

    name: str
    side: float
    """Its side now."""
    by: float
    """How far it moves: down from a side ``≥``, up from a side ``≤``."""
    is_lower: bool
    """Whether its side is one of ``≥``."""
    exact: Fraction | None = None
    """`by` in exact numbers, if it is proved."""
    is_equation: bool = False
    """Whether it has the same side on the other side, too, which moves along."""

    @property
    def text(self) -> str:
        """For instance ``robot 2 has at most one cluster: ≤ 2 instead of ≤ 1``."""
        sign, moved = ("≥", self.side - self.by) if self.is_lower else ("≤", self.side + self.by)
        sign = "=" if self.is_equation else sign
        new, old = told_apart(moved, self.side, digits=6)
        return f"{self.name}: {sign} {new} instead of {sign} {old}"


@dataclass(frozen=True)
class Repair:
    """The least that has to give way so that a program has a solution."""

    rows: tuple[Relaxed, ...] = ()
    cost: float | None = None
    """The amounts times their weights, summed; ``None`` if there is no repair, or none was found."""
    proof: str = ""
    """How it is known that no repair is cheaper; empty if it is not."""
    message: str = ""
    """Why there is none."""
    point: Mapping[str, Any] | None = None
    """A point that is feasible then, by variable."""

    @property
    def text(self) -> str:
        """The repair in words, a line for each row."""
        if self.cost is None:
            return f"No repair: {self.message}."
        claim = f"none is cheaper ({self.proof})" if self.proof else "a cheaper one may exist"
        lines = [f"  {item.text}" for item in self.rows]
        return "\n".join([f"Smallest repair, of cost {in_full(self.cost)}; {claim}:", *lines])


def repair(
    program: Program,
    *,
    weights: Mapping[str, float] | None = None,
    time_limit: float | None = None,
) -> Repair:
    """The minimum-cost repair of `program`.

    Parameters
    ----------
    program : Program
        An infeasible one.
    weights : dict of str to float, optional
        What a unit of relaxation costs, by the label of rows (by default 1), or by the name of a
        variable for its bounds (by default they stay); ``inf`` for what must stay.
    time_limit : float, optional
        Seconds.

    Raises
    ------
    InputError
        If a weight is negative, or of what the program does not have.
    """
    clock = Clock(time_limit)
    elastic = _Elastic(program, _weights(program, weights or {}))
    if elastic.program.n_columns == program.n_columns:
        return Repair(message="nothing is allowed to give way")
    solution = solve_program(elastic.program, options=Options(time_limit=clock.left))
    if not solution.found:
        if solution.status == "infeasible":
            stays = "what must stay, and the bounds of the variables, conflict by themselves"
            return Repair(message=stays)
        return Repair(message=f"{solution.status}, {solution.message or 'no solution in time'}")
    x = elastic.program.flat(solution.values)
    found = Repair(
        elastic.relaxed(x.tolist()),
        elastic.program.value(x),
        proof=solution.proof if solution.status == "optimal" else "",
        point=program.shaped(x[: program.n_columns]),
    )
    if solution.status != "optimal":
        return found
    from ..proofs.prove import prove_program

    with tempfile.TemporaryDirectory() as folder:
        limit = PROOF_SECONDS if clock.left is None else min(clock.left, PROOF_SECONDS)
        try:
            proof = prove_program(
                elastic.program, solution, Path(folder) / "repair.vipr", time_limit=limit
            )
        except (CheckError, SolverError):
            return found
    if proof.status != "proved" or proof.exact_point is None or proof.exact_value is None:
        return found
    exact, is_equal = list(proof.exact_point), proof.exact_value == proof.exact_bound
    return replace(
        found,
        rows=elastic.relaxed(exact),
        cost=float(proof.exact_value),
        proof="proved in exact numbers" if is_equal else "proved to 1e-9",
        point=program.shaped(np.array([float(v) for v in exact[: program.n_columns]])),
    )


def _weights(program: Program, given: Mapping[str, float]) -> dict[str, float]:
    """The weight of each label and each variable."""
    known = {block.name: 1.0 for block in program.rows}
    known |= {block.name: math.inf for block in program.columns}
    for name, weight in given.items():
        if name not in known:
            raise InputError(
                f"no rows and no variable {name!r}; there are {', '.join(map(repr, known))}",
                field="weights",
            )
        if not weight >= 0:
            raise InputError(
                f"{in_full(weight)}; give 0 or more, or inf", field=f"weights[{name!r}]"
            )
    return {**known, **given}


class _Elastic:
    """`program` with artificial variables, in pairs of what is relaxed and on which side."""

    def __init__(self, program: Program, weights: Mapping[str, float]) -> None:
        from scipy.sparse import csr_array, hstack, vstack

        self.own = program
        row_weight = _by_block(program.rows, weights, program.n_rows, 1.0)
        bound_weight = _by_block(program.columns, weights, program.n_columns, math.inf)
        loose = np.isfinite(bound_weight)
        bounds = np.flatnonzero(loose & (np.isfinite(program.lower) | np.isfinite(program.upper)))
        n_rows, n_bounds = program.n_rows, len(bounds)
        picked = csr_array(
            (np.ones(n_bounds), (np.arange(n_bounds), bounds)), (n_bounds, program.n_columns)
        )
        matrix = vstack([program.matrix, picked])
        lower = np.append(program.row_lower, program.lower[bounds])
        upper = np.append(program.row_upper, program.upper[bounds])
        weight = np.append(row_weight, bound_weight[bounds])
        self.names = [program.row_name(i) for i in range(n_rows)]
        self.names += [program.column_name(int(j)) for j in bounds]
        below = np.flatnonzero(np.isfinite(lower) & np.isfinite(weight))
        above = np.flatnonzero(np.isfinite(upper) & np.isfinite(weight))
        self.places = [(int(i), True) for i in below] + [(int(i), False) for i in above]
        self.lower, self.upper = lower, upper
        self.signs = np.append(signs(program), np.ones(n_bounds))
        n_new = len(self.places)
        at = np.array([i for i, _ in self.places], dtype=np.int64)
        sign = np.array([1.0 if is_lower else -1.0 for _, is_lower in self.places])
        artificial = csr_array((sign, (at, np.arange(n_new))), (n_rows + n_bounds, n_new))
        new = Block("artificial variable", program.n_columns, (n_new,))
        free = np.isin(np.arange(program.n_columns), bounds)
        self.program = Program(
            sense="min",
            cost=np.append(np.zeros(program.n_columns), weight[at]),
            offset=0.0,
            matrix=csr_array(hstack([matrix, artificial])),
            row_lower=lower,
            row_upper=upper,
            lower=np.append(np.where(free, -np.inf, program.lower), np.zeros(n_new)),
            upper=np.append(np.where(free, np.inf, program.upper), np.full(n_new, np.inf)),
            integer=np.append(program.integer, np.zeros(n_new, dtype=bool)),
            columns=(*program.columns, new),
            rows=(*program.rows, Block("bound", n_rows, (n_bounds,))),
        )

    def relaxed(self, point: list[Any]) -> tuple[Relaxed, ...]:
        """What gives way at `point`, in floats or in exact numbers."""
        found = []
        for (i, is_lower), by in zip(self.places, point[self.own.n_columns :], strict=False):
            if by > (WHOLE if isinstance(by, float) else 0):
                side = float((self.lower if is_lower else self.upper)[i] * self.signs[i])
                exact = None if isinstance(by, float) else Fraction(by)
                as_told = is_lower == bool(self.signs[i] > 0)
                equal = i < self.own.n_rows and bool(self.lower[i] == self.upper[i])
                found.append(Relaxed(self.names[i], side, float(by), as_told, exact, equal))
        return tuple(found)


def _by_block(
    blocks: tuple[Block, ...], weights: Mapping[str, float], n: int, default: float
) -> Floats:
    found = np.full(n, default)
    for block in blocks:
        found[block.start : block.stop] = weights[block.name]
    return found
