"""A program in exact numbers: what a proof is about.

A float is a rational number, so a `Program` has an exact meaning; here it is, as the constraints of a
VIPR certificate, and for the prover in integers. The objective is minimised (a maximisation has its
sign turned); a constant in it becomes a variable that is 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from ..mission.exact import exact
from ..optimise.program import Program

CONSTANT = "objective_constant"
"""Name of the variable that is 1."""

Rational = int | Fraction
Reading = Callable[[float], Rational]
Numbers = Literal["binary", "decimal", "simple"]


@dataclass(slots=True)
class Row:
    """``lower ≤ Σ coefficients · columns ≤ upper`` in integers, and where it stands in the proof.

    It is `factor` times the constraint `at_lower` (where the lower side is used) or `at_upper`; these
    are the same for an equation, and -1 where there is no such side.
    """

    columns: Sequence[int]
    coefficients: Sequence[int]
    lower: int | None
    upper: int | None
    factor: int = 1
    at_lower: int = -1
    at_upper: int = -1


@dataclass(frozen=True, slots=True)
class Violation:
    """What a point violates, and by which share of the terms that should agree."""

    what: str
    relative: float


@dataclass(frozen=True, slots=True)
class Stated:
    """A constraint as the certificate states it; `terms` are pairs of a column and a coefficient."""

    name: str
    sense: str
    """``G``, ``L`` or ``E``."""
    side: Rational
    terms: tuple[tuple[int, Rational], ...]


@dataclass
class ExactProgram:
    """A `Program`, minimised, in exact numbers."""

    sign: int
    """1 for a minimisation, -1 for a maximisation."""
    names: list[str]
    integer: list[bool]
    cost: list[Fraction]
    """Of the minimisation, the constant's column included."""
    lower: list[Rational | None]
    upper: list[Rational | None]
    at_lower: list[int]
    """Index of the constraint that states the lower bound, -1 if there is none."""
    at_upper: list[int]
    rows: list[Row]
    stated: list[Stated] = field(repr=False)
    """Bounds first, then rows."""
    n_bounds: int = 0
    row_of: list[int] = field(default_factory=list, repr=False)
    """For each of `rows`, the program's row."""
    objective: list[Fraction] | None = None
    """The cost as it is stated, if that is in other units and holds a constant."""

    @property
    def n_columns(self) -> int:
        """Number of variables, the constant's included."""
        return len(self.names)

    @property
    def constant(self) -> Fraction:
        """What no point changes of the objective, which is no part of any difference of values."""
        pairs = zip(self.cost, self.lower, self.upper, strict=True)
        fixed = (c * low for c, low, high in pairs if low is not None and low == high)
        return sum(fixed, Fraction(0))

    @property
    def largest_cost(self) -> Fraction:
        """The size of the largest cost of a variable that can vary."""
        pairs = zip(self.cost, self.lower, self.upper, strict=True)
        return max(
            (abs(c) for c, low, high in pairs if low is None or low != high), default=Fraction(0)
        )

    def value(self, point: Sequence[Rational]) -> Fraction:
        """The objective to be minimised at `point`."""
        return sum((c * v for c, v in zip(self.cost, point, strict=True) if c and v), Fraction(0))

    def violated(self, point: Sequence[Rational]) -> Violation | None:
        """What `point` violates most, exactly; ``None`` if it is feasible."""
        worst: Violation | None = None
        for found in self._violations(point):
            if worst is None or found.relative > worst.relative:
                worst = found
        return worst

    def _violations(self, point: Sequence[Rational]) -> Iterator[Violation]:
        for j, value in enumerate(point):
            name, low, high = self.names[j], self.lower[j], self.upper[j]
            if self.integer[j] and value.denominator != 1:
                yield Violation(f"{name} = {float(value)!r} is no integer", math.inf)
            for bound, sign in ((low, 1), (high, -1)):
                side = Fraction(0 if bound is None else bound)
                if bound is not None and sign * (side - value) > 0:
                    share = float(abs(side - value) / (abs(side) + abs(Fraction(value))))
                    yield Violation(f"{name} = {float(value)!r} is beyond {float(side)!r}", share)
        for row in self.rows:
            terms = [
                Fraction(a * point[j]) for j, a in zip(row.columns, row.coefficients, strict=True)
            ]
            activity = sum(terms, Fraction(0))
            for end, at, sign in ((row.lower, row.at_lower, 1), (row.upper, row.at_upper, -1)):
                if end is not None and sign * (end - activity) > 0:
                    missed = abs(end - activity)
                    share = float(missed / (sum(map(abs, terms), Fraction(0)) + abs(end)))
                    what = f"{self.stated[at].name} is missed by {float(missed / row.factor):.2g}"
                    yield Violation(what, share)


def exact_program(program: Program, numbers: Numbers = "binary") -> ExactProgram:
    """`program` in exact numbers.

    Parameters
    ----------
    program : Program
        The arrays.
    numbers : str
        What a float stands for: ``binary``, the binary fraction that it is; ``decimal``, the shortest
        decimal that is read as it, which is what stands in a text file; ``simple``, the simplest
        fraction within its rounding (1/3 for 0.3333333333333333).
    """
    read = _READINGS[numbers]
    n = program.n_columns
    names = _unique(_word(program.column_name(j)) for j in range(n))
    sign = 1 if program.sense == "min" else -1
    cost = [sign * Fraction(read(c)) for c in program.cost.tolist()]
    integer = [bool(i) for i in program.integer]
    lower = [_finite(b, read) for b in program.lower.tolist()]
    upper = [_finite(b, read) for b in program.upper.tolist()]
    if program.offset:
        names.append(CONSTANT)
        cost.append(sign * Fraction(read(program.offset)))
        integer.append(True)
        lower.append(1)
        upper.append(1)
    found = ExactProgram(sign, names, integer, cost, lower, upper, [], [], [], [])
    for j in range(found.n_columns):
        _state_bounds(found, j)
    found.n_bounds = len(found.stated)
    _state_rows(found, program, read)
    return found


def _state_bounds(found: ExactProgram, j: int) -> None:
    low, high, name, terms = found.lower[j], found.upper[j], found.names[j], ((j, 1),)
    if low is not None and low == high:
        found.at_lower.append(len(found.stated))
        found.at_upper.append(len(found.stated))
        found.stated.append(Stated(f"fix:{name}", "E", low, terms))
        return
    found.at_lower.append(-1 if low is None else len(found.stated))
    if low is not None:
        found.stated.append(Stated(f"low:{name}", "G", low, terms))
    found.at_upper.append(-1 if high is None else len(found.stated))
    if high is not None:
        found.stated.append(Stated(f"upp:{name}", "L", high, terms))


def _state_rows(found: ExactProgram, program: Program, read: Reading) -> None:
    matrix = program.matrix.tocsr().copy()
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    starts, columns, data = matrix.indptr.tolist(), matrix.indices.tolist(), matrix.data.tolist()
    sides = zip(program.row_lower.tolist(), program.row_upper.tolist(), strict=True)
    words = _unique(_word(program.row_name(i)) for i in range(program.n_rows))
    for i, (low, high) in enumerate(sides):
        lower, upper = _finite(low, read), _finite(high, read)
        if lower is None and upper is None:
            continue
        own = columns[starts[i] : starts[i + 1]]
        own_numbers = [read(a) for a in data[starts[i] : starts[i + 1]]]
        numbers = [*own_numbers, *(side for side in (lower, upper) if side is not None)]
        factor = math.lcm(*(number.denominator for number in numbers))
        coefficients = [a.numerator * (factor // a.denominator) for a in own_numbers]
        terms = tuple(zip(own, own_numbers, strict=True))
        row = Row(own, coefficients, _times(lower, factor), _times(upper, factor), factor)
        if lower is not None:
            row.at_lower = len(found.stated)
            sense = "E" if lower == upper else "G"
            name = words[i] if upper is None or lower == upper else words[i] + ":low"
            found.stated.append(Stated(name, sense, lower, terms))
        if upper is not None:
            row.at_upper = row.at_lower
            if lower != upper:
                row.at_upper = len(found.stated)
                name = words[i] if lower is None else words[i] + ":upp"
                found.stated.append(Stated(name, "L", upper, terms))
        found.rows.append(row)
        found.row_of.append(i)


def _times(side: Rational | None, factor: int) -> int | None:
    return None if side is None else int(side * factor)


def _finite(number: float, read: Reading) -> Rational | None:
    return read(number) if math.isfinite(number) else None


def _binary(number: float) -> Rational:
    over, under = number.as_integer_ratio()
    return over if under == 1 else Fraction(over, under)


def _decimal(number: float) -> Rational:
    return _whole_if_it_is(Fraction(repr(number)))


def _simple(number: float) -> Rational:
    return _whole_if_it_is(exact(number))


def _whole_if_it_is(value: Fraction) -> Rational:
    return value.numerator if value.denominator == 1 else value


_READINGS: dict[Numbers, Reading] = {"binary": _binary, "decimal": _decimal, "simple": _simple}


def _word(name: str) -> str:
    """`name` as one word of text."""
    return "_".join(name.split()).replace("%", "_") or "_"


def _unique(names: Iterable[str]) -> list[str]:
    """`names`, those that were there already with a number behind."""
    seen: dict[str, int] = {}
    found: list[str] = []
    for name in names:
        count = seen[name] = seen.get(name, -1) + 1
        if count:
            while (numbered := f"{name}~{count}") in seen:
                count += 1
            seen[name], seen[numbered] = count, 0
            name = numbered
        found.append(name)
    return found
