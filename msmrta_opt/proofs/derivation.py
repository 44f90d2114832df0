"""What derivations are made of, before they have their places in a certificate.

A *reference* tells a constraint: an index from 0 is that of a constraint of the program, `LEMMA` and
above is a lemma, and a negative one is an assumption: -1 is that of the first branching on the way from
the root, -2 of the second, and so on.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, partial

from .exact import ExactProgram, Rational

LEMMA = 1 << 48

Uses = tuple[tuple[int, Rational], ...]


@dataclass(frozen=True, slots=True)
class Side:
    """A bound of a column, and the reference of the constraint that states it."""

    bound: Rational
    at: int


@dataclass
class Box:
    """The bounds of all columns at a node; ``None`` where there is none."""

    lower: list[Side | None]
    upper: list[Side | None]

    @classmethod
    def of(cls, program: ExactProgram) -> Box:
        """The bounds that the program states."""
        return cls(*(
            [None if b is None else Side(b, at) for b, at in zip(bounds, places, strict=True)]
            for bounds, places in (
                (program.lower, program.at_lower), (program.upper, program.at_upper)
            )
        ))  # fmt: skip

    def bounds(self, j: int) -> tuple[Rational | None, Rational | None]:
        """The bounds of a column."""
        low, high = self.lower[j], self.upper[j]
        return None if low is None else low.bound, None if high is None else high.bound


@dataclass(frozen=True, slots=True)
class Combination:
    """A linear combination that gives ``objective ≥ value``, in exact numbers.

    Without a value it gives ``0 ≥ β`` with β > 0: a contradiction.
    """

    value: Fraction | None
    multipliers: Mapping[int, int]
    """By reference, over `under`."""
    under: int


@dataclass(frozen=True)
class Lemma:
    """A derived constraint that proofs may refer to, and its reason."""

    sense: str
    side: Rational
    terms: tuple[tuple[int, Rational], ...]
    rule: str
    """``asm``, ``lin``, ``rnd`` or ``uns``."""
    reason: Callable[[], Uses] = tuple
    """Worked out only if the lemma is needed."""

    @cached_property
    def uses(self) -> Uses:
        """References and multipliers; for ``uns`` the four references, and anything with them."""
        return self.reason()


@dataclass
class Lemmas:
    """All lemmas, in an order in which each refers to earlier ones only."""

    items: list[Lemma] = field(default_factory=list)

    def add(self, lemma: Lemma) -> int:
        """Add a lemma; its reference."""
        self.items.append(lemma)
        return LEMMA + len(self.items) - 1

    def rounded(
        self, sense: str, side: Fraction, terms: tuple[tuple[int, Rational], ...], uses: Uses
    ) -> int:
        """Add ``terms sense side``, a combination of `uses`, rounded; its reference.

        It is put down first as it is: a combination of equations is one, which cannot be rounded.
        """
        at = self.add(Lemma(sense, side, terms, "lin", partial(tuple, uses)))
        whole = math.floor(side) if sense == "L" else math.ceil(side)
        if whole == side:
            return at
        return self.add(Lemma(sense, whole, terms, "rnd", partial(tuple, ((at, 1),))))

    def needed(self, references: set[int]) -> list[int]:
        """The positions of the lemmas that these references need, ascending."""
        found: set[int] = set()
        waiting = [at - LEMMA for at in references if at >= LEMMA]
        while waiting:
            position = waiting.pop()
            if position not in found:
                found.add(position)
                uses = self.items[position].uses
                waiting.extend(at - LEMMA for at, _ in uses if at >= LEMMA)
        return sorted(found)


@dataclass(frozen=True, slots=True)
class Leaf:
    """A combination that was put down: where its text is, and what of it has no place yet."""

    value: Fraction | None
    start: int
    length: int
    size: int
    """Number of multipliers."""
    placeless: tuple[tuple[int, str], ...]
    """References to lemmas and assumptions, with the text of their multipliers."""


class Spool:
    """Texts of combinations, kept in a file until the certificate is written."""

    def __init__(self, sign: int) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115 - it lives as long as the search
        self._sign = sign
        self._end = 0
        self.size = 0
        """Bytes that the combinations so far will take in the certificate, about."""

    def put(self, found: Combination) -> Leaf:
        """Put `found` down."""
        words: list[str] = []
        placeless: list[tuple[int, str]] = []
        size = 0
        for at, weight in found.multipliers.items():
            if not weight:
                continue
            size += 1
            text = ratio(self._sign * weight, found.under)
            if 0 <= at < LEMMA:
                words.append(f" {at} {text}")
            else:
                placeless.append((at, text))
        data = "".join(words).encode()
        leaf = Leaf(found.value, self._end, len(data), size, tuple(placeless))
        self._file.seek(self._end)
        self._end += self._file.write(data)
        self.size += len(data) + 60 + sum(12 + len(text) for _, text in placeless)
        return leaf

    def text(self, leaf: Leaf) -> bytes:
        """The multipliers of `leaf` that have places: references and numbers, a blank before each."""
        self._file.seek(leaf.start)
        return self._file.read(leaf.length)


def ratio(over: int, under: int) -> str:
    """The text of a fraction in lowest terms."""
    if under != 1:
        common = math.gcd(over, under)
        if common != under:
            return f"{over // common}/{under // common}"
        over //= under
    return str(over)


def number(value: Rational) -> str:
    """The text of a number."""
    return str(value) if value.denominator == 1 else f"{value.numerator}/{value.denominator}"
