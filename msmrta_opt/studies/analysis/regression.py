"""Solver regression: what changed between two comparisons of the same solves."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from ...mission.errors import InputError, shown
from ...mission.files import read_json, write_text
from ...mission.validation import said_of
from ..record import Record
from ..solves import documents_of, record_of_row
from .agreement import SMALLEST, TOLERANCE

FORMAT = "msmrta-comparison/1"
SHORTEST_SECONDS = 0.1
"""Solves quicker than this, then and now, are not called slower: that would be noise."""
_PROVEN = ("optimal", "infeasible", "unbounded")


def save_baseline(records: Sequence[Record], path: str | Path) -> None:
    """Write the rows of `records` as a baseline, whole or not at all."""
    document = {"format": FORMAT, "rows": documents_of(records)}
    write_text(path, json.dumps(document, indent=1, allow_nan=False) + "\n")


def read_baseline(path: str | Path) -> list[Record]:
    """The records of a baseline file.

    Raises
    ------
    InputError
        If the file is not a baseline, or a row is not one of a comparison.
    """
    document = read_json(path)
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InputError(f"not a comparison; its format should be {FORMAT!r}", file=path)
    rows = document.get("rows")
    if not isinstance(rows, list):
        raise InputError(f"{shown(rows)}; give a list, […]", field="rows", file=path)
    found = []
    for i, row in enumerate(rows):
        if not isinstance(row, dict):
            raise InputError(f"{shown(row)}; give an object", field=f"rows[{i}]", file=path)
        try:
            found.append(record_of_row(row))
        except InputError as error:
            raise said_of(f"rows[{i}]", error).within(path) from None
    return found


def changes(
    before: Sequence[Record],
    after: Sequence[Record],
    *,
    tolerance: float = TOLERANCE,
    slower: float | None = None,
) -> list[str]:
    """What is different in `after`, one line each.

    A status, an objective or a bound beyond `tolerance` (relative), a check, a solve that is
    missing or new, and, if `slower` is given, a total time beyond that ratio.
    """
    old, new = ({row.solve: row for row in rows} for rows in (before, after))
    found = [
        f"{_name(row)}: was there before, is missing" for key, row in old.items() if key not in new
    ]
    found += [f"{_name(row)}: was not there before" for key, row in new.items() if key not in old]
    for key in (key for key in old if key in new):
        found += [
            f"{_name(new[key])}: {what}" for what in _differences(old[key], new[key], tolerance)
        ]
        if slower is not None and _is_slower(old[key], new[key], slower):
            found.append(
                f"{_name(new[key])}: took {new[key].seconds:.3g} s, was {old[key].seconds:.3g} s"
            )
    return found


def _name(row: Record) -> str:
    seed = "" if row.solver_seed is None else f", seed {row.solver_seed}"
    return f"{row.model} on {row.instance} by {row.solver}{seed}"


def _differences(old: Record, new: Record, tolerance: float) -> list[str]:
    found = []
    if old.verdict != new.verdict:
        found.append(f"status {new.verdict}, was {old.verdict}")
    if (old.check or "") != (new.check or ""):
        found.append(f"check {new.check or 'none'}, was {old.check or 'none'}")
    # Where a limit stopped both, value and bound depend on the machine's speed.
    names = ("objective", "bound") if old.verdict == new.verdict and old.verdict in _PROVEN else ()
    for name in names:
        was, is_ = getattr(old, name), getattr(new, name)
        if (was is None) != (is_ is None) or (
            was is not None and abs(was - is_) > tolerance * max(SMALLEST, abs(was))
        ):
            found.append(f"{name} {_number(is_)}, was {_number(was)}")
    return found


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.9g}"


def _is_slower(old: Record, new: Record, ratio: float) -> bool:
    if old.seconds is None or new.seconds is None:
        return False
    return new.seconds > max(ratio * old.seconds, SHORTEST_SECONDS)
