r"""Reading programs in LP format.

::

    file     = ("max" | "min") [name ":"] [side] "subject to" {row} {section} "end"
    row      = [name ":"] side relation side [relation side]
    side     = [sign] term {sign term}
    term     = number | [number] name
    section  = "bounds" {row | name "free"} | ("general" | "binary") {name}

Words are in any case and of any of the spellings below, the first of their line; ``\`` begins a remark.
Variables and constants may stand on both sides of a relation, and terms of one variable add up. A
constant on the right ends with its line, so that a row needs no name. Two terms without a sign between
them are refused: what ``3 x y`` or ``2 3 x`` means, nobody knows. Of bounds given twice the last one
counts, as all readers have it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count, pairwise
from typing import NamedTuple

from ...mission.errors import InputError, shown
from ..program import Program
from .draft import NUMBER, Column, Draft, Row, limit, number

_SPELLINGS = {
    "max": "max maximise maximize maximum",
    "min": "min minimise minimize minimum",
    "rows": "st st. s.t. subject such",
    "bounds": "bound bounds",
    "general": "gen general generals int integer integers",
    "binary": "bin binaries binary",
    "other": "lazy pwlobj scenario semi semis semi-continuous sin sos sos1 sos2 user",
    "end": "end",
}
_WORDS = {word: section for section, words in _SPELLINGS.items() for word in words.split()}
_SECOND = {"subject": "to", "such": "that"}
_INFINITE = ("inf", "infinity")
_NO_NAMES = {*_WORDS, *_INFINITE, "free", "nan"}
_FURTHER = r"A-Za-z0-9_.,()!\"#$%&?@'`{}~|"

_TOKEN = re.compile(
    rf"(?P<blank>[ \t]+|\\.*)|(?P<line>\n)|(?P<number>{NUMBER})|(?P<relation>[<>]=?|=[<>]?)"
    rf"|(?P<sign>[+-])|(?P<colon>:)|(?P<name>(?i:semi-continuous)|[A-Za-z_][{_FURTHER}]*)"
)


class _Token(NamedTuple):
    kind: str
    text: str
    line: int
    joined: bool
    """Whether nothing is between it and what comes before."""

    def wrong(self, problem: str) -> InputError:
        return InputError(problem, field=f"line {self.line}")


def read_lp(text: str) -> Program:
    """The program in the text of an LP file.

    Raises
    ------
    InputError
        Naming the line, what is wrong with it and what would be right.
    """
    draft = Draft()
    (sense, objective), *others = _sections(_tokens(text))
    if sense not in ("max", "min"):
        raise objective.header.wrong("neither minimize nor maximize before it")
    draft.sense = "max" if sense == "max" else "min"
    _read_objective(draft, objective)
    if not others or others[0][0] != "rows":
        raise objective.header.wrong("no 'subject to' behind the objective")
    if others[-1][0] != "end":
        raise InputError("no 'end'; the file is cut off")
    for section, tokens in others:
        if section == "rows" and tokens is not others[0][1]:
            raise tokens.header.wrong("a second list of rows; give one")
        read = {"rows": _read_rows, "bounds": _read_bounds, "general": _read_integers}
        read |= {"binary": _read_integers, "other": _read_nothing, "end": _read_nothing}
        if section not in read:
            raise tokens.header.wrong("a second objective; give one")
        read[section](draft, tokens)
    return draft.program()


def _tokens(text: str) -> Iterator[_Token]:
    at, line, joined = 0, 1, False
    while at < len(text):
        found = _TOKEN.match(text, at)
        if found is None:
            character = text[at]
            what = "a quadratic term, or no part" if character in "[]^*/" else "no part"
            raise InputError(
                f"{shown(character)} is {what} of a linear program", field=f"line {line}"
            )
        kind = str(found.lastgroup)
        if kind != "blank":
            yield _Token(kind, found[0], line, joined)
        joined = kind != "blank"
        line += kind == "line"
        at = found.end()


@dataclass
class _Tokens:
    """The tokens of a section, from the front."""

    header: _Token
    todo: list[_Token] = field(default_factory=list)
    at: int = 0

    def next(self) -> _Token | None:
        """The next one, that stays where it is."""
        return self.todo[self.at] if self.at < len(self.todo) else None

    def take(self) -> _Token:
        """The next one, which must be there."""
        if self.at == len(self.todo):
            last = self.todo[-1] if self.todo else self.header
            raise last.wrong("more was to come")
        self.at += 1
        return self.todo[self.at - 1]

    def kinds(self, *kinds: str) -> bool:
        """Whether tokens of these kinds come next."""
        return tuple(token.kind for token in self.todo[self.at : self.at + len(kinds)]) == kinds

    def skip_lines(self) -> None:
        while self.kinds("line"):
            self.at += 1


def _sections(tokens: Iterator[_Token]) -> list[tuple[str, _Tokens]]:
    """The sections of a file, each with what is in it."""
    every = list(tokens)
    found: list[tuple[str, _Tokens]] = []
    at, first = 0, True
    while at < len(every):
        token = every[at]
        word = token.text.lower()
        labels = at + 1 < len(every) and every[at + 1].kind == "colon"
        at += 1
        if first and word in _WORDS and not labels:
            if word in _SECOND:
                if at == len(every) or every[at].text.lower() != _SECOND[word]:
                    raise token.wrong(f"{shown(token.text)} without '{_SECOND[word]}' behind it")
                at += 1
            found.append((_WORDS[word], _Tokens(token)))
        elif found:
            found[-1][1].todo.append(token)
        elif token.kind != "line":
            raise token.wrong(f"{shown(token.text)}, where minimize or maximize should be")
        first = token.kind == "line"
    if not found:
        raise InputError("neither minimize nor maximize in it; give a linear program")
    return found


@dataclass
class _Side:
    """One side of a relation: a constant, and coefficients by variable."""

    constant: float = 0.0
    terms: dict[str, float] = field(default_factory=dict)
    empty: bool = True


def _side(tokens: _Tokens, *, on_the_right: bool = False, is_number: bool = False) -> _Side:
    """The next side; if it `is_number`, no coefficient is joined to a variable: 0x10 is no zero."""
    side = _Side()
    sign: float | None = None
    factor: float | None = None

    def finish(variable: str = "") -> None:
        nonlocal sign, factor
        value = (1.0 if sign is None else sign) * (1.0 if factor is None else factor)
        if variable:
            side.terms[variable] = side.terms.get(variable, 0.0) + value
        else:
            side.constant += value
        side.empty, sign, factor = False, None, None

    while token := tokens.next():
        if token.kind in ("relation", "colon") or tokens.kinds("name", "colon"):
            break
        constant = not side.terms and (factor is not None or (not side.empty and sign is None))
        if token.kind == "line" and on_the_right and constant:
            break  # with its line
        tokens.at += 1
        if token.kind == "line":
            continue
        if token.kind == "sign":
            if factor is not None:
                finish()
            sign = (1.0 if sign is None else sign) * (1.0 if token.text == "+" else -1.0)
            continue
        infinite = token.text.lower() in _INFINITE
        variable = "" if token.kind == "number" or infinite else _name(token)
        if factor is None and sign is None and not side.empty:
            raise token.wrong(f"{shown(token.text)} without a sign before it")
        if not variable:
            if factor is not None:
                raise token.wrong(f"{shown(token.text)} behind another number, without a sign")
            factor = math.inf if infinite else _number(token)
        else:
            if factor == math.inf:
                raise token.wrong("an infinite coefficient; give a number")
            if token.joined and factor is not None and (is_number or token.text[0] in "eE"):
                raise token.wrong(f"{shown(token.text)} joined to a number; put a blank between")
            finish(variable)
            if not math.isfinite(side.terms[variable]):
                raise token.wrong(
                    f"coefficients of {shown(variable)} add up beyond a float's range"
                )
    if factor is not None:
        finish()
    if sign is not None:
        raise (tokens.next() or tokens.todo[-1]).wrong("a sign with nothing behind it")
    return side


def _number(token: _Token) -> float:
    try:
        return number(token.text)
    except InputError as error:
        raise token.wrong(error.problem) from None


def _name(token: _Token) -> str:
    if token.kind != "name" or token.text.lower() in _NO_NAMES:
        raise token.wrong(f"{shown(token.text)}, where the name of a variable or a row should be")
    return token.text


class _Statement(NamedTuple):
    """What a row or a bound says: minimum and maximum, ``None`` where it says nothing."""

    terms: dict[str, float]
    lower: float | None
    upper: float | None


def _statement(tokens: _Tokens) -> _Statement:
    start = tokens.next() or tokens.header
    sides, relations = [_side(tokens)], []
    while tokens.kinds("relation"):
        relations.append(tokens.take().text.replace("=", "")[:1] or "=")
        is_number = any(side.terms for side in sides)
        sides.append(_side(tokens, on_the_right=True, is_number=is_number))
    if len(sides) not in (2, 3):
        raise start.wrong("a row has one relation: terms, then <=, >= or =, then a number")
    if any(side.empty for side in sides):
        raise start.wrong("a relation with nothing on one of its sides")
    if len(sides) == 3:
        outer_terms = sides[0].terms or sides[2].terms
        if relations[0] != relations[1] or "=" in relations or outer_terms:
            raise start.wrong(
                "two relations in a row; give 'number <= terms <= number', or two rows"
            )
        middle, ends = sides[1], (sides[0].constant, sides[2].constant)
        low, high = ends if relations[0] == "<" else ends[::-1]
        return _checked(start, middle.terms, low - middle.constant, high - middle.constant)
    left, right, relation = *sides, relations[0]
    if not left.terms:
        left, right, relation = right, left, {"<": ">", ">": "<", "=": "="}[relation]
    terms = dict(left.terms)
    for name, value in right.terms.items():
        terms[name] = terms.get(name, 0.0) - value
    value = right.constant - left.constant
    return _checked(
        start, terms, None if relation == "<" else value, None if relation == ">" else value
    )


def _checked(
    start: _Token, terms: dict[str, float], low: float | None, high: float | None
) -> _Statement:
    if not terms:
        raise start.wrong("a relation of numbers alone; give variables")
    low, high = (None if side is None else limit(side) for side in (low, high))
    if low == math.inf or high == -math.inf or any(map(math.isnan, (low or 0.0, high or 0.0))):
        raise start.wrong("a side that no number can meet; give a finite one")
    return _Statement(terms, low, high)


def _read_objective(draft: Draft, tokens: _Tokens) -> None:
    tokens.skip_lines()
    if tokens.kinds("name", "colon"):
        _name(tokens.take())
        tokens.take()
    side = _side(tokens)
    if token := tokens.next():
        raise token.wrong(f"{shown(token.text)} in the objective; give terms alone")
    if not math.isfinite(side.constant):
        raise tokens.header.wrong("an infinite constant; give a finite one")
    draft.offset = side.constant
    for name, value in side.terms.items():
        draft.columns[name] = Column(cost=value)


def _read_rows(draft: Draft, tokens: _Tokens) -> None:
    given = {a.text for a, b in pairwise(tokens.todo) if b.kind == "colon"}
    tokens.skip_lines()
    while token := tokens.next():
        numbered = (f"R{number}" for number in count(len(draft.rows) + 1))
        name = next(name for name in numbered if name not in given and name not in draft.rows)
        if tokens.kinds("name", "colon"):
            name = _name(tokens.take())
            tokens.take()
        if name in draft.rows:
            raise token.wrong(f"a second row {shown(name)}; names differ")
        terms, low, high = _statement(tokens)
        draft.rows[name] = Row(
            {name: value for name, value in terms.items() if value},
            -math.inf if low is None else low,
            math.inf if high is None else high,
        )
        for variable in terms:
            draft.columns.setdefault(variable, Column())
        if (after := tokens.next()) and not (tokens.kinds("line") or tokens.kinds("name", "colon")):
            raise after.wrong(f"{shown(after.text)} behind a row")
        tokens.skip_lines()


def _read_bounds(draft: Draft, tokens: _Tokens) -> None:
    lines: dict[int, _Tokens] = {}
    for token in tokens.todo:
        if token.kind != "line":
            lines.setdefault(token.line, _Tokens(token)).todo.append(token)
    for line in lines.values():
        if line.kinds("name", "name") and line.todo[1].text.lower() == "free":
            column = _known(draft, line.take())
            column.lower, column.upper = -math.inf, math.inf
            line.take()
        else:
            terms, low, high = _statement(line)
            (name, factor), *more = terms.items()
            if more or factor != 1:
                raise line.header.wrong("a bound is of one variable, without a coefficient")
            named = next(token for token in line.todo if token.text == name)
            column = _known(draft, named)
            column.lower = column.lower if low is None else low
            column.upper = column.upper if high is None else high
        if (after := line.next()) is not None:
            raise after.wrong(f"{shown(after.text)} behind a bound; one a line")


def _read_integers(draft: Draft, tokens: _Tokens) -> None:
    for token in tokens.todo:
        if token.kind != "line":
            column = _known(draft, token)
            column.integer = True
            column.binary = column.binary or _WORDS[tokens.header.text.lower()] == "binary"


def _read_nothing(draft: Draft, tokens: _Tokens) -> None:
    """What must be empty: sections of programs that are not linear, and what is behind the end."""
    del draft
    for token in tokens.todo:
        if token.kind != "line":
            header = tokens.header.text
            raise token.wrong(f"{shown(token.text)} behind {shown(header)}; give a linear program")


def _known(draft: Draft, token: _Token) -> Column:
    name = _name(token)
    if name not in draft.columns:
        raise token.wrong(
            f"unknown variable {shown(name)}; it is in no row and not in the objective"
        )
    return draft.columns[name]
