"""The short way from cvxpy to numbers, for problems that are made of affine atoms alone.

Such a problem is already in the form that a solver wants: the coefficients of its expressions are the
costs and rows, and are read off as they stand. It is several times as quick as cvxpy's reductions, gives
the same numbers, and leaves to them whatever it does not know. A new value of a parameter then costs a
sum of what is there.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import cvxpy as cp
import numpy as np
from cvxpy.constraints import Equality, Inequality
from scipy.sparse import coo_array, csr_array

from ...arrays import Floats, Ints
from .canonical import Canonical, Numbers, constraint_blocks, variable_blocks

if TYPE_CHECKING:
    from .coefficients import Coefficients, Reader

PLAIN_ATTRIBUTES = {"boolean", "integer", "bounds", "nonneg", "nonpos"}
"""Attributes of variables that are bounds and integrality of columns, and nothing else."""


def read_off(problem: cp.Problem) -> Canonical | None:
    """`problem` by the coefficients of its expressions; ``None`` if they do not say all of it."""
    try:
        from .coefficients import Reader, are_affine
    except ImportError:  # a cvxpy that keeps elsewhere what this needs
        return None
    equations = [item for item in problem.constraints if type(item) is Equality]
    inequalities = [item for item in problem.constraints if type(item) is Inequality]
    constraints = equations + inequalities
    expressions = [problem.objective.expr, *(item.expr for item in constraints)]
    plain = len(constraints) == len(problem.constraints) and are_affine(expressions)
    if not plain or not all(map(_is_plain, problem.variables())):
        return None
    try:
        reader = Reader(problem)
        coefficients = reader.stacked(expressions)
    except (NotImplementedError, AttributeError, TypeError):  # the last two of another cvxpy
        return None
    variables, starts = reader.variables, reader.starts
    return Canonical(
        _Rows(reader, coefficients, sum(item.size for item in constraints)).numbers,
        sum(item.size for item in equations),
        np.concatenate([np.full(item.size, _is_integer(item)) for item in variables]),
        variable_blocks(variables, starts, {item.id: item for item in variables}),
        constraint_blocks(problem, constraints),
    )


def _is_plain(variable: cp.Variable) -> bool:
    """Whether all that `variable` has are numbers as bounds, and integrality throughout."""
    given = {name: value for name, value in variable.attributes.items() if _is_given(value)}
    bounds = given.get("bounds", ())
    return (
        given.keys() <= PLAIN_ATTRIBUTES
        and all(given.get(name, True) is True for name in PLAIN_ATTRIBUTES - {"bounds"})
        and all(isinstance(bound, (int, float, np.number, np.ndarray)) for bound in bounds)
    )


def _is_given(attribute: object) -> bool:
    return attribute is not None and attribute is not False


def _is_integer(variable: cp.Variable) -> bool:
    return bool(variable.attributes["boolean"] or variable.attributes["integer"])


class _Rows:
    """``c x + d`` and below it ``A x + b``, affine in the parameters."""

    def __init__(self, reader: Reader, found: Coefficients, n_rows: int) -> None:
        self._parameters = reader.parameters
        self._n_rows, self._n_columns = n_rows, reader.n_columns
        self._bounds = _bounds(reader.variables, reader.starts, reader.n_columns)
        found = found.at(found.row - 1)
        in_rows, constant = found.row >= 0, found.column == reader.n_columns
        self._objective = found.where(~in_rows)
        self._linear = found.where(in_rows & ~constant)
        self._constant = found.where(in_rows & constant)

    def numbers(self) -> Numbers:
        """The numbers at the present values of the parameters."""
        cost = self._sums(self._objective.column, self._objective, self._n_columns + 1)
        matrix, right = self._rows() if self._rows_vary else self._fixed_rows
        return Numbers(cost[:-1], float(cost[-1]), matrix, right, *self._bounds)

    def _values(self, given: Coefficients) -> Floats:
        weights = np.array([*(item.value for item in self._parameters), 1.0], dtype=float)
        values: Floats = given.number * weights[given.parameter]
        return values

    def _sums(self, place: Ints, given: Coefficients, n_places: int) -> Floats:
        return np.asarray(np.bincount(place, self._values(given), minlength=n_places), float)

    def _rows(self) -> tuple[csr_array, Floats]:
        at, shape = (self._linear.row, self._linear.column), (self._n_rows, self._n_columns)
        right = -self._sums(self._constant.row, self._constant, self._n_rows)
        return coo_array((self._values(self._linear), at), shape=shape).tocsr(), right

    @cached_property
    def _rows_vary(self) -> bool:
        either = np.concatenate([self._linear.parameter, self._constant.parameter])
        return bool(np.any(either < len(self._parameters)))

    @cached_property
    def _fixed_rows(self) -> tuple[csr_array, Floats]:
        return self._rows()


def _bounds(
    variables: list[cp.Variable], starts: list[int], n_columns: int
) -> tuple[Floats, Floats]:
    lower, upper = np.full(n_columns, -np.inf), np.full(n_columns, np.inf)
    for variable, start in zip(variables, starts, strict=True):
        own = slice(start, start + variable.size)
        given = variable.attributes
        if given["bounds"] is not None:
            low, high = (np.broadcast_to(bound, variable.shape) for bound in given["bounds"])
            lower[own], upper[own] = low.ravel(order="F"), high.ravel(order="F")
        if given["nonneg"] or given["boolean"]:
            lower[own] = np.maximum(lower[own], 0.0)
        if given["nonpos"]:
            upper[own] = np.minimum(upper[own], 0.0)
        if given["boolean"]:
            upper[own] = np.minimum(upper[own], 1.0)
    return lower, upper
