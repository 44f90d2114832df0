"""What a question is about: a formulation on data, a file, arrays, or any linear problem of cvxpy."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..mission.errors import InputError
from ..mission.suggestions import meant
from .compile import Compiled, compile_for, compile_formulation, parameter_values
from .compile.canonical import UNLABELLED
from .formats.files import is_program, read_program
from .formulation import Spec
from .program import Program
from .registry import Formulation

if TYPE_CHECKING:
    import cvxpy as cp

LONGEST_TEXT = 60
"""Characters of a constraint's text that stand behind its number."""


@dataclass(frozen=True, eq=False)
class Subject:
    """A program, its name, and the cvxpy problem behind it if there is one."""

    program: Program
    name: str
    problem: cp.Problem | None = None
    compiled: Compiled | None = None
    """Of a formulation."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """Of a formulation: the values of all of its parameters."""
    data: Any = None
    """Of a formulation: what it was built on."""

    @property
    def described(self) -> Program:
        """The program, rows of constraints without a label called by their number and their text."""
        if self.problem is None:
            return self.program
        texts = {
            UNLABELLED.format(i + 1): shortened(str(item))
            for i, item in enumerate(self.problem.constraints)
        }
        rows = []
        for block in self.program.rows:
            if block.name in texts:
                index = ",".join(f"{{{d}}}" for d in range(len(block.shape)))
                place = f"[{index}]" if index else ""
                block = replace(block, name=f"{block.name}{place}: {texts[block.name]}")
            rows.append(block)
        return replace(self.program, rows=tuple(rows))


def subject(what: Any, data: Any = None, **parameters: float) -> Subject:
    """What is asked about, as arrays.

    Parameters
    ----------
    what : str, Formulation, path, Program or cvxpy.Problem
        A formulation by its name or itself, which takes `data`; a file in MPS or LP format; arrays; or
        any linear (integer) problem of cvxpy, whose parameters have values.
    data
        What the formulation's stage takes, for instance `ClusterData`.
    **parameters : float
        The formulation's parameters, for instance ``psi``.

    Raises
    ------
    InputError
        If a name, a file or a parameter is wrong.
    ModelError
        If it is no linear integer program.
    """
    is_formulation = isinstance(what, Formulation) or (
        isinstance(what, str) and not is_program(what)
    )
    if parameters and not is_formulation:
        raise InputError(
            "only formulations take parameters; set the value of a cvxpy problem's own",
            field=next(iter(parameters)),
        )
    if isinstance(what, Program):
        return Subject(what, "the program")
    if isinstance(what, (str, Path)) and is_program(what):
        return Subject(read_program(what), Path(what).name)
    if is_formulation:
        compiled = compile_for(what, data)
        return Subject(
            compiled.program(**parameters),
            compiled.formulation.name,
            compiled.problem,
            compiled,
            parameter_values(compiled.formulation, parameters),
            data,
        )
    import cvxpy as cp

    if not isinstance(what, cp.Problem):
        raise InputError(
            f"{type(what).__name__}; give a formulation, a file, a program or a cvxpy problem"
        )
    name = "the cvxpy problem"
    problem = _with_values(what)
    formulation = Formulation(name, Path("problem"), Spec("cluster", name), "", lambda _: problem)
    return Subject(compile_formulation(formulation, None).program(), name, problem)


def own_parameters(
    programs: Sequence[Any], parameters: Mapping[str, float]
) -> list[dict[str, float]]:
    """Those of `parameters` that each of `programs` has; only formulations have any.

    Raises
    ------
    InputError
        If none has one of them, or its value is out of its range.
    """
    formulations = [x for x in programs if isinstance(x, Formulation)]
    known = list(dict.fromkeys(name for x in formulations for name in x.spec.parameters))
    for name in parameters:
        if name not in known:
            there = ", ".join(known) or "none"
            raise InputError(
                f"neither has such a parameter{meant(name, known)}; there are {there}", field=name
            )
    for item in formulations:
        parameter_values(item, item.takes(**parameters))
    return [x.takes(**parameters) if isinstance(x, Formulation) else {} for x in programs]


def _with_values(problem: cp.Problem) -> cp.Problem:
    """`problem` with its parameters as numbers, and with its labels, which cvxpy drops."""
    from cvxpy.reductions.eval_params import EvalParams

    if not problem.parameters():
        return problem
    missing = [item.name() for item in problem.parameters() if item.value is None]
    if missing:
        raise InputError(f"parameter {missing[0]} of the problem has no value; set it")
    found = EvalParams().apply(problem)[0]
    for before, after in zip(problem.constraints, found.constraints, strict=True):
        if before.label is not None and after.label is None:
            after.set_label(before.label)
    return found


def shortened(text: str) -> str:
    """The text of an expression on a line, arrays of numbers as ``[…]``, without braces.

    In a label these would name axes.
    """
    plain = re.sub(r"\[[\[\]\d\s.eE+\-]*\s[\[\]\d\s.eE+\-]*\]", "[…]", text)
    plain = " ".join(plain.split()).replace("{", "(").replace("}", ")")
    return plain if len(plain) <= LONGEST_TEXT else plain[: LONGEST_TEXT - 1] + "…"
