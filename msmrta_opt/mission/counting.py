"""Counts in words."""

from __future__ import annotations


def counted(number: int, noun: str) -> str:
    """So ``1 robot``, or ``2 robots``."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


def rows_by_columns(shape: tuple[int, int]) -> str:
    """The size of a map or an image, as all tell it: ``20 rows × 30 columns``."""
    return f"{counted(shape[0], 'row')} × {counted(shape[1], 'column')}"
