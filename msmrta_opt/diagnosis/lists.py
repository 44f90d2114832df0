"""Lists in texts: some of what there is, and how many more."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby

ALIKE = 4
"""Neighbours that differ in their numbers alone and are all told."""


def shortened(members: list[str]) -> Iterator[str]:
    """The members, of runs that differ in their numbers alone only the first two and a count."""
    for _, run in groupby(members, key=lambda member: re.sub(r"\d+", "#", member)):
        alike = list(run)
        yield from alike if len(alike) <= ALIKE else alike[:2]
        if len(alike) > ALIKE:
            yield f"… and {len(alike) - 2} more like these"


def under(title: str, members: list[str], maximum: int) -> list[str]:
    """Lines with up to so many members, shortened, under a title that counts them; none of none."""
    if not members:
        return []
    shown = list(shortened(members))
    more = [f"  … and {len(shown) - maximum} more"] if len(shown) > maximum else []
    return [f"{title} ({len(members)}):", *(f"  {item}" for item in shown[:maximum]), *more]
