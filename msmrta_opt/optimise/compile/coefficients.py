"""The coefficients of affine cvxpy expressions.

An expression's entries are numbered in column-major order, those of the variables likewise, one variable
after the other; a coefficient is a number, times a parameter of the problem or not. What the commonest
atoms (sums, products with data and parameters, selections) do to the coefficients of their arguments
is a line of numpy each. Those of any other atom are asked of cvxpy, which compiles what it is given.

Where the coefficients are depends on shapes and on how the expressions are made (`fingerprint`), not on
the numbers in them. So the next problem that is made in the same way needs only its numbers, which
`again` works out from its constants.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import singledispatchmethod
from operator import itemgetter
from typing import NamedTuple

import cvxpy as cp
import numpy as np
from cvxpy.atoms.affine.add_expr import AddExpression
from cvxpy.atoms.affine.affine_atom import AffAtom
from cvxpy.atoms.affine.binary_operators import DivExpression, multiply
from cvxpy.atoms.affine.broadcast_to import broadcast_to
from cvxpy.atoms.affine.index import index, special_index
from cvxpy.atoms.affine.promote import Promote
from cvxpy.atoms.affine.reshape import reshape
from cvxpy.atoms.affine.sum import Sum
from cvxpy.atoms.affine.transpose import transpose
from cvxpy.atoms.affine.unary_operators import NegExpression
from cvxpy.expressions.leaf import Leaf
from cvxpy.reductions import InverseData
from cvxpy.utilities.coeff_extractor import CoeffExtractor
from scipy.sparse import issparse

from ...arrays import Bools, Floats, Ints

PASSING = (NegExpression, Promote)
"""Atoms that have one coefficient for each of their argument, constants included."""
MADE_OF = {
    *(AddExpression, DivExpression, NegExpression, Promote, Sum),
    *(broadcast_to, index, multiply, reshape, special_index, transpose),
}
"""Atoms whose coefficients are read here."""
Again = Callable[[Sequence[Floats]], Floats]
"""The numbers of coefficients, from the constants of the problem."""


class AskCvxpyError(Exception):
    """Numbers come from cvxpy, which has to be asked again."""


def _by_cvxpy_alone(_: Sequence[Floats]) -> Floats:
    raise AskCvxpyError


def is_constant(node: cp.Expression) -> bool:
    """Whether the value of `node` stands for it: of constants alone, and what is made of them here."""
    return type(node) not in PASSING and _has_constants_alone(node)


def _has_constants_alone(node: cp.Expression) -> bool:
    if not node.args:
        return isinstance(node, cp.Constant)
    return all(map(_has_constants_alone, node.args))


def flat(node: cp.Expression) -> Floats:
    """The value of a constant, in column-major order."""
    value = node.value.toarray() if issparse(node.value) else np.asarray(node.value)
    return np.asarray(value.ravel(order="F"), dtype=float)


def nodes(expressions: list[cp.Expression]) -> Iterator[cp.Expression]:
    """All expressions of which `expressions` are made, themselves included."""
    todo = list(expressions)
    while todo:
        node = todo.pop()
        yield node
        todo.extend(node.args)


def are_affine(expressions: list[cp.Expression]) -> bool:
    """Whether `expressions` are affine atoms of real numbers all through, none of them empty."""
    return all(
        node.size > 0 and (isinstance(node, AffAtom) or (isinstance(node, Leaf) and node.is_real()))
        for node in nodes(expressions)
    )


class Coefficients(NamedTuple):
    """Numbers, each with its place: coefficients of equal places add up."""

    row: Ints
    """The entry of the expression."""
    column: Ints
    """The entry of the variables, or their number for a constant."""
    parameter: Ints
    """The parameter that the number is multiplied with, or their number for none."""
    number: Floats
    again: Again

    def where(self, chosen: Bools | Ints) -> Coefficients:
        """Those `chosen`, by truth or by position."""
        row, column, parameter, _, _ = self
        places = Coefficients(row[chosen], column[chosen], parameter[chosen], *self[3:])
        return places.changed(lambda number: number[chosen])

    def changed(self, change: Callable[[Floats], Floats]) -> Coefficients:
        """With other numbers."""
        again = self.again
        return self._replace(
            number=change(self.number), again=lambda constants: change(again(constants))
        )

    def at(self, row: Ints) -> Coefficients:
        """The same, but in other entries of an expression."""
        return self._replace(row=row)

    def combined(
        self, operation: np.ufunc, constant: Coefficients, entry: Ints | int
    ) -> Coefficients:
        """With ``operation(number, that of constant at entry)`` for numbers."""
        own, other = self.again, constant.again
        return self._replace(
            number=operation(self.number, constant.number[entry]),
            again=lambda constants: operation(own(constants), other(constants)[entry]),
        )


class Reader:
    """Reads the affine expressions of one problem, whose parameters are scalars.

    `constants` are those of the problem, by `id`, as `fingerprint` numbers them.
    """

    def __init__(self, problem: cp.Problem, constants: dict[int, int] | None = None) -> None:
        self._constants = constants or {}
        self._places = InverseData(problem)
        self.variables: list[cp.Variable] = problem.variables()
        self.parameters: list[cp.Parameter] = problem.parameters()
        self.starts: list[int] = [self._places.var_offsets[item.id] for item in self.variables]
        self.n_columns = sum(item.size for item in self.variables)
        self._start = dict(zip((item.id for item in self.variables), self.starts, strict=True))
        self._number = {item.id: number for number, item in enumerate(self.parameters)}

    def stacked(self, expressions: list[cp.Expression]) -> Coefficients:
        """Those of `expressions`, one below the other.

        Raises
        ------
        NotImplementedError
            If cvxpy has to restate one of them or has no coefficients for it, or parameters are
            not in DPP form.
        """
        parts, below = [], 0
        for expression in expressions:
            part = self.of(expression)
            parts.append(part.at(part.row + below))
            below += expression.size
        return _joined(parts)

    def of(self, node: cp.Expression) -> Coefficients:
        """Those of one expression."""
        if is_constant(node):
            place = self._constants.get(id(node))
            again = _by_cvxpy_alone if place is None else itemgetter(place)
            return self._plain(self.n_columns, flat(node), again)
        found: Coefficients = self._of(node)
        return found

    def _plain(self, column: int | Ints, number: Floats, again: Again) -> Coefficients:
        """One coefficient for each entry, without a parameter."""
        row = np.arange(len(number))
        columns = np.broadcast_to(column, row.shape)
        return Coefficients(row, columns, np.full(len(row), len(self.parameters)), number, again)

    def _ones(self, column: int | Ints, size: int) -> Coefficients:
        ones = np.ones(size)
        return self._plain(column, ones, lambda _: ones)

    @singledispatchmethod
    def _of(self, node: cp.Expression) -> Coefficients:
        return self._by_cvxpy(node)

    def _by_cvxpy(self, node: cp.Expression) -> Coefficients:
        if not node.is_affine() or (node.parameters() and not node.is_dpp()):
            raise NotImplementedError
        _, added = node.canonical_form
        if added or any(part.ndim > 2 for part in nodes([node])):
            raise NotImplementedError  # it needs rows of its own, or more axes than cvxpy compiles
        tensor = CoeffExtractor(self._places, None).affine([node]).tocoo()
        place, parameter = tensor.coords
        column, row = np.divmod(place, node.size)
        own = np.full(tensor.shape[1], len(self.parameters))
        for item in self.parameters:
            own[self._places.param_id_map[item.id]] = self._number[item.id]
        return Coefficients(row, column, own[parameter], tensor.data, _by_cvxpy_alone)

    @_of.register(cp.Variable)
    def _(self, node: cp.Variable) -> Coefficients:
        return self._ones(self._start[node.id] + np.arange(node.size), node.size)

    @_of.register(cp.Parameter)
    def _(self, node: cp.Parameter) -> Coefficients:
        alone = self._ones(self.n_columns, 1)
        return alone._replace(parameter=np.array([self._number[node.id]]))

    @_of.register(NegExpression)
    def _(self, node: NegExpression) -> Coefficients:
        return self.of(node.args[0]).changed(np.negative)

    @_of.register(AddExpression)
    def _(self, node: AddExpression) -> Coefficients:
        if any(item.size != node.size for item in node.args):
            return self._by_cvxpy(node)
        return _joined([self.of(item) for item in node.args])

    @_of.register(multiply)
    def _(self, node: multiply) -> Coefficients:
        factor, other = node.args if node.args[0].is_constant() else node.args[::-1]
        if not factor.is_constant():
            raise NotImplementedError
        inner = self.of(other)
        if not factor.parameters():
            return inner.combined(np.multiply, self.of(factor), inner.row)
        if isinstance(factor, Promote):
            factor = factor.args[0]
        if not factor.is_scalar():
            return self._by_cvxpy(node)
        parts = []
        if np.any(inner.parameter < len(self.parameters)):
            raise NotImplementedError  # a product of parameters, which is not in DPP form
        weights = self.of(factor)
        for place, parameter in enumerate(weights.parameter):
            weighed = inner.combined(np.multiply, weights, place)
            if parameter < len(self.parameters):
                weighed = weighed._replace(parameter=np.full(len(inner.row), parameter))
            parts.append(weighed)
        return _joined(parts)

    @_of.register(DivExpression)
    def _(self, node: DivExpression) -> Coefficients:
        if node.args[1].parameters() or not node.args[1].is_constant():
            return self._by_cvxpy(node)
        inner, divisor = (self.of(item) for item in node.args)
        return inner.combined(np.divide, divisor, inner.row)

    @_of.register(Sum)
    def _(self, node: Sum) -> Coefficients:
        (summed,) = node.args
        kept = np.zeros(summed.shape).sum(axis=node.axis, keepdims=True).shape
        into = np.arange(node.size).reshape(kept, order="F")
        row = np.broadcast_to(into, summed.shape).ravel(order="F")
        inner = self.of(summed)
        return inner.at(row[inner.row])

    @_of.register(Promote)
    @_of.register(broadcast_to)
    @_of.register(index)
    @_of.register(special_index)
    @_of.register(reshape)
    @_of.register(transpose)
    def _(self, node: cp.Expression) -> Coefficients:
        (inner,) = node.args
        numbered = np.arange(inner.size).reshape(inner.shape, order="F")
        source = np.asarray(node.numeric([numbered])).astype(np.int64)
        return _taken(self.of(inner), source.ravel(order="F"))


def _joined(parts: list[Coefficients]) -> Coefficients:
    row, column, parameter, number = (
        np.concatenate(same) for same in list(zip(*parts, strict=True))[:4]
    )
    agains = [part.again for part in parts]
    return Coefficients(
        row, column, parameter, number, lambda given: np.concatenate([f(given) for f in agains])
    )


def _taken(inner: Coefficients, source: Ints) -> Coefficients:
    """Those of an expression whose entries are the entries `source` of another."""
    by_row = np.argsort(inner.row, kind="stable")
    count = np.bincount(inner.row, minlength=int(source.max()) + 1)
    first = np.cumsum(count) - count
    row = np.repeat(np.arange(len(source)), count[source])
    within = np.arange(len(row)) - np.searchsorted(row, row)
    return inner.where(by_row[first[source][row] + within]).at(row)
