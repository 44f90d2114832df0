"""Names of files and figures of numbers, as a report writes them."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

TINY = 1e-6
"""Below this, a number in full is mostly zeros."""


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
