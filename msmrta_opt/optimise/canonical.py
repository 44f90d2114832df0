"""The numbers of a linear program, from the cvxpy problem that states it, by one of two roads.

A problem that is made of affine atoms alone is already in the form that a solver wants: the coefficients
of its expressions are the costs and rows, and are read off as they stand. Any other (a maximum, an
absolute value, a variable with an attribute that asks for rows) goes through cvxpy's reductions, which
restate it first. Where the short road is open, both lead to the same numbers; it is several times as
quick, and leaves to the other whatever it does not know.

Either way a new value of a parameter costs a sparse product at most, not a canonicalisation.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import cvxpy as cp
import numpy as np
from cvxpy.constraints import Equality, Inequality
from cvxpy.error import DCPError, DPPError, ParameterError, SolverError
from scipy.sparse import coo_array, csr_array

from ..arrays import Bools, Floats, Ints
from ..mission.errors import ModelError
from .program import Block

if TYPE_CHECKING:
    from .coefficients import Coefficients, Reader

AUXILIARY = "auxiliary"
"""Name of columns and rows that cvxpy adds, for instance for a maximum in the objective."""
PLAIN_ATTRIBUTES = {"boolean", "integer", "bounds", "nonneg", "nonpos"}
"""Attributes of variables that are bounds and integrality of columns, and nothing else."""


class Numbers(NamedTuple):
    """Costs, rows and bounds at some values of the parameters, in the problem's own sense.

    Rows are ``matrix @ x = right`` for the first `Canonical.n_equations`, ``≤ right`` for the others.
    """

    cost: Floats
    offset: float
    matrix: csr_array
    right: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, eq=False)
class Canonical:
    """A problem restated in arrays."""

    numbers: Callable[[], Numbers]
    """The numbers at the present values of the problem's parameters."""
    n_equations: int
    integer: Bools
    columns: tuple[Block, ...]
    rows: tuple[Block, ...]


def canonicalise(name: str, problem: cp.Problem) -> Canonical:
    """`problem`, of the formulation `name`, in arrays. Its parameters are scalars and have values.

    Raises
    ------
    ModelError
        If it is not a linear (integer) program, whatever the values of its parameters.
    """
    return read_off(problem) or reduced(name, problem)


# The short road.


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
        _named(variables, starts, {item.id: item for item in variables}),
        _labelled(problem, constraints),
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


# The long road.


def reduced(name: str, problem: cp.Problem) -> Canonical:
    """`problem` by cvxpy's reductions; see `canonicalise`."""
    try:
        with warnings.catch_warnings():
            # Which of its backends cvxpy takes is its own affair.
            warnings.filterwarnings("ignore", message=".*Defaulting to the .* backend")
            data, _, _ = problem.get_problem_data(cp.HIGHS)
    except (DCPError, DPPError, ParameterError, SolverError, ValueError) as error:
        first = str(error).strip().splitlines()[0]
        raise ModelError(f"{name}: not a linear integer program: {first}") from error
    cone = data["param_prob"]
    if getattr(cone, "P", None) is not None or data.get("P") is not None:
        raise ModelError(f"{name}: not a linear integer program: the objective is quadratic")
    own = {variable.id: variable for variable in problem.variables()}
    for variable in cone.variables:
        if variable.id in own and own[variable.id].shape != variable.shape:
            raise ModelError(
                f"{name}: variable {own[variable.id].name()} has an attribute that changes its"
                " shape; state it as a constraint"
            )
    boolean, integer = _flat(cone.x.boolean_idx), _flat(cone.x.integer_idx)
    is_integer = np.zeros(cone.x.size, dtype=bool)
    is_integer[boolean + integer] = True
    # cvxpy minimises, and states rows as `A x + b = 0`, then `A x + b ≥ 0`.
    sign = -1.0 if isinstance(problem.objective, cp.Maximize) else 1.0

    def numbers() -> Numbers:
        cost, offset, matrix, constant = cone.apply_parameters()
        lower = np.full(cone.x.size, -np.inf)
        upper = np.full(cone.x.size, np.inf)
        if cone.lower_bounds is not None:
            lower[:] = cone.lower_bounds
        if cone.upper_bounds is not None:
            upper[:] = cone.upper_bounds
        lower[boolean] = np.maximum(lower[boolean], 0.0)
        upper[boolean] = np.minimum(upper[boolean], 1.0)
        right = np.asarray(constant, float).ravel()
        cost = sign * np.asarray(cost, float).ravel()
        return Numbers(cost, sign * float(offset), (-matrix).tocsr(), right, lower, upper)

    starts = [cone.var_id_to_col[variable.id] for variable in cone.variables]
    return Canonical(
        numbers,
        cone.cone_dims.zero,
        is_integer,
        _named(cone.variables, starts, own),
        _labelled(problem, cone.constraints),
    )


def _flat(indices: list[tuple[int, ...]]) -> list[int]:
    return [int(index[0]) for index in indices]


# The names, on both.


def _named(
    variables: list[cp.Variable], starts: list[int], own: dict[int, cp.Variable]
) -> tuple[Block, ...]:
    """The columns, by the names of those that the problem has of its own."""
    blocks: list[Block] = []
    for variable, start in zip(variables, starts, strict=True):
        label = own[variable.id].name() if variable.id in own else AUXILIARY
        if label in {block.name for block in blocks}:
            label = f"{label}_{variable.id}"
        blocks.append(Block(label, start, variable.shape))
    return tuple(sorted(blocks, key=lambda block: block.start))


def _labelled(problem: cp.Problem, constraints: list[cp.Constraint]) -> tuple[Block, ...]:
    """The rows of `constraints`, by the labels or places of those that the problem has of its own."""
    own = {constraint.id: constraint for constraint in problem.constraints}
    place = {constraint.id: i + 1 for i, constraint in enumerate(problem.constraints)}
    blocks, start = [], 0
    for constraint in constraints:
        original = own.get(constraint.id)
        if original is None:
            block = Block(AUXILIARY, start, (constraint.size,))
        elif original.label is None:
            block = Block(f"constraint {place[original.id]}", start, original.shape)
        else:
            block = Block(original.label, start, original.shape)
        blocks.append(block)
        start += constraint.size
    return tuple(blocks)
