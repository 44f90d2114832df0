"""How a problem of affine atoms is made, apart from the numbers in it.

Two problems with the same fingerprint have their coefficients in the same places, but for numbers that
are 0: the same atoms of the same shapes on the same variables and parameters. It is taken from the
problem that a formulation has built, so whatever the formulation does about its data is seen.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable

import cvxpy as cp
import numpy as np
from cvxpy.expressions.leaf import Leaf

from ...arrays import Floats
from .coefficients import MADE_OF, flat, is_constant


class _NotKnownError(Exception):
    """It has an atom whose coefficients cvxpy is asked for."""


class Making:
    """The fingerprint of expressions, and their constants.

    ``key`` is ``None`` if there is none; ``constants`` are in column-major order, ``places`` theirs
    among these by the `id` of their nodes.
    """

    def __init__(self, problem: cp.Problem, expressions: Iterable[cp.Expression]) -> None:
        self.constants: list[Floats] = []
        self.places: dict[int, int] = {}
        leaves = [*problem.variables(), *problem.parameters()]
        self._leaves = {leaf.id: number for number, leaf in enumerate(leaves)}
        self.key: Hashable | None
        try:
            of_leaves = tuple((type(leaf), leaf.shape, _attributes(leaf)) for leaf in leaves)
            self.key = of_leaves, tuple(self._of(expression) for expression in expressions)
        except _NotKnownError:
            self.key = None

    def _of(self, node: cp.Expression) -> Hashable:
        if is_constant(node):
            place = self.places.setdefault(id(node), len(self.constants))
            if place == len(self.constants):
                if not node.is_real():
                    raise _NotKnownError
                self.constants.append(flat(node))
            return "constant", place, node.shape
        kind = type(node)
        if kind in MADE_OF:
            return kind, node.shape, _plain(node.get_data()), *map(self._of, node.args)
        if isinstance(node, Leaf):
            return self._leaves[node.id]
        raise _NotKnownError


def _attributes(leaf: cp.Variable | cp.Parameter) -> Hashable:
    """What is asked of a variable or a parameter; of bounds, that there are some."""
    return tuple(name for name, x in leaf.attributes.items() if x is not None and x is not False)


def _plain(data: object) -> Hashable:
    """What an atom is told beside its arguments, to be compared."""
    if isinstance(data, (list, tuple)):
        return tuple(map(_plain, data))
    if isinstance(data, slice):
        return "slice", data.start, data.stop, data.step
    if isinstance(data, np.ndarray):
        return data.shape, data.dtype.str, data.tobytes()
    if data is None or isinstance(data, (bool, int, str, np.integer)):
        return data
    raise _NotKnownError
