"""The linear relaxation of a program as one live HiGHS model, warm-started from solve to solve.

What comes from here is a hint and nothing more: floating-point numbers, from which `multipliers` makes
exact ones. So rows and columns may be scaled (by powers of two), and integers be written as floats.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..arrays import Bools, Floats
from ..optimise.scaling import Scaling
from ..optimise.solvers.highs import new_highs
from .exact import ExactProgram, Rational, Row


@dataclass(frozen=True)
class Relaxed:
    """What HiGHS says of the relaxation between some bounds.

    `duals` (shape ``(n_rows,)``) are multipliers of the rows in integers: of an optimal solution, or, if
    it is infeasible, of a combination that no point satisfies.
    """

    status: Literal["optimal", "infeasible", "unbounded", "unknown"]
    value: float = math.nan
    x: Floats | None = None
    duals: Floats | None = None


class Relaxation:
    """The relaxation of `program`, whose bounds can be changed and to which rows can be added."""

    def __init__(self, program: ExactProgram, factors: Scaling) -> None:
        import highspy

        self.program = program
        self._statuses = highspy.HighsModelStatus
        self._highs: Any = new_highs()
        for name, value in {
            "output_flag": False,
            "threads": 1,
            "solver": "simplex",
            "presolve": "off",
            "primal_feasibility_tolerance": 1e-9,
            "dual_feasibility_tolerance": 1e-9,
            "small_matrix_value": 1e-12,
        }.items():
            self._highs.setOptionValue(name, value)
        self._scale_rows: Floats = np.array(
            [
                factors.row[i] / row.factor
                for i, row in zip(program.row_of, program.rows, strict=True)
            ]
        )
        extra = np.ones(program.n_columns - len(factors.column))
        self._scale_columns: Floats = np.concatenate([factors.column, extra])
        self._scale_cost = factors.objective
        lower = [_float(b, -math.inf) for b in program.lower]
        upper = [_float(b, math.inf) for b in program.upper]
        cost = np.array([float(c) for c in program.cost]) * self._scale_columns * self._scale_cost
        self._cost: Floats = cost
        n = program.n_columns
        nothing = np.array([], dtype=np.int32)
        self._highs.addCols(
            n, cost, np.array(lower) / self._scale_columns, np.array(upper) / self._scale_columns,
            0, nothing, nothing, np.array([]),
        )  # fmt: skip
        self.bounds: list[tuple[Rational | None, Rational | None]] = list(
            zip(program.lower, program.upper, strict=True)
        )
        """Of each column, as they are now."""
        self._crossed: set[int] = set()
        """Columns with a lower bound above the upper one, of which HiGHS is not told."""
        self.n_rows = 0
        self._add(program.rows, self._scale_rows)

    def add_rows(self, rows: Sequence[Row]) -> None:
        """Add rows, for instance cuts."""
        scales = [2.0 ** -math.frexp(max(map(abs, row.coefficients)))[1] for row in rows]
        self._scale_rows = np.concatenate([self._scale_rows, scales])
        self._add(rows, np.array(scales))

    def remove_rows(self, rows: Sequence[int]) -> None:
        """Remove the rows of these positions."""
        self._highs.deleteRows(len(rows), np.array(rows, dtype=np.int32))
        self._scale_rows = np.delete(self._scale_rows, rows)
        self.n_rows -= len(rows)

    def _add(self, rows: Sequence[Row], scales: Floats) -> None:
        starts: list[int] = [0]
        columns: list[int] = []
        data: list[float] = []
        for row, scale in zip(rows, scales.tolist(), strict=True):
            columns.extend(row.columns)
            data.extend(_times(a, scale) for a in row.coefficients)
            starts.append(len(columns))
        lower = [_float(row.lower, -math.inf) for row in rows] * scales
        upper = [_float(row.upper, math.inf) for row in rows] * scales
        index = np.array(columns, dtype=np.int32)
        self._highs.addRows(
            len(rows), lower, upper, len(columns),
            np.array(starts[:-1], dtype=np.int32), index, np.array(data) * self._scale_columns[index],
        )  # fmt: skip
        self.n_rows += len(rows)

    def set_bounds(self, column: int, lower: Rational | None, upper: Rational | None) -> None:
        """Change the bounds of a column."""
        if self.bounds[column] == (lower, upper):
            return
        self.bounds[column] = (lower, upper)
        if lower is not None and upper is not None and lower > upper:
            self._crossed.add(column)
            return
        self._crossed.discard(column)
        scale = float(self._scale_columns[column])
        low, high = _float(lower, -math.inf), _float(upper, math.inf)
        self._highs.changeColBounds(column, low / scale, high / scale)

    def forget_cost(self) -> None:
        """Ask for any feasible point."""
        n = self.program.n_columns
        self._highs.changeColsCost(n, np.arange(n, dtype=np.int32), np.zeros(n))

    def restore_cost(self) -> None:
        """Ask for the best point again."""
        n = self.program.n_columns
        self._highs.changeColsCost(n, np.arange(n, dtype=np.int32), self._cost)

    def solve(self, *, iterations: int | None = None, time_limit: float | None = None) -> Relaxed:
        """Solve it between the present bounds, by at most so many iterations, in so many seconds."""
        highs, statuses = self._highs, self._statuses
        if self._crossed:
            return Relaxed("infeasible", math.inf, None, np.zeros(self.n_rows))
        highs.setOptionValue(
            "simplex_iteration_limit", 2**31 - 1 if iterations is None else iterations
        )
        if time_limit is not None:
            highs.setOptionValue("time_limit", highs.getRunTime() + max(time_limit, 0.0))
        highs.run()
        status = highs.getModelStatus()
        if status in (statuses.kOptimal, statuses.kModelEmpty):
            return self._optimal()
        if status in (statuses.kInfeasible, statuses.kUnboundedOrInfeasible):
            return self._infeasible()
        if status == statuses.kUnbounded:
            return Relaxed("unbounded")
        if iterations is not None and status == statuses.kIterationLimit:
            return Relaxed("unknown", highs.getInfo().objective_function_value / self._scale_cost)
        return Relaxed("unknown")

    def basis(self) -> Any:
        """Where to start from again."""
        return self._highs.getBasis()

    def start_from(self, basis: Any) -> None:
        """Start from a basis kept before; rows added since are basic."""
        self._highs.setBasis(basis)

    def forget_basis(self) -> None:
        """Start from nothing."""
        self._highs.clearSolver()

    def basic(self) -> tuple[Bools, Bools]:
        """Which columns and which rows are basic."""
        basis = self._highs.getBasis()
        return (
            np.array([int(status) == 1 for status in basis.col_status]),
            np.array([int(status) == 1 for status in basis.row_status]),
        )

    def basic_columns(self) -> list[tuple[int, int]]:
        """Places in the tableau, and the columns that are basic there."""
        _, basic = self._highs.getBasicVariables()
        return [(place, j) for place, j in enumerate(np.asarray(basic).tolist()) if j >= 0]

    def tableau_row(self, place: int) -> Floats:
        """The weights of the rows (in integers) that give the row of the tableau, up to a factor."""
        weights: Floats = np.array(self._highs.getBasisInverseRow(place)[1]) * self._scale_rows
        largest = float(np.abs(weights).max(initial=0.0))
        return weights / largest if largest else weights

    def _optimal(self) -> Relaxed:
        solution = self._highs.getSolution()
        x = np.array(solution.col_value) * self._scale_columns
        duals = np.array(solution.row_dual) * self._scale_rows / self._scale_cost
        value = self._highs.getInfo().objective_function_value / self._scale_cost
        return Relaxed("optimal", value, x, duals)

    def _infeasible(self) -> Relaxed:
        _, exists, ray = self._highs.getDualRay()
        if not exists:
            # Without a cost, the dual simplex method ends at a ray.
            self.forget_cost()
            self._highs.run()
            if self._highs.getModelStatus() == self._statuses.kInfeasible:
                _, exists, ray = self._highs.getDualRay()
            status = self._highs.getModelStatus()
            self.restore_cost()
            if not exists:
                feasible = status in (self._statuses.kOptimal, self._statuses.kModelEmpty)
                return Relaxed("unbounded" if feasible else "unknown")
        duals = np.array(ray) * self._scale_rows
        largest = float(np.abs(duals).max(initial=0.0))
        return Relaxed("infeasible", math.inf, None, duals / largest if largest else duals)


def _float(number: Rational | None, infinity: float) -> float:
    if number is None:
        return infinity
    try:
        return float(number)
    except OverflowError:
        return math.copysign(math.inf, number)


def _times(number: int, scale: float) -> float:
    """The product, also where the integer alone is beyond floats."""
    try:
        return float(number) * scale
    except OverflowError:
        over, under = scale.as_integer_ratio()
        return (number * over) / under
