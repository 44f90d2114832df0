"""The checker of VIPR 1.0: certificates of mixed-integer linear programs, checked in exact arithmetic.

The format is that of ``cert_spec_v1_0.md`` of the project scipopt/vipr (Cheung, Gleixner and Steffy
2017, *Verifying integer programming results*). A file states a program, solutions of it, and a chain of
derived constraints; the last one is what is claimed: that the program is infeasible, or that its optimal
value lies in a range. Each gives its reason; reasons other than the first are functions below.

=======  ==========================================================================================
``asm``  it is assumed, and depends on itself
``lin``  it is dominated by a suitable linear combination of constraints before it
``rnd``  … by such a combination with integer coefficients on integer variables, its side rounded
``uns``  it holds on both sides of a disjunction that every integer point satisfies
``sol``  points that are no better than a given solution need not be looked at
=======  ==========================================================================================

This file needs nothing but Python, and is a program by itself: ``python check.py FILE.vipr``. All
numbers are integers and fractions of integers; nothing is rounded but by ``rnd``. It reads as it goes
and forgets a derived constraint once the file says that nothing refers to it any more.

What the specification leaves open is decided here, each time on the side of refusing: variables have
names of their own, and occur once in a constraint; ``sol`` gives that the objective is at most that of
the best solution (at least, in a maximisation), by 1 less where all its coefficients are integers on
integer variables; it proves no infeasibility, and a solution outside the claimed range refutes the
claim. That names of constraints are unique is not checked: they are referred to by index.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import BinaryIO

MAX_DIGITS = 100_000  # of a number
LONGEST_WORD = 1_000_000  # characters

Number = int | Fraction
Terms = dict[int, int]  # coefficients by variable, over a common denominator; none is 0
Assumptions = frozenset[int]  # indices of the constraints that are assumed
NOTHING_ASSUMED: Assumptions = frozenset()


class RefusedError(Exception):
    """The certificate is not accepted: the line of the file, from 1, and what is wrong there."""

    def __init__(self, line: int, reason: str) -> None:
        self.line = line
        self.reason = reason
        super().__init__(f"line {line}: {reason}")


@dataclass(frozen=True, slots=True)
class Constraint:
    """``terms / under`` times the variables, ``sense`` (1: ≥, 0: =, -1: ≤), ``side / under``."""

    sense: int
    terms: Terms
    side: int
    under: int = 1
    assumptions: Assumptions = NOTHING_ASSUMED

    @property
    def is_absurd(self) -> bool:
        """Whether it is 0 ≥ β with β > 0, 0 ≤ β with β < 0, or 0 = β with β ≠ 0."""
        if self.terms:
            return False
        return (self.sense >= 0 and self.side > 0) or (self.sense <= 0 and self.side < 0)

    def dominates(self, other: Constraint) -> bool:
        """Whether `other` follows from it at sight, as *Domination of constraints* has it."""
        if self.is_absurd:
            return True
        if not self.has_terms_of(other):
            return False
        mine, others = self.side * other.under, other.side * self.under
        if other.sense > 0:
            return self.sense >= 0 and mine >= others
        if other.sense < 0:
            return self.sense <= 0 and mine <= others
        return self.sense == 0 and mine == others

    def has_terms_of(self, other: Constraint) -> bool:
        """Whether the left-hand sides are equal."""
        if self.under == other.under:
            return self.terms == other.terms
        return len(self.terms) == len(other.terms) and all(
            a * other.under == other.terms.get(j, 0) * self.under for j, a in self.terms.items()
        )

    def difference(self, other: Constraint) -> str:
        """Why it does not dominate `other`."""
        for j in sorted(self.terms.keys() | other.terms.keys()):
            mine = Fraction(self.terms.get(j, 0), self.under)
            others = Fraction(other.terms.get(j, 0), other.under)
            if mine != others:
                return f"has {_shown(mine)}, not {_shown(others)}, as coefficient of variable {j}"
        ends = [
            f"{('=', '>=', '<=')[item.sense]} {_shown(Fraction(item.side, item.under))}"
            for item in (self, other)
        ]
        return f"is {ends[0]}, which does not give {ends[1]}"


def of(sense: int, terms: Terms, under: int, side: Number) -> Constraint:
    """The constraint ``terms / under`` times the variables, ``sense``, ``side``."""
    if under % side.denominator:
        common = math.lcm(under, side.denominator)
        terms = {j: a * (common // under) for j, a in terms.items()}
        under = common
    return Constraint(sense, terms, side.numerator * (under // side.denominator), under)


@dataclass
class Certificate:
    """What the sections before the derivations say."""

    names: list[str] = field(default_factory=list)
    """Of the variables."""
    integer: set[int] = field(default_factory=set)
    minimise: bool = True
    objective: Terms = field(default_factory=dict)
    objective_under: int = 1
    constraints: list[Constraint] = field(default_factory=list)
    labels: list[tuple[int, str]] = field(default_factory=list)
    """Of the constraints: the line that each begins on, and its name."""
    infeasible: bool = False
    """Whether this is what is claimed; else a range is."""
    lower: Number | None = None
    """The claimed lower end; ``None`` for -inf."""
    upper: Number | None = None
    """The claimed upper end; ``None`` for inf."""
    best: Fraction | None = None
    """The value of the best solution that was checked."""
    n_derivations: int = 0

    @property
    def claim(self) -> str:
        """What the file claims, in words."""
        if self.infeasible:
            return "infeasible"
        low = "(-inf" if self.lower is None else f"[{_shown(self.lower)}"
        high = "inf)" if self.upper is None else f"{_shown(self.upper)}]"
        ends = [Fraction(end) for end in (self.lower, self.upper) if end is not None]
        is_told = any(e.denominator > 1 for e in ends) and all(abs(e) < 10**300 for e in ends)
        near = " to ".join(dict.fromkeys(f"{float(e):.9g}" for e in ends)) if is_told else ""
        about = f" (about {near})" if near else ""
        return f"{'minimum' if self.minimise else 'maximum'} in {low}, {high}{about}"

    @property
    def relation(self) -> Constraint | None:
        """The constraint that must be derived; ``None`` if none need be."""
        if self.infeasible:
            return Constraint(1, {}, 1)
        sense, bound = (1, self.lower) if self.minimise else (-1, self.upper)
        return None if bound is None else of(sense, self.objective, self.objective_under, bound)

    @property
    def cutoff(self) -> Constraint | None:
        """The constraint that only better points than the best solution satisfy, if there is one."""
        if self.best is None:
            return None
        integral = self.objective_under == 1 and self.integer.issuperset(self.objective)
        sense = -1 if self.minimise else 1
        return of(sense, self.objective, self.objective_under, self.best + sense * integral)


class Reader:
    """The words of a file, one after another, and the line that the last one stood on."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._words: list[bytes] = []
        self._at = 0
        self._next_line = 1
        self.line = 1

    def refusal(self, reason: str) -> RefusedError:
        """The refusal of what was read last."""
        return RefusedError(self.line, reason)

    def word(self, what: str) -> bytes:
        """The next word, which should be `what`."""
        while self._at == len(self._words):
            if not self._fill():
                raise self.refusal(f"the file ends where {what} should be")
        self._at += 1
        return self._words[self._at - 1]

    def keyword(self, *expected: bytes) -> bytes:
        """The next word, one of `expected`."""
        found = self.word(expected[0].decode())
        if found not in expected:
            names = " or ".join(word.decode() for word in expected)
            raise self.refusal(f"{_shown(found)} where {names} should be")
        return found

    def whole(self, what: str) -> int:
        """The next word as an integer."""
        return self.as_whole(self.word(what), what)

    def count(self, what: str, word: bytes | None = None) -> int:
        """`word`, or else the next one, as a number of things."""
        what = f"the number of {what}"
        found = self.as_whole(self.word(what) if word is None else word, what)
        if found < 0:
            raise self.refusal(f"{found} for {what}")
        return found

    def as_whole(self, word: bytes, what: str) -> int:
        """`word` as an integer."""
        if not (word.isdigit() or (word[:1] == b"-" and word[1:].isdigit())):
            raise self.refusal(f"{_shown(word)} where {what} should be, an integer")
        if len(word) > MAX_DIGITS:
            raise self.refusal(f"{len(word)} digits for {what}")
        return int(word)

    def as_number(self, word: bytes, what: str) -> Number:
        """`word` as a rational number: an integer, a fraction or a finite decimal."""
        if b"/" in word:
            over, _, under = word.partition(b"/")
            if not under.isdigit() or not under.strip(b"0"):
                raise self.refusal(f"{_shown(word)} where {what} should be, a fraction")
            return Fraction(self.as_whole(over, what), self.as_whole(under, what))
        if b"." in word:
            whole, _, decimals = word.partition(b".")
            if decimals and not decimals.isdigit():
                raise self.refusal(f"{_shown(word)} where {what} should be, a decimal")
            return Fraction(self.as_whole(whole + decimals, what), 10 ** len(decimals))
        return self.as_whole(word, what)

    def skip_comments(self) -> None:
        """Go past the comment lines at the beginning of the file."""
        while self._file.peek(1)[:1] == b"%":  # type: ignore[attr-defined]
            piece = b"%"
            while piece and not piece.endswith(b"\n"):
                piece = self._file.readline(LONGEST_WORD)
            self._next_line += 1

    def end(self) -> None:
        """Refuse anything but the end of the file."""
        while self._at == len(self._words):
            if not self._fill():
                return
        raise self.refusal(f"{_shown(self._words[self._at])} after the last derivation")

    def _fill(self) -> bool:
        """Read a line, or as much of a very long one as ends with a whole word."""
        piece = self._file.readline(LONGEST_WORD)
        self.line = self._next_line if piece else self.line
        while piece and not piece[-1:].isspace():
            more = self._file.readline(4096)
            if not more:
                break
            piece += more
            if len(piece) > 2 * LONGEST_WORD:
                raise self.refusal(f"a word of more than {LONGEST_WORD} characters")
        self._next_line += piece.count(b"\n")
        self._words, self._at = piece.split(), 0
        return bool(piece)


def _shown(word: bytes | Number) -> str:
    if not isinstance(word, bytes) and abs(word.numerator) + word.denominator > 10**1000:
        return "a number of over 1000 digits"
    text = repr(word.decode("utf-8", "replace")) if isinstance(word, bytes) else str(word)
    return text if len(text) <= 60 else text[:56] + "…" + text[-1]


# The sections, in their order.


def read_program(reader: Reader) -> Certificate:
    """The sections ``VER`` to ``CON``: the program that the certificate is about."""
    found = Certificate()
    reader.skip_comments()
    reader.keyword(b"VER")
    reader.keyword(b"1.0")
    reader.keyword(b"VAR")
    names: dict[bytes, None] = {}
    for _ in range(reader.count("variables")):
        name = reader.word("a variable's name")
        if name in names:
            raise reader.refusal(f"a second variable is called {_shown(name)}")
        names[name] = None
    found.names = [name.decode("utf-8", "surrogateescape") for name in names]
    reader.keyword(b"INT")
    for _ in range(reader.count("integer variables")):
        found.integer.add(_variable(reader, len(found.names)))
    reader.keyword(b"OBJ")
    found.minimise = reader.keyword(b"min", b"max") == b"min"
    size = reader.count("objective coefficients")
    found.objective, found.objective_under = _terms(reader, size, len(found.names))
    reader.keyword(b"CON")
    n_constraints, n_bounds = reader.count("constraints"), reader.count("bound constraints")
    if n_bounds > n_constraints:
        raise reader.refusal(f"{n_bounds} of {n_constraints} constraints are said to be bounds")
    for index in range(n_constraints):
        item = _constraint(reader, found, found.labels)
        if index < n_bounds and len(item.terms) > 1:
            raise reader.refusal(f"constraint {index} is no bound, and bounds come first")
        found.constraints.append(item)
    return found


def read_claim(reader: Reader, found: Certificate) -> None:
    """The section ``RTP``: the relation to prove."""
    reader.keyword(b"RTP")
    found.infeasible = reader.keyword(b"infeas", b"range") == b"infeas"
    if found.infeasible:
        return
    low, high = reader.word("the lower bound"), reader.word("the upper bound")
    found.lower = None if low == b"-inf" else reader.as_number(low, "the lower bound")
    found.upper = None if high == b"inf" else reader.as_number(high, "the upper bound")
    if found.lower is not None and found.upper is not None and found.upper < found.lower:
        raise reader.refusal("the lower bound is above the upper one")


def check_solutions(reader: Reader, found: Certificate) -> None:
    """The section ``SOL``: each solution is feasible, and the best one is where it is claimed to be."""
    reader.keyword(b"SOL")
    for _ in range(reader.count("solutions")):
        name = _shown(reader.word("a solution's name"))
        point, under = _terms(reader, reader.count("values"), len(found.names))
        for j, value in point.items():
            if j in found.integer and value % under:
                raise reader.refusal(f"solution {name} has no integer for variable {j}")
        for index, item in enumerate(found.constraints):
            beyond = _product(item.terms, point) - item.side * under
            if beyond * item.sense < 0 or (item.sense == 0 and beyond):
                raise reader.refusal(f"solution {name} does not satisfy constraint {index}")
        if found.infeasible:
            raise reader.refusal(f"solution {name} is feasible, where infeasibility is claimed")
        worth = Fraction(_product(found.objective, point), under * found.objective_under)
        if found.best is None or (worth < found.best if found.minimise else worth > found.best):
            found.best = worth
    best, low, high = found.best, found.lower, found.upper
    if best is None:
        if (high if found.minimise else low) is not None:
            raise reader.refusal("no solution is given that reaches the claimed range")
    elif (low is not None and best < low) or (high is not None and high < best):
        raise reader.refusal(f"the best solution has the value {_shown(best)}, outside the claim")


def _product(terms: Terms, point: Terms) -> int:
    if len(point) < len(terms):
        terms, point = point, terms
    return sum(a * point.get(j, 0) for j, a in terms.items())


def check_derivations(reader: Reader, found: Certificate) -> None:
    """The section ``DER``: each constraint follows by its reason, and the last one is the claim."""
    reader.keyword(b"DER")
    found.n_derivations = reader.count("derivations")
    proof, last = Proof(found), None
    for index in range(proof.n_given, proof.n_given + found.n_derivations):
        last = proof.derive(reader, index)
    reader.end()
    relation = found.relation
    if relation is None:
        return
    what = "infeasibility" if found.infeasible else "the claimed bound"
    if last is None:
        raise reader.refusal(f"nothing is derived, so {what} is not proved")
    if last.assumptions:
        raise reader.refusal(f"{what} is derived only if constraint {min(last.assumptions)} holds")
    if not last.dominates(relation):
        raise reader.refusal(f"what is derived last is not {what}: it {last.difference(relation)}")


class Proof:
    """The constraints so far, by index, and how each reason leads from them to the next."""

    def __init__(self, found: Certificate) -> None:
        self.found = found
        self.known: dict[int, Constraint] = dict(enumerate(found.constraints))
        self.n_given = len(self.known)
        self._last_used: dict[int, list[int]] = {}
        """Which constraints to forget, by the last index that refers to them."""

    def derive(self, reader: Reader, index: int) -> Constraint:
        """Read the next constraint, and make sure that its reason holds."""
        stated = _constraint(reader, self.found)
        begins = reader.line
        reader.keyword(b"{")
        rule = reader.keyword(b"asm", b"lin", b"rnd", b"uns", b"sol")
        try:
            if rule == b"asm":
                assumptions = frozenset((index,))
            elif rule in (b"lin", b"rnd"):
                follows = self.linear if rule == b"lin" else self.rounding
                assumptions = follows(stated, self._multipliers(reader, index))
            elif rule == b"uns":
                indices = [self._index(reader, index) for _ in range(4)]
                assumptions = self.unsplit(stated, *indices)
            else:
                assumptions = self.cutoff(stated)
        except ValueError as error:
            raise RefusedError(begins, f"constraint {index} by {rule.decode()}: {error}") from None
        reader.keyword(b"}")
        stated = replace(stated, assumptions=assumptions)
        last_use = reader.whole("the last index that refers to the constraint")
        if last_use < -1:
            raise reader.refusal(f"{last_use} for the last index that refers to the constraint")
        if last_use == -1 or last_use > index:
            self.known[index] = stated
        if last_use > index:
            self._last_used.setdefault(last_use, []).append(index)
        for gone in self._last_used.pop(index, ()):
            del self.known[gone]
        return stated

    def linear(self, stated: Constraint, multipliers: list[tuple[int, Number]]) -> Assumptions:
        """``lin``: a suitable linear combination that dominates the constraint."""
        combined = self.combination(multipliers)
        if not combined.dominates(stated):
            raise ValueError(f"the linear combination {combined.difference(stated)}")
        return combined.assumptions

    def rounding(self, stated: Constraint, multipliers: list[tuple[int, Number]]) -> Assumptions:
        """``rnd``: … that can be rounded, and dominates the constraint then."""
        combined = self.combination(multipliers)
        if not combined.sense:
            raise ValueError("an equation cannot be rounded")
        self._require_integers(combined)
        under, up = combined.under, combined.sense > 0
        side = -(-combined.side // under) if up else combined.side // under
        terms = {j: a // under for j, a in combined.terms.items()}
        rounded = Constraint(combined.sense, terms, side)
        if not rounded.dominates(stated):
            raise ValueError(f"the rounded combination {rounded.difference(stated)}")
        return combined.assumptions

    def unsplit(
        self, stated: Constraint, one: int, asm_one: int, other: int, asm_other: int
    ) -> Assumptions:
        """``uns``: it holds if ``a x ≤ β`` and if ``a x ≥ β + 1``, and one of these is always so."""
        for index in (one, other):
            if not self.known[index].dominates(stated):
                raise ValueError(f"constraint {index} {self.known[index].difference(stated)}")
        low, high = self.known[asm_one], self.known[asm_other]
        if low.sense > high.sense:
            low, high = high, low
        if (low.sense, high.sense) != (-1, 1) or not low.has_terms_of(high):
            raise ValueError(f"constraints {asm_one} and {asm_other} are not ≤ and ≥ of the same")
        self._require_integers(low)
        if low.side % low.under or (low.side // low.under + 1) * high.under != high.side:
            raise ValueError(f"constraints {asm_one} and {asm_other} are not ≤ β and ≥ β + 1")
        return (self.known[one].assumptions - {asm_one}) | (
            self.known[other].assumptions - {asm_other}
        )

    def cutoff(self, stated: Constraint) -> Assumptions:
        """``sol``: no point is needed that is no better than the best solution."""
        cutoff = self.found.cutoff
        if cutoff is None or not cutoff.dominates(stated):
            raise ValueError(f"the best solution, of value {self.found.best}, gives no such cutoff")
        return NOTHING_ASSUMED

    def combination(self, multipliers: list[tuple[int, Number]]) -> Constraint:
        """A suitable linear combination: the senses of its terms agree."""
        sense, under = 0, 1
        for index, weight in multipliers:
            item = self.known[index]
            pointing = item.sense if weight > 0 else -item.sense
            if pointing and sense and pointing != sense:
                raise ValueError(f"the sign of the multiplier of constraint {index} is wrong")
            sense = sense or pointing
            if under % (item.under * weight.denominator):
                under = math.lcm(under, item.under * weight.denominator)
        terms: Terms = {}
        side, assumptions = 0, NOTHING_ASSUMED
        for index, weight in multipliers:
            item = self.known[index]
            factor = weight.numerator * (under // (item.under * weight.denominator))
            side += factor * item.side
            for j, a in item.terms.items():
                terms[j] = terms.get(j, 0) + factor * a
            if not assumptions.issuperset(item.assumptions):
                assumptions |= item.assumptions
        return Constraint(sense, {j: a for j, a in terms.items() if a}, side, under, assumptions)

    def _require_integers(self, item: Constraint) -> None:
        """Refuse anything but integer coefficients on integer variables."""
        for j, a in item.terms.items():
            if j not in self.found.integer:
                raise ValueError(f"variable {j} is not integer, and has a coefficient")
            if a % item.under:
                raise ValueError(f"variable {j} has a coefficient that is no integer")

    def _multipliers(self, reader: Reader, index: int) -> list[tuple[int, Number]]:
        found: dict[int, Number] = {}
        for _ in range(reader.count("multipliers")):
            other = self._index(reader, index)
            if other in found:
                raise reader.refusal(f"constraint {other} has two multipliers")
            found[other] = reader.as_number(reader.word("a multiplier"), "a multiplier")
        return [(other, weight) for other, weight in found.items() if weight]

    def _index(self, reader: Reader, index: int) -> int:
        """The next word as the index of a constraint before `index`."""
        other = reader.whole("the index of a constraint")
        if other in self.known:
            return other
        when = "was not to be used again" if 0 <= other < index else "is not before it"
        raise reader.refusal(f"constraint {index} refers to constraint {other}, which {when}")


def _constraint(
    reader: Reader, found: Certificate, labels: list[tuple[int, str]] | None = None
) -> Constraint:
    """A constraint: name (put into `labels`), sense, side, and coefficients or ``OBJ``."""
    name = reader.word("a constraint's name")
    if labels is not None:
        labels.append((reader.line, name.decode("utf-8", "surrogateescape")))
    sense = {b"E": 0, b"L": -1, b"G": 1}[reader.keyword(b"E", b"L", b"G")]
    side = reader.as_number(reader.word("the right-hand side"), "the right-hand side")
    size = reader.word("the number of coefficients, or OBJ")
    if size == b"OBJ":
        return of(sense, found.objective, found.objective_under, side)
    return of(sense, *_terms(reader, reader.count("coefficients", size), len(found.names)), side)


def _terms(reader: Reader, size: int, n_variables: int) -> tuple[Terms, int]:
    """``size`` pairs of a variable and a number, over a common denominator."""
    numbers: dict[int, Number] = {}
    under = 1
    for _ in range(size):
        j = _variable(reader, n_variables)
        if j in numbers:
            raise reader.refusal(f"variable {j} occurs twice")
        number = numbers[j] = reader.as_number(reader.word("a number"), "a number")
        if under % number.denominator:
            under = math.lcm(under, number.denominator)
    return {j: a.numerator * (under // a.denominator) for j, a in numbers.items() if a}, under


def _variable(reader: Reader, n_variables: int) -> int:
    j = reader.whole("the index of a variable")
    if not 0 <= j < n_variables:
        raise reader.refusal(f"variable {j}, where there are {n_variables}")
    return j


def verify(path: str, admit: Callable[[Certificate], object] | None = None) -> Certificate:
    """What the certificate in the file `path` proves; `admit` may refuse the program it is about.

    Raises
    ------
    RefusedError
        If it does not prove what it claims, with the line at which it fails.
    OSError
        If the file cannot be read, or is not a regular one: a pipe may never end.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        raise OSError(0, "not a regular file")
    digits = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)  # longer numbers than `MAX_DIGITS` are refused before
    try:
        with open(path, "rb") as file:
            reader = Reader(file)
            found = read_program(reader)
            if admit is not None:
                admit(found)
            read_claim(reader, found)
            check_solutions(reader, found)
            check_derivations(reader, found)
    finally:
        sys.set_int_max_str_digits(digits)
    return found


def main(paths: list[str]) -> int:
    """Check the files `paths` and say what they prove; 0 if all are accepted, 1 if not, 2 if unread."""
    status = 0
    for path in paths:
        began = time.perf_counter()
        try:
            found = verify(path)
        except RefusedError as refusal:
            print(f"{path}: refused: {refusal}")
            status = max(status, 1)
        except OSError as error:
            print(f"{path}: {error.strerror}", file=sys.stderr)
            status = 2
        else:
            print(
                f"{path}: proved: {found.claim} ({len(found.names)} variables, "
                f"{len(found.constraints)} constraints, {found.n_derivations} derivations, "
                f"{time.perf_counter() - began:.1f} s)"
            )
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) if sys.argv[1:] else "usage: python check.py FILE.vipr...")
