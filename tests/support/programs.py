"""Small programs as arrays, and the oracle for them: all integer points, one after the other."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cvxpy as cp
import numpy as np
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from msmrta_opt.optimise.formulation import Parameter, Spec
from msmrta_opt.optimise.program import Block, Program, Sense
from msmrta_opt.optimise.registry import Formulation
from msmrta_opt.optimise.solution import Solution

INF = float("inf")


def program(
    matrix: ArrayLike,
    row_upper: ArrayLike,
    cost: ArrayLike,
    *,
    row_lower: ArrayLike = -INF,
    lower: ArrayLike = 0.0,
    upper: ArrayLike = 1.0,
    integer: ArrayLike = True,
    sense: Sense = "min",
    offset: float = 0.0,
) -> Program:
    """A program on one variable ``x``, by default binary, with rows called "row 0", "row 1", …"""
    table = np.atleast_2d(np.asarray(matrix, float))
    n_rows, n_columns = table.shape
    return Program(
        sense=sense,
        cost=np.array(np.broadcast_to(np.asarray(cost, float), n_columns)),
        offset=offset,
        matrix=csr_array(table),
        row_lower=np.array(np.broadcast_to(np.asarray(row_lower, float), n_rows)),
        row_upper=np.array(np.broadcast_to(np.asarray(row_upper, float), n_rows)),
        lower=np.array(np.broadcast_to(np.asarray(lower, float), n_columns)),
        upper=np.array(np.broadcast_to(np.asarray(upper, float), n_columns)),
        integer=np.array(np.broadcast_to(np.asarray(integer, bool), n_columns)),
        columns=(Block("x", 0, (n_columns,)),),
        rows=(Block("row {i}", 0, (n_rows,)),),
    )


def feasible_points(program: Program) -> NDArray[np.float64]:
    """All feasible points of a pure integer program with finite bounds, one per row."""
    ranges = [
        np.arange(np.ceil(low), np.floor(high) + 1)
        for low, high in zip(program.lower, program.upper, strict=True)
    ]
    points = np.array(list(itertools.product(*ranges)), float).reshape(-1, program.n_columns)
    activity = points @ program.matrix.toarray().T
    inside = (activity >= program.row_lower - 1e-9) & (activity <= program.row_upper + 1e-9)
    feasible: NDArray[np.float64] = points[inside.all(axis=1)]
    return feasible


def best_value(program: Program) -> float | None:
    """The optimum of a pure integer program with finite bounds, ``None`` if it is infeasible."""
    points = feasible_points(program)
    if not len(points):
        return None
    values = points @ program.cost + program.offset
    return float(values.min() if program.sense == "min" else values.max())


def assert_solved_right(solution: Solution, best: float | None) -> None:
    """The solution says and proves what the oracle says."""
    if best is None:
        assert solution.status == "infeasible", solution
        assert solution.objective is None
        assert solution.values == {}
        return
    assert solution.status == "optimal", solution
    assert solution.check == "passed"
    assert solution.objective is not None
    assert solution.bound is not None
    assert abs(solution.objective - best) <= 1e-6
    assert abs(solution.bound - best) <= 1e-6


def formulation(
    build: Callable[[Any], Any], *, name: str = "trial", **parameters: Parameter
) -> Formulation:
    """A formulation that has no file."""
    return Formulation(name, Path(f"{name}.py"), Spec("cluster", name, parameters), "", build)


def problem(
    objective: cp.Minimize | cp.Maximize, constraints: list[Any] | None = None
) -> Formulation:
    """The formulation that is this one problem, whatever the data."""
    return formulation(lambda _: cp.Problem(objective, constraints or []))


def costs(n_columns: int) -> st.SearchStrategy[list[float]]:
    """Costs with ties, zeros and thirds."""
    third = st.integers(-6, 6).map(lambda number: number / 3)
    return st.lists(third, min_size=n_columns, max_size=n_columns)


@st.composite
def structured_matrices(draw: st.DrawFn) -> NDArray[np.int64]:
    """Matrices of 0 and ±1 with up to 4 rows and 6 columns, most of them of a known pattern."""
    n_rows, n_columns = draw(st.integers(1, 4)), draw(st.integers(1, 6))
    pattern = draw(st.sampled_from(["any", "two kinds of rows", "network", "interval"]))
    shape = (n_rows, n_columns)
    if pattern == "any":
        cells = st.lists(
            st.sampled_from([0, 0, 1, 1, -1]),
            min_size=n_rows * n_columns,
            max_size=n_rows * n_columns,
        )
        matrix = np.array(draw(cells)).reshape(shape)
    else:
        matrix = np.zeros(shape, dtype=np.int64)
        for column in range(n_columns):
            if pattern == "two kinds of rows":
                split = max(n_rows // 2, 1)
                matrix[draw(st.integers(0, split - 1)), column] = 1
                if split < n_rows:
                    matrix[draw(st.integers(split, n_rows - 1)), column] = 1
            elif pattern == "network":
                matrix[draw(st.integers(0, n_rows - 1)), column] += 1
                matrix[draw(st.integers(0, n_rows - 1)), column] -= 1
            else:
                first, last = sorted([draw(st.integers(0, n_rows)), draw(st.integers(0, n_rows))])
                matrix[first:last, column] = 1
        if draw(st.booleans()):
            matrix = np.vstack([matrix[: n_rows - 1], np.ones((1, n_columns), dtype=np.int64)])
    if draw(st.booleans()):
        signs = draw(st.lists(st.sampled_from([1, -1]), min_size=n_rows, max_size=n_rows))
        matrix = matrix * np.array(signs)[:, None]
    if draw(st.integers(0, 3)) == 0:
        matrix = matrix.T
    return matrix


@st.composite
def structured_programs(draw: st.DrawFn) -> Program:
    """Pure integer programs over `structured_matrices`, with right-hand sides of all kinds."""
    matrix = draw(structured_matrices())
    n_rows, n_columns = matrix.shape
    low, high = [], []
    for _ in range(n_rows):
        end = draw(st.integers(-1, 2))
        kind = draw(st.sampled_from(["at most", "at most", "at least", "equal", "range"]))
        low.append(-INF if kind == "at most" else end - 1 if kind == "range" else end)
        high.append(INF if kind == "at least" else end)
    return program(
        matrix,
        high,
        draw(costs(n_columns)),
        row_lower=low,
        upper=draw(st.lists(st.integers(0, 2), min_size=n_columns, max_size=n_columns)),
        sense=draw(st.sampled_from(["min", "max"])),
        offset=draw(st.integers(-2, 2)),
    )


@st.composite
def assignment_programs(draw: st.DrawFn, *, most_edits: int = 0) -> Program:
    """Assignments of 2 or 3 rows to 3 others: pairs may be missing or twofold, rows may have to
    be matched, their number may be given; then edited as a modeller might edit them.
    """
    n_left, n_right = draw(st.integers(2, 3)), draw(st.integers(2, 3))
    every_pair = list(itertools.product(range(n_left), range(n_right)))
    missing = draw(st.sets(st.sampled_from(every_pair), max_size=1))
    pairs = [pair for pair in every_pair if pair not in missing]
    if draw(st.integers(0, 3)) == 3:
        pairs.append(draw(st.sampled_from(pairs)))
    matrix = np.zeros((n_left + n_right, len(pairs)))
    for column, (left, right) in enumerate(pairs):
        matrix[left, column] = matrix[n_left + right, column] = 1
    low, high = np.full(n_left + n_right, -INF), np.ones(n_left + n_right)
    must = draw(st.sampled_from(["none", "left", "right", "some"]))
    if must == "left":
        low[:n_left] = 1
    elif must == "right":
        low[n_left:] = 1
    elif must == "some":
        low[draw(st.integers(0, n_left + n_right - 1))] = 1
    if draw(st.booleans()):
        number = min(n_left, n_right) - draw(st.sampled_from([0, 0, 1]))
        matrix = np.vstack([matrix, np.ones(len(pairs))])
        low, high = np.append(low, number), np.append(high, number)
    base = program(
        matrix,
        high,
        draw(costs(len(pairs))),
        row_lower=low,
        sense=draw(st.sampled_from(["min", "max"])),
        offset=draw(st.sampled_from([0.0, 1.5])),
    )
    for _ in range(draw(st.integers(0, most_edits))):
        base = draw(edits(base))
    return base


@st.composite
def edits(draw: st.DrawFn, base: Program) -> Program:
    """`base` with one change to its rows or bounds."""
    matrix = base.matrix.toarray()
    low, high = base.row_lower.copy(), base.row_upper.copy()
    lower, upper = base.lower.copy(), base.upper.copy()
    row = draw(st.integers(0, base.n_rows - 1))
    column = draw(st.integers(0, base.n_columns - 1))
    edit = draw(
        st.sampled_from(
            [
                "drop row",
                "right-hand side",
                "coefficient",
                "add row",
                "add empty row",
                "sign of row",
                "fix",
                "bound",
            ]
        )
    )
    if edit == "drop row" and base.n_rows > 1:
        matrix = np.delete(matrix, row, axis=0)
        low, high = np.delete(low, row), np.delete(high, row)
    elif edit == "right-hand side":
        high[row] += draw(st.sampled_from([-1, 1, 0.5]))
    elif edit == "coefficient":
        matrix[row, column] = draw(st.sampled_from([-1, 0, 1, 2]))
    elif edit == "add row":
        new = st.lists(st.sampled_from([0, 1]), min_size=base.n_columns, max_size=base.n_columns)
        matrix = np.vstack([matrix, draw(new)])
        low = np.append(low, draw(st.sampled_from([-INF, 0, 1])))
        high = np.append(high, 1)
    elif edit == "add empty row":
        matrix = np.vstack([matrix, np.zeros(base.n_columns)])
        low, high = np.append(low, draw(st.sampled_from([0, 1]))), np.append(high, 1)
    elif edit == "sign of row":
        matrix[row] *= -1
        low[row], high[row] = -high[row], -low[row]
    elif edit == "fix":
        lower[column] = upper[column] = draw(st.sampled_from([0, 1]))
    elif edit == "bound":
        unit = np.zeros(base.n_columns)
        unit[column] = 1
        matrix = np.vstack([matrix, unit])
        low, high = np.append(low, -INF), np.append(high, draw(st.sampled_from([0, 1])))
    return program(
        matrix,
        high,
        base.cost,
        row_lower=low,
        lower=lower,
        upper=upper,
        sense=base.sense,
        offset=base.offset,
    )
