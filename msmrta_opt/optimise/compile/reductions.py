"""The long way from cvxpy to numbers: its reductions, which restate what is not affine.

A maximum, an absolute value, or an attribute that asks for rows, is restated by columns and rows of its
own. A new value of a parameter then costs a sparse product.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import cvxpy as cp
import numpy as np
from cvxpy.error import DCPError, DPPError, ParameterError, SolverError

from ...mission.errors import ModelError
from .canonical import Canonical, Numbers, constraint_blocks, place_of, variable_blocks


def reduced(name: str, problem: cp.Problem) -> Canonical:
    """`problem`, of the formulation `name`, by cvxpy's reductions.

    Raises
    ------
    ModelError
        If it is not a linear (integer) program.
    """
    if said := _not_linear(problem):
        raise ModelError(f"{name}: not a linear integer program: {said}")
    try:
        with warnings.catch_warnings():
            # Which of its backends cvxpy takes is its own affair.
            warnings.filterwarnings("ignore", message=".*Defaulting to the .* backend")
            with _without_values(problem):
                data, _, _ = problem.get_problem_data(cp.HIGHS)
    except (DCPError, DPPError, ParameterError, SolverError, ValueError) as error:
        first = str(error).strip().splitlines()[0]
        raise ModelError(f"{name}: not a linear integer program: {first}") from error
    cone = data["param_prob"]
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
        variable_blocks(cone.variables, starts, own),
        constraint_blocks(problem, cone.constraints),
    )


@contextmanager
def _without_values(problem: cp.Problem) -> Iterator[None]:
    """Its variables without values: cvxpy restates these, too, and of some atoms it fails to."""
    values = [(variable, variable.value) for variable in problem.variables()]
    try:
        for variable, _ in values:
            variable.save_value(None)
        yield
    finally:
        for variable, value in values:
            variable.save_value(value)


def _flat(indices: list[tuple[int, ...]]) -> list[int]:
    return [int(index[0]) for index in indices]


def _not_linear(problem: cp.Problem) -> str:
    """What of a convex problem is neither affine nor piecewise linear; empty if nothing is."""
    objective = problem.objective.expr
    if not objective.is_pwl():
        what = "quadratic" if objective.is_quadratic() else "neither linear nor piecewise linear"
        return f"the objective is {what}; state it linearly"
    for constraint in problem.constraints:
        if not all(item.is_pwl() for item in constraint.args):
            where = place_of(problem, constraint)
            return f"{where} is neither linear nor piecewise linear; state it linearly"
    return ""
