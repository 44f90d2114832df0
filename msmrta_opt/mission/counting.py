"""Counts in words."""

from __future__ import annotations


def counted(number: int, noun: str) -> str:
    """So ``1 robot``, or ``2 robots``."""
    return f"{number} {noun}" + ("" if number == 1 else "s")
