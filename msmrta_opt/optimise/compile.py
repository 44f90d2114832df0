"""From a formulation and data to arrays, by cvxpy's canonicalisation.

cvxpy is asked once for its parametrised matrices; a new value of a parameter then costs a sparse
product, not a canonicalisation.
"""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass, replace
from typing import Any

import cvxpy as cp
import numpy as np
from cvxpy.error import DCPError, DPPError, ParameterError, SolverError

from ..mission.errors import InputError, ModelError
from .program import Block, Program
from .registry import Formulation
from .structure import Structure, recognise

AUXILIARY = "auxiliary"
"""Name of columns and rows that cvxpy adds, for instance for a maximum in the objective."""


@dataclass
class Compiled:
    """A formulation on data, canonicalised once, to be solved for any values of its parameters."""

    formulation: Formulation
    problem: cp.Problem
    seconds: float
    """Wall time of building and canonicalising."""
    _matrices: Any
    _columns: tuple[Block, ...]
    _rows: tuple[Block, ...]
    _n_equations: int
    _integer: Any
    _last: Program | None = None
    _structure: Structure | None = None
    _asked: bool = False

    def structure(self, program: Program) -> Structure | None:
        """What the matrix of `program`, from this object, proves; asked once while it stays."""
        if self._last is None or program.matrix is not self._last.matrix:
            return recognise(program)
        if not self._asked:
            self._structure, self._asked = recognise(program), True
        return self._structure

    def program(self, **parameters: float) -> Program:
        """The arrays at the given parameter values, defaults for the others.

        Raises
        ------
        InputError
            If a parameter is unknown or out of its range.
        """
        values = parameter_values(self.formulation, parameters)
        for name, value in values.items():
            if name in self.problem.param_dict:
                self.problem.param_dict[name].value = value
        cost, offset, matrix, constant = self._matrices.apply_parameters()
        # cvxpy minimises, and states rows as `A x + b = 0`, then `A x + b ≥ 0`.
        maximise = isinstance(self.problem.objective, cp.Maximize)
        sign = -1.0 if maximise else 1.0
        row_upper = np.asarray(constant, float).ravel()
        row_lower = np.where(np.arange(len(row_upper)) < self._n_equations, row_upper, -np.inf)
        n_columns = len(cost)
        lower, upper = self._matrices.lower_bounds, self._matrices.upper_bounds
        lower = np.full(n_columns, -np.inf) if lower is None else np.array(lower, float)
        upper = np.full(n_columns, np.inf) if upper is None else np.array(upper, float)
        boolean, integer = self._integer
        lower[boolean] = np.maximum(lower[boolean], 0.0)
        upper[boolean] = np.minimum(upper[boolean], 1.0)
        is_integer = np.zeros(n_columns, dtype=bool)
        is_integer[boolean + integer] = True
        numbers = (cost, [offset], matrix.data)
        if not all(np.isfinite(part).all() for part in numbers) or np.isnan(row_upper).any():
            raise ModelError(
                f"{self.formulation.name}: costs, constants or coefficients are not finite"
            )
        program = Program(
            sense="max" if maximise else "min",
            cost=sign * np.asarray(cost, float).ravel(),
            offset=sign * float(offset),
            matrix=(-matrix).tocsr(),
            row_lower=row_lower,
            row_upper=row_upper,
            lower=lower,
            upper=upper,
            integer=is_integer,
            columns=self._columns,
            rows=self._rows,
        )
        if self._last is not None and program.differs_in_cost_alone(self._last):
            return replace(self._last, cost=program.cost, offset=program.offset)
        self._last, self._asked = program, False
        return program


def parameter_values(formulation: Formulation, parameters: dict[str, float]) -> dict[str, float]:
    """All parameters of `formulation`: the given values, in range, and defaults for the rest.

    Raises
    ------
    InputError
        If a parameter is unknown, not a number, or out of its range.
    """
    known = formulation.spec.parameters
    for name, value in parameters.items():
        if name not in known:
            there = ", ".join(known) or "none"
            raise InputError(
                f"{formulation.name} has no such parameter; it has {there}", field=name
            )
        low, high = known[name].low, known[name].high
        number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
        if not (number and low <= value <= high):
            raise InputError(f"{value!r}; give a number from {low:g} to {high:g}", field=name)
    return {name: float(parameters.get(name, item.default)) for name, item in known.items()}


def compile_formulation(formulation: Formulation, data: object) -> Compiled:
    """Build `formulation` on `data` and canonicalise it.

    Raises
    ------
    ModelError
        If building fails, or the program is not a linear (integer) one.
    """
    began = time.perf_counter()
    name = formulation.name
    try:
        problem = formulation.build(data)
    except Exception as error:
        said = " ".join(str(error).split())
        raise ModelError(f"{name}: build(data) failed: {type(error).__name__}: {said}") from error
    if not isinstance(problem, cp.Problem):
        raise ModelError(f"{name}: build(data) returned {type(problem).__name__}, not a Problem")
    undeclared = set(problem.param_dict) - set(formulation.spec.parameters)
    if undeclared:
        raise ModelError(f"{name}: SPEC.parameters lacks {', '.join(sorted(undeclared))}")
    _set_defaults(formulation, problem)
    if not problem.variables():
        raise ModelError(f"{name}: the program has no variables")
    if not problem.is_dcp():
        raise ModelError(f"{name}: the program is not convex (cvxpy's DCP rules)")
    if not problem.is_dpp():
        raise ModelError(
            f"{name}: parameters are not used in DPP form; multiply each only with variables and data"
        )
    try:
        with warnings.catch_warnings():
            # Which of its backends cvxpy takes is its own affair.
            warnings.filterwarnings("ignore", message=".*Defaulting to the .* backend")
            data_, _, _ = problem.get_problem_data(cp.HIGHS)
    except (DCPError, DPPError, ParameterError, SolverError, ValueError) as error:
        first = str(error).strip().splitlines()[0]
        raise ModelError(f"{name}: not a linear integer program: {first}") from error
    matrices = data_["param_prob"]
    if getattr(matrices, "P", None) is not None or data_.get("P") is not None:
        raise ModelError(f"{name}: not a linear integer program: the objective is quadratic")
    return Compiled(
        formulation,
        problem,
        time.perf_counter() - began,
        matrices,
        _columns(name, problem, matrices),
        _rows(problem, matrices),
        matrices.cone_dims.zero,
        (_flat(matrices.x.boolean_idx), _flat(matrices.x.integer_idx)),
    )


def _set_defaults(formulation: Formulation, problem: cp.Problem) -> None:
    names = [parameter.name() for parameter in problem.parameters()]
    for repeated in {name for name in names if names.count(name) > 1}:
        raise ModelError(
            f"{formulation.name}: two parameters are called {repeated!r}; make one and use it twice"
        )
    for name, item in formulation.spec.parameters.items():
        if name in problem.param_dict:
            try:
                for value in (item.low, item.high, item.default):
                    problem.param_dict[name].value = value
            except ValueError as error:
                raise ModelError(
                    f"{formulation.name}: parameter {name} cannot be a number from {item.low:g} to"
                    f" {item.high:g}: {error}"
                ) from error


def _flat(indices: list[tuple[int, ...]]) -> list[int]:
    return [int(index[0]) for index in indices]


def _columns(name: str, problem: cp.Problem, matrices: Any) -> tuple[Block, ...]:
    own = {variable.id: variable for variable in problem.variables()}
    blocks: list[Block] = []
    for variable in matrices.variables:
        start = matrices.var_id_to_col[variable.id]
        original = own.get(variable.id)
        if original is not None and original.shape != variable.shape:
            raise ModelError(
                f"{name}: variable {original.name()} has an attribute that changes its shape;"
                " state it as a constraint"
            )
        label = AUXILIARY if original is None else original.name()
        if label in {block.name for block in blocks}:
            label = f"{label}_{variable.id}"
        blocks.append(Block(label, start, variable.shape))
    return tuple(sorted(blocks, key=lambda block: block.start))


def _rows(problem: cp.Problem, matrices: Any) -> tuple[Block, ...]:
    own = {constraint.id: constraint for constraint in problem.constraints}
    place = {constraint.id: i + 1 for i, constraint in enumerate(problem.constraints)}
    blocks, start = [], 0
    for constraint in matrices.constraints:
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
