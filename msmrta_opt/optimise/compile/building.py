"""From a formulation's file to its cvxpy problem: what `build` did wrong, in a line with its place."""

from __future__ import annotations

import linecache
import re
import traceback
from collections import Counter
from collections.abc import Hashable
from difflib import get_close_matches

import cvxpy as cp

from ...mission.errors import ModelError
from ...mission.instance import Instance
from ..axes import StageData
from ..registry import Formulation

UNNAMED = re.compile(r"var\d+$")
"""What cvxpy calls a variable that has no name."""


def built(formulation: Formulation, data: object) -> cp.Problem:
    """The problem that `formulation` builds on `data`.

    Raises
    ------
    ModelError
        If the data is of another stage, building fails, or variables and parameters are not those that
        the stage and the `Spec` declare.
    """
    name = formulation.name
    _require_data(formulation, data)
    try:
        problem = formulation.build(data)
    except Exception as error:
        asks = data is None and "NoneType" in str(error)
        missing = f"; it had no data, {_right(formulation)}" if asks else ""
        said = _told(formulation, error)
        raise ModelError(f"{name}: build(data) failed: {said}{missing}") from error
    if not isinstance(problem, cp.Problem):
        raise ModelError(
            f"{name}: build(data) returned {type(problem).__name__}, not a Problem; return "
            "cp.Problem(objective, constraints)"
        )
    variables = problem.variables()
    if not variables:
        raise ModelError(f"{name}: the program has no variables; state it in cp.Variable")
    for repeated in _repeated([variable.name() for variable in variables]):
        raise ModelError(
            f"{name}: two variables are called {repeated!r}; give each a name of its own"
        )
    if isinstance(data, StageData) and formulation.reads_data:
        for variable in data.solution:
            _require_variable(name, variable, data, variables)
    _require_parameters(formulation, problem)
    return problem


def _right(formulation: Formulation) -> str:
    return f"give mo.stage_data(mission, {formulation.spec.stage!r})"


def _require_data(formulation: Formulation, data: object) -> None:
    stage, right = formulation.spec.stage, _right(formulation)
    if isinstance(data, StageData) and data.stage != stage:
        raise ModelError(
            f"{formulation.name}: it is for data of stage {stage!r}, not {type(data).__name__} of "
            f"{data.stage!r}; {right}"
        )
    if isinstance(data, Instance):
        raise ModelError(f"{formulation.name}: it takes data of stage {stage!r}; {right}")


def _told(formulation: Formulation, error: Exception) -> str:
    """The error on one line, with the place in the model's file where it arose."""
    said = f"{type(error).__name__}: {' '.join(str(error).split())}".rstrip(": ")
    if isinstance(error, AttributeError) and isinstance(error.obj, StageData):
        there = [name for name in dir(error.obj) if not name.startswith("_")]
        close = get_close_matches(error.name or "", there, 1)
        said += f"; did you mean {close[0]}?" if close else f"; it has {', '.join(there)}"
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename == str(formulation.path) and frame.lineno is not None
    ]
    if not frames:
        return said
    at = frames[-1]
    source = (at.line or linecache.getline(at.filename, at.lineno or 0)).strip()
    return f"{formulation.path}, line {at.lineno}: {said}: {' '.join(source.split())}"


def _repeated(names: list[str]) -> list[str]:
    return [name for name, count in Counter(names).items() if count > 1]


def _require_variable(name: str, wanted: str, data: StageData, there: list[cp.Variable]) -> None:
    letters = data.solution[wanted]
    shape = tuple(len(data.along(letter)) for letter in letters)
    over = " by ".join(f"{data.axes[letter].noun}s" for letter in letters)
    like = next((field for field, axes, _ in data._arrays() if axes == letters), "")
    right = f"cp.Variable({f'data.{like}.shape' if like else shape}, boolean=True, name={wanted!r})"
    found = next((variable for variable in there if variable.name() == wanted), None)
    if found is None:
        known = ", ".join(
            f"{'one without a name' if UNNAMED.match(other.name()) else other.name()} {other.shape}"
            for other in there
        )
        raise ModelError(
            f"{name}: no variable is called {wanted!r}, which the stage reads, {over}; there are "
            f"{known}; declare it as {right}"
        )
    if found.shape != shape:
        turned = ", transposed" if found.shape == shape[::-1] else ""
        raise ModelError(
            f"{name}: variable {wanted} has shape {found.shape}{turned}, where the stage reads "
            f"{over}, {shape}; declare it as {right}"
        )


def _require_parameters(formulation: Formulation, problem: cp.Problem) -> None:
    """Refuse parameters of the program that are not those of the `Spec`."""
    name, declared = formulation.name, formulation.spec.parameters
    names = [parameter.name() for parameter in problem.parameters()]
    if undeclared := sorted(set(names) - set(declared)):
        raise ModelError(
            f"{name}: SPEC.parameters lacks {', '.join(undeclared)}; declare it as "
            f"{undeclared[0]!r}: Parameter(low, high, default, meaning)"
        )
    if unused := [parameter for parameter in declared if parameter not in names]:
        raise ModelError(
            f"{name}: nothing uses parameter {', '.join(unused)} that SPEC declares; use "
            f"cp.Parameter(name={unused[0]!r}) in the program, or declare none"
        )
    for repeated in _repeated(names):
        raise ModelError(
            f"{name}: two parameters are called {repeated!r}; make one and use it twice"
        )


def set_defaults(formulation: Formulation, problem: cp.Problem, before: Hashable) -> Hashable:
    """Set the parameters to their defaults, if they can have all values that are declared for them.

    What they are is returned; if it is what it was `before`, they can.

    Raises
    ------
    ModelError
        If one cannot have a value that is declared for it.
    """
    parameters, declared = problem.parameters(), formulation.spec.parameters
    names = [parameter.name() for parameter in parameters]
    found = tuple(
        (name, declared[name], type(parameter), parameter.shape, repr(parameter.attributes))
        for name, parameter in zip(names, parameters, strict=True)
    )
    for name, parameter in zip(names, parameters, strict=True):
        item = declared[name]
        if found == before:
            parameter.save_value(item.default)  # without cvxpy's looking at it again
            continue
        try:
            for value in (item.low, item.high, item.default):
                parameter.value = value
        except ValueError as error:
            raise ModelError(
                f"{formulation.name}: parameter {name} cannot be a number from {item.low:g} to"
                f" {item.high:g}: {error}"
            ) from error
    return found
