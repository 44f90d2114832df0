"""The short way from cvxpy to numbers, for problems that are made of affine atoms alone.

Such a problem is already in the form that a solver wants: the coefficients of its expressions are the
costs and rows, and are read off as they stand. It is several times as quick as cvxpy's reductions, gives
the same numbers, and leaves to them whatever it does not know. A new value of a parameter then costs a
sum of what is there; and the next problem of a formulation, made in the same way on other data, a
calculation with its constants, for where the coefficients are is known.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Sequence
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING

import cvxpy as cp
import numpy as np
from cvxpy.constraints import Equality, Inequality
from scipy.sparse import csr_array

from ...arrays import Floats, Ints
from .canonical import Canonical, Numbers, constraint_blocks, variable_blocks

if TYPE_CHECKING:
    from .coefficients import Coefficients

KEPT = 8
"""Ways in which problems of one formulation are made that are kept in mind."""
CANCELLED = 1e-15
"""Size of a sum, relative to that of its terms, up to which it is their rounding."""
PLAIN_ATTRIBUTES = {"boolean", "integer", "bounds", "nonneg", "nonpos"}
"""Attributes of variables that are bounds and integrality of columns, and nothing else."""


def read_off(problem: cp.Problem, patterns: Patterns | None = None) -> Canonical | None:
    """`problem` by the coefficients of its expressions; ``None`` if they do not say all of it.

    `patterns` are those of the formulation which has built it.
    """
    try:
        from .coefficients import Reader, are_affine
        from .fingerprint import Making
    except ImportError:  # a cvxpy that keeps elsewhere what this needs
        return None
    equations = [item for item in problem.constraints if type(item) is Equality]
    inequalities = [item for item in problem.constraints if type(item) is Inequality]
    constraints = equations + inequalities
    expressions = [problem.objective.expr, *(item.expr for item in constraints)]
    variables, parameters = problem.variables(), problem.parameters()
    if len(constraints) < len(problem.constraints) or not all(map(_is_plain, variables)):
        return None
    n_rows, sizes = sum(item.size for item in constraints), [item.size for item in variables]
    try:
        making = Making(problem, expressions)
        pattern = patterns.of(making.key) if patterns else None
        numbers = pattern.numbers(making.constants) if pattern else None
        if pattern is None or numbers is None:
            if not are_affine(expressions):
                return None
            found = Reader(problem, making.places).stacked(expressions)
            pattern, numbers = Pattern(found, n_rows, sum(sizes), len(parameters)), found.number
            if patterns:
                patterns.keep(making.key, pattern)
    except (NotImplementedError, AttributeError, TypeError):  # the last two of another cvxpy
        return None
    starts = [0, *accumulate(sizes)][:-1]
    return Canonical(
        _Rows(pattern, numbers, parameters, _bounds(variables, starts, sum(sizes))).numbers,
        sum(item.size for item in equations),
        np.repeat([_is_integer(item) for item in variables], sizes),
        variable_blocks(variables, starts, {item.id: item for item in variables}),
        constraint_blocks(problem, constraints),
    )


class Patterns:
    """Those of one formulation's problems, by how they are made: the last few."""

    def __init__(self) -> None:
        self._patterns: OrderedDict[Hashable, Pattern] = OrderedDict()

    def of(self, key: Hashable) -> Pattern | None:
        """That of problems with the fingerprint `key`."""
        return self._patterns.get(key)

    def keep(self, key: Hashable, pattern: Pattern) -> None:
        """Keep `pattern`, if there is a fingerprint to find it by."""
        if key is not None:
            self._patterns[key] = pattern
        while len(self._patterns) > KEPT:
            self._patterns.popitem(last=False)


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


class _Sums:
    """Numbers that add up at places, each times a parameter or 1."""

    def __init__(self, found: Coefficients, chosen: Ints, place: Ints, n_places: int) -> None:
        self._chosen, self._place, self._n_places = chosen, place, n_places
        self._parameter = found.parameter[chosen]

    def __call__(self, numbers: Floats, weights: Floats) -> Floats:
        """The sums at all places; `weights` are the values of the parameters, and a 1."""
        values = numbers[self._chosen] * weights[self._parameter]
        sums = np.asarray(np.bincount(self._place, values, self._n_places), float)
        if values.min(initial=0.0) >= 0 or values.max(initial=0.0) <= 0:
            return sums
        sizes = np.bincount(self._place, np.abs(values), self._n_places)
        # What is left of terms that cancel is no coefficient, but their rounding.
        sums[(np.abs(sums) <= CANCELLED * sizes) & np.isfinite(sizes)] = 0.0
        return sums

    def vary(self, n_parameters: int) -> bool:
        """Whether they depend on parameters."""
        return bool((self._parameter < n_parameters).any())


class Pattern:
    """Where the coefficients of ``c x + d``, and below it ``A x + b``, are, affine in the parameters."""

    def __init__(self, found: Coefficients, n_rows: int, n_columns: int, n_parameters: int) -> None:
        self._again = found.again
        in_rows, constant = found.row > 0, found.column == n_columns
        objective, right = np.flatnonzero(~in_rows), np.flatnonzero(in_rows & constant)
        self._matrix = np.flatnonzero(in_rows & ~constant)
        self._there = found.number[self._matrix] != 0
        entries = self._matrix[self._there]
        places = found.row[entries] - 1, found.column[entries]
        self._skeleton, slot = _skeleton(*places, (n_rows, n_columns))
        self.objective = _Sums(found, objective, found.column[objective], n_columns + 1)
        self.entries = _Sums(found, entries, slot, self._skeleton.nnz)
        self.right = _Sums(found, right, found.row[right] - 1, n_rows)
        self.rows_vary = self.entries.vary(n_parameters) or self.right.vary(n_parameters)

    def numbers(self, constants: Sequence[Floats]) -> Floats | None:
        """Those of another problem with the same fingerprint; ``None`` if others of them are 0."""
        from .coefficients import AskCvxpyError

        try:
            numbers = self._again(constants)
        except AskCvxpyError:
            return None
        same = np.array_equal(numbers[self._matrix] != 0, self._there)
        return numbers if same else None

    def matrix(self, data: Floats) -> csr_array:
        """The rows with entries `data`; one object for the same entries that were asked for last."""
        if not np.array_equal(self._skeleton.data, data):
            parts = (data, self._skeleton.indices, self._skeleton.indptr)
            self._skeleton = csr_array(parts, shape=self._skeleton.shape)
        return self._skeleton


def _skeleton(row: Ints, column: Ints, shape: tuple[int, int]) -> tuple[csr_array, Ints]:
    """A matrix of zeros with an entry at each of these places, and which entry is whose."""
    slot = np.arange(len(row))
    once = csr_array((slot, (row, column)), shape=shape)
    if once.nnz == len(row):
        slot[once.data] = np.arange(len(row))
        indices, ends = once.indices, once.indptr
    else:  # some places are the same
        key, slot = np.unique(row * shape[1] + column, return_inverse=True)
        rows, indices = np.divmod(key, shape[1])
        ends = np.searchsorted(rows, np.arange(shape[0] + 1))
    parts = np.zeros(len(indices)), indices.astype(np.int32), ends.astype(np.int32)
    return csr_array(parts, shape=shape), slot


class _Rows:
    """``c x + d`` and below it ``A x + b``, at the present values of the parameters."""

    def __init__(
        self,
        pattern: Pattern,
        numbers: Floats,
        parameters: list[cp.Parameter],
        bounds: tuple[Floats, Floats],
    ) -> None:
        self._pattern, self._numbers = pattern, numbers
        self._parameters, self._bounds = parameters, bounds

    def numbers(self) -> Numbers:
        """The numbers at the present values of the parameters."""
        weights = np.array([*(item.value for item in self._parameters), 1.0], dtype=float)
        cost = self._pattern.objective(self._numbers, weights)
        vary = self._pattern.rows_vary
        matrix, right = self._rows(weights) if vary else self._fixed_rows
        return Numbers(cost[:-1], float(cost[-1]), matrix, right, *self._bounds)

    def _rows(self, weights: Floats) -> tuple[csr_array, Floats]:
        matrix = self._pattern.matrix(self._pattern.entries(self._numbers, weights))
        return matrix, -self._pattern.right(self._numbers, weights)

    @cached_property
    def _fixed_rows(self) -> tuple[csr_array, Floats]:
        return self._rows(np.ones(len(self._parameters) + 1))


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
