"""Names of files and figures of numbers, as a report writes them."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

TINY = 1e-6
"""Below this, a number in full is mostly zeros."""
TEN_THOUSAND, MILLION, SMALL = 1e4, 1e6, 0.1


def slug(text: str) -> str:
    """`text` as part of a file's name: letters, digits and hyphens of ASCII only."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "x"


def file_names(texts: Sequence[str]) -> dict[str, str]:
    """A slug for each of the different `texts`, no two alike."""
    found: dict[str, str] = {}
    for text in dict.fromkeys(texts):
        name, number = slug(text), 2
        while name in found.values():
            name, number = f"{slug(text)}-{number}", number + 1
        found[text] = name
    return found


def compact(value: float) -> str:
    """`value` in five letters or so: two or three significant digits, thousands as ``k``."""
    if abs(value) >= MILLION:
        return f"{value / MILLION:.3g}M"
    if abs(value) >= TEN_THOUSAND:
        return f"{value / 1000:.0f}k"
    return f"{value:.2g}" if 0 < abs(value) < SMALL else number(value)


def number(value: float) -> str:
    """`value` to three significant digits; in full, unless it is tiny."""
    if not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    if abs(value) < TINY:
        return f"{value:.2e}"
    places = max(0, 2 - int(np.floor(np.log10(abs(value)))))
    return f"{value:,.{places}f}"
