"""Which program a certificate states, and whether that is the one that is meant."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..certify import vipr
from ..certify.plan_proof import check_plan_proof
from ..mission.errors import CheckError, InputError
from ..mission.plan import Plan
from ..optimise.program import Program
from ..optimise.subject import subject
from .exact import ExactProgram, Numbers, Rational, exact_program

_READINGS: tuple[Numbers, ...] = ("binary", "decimal", "simple")
_MAX = 5
"""Names and terms that are told."""
_LONGEST = 60
"""Characters of a number."""
_SENSES = ("=", ">=", "<=")

_Row = tuple[int, Fraction, tuple[tuple[int, Fraction], ...]]
"""Sense, side and terms of a constraint."""
_Named = tuple[str, _Row]
"""With its name."""


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
            values = ", ".join(f"{name}={value:g}" for name, value in meant.parameters.items())
            name = f"{meant.name} with {values}" if values else meant.name
            raise CheckError(f"{path}: it is not of {name}: {different[0]}{more}")
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
    if set(found.names) != set(program.names):
        other = sorted(set(found.names) ^ set(program.names))
        return [f"the variables are not the same: {', '.join(other[:_MAX])}"]
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
            a, b = _figures(stated.get(j, Fraction(0)), own)
            wrong.append(f"the objective's coefficient of {program.names[j]} is {a}, not {b}")
    meant = [
        (item.name, _row({"G": 1, "E": 0, "L": -1}[item.sense], item.side, dict(item.terms)))
        for item in program.stated
    ]
    written = [
        (name, _row(item.sense, Fraction(item.side, item.under),
                    {place[j]: Fraction(a, item.under) for j, a in item.terms.items()}))
        for (_, name), item in zip(found.labels, found.constraints, strict=True)
    ]  # fmt: skip
    return wrong + _different_rows(program, meant, written)


def _different_rows(program: ExactProgram, meant: list[_Named], written: list[_Named]) -> list[str]:
    """In what the rows that are written are not those that are meant; rows of one name side by side."""
    known, given = (Counter(row for _, row in rows) for rows in (meant, written))
    lacking, added = known - given, given - known
    missing = {row: name for name, row in meant if row in lacking}
    others = {name: row for name, row in written if row in added}
    wrong: list[str] = []
    for row, name in missing.items():
        other = others.pop(name, None)
        text = "is missing" if other is None else _difference(program, row, other)
        wrong.append(f"{name} {text}")
    return wrong + [f"{_text(program, row)} is not in the program" for row in others.values()]


def _difference(program: ExactProgram, meant: _Row, written: _Row) -> str:
    """In what a row that is written differs from the one that is meant."""
    own, other = dict(meant[2]), dict(written[2])
    for j in sorted(own.keys() | other.keys()):
        if other.get(j, 0) != own.get(j, 0):
            a, b = _figures(other.get(j, Fraction(0)), own.get(j, Fraction(0)))
            return f"has {a}, not {b}, as coefficient of {program.names[j]}"
    a, b = _figures(written[1], meant[1])
    return f"is {_SENSES[written[0]]} {a}, not {_SENSES[meant[0]]} {b}"


def _row(sense: int, side: Rational, terms: Mapping[int, Rational]) -> _Row:
    return sense, Fraction(side), tuple(sorted((j, Fraction(a)) for j, a in terms.items() if a))


def _text(program: ExactProgram, row: _Row) -> str:
    sense, side, terms = row
    left = " + ".join(f"{_figure(a)} {program.names[j]}" for j, a in terms[:_MAX]) or "0"
    more = " + ..." if len(terms) > _MAX else ""
    return f"{left}{more} {_SENSES[sense]} {_figure(side)}"


def _figures(one: Fraction, other: Fraction) -> tuple[str, str]:
    """Two numbers as floats, or as fractions where these would be the same."""
    texts = _figure(one), _figure(other)
    return (f"{one}"[:_LONGEST], f"{other}"[:_LONGEST]) if texts[0] == texts[1] else texts


def _figure(number: Fraction) -> str:
    """`number` as a float, whatever its size."""
    try:
        return repr(float(number)).removesuffix(".0")
    except OverflowError:
        return "more than 1e308"
