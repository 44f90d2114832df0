"""A formulation on data as arrays, for any values of its parameters, built and read once."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any
from weakref import WeakKeyDictionary

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from ...mission.errors import InputError, ModelError
from ...mission.suggestions import meant
from .. import registry
from ..program import Block, Program
from ..registry import Formulation
from ..structure import Frame, Structure, recognise
from .affine import Patterns, read_off
from .building import built, set_defaults
from .canonical import Canonical, place_of
from .contract import Reading, broken, check_program, readings
from .finite import require_numbers
from .labels import Named, named
from .reductions import reduced

_compiled: WeakKeyDictionary[object, dict[Callable[[Any], Any], Compiled]] = WeakKeyDictionary()


@dataclass
class _Alike:
    """What a formulation's programs on different data have in common, to be found once."""

    declared: Hashable = None
    """Parameters that can have all values that are declared for them, as cvxpy has them."""
    patterns: Patterns = field(default_factory=Patterns)
    named: Named | None = None
    frame: Frame | None = None


_alike: WeakKeyDictionary[Callable[[Any], Any], _Alike] = WeakKeyDictionary()
"""By the function that builds them, which is another one once its file has been read anew."""


@dataclass
class Compiled:
    """A formulation on data, canonicalised once, to be solved for any values of its parameters."""

    formulation: Formulation
    problem: cp.Problem
    seconds: float
    """Wall time of building and canonicalising."""
    _canonical: Canonical
    _parameters: dict[str, cp.Parameter]
    _columns: tuple[Block, ...]
    _rows: tuple[Block, ...]
    _alike: _Alike = field(repr=False)
    _read: tuple[Reading, ...] = ()
    _last: Program | None = None
    _structure: Structure | None = None
    _asked: bool = False

    def structure(self, program: Program) -> Structure | None:
        """What the matrix of `program`, from this object, proves; asked once while it stays."""
        if self._last is None or program.matrix is not self._last.matrix:
            return recognise(program)
        if not self._asked:
            if self._alike.frame is None or self._alike.frame.given is not program.matrix:
                self._alike.frame = Frame.of(program.matrix)
            self._structure, self._asked = recognise(program, self._alike.frame), True
        return self._structure

    def program(self, **parameters: float) -> Program:
        """The arrays at the given parameter values, defaults for the others.

        Raises
        ------
        InputError
            If a parameter is unknown or out of its range.
        ModelError
            If a number is not finite, or the program breaks the stage's contract; see `contract`.
        """
        values = parameter_values(self.formulation, parameters)
        for name, parameter in self._parameters.items():
            if parameter.value == values[name]:
                continue
            # Beside another attribute cvxpy does not look at this one.
            is_whole = parameter.attributes["integer"] or parameter.attributes["boolean"]
            if is_whole and not values[name].is_integer():
                raise InputError(f"{values[name]:g}; give a value that is integer", field=name)
            # Sign and bounds allow both ends of its range (`set_defaults`): cvxpy need not look again.
            parameter.save_value(values[name])
        canonical = self._canonical
        cost, offset, matrix, right, lower, upper = canonical.numbers()
        is_equation = np.arange(len(right)) < canonical.n_equations
        program = Program(
            sense="max" if isinstance(self.problem.objective, cp.Maximize) else "min",
            cost=cost,
            offset=offset,
            matrix=matrix,
            row_lower=np.where(is_equation, right, -np.inf),
            row_upper=right,
            lower=lower,
            upper=upper,
            integer=canonical.integer,
            columns=self._columns,
            rows=self._rows,
        )
        require_numbers(self.formulation.name, program)
        if self._last is not None and program.differs_in_cost_alone(self._last):
            return replace(self._last, cost=program.cost, offset=program.offset)
        # A problem of no stage is under no contract: its big M is told by `explain`, not refused.
        is_free = registry.is_shipped(self.formulation) or not self._read
        check_program(self.formulation.name, program, self._read, numbers_are_of_data=is_free)
        self._last, self._asked = program, False
        return program

    def broken(self, values: Mapping[str, NDArray[np.float64]]) -> str:
        """What of a solution's `values` the stage cannot take; see `contract`."""
        return broken(values, self._read)


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
                f"{formulation.name} has no such parameter{meant(name, known)}; it has {there}",
                field=name,
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
    problem = built(formulation, data)
    if not formulation.reads_data:
        data = None  # a program of its own has no stage, whose axes and contract would be its
    kept = _alike.setdefault(formulation.build, _Alike())
    kept.declared = set_defaults(formulation, problem, kept.declared)
    canonical = canonicalise(name, problem, kept.patterns)
    matrix = canonical.numbers().matrix
    kept.named = named(name, canonical.columns, canonical.rows, matrix, data, kept.named)
    columns, rows = kept.named.filled(data)
    seconds = time.perf_counter() - began
    read = readings(data, columns)
    return Compiled(
        formulation, problem, seconds, canonical, problem.param_dict, columns, rows, kept, read
    )


def canonicalise(name: str, problem: cp.Problem, patterns: Patterns | None = None) -> Canonical:
    """`problem`, of the formulation `name`, in arrays. Its parameters are scalars and have values.

    `patterns` are those of the formulation.

    Raises
    ------
    ModelError
        If it is not a linear (integer) program, whatever the values of its parameters.
    """
    found = read_off(problem, patterns)
    if found is not None:
        return found
    if not problem.is_dpp():
        if not problem.is_dcp():
            wrong = [item for item in problem.constraints if not item.is_dcp()]
            where = place_of(problem, wrong[0]) if wrong else "the objective"
            raise ModelError(
                f"{name}: the program is not convex (cvxpy's DCP rules) in {where}; multiply "
                "variables only with numbers, and bound only what is convex from above"
            )
        raise ModelError(
            f"{name}: parameters are not used in DPP form; multiply each only with variables and data"
        )
    return reduced(name, problem)


def compile_for(formulation: str | Formulation, data: Any) -> Compiled:
    """`formulation` on `data`, canonicalised when first asked for and kept as long as `data`.

    Raises
    ------
    InputError, ModelError
        As `registry.get` and `compile_formulation`.
    """
    if isinstance(formulation, str):
        formulation = registry.get(formulation)
    try:
        kept = _compiled.setdefault(data, {})
    except TypeError:  # data of a kind that cannot be kept by reference
        return compile_formulation(formulation, data)
    # An edited and reloaded file has a new function, so it is compiled anew.
    if formulation.build not in kept:
        kept[formulation.build] = compile_formulation(formulation, data)
    return kept[formulation.build]


def program(formulation: str | Formulation, data: Any, **parameters: float) -> Program:
    """The linear integer program that `formulation` is on `data`, unsolved.

    Parameters
    ----------
    formulation : str or Formulation
        Its name in the registry, or itself.
    data
        What its stage takes, for instance `ClusterData`.
    **parameters : float
        The formulation's parameters, for instance ``psi``; the others keep their defaults.

    Raises
    ------
    InputError
        If a name or a parameter is wrong.
    ModelError
        If the formulation cannot be built as a linear integer program.
    """
    return compile_for(formulation, data).program(**parameters)


def structure(formulation: str | Formulation, data: Any, **parameters: float) -> Structure | None:
    """What the matrix of `formulation` on `data` proves, or ``None`` if nothing is recognised.

    Takes and raises what `program` does. What is proven is that every vertex of the linear
    relaxation is integral, so that an assignment algorithm or the relaxation solves the program.
    """
    return recognise(program(formulation, data, **parameters))
