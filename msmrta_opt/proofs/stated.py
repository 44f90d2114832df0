"""Which program a certificate states, and whether that is the one that is meant."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..certify import vipr
from ..certify.plan_proof import check_plan_proof
from ..mission.errors import CheckError, InputError
from ..mission.plan import Plan
from ..optimise.program import Program
from ..optimise.subject import subject
from .exact import ExactProgram, Numbers, exact_program

_READINGS: tuple[Numbers, ...] = ("binary", "decimal", "simple")
_MOST = 5
"""Differences that are told."""

_Row = tuple[int, Fraction, tuple[tuple[int, Fraction], ...]]
"""Sense, side and terms of a constraint."""


def check_proof(path: str | Path, what: Any = None, data: Any = None, **parameters: float) -> str:
    """Check a certificate; what it proves, in words.

    Parameters
    ----------
    path : path
        The certificate.
    what, data, **parameters
        The program that it should be of, as `prove` takes it, or a plan, of whose mission and limits it
        should be; by default that is not looked at.

    Raises
    ------
    InputError
        If the file cannot be read.
    CheckError
        If it does not prove what it claims, naming the line; or if it is of another program, naming
        what differs.
    """
    if isinstance(what, Plan):
        return check_plan_proof(path, what).summary
    try:
        found = vipr.verify(str(path))
    except vipr.RefusedError as refusal:
        raise CheckError(f"{path}: {refusal}") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", file=path) from None
    if what is not None:
        meant = subject(what, data, **parameters)
        different = differences(meant.program, found)
        if different:
            more = f" (and {len(different) - 1} more)" if len(different) > 1 else ""
            raise CheckError(f"{path}: it is not of {meant.name}: {different[0]}{more}")
    return found.claim


def differences(program: Program, found: vipr.Certificate) -> list[str]:
    """In what the program that a certificate states is not `program`, number by number.

    Each number may be the binary fraction that the program holds, the decimal that it prints as, or
    the simplest fraction within its rounding; all in the same way.
    """
    several = (_differences(exact_program(program, reading), found) for reading in _READINGS)
    first = next(several)
    if not first or any(not other for other in several):
        return []
    return first


def _differences(program: ExactProgram, found: vipr.Certificate) -> list[str]:
    if found.minimise != (program.sign > 0):
        return [f"it is a {'minimum' if found.minimise else 'maximum'}, the program is not"]
    if len(set(found.names)) != len(found.names) or set(found.names) != set(program.names):
        other = sorted(set(found.names) ^ set(program.names)) or sorted(found.names)
        return [f"the variables are not the same: {', '.join(other[:_MOST])}"]
    column = {name: j for j, name in enumerate(program.names)}
    place = [column[name] for name in found.names]
    wrong: list[str] = []
    whole = {place[j] for j in found.integer}
    for j, integer in enumerate(program.integer):
        if integer != (j in whole):
            wrong.append(f"{program.names[j]} is {'not ' * integer}integer in the certificate")
    stated = {place[j]: Fraction(a, found.objective_under) for j, a in found.objective.items()}
    for j, cost in enumerate(program.cost):
        own = program.sign * cost
        if stated.get(j, 0) != own:
            text = f"{float(stated.get(j, 0))!r}, not {float(own)!r}"
            wrong.append(f"the objective's coefficient of {program.names[j]} is {text}")
    meant = Counter(
        _row({"G": 1, "E": 0, "L": -1}[item.sense], Fraction(item.side),
             {j: Fraction(a) for j, a in item.terms}) for item in program.stated
    )  # fmt: skip
    written = Counter(
        _row(item.sense, Fraction(item.side, item.under),
             {place[j]: Fraction(a, item.under) for j, a in item.terms.items()})
        for item in found.constraints
    )  # fmt: skip
    names = {
        _row({"G": 1, "E": 0, "L": -1}[item.sense], Fraction(item.side),
             {j: Fraction(a) for j, a in item.terms}): item.name for item in program.stated
    }  # fmt: skip
    wrong += [f"{names[row]} is missing" for row in meant - written]
    wrong += [f"{_text(program, row)} is not in the program" for row in written - meant]
    return wrong


def _row(sense: int, side: Fraction, terms: dict[int, Fraction]) -> _Row:
    return sense, side, tuple(sorted((j, a) for j, a in terms.items() if a))


def _text(program: ExactProgram, row: _Row) -> str:
    sense, side, terms = row
    left = " + ".join(f"{float(a):g} {program.names[j]}" for j, a in terms[:_MOST]) or "0"
    more = " + ..." if len(terms) > _MOST else ""
    return f"{left}{more} {('=', '>=', '<=')[sense]} {float(side):g}"
