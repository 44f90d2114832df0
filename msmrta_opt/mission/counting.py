"""Counts and numbers as people read them."""

from __future__ import annotations

LONGEST_IN_FULL = 1e15
"""Numbers from here on are told by their power of ten."""
MAX_DIGITS = 17
"""By which any two floats are told apart."""


def counted(number: int, noun: str) -> str:
    """So ``1 robot``, or ``2 robots``."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


def rows_by_columns(shape: tuple[int, int]) -> str:
    """The size of a map or an image, as all tell it: ``20 rows × 30 columns``."""
    return f"{counted(shape[0], 'row')} × {counted(shape[1], 'column')}"


def in_full(value: float, digits: int = 9) -> str:
    """`value` in so many significant digits, or in all those before its point if these are more."""
    if 1 <= abs(value) < LONGEST_IN_FULL:
        digits = max(digits, len(str(int(abs(value)))))
    return f"{value:.{digits}g}"


def told_apart(*values: float, digits: int = 9) -> list[str]:
    """`values` in so many digits, or in more where different ones would look the same."""
    texts: list[str] = []
    while len(set(texts)) < len(set(values)) and digits <= MAX_DIGITS:
        texts, digits = [in_full(value, digits) for value in values], digits + 1
    return texts
