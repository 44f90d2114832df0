"""Solver regression: what changed between two comparisons of the same solves."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from ...mission.errors import InputError
from ...mission.files import read_json, write_text
from ..rows import TOLERANCE, Row, as_documents

FORMAT = "msmrta-comparison/1"
SHORTEST_SECONDS = 0.1
"""Solves quicker than this, then and now, are not called slower: that would be noise."""
_PROVEN = ("optimal", "infeasible", "unbounded")


def save_baseline(rows: Sequence[Row], path: str | Path) -> None:
    """Write `rows` as a baseline, whole or not at all."""
    write_text(path, json.dumps({"format": FORMAT, "rows": as_documents(rows)}, indent=1) + "\n")


def read_baseline(path: str | Path) -> list[Row]:
    """The rows of a baseline file.

    Raises
    ------
    InputError
        If the file is not a baseline.
    """
    document = read_json(path)
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InputError(f"not a comparison; its format should be {FORMAT!r}", file=path)
    try:
        return TypeAdapter(list[Row]).validate_python(document.get("rows"))
    except ValidationError as error:
        first = error.errors()[0]
        place = "".join(f"[{i}]" if isinstance(i, int) else f".{i}" for i in first["loc"])
        raise InputError(first["msg"], field=f"rows{place}", file=path) from None


def changes(
    before: Sequence[Row],
    after: Sequence[Row],
    *,
    tolerance: float = TOLERANCE,
    slower: float | None = None,
) -> list[str]:
    """What is different in `after`, one line each.

    A status, an objective or a bound beyond `tolerance` (relative), a check, a solve that is
    missing or new, and, if `slower` is given, a total time beyond that ratio.
    """
    old, new = ({row.key: row for row in rows} for rows in (before, after))
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
                f"{_name(new[key])}: took {new[key].total_seconds:.3g} s,"
                f" was {old[key].total_seconds:.3g} s"
            )
    return found


def _name(row: Row) -> str:
    seed = "" if row.seed is None else f", seed {row.seed}"
    return f"{row.model} on {row.instance} by {row.solver}{seed}"


def _differences(old: Row, new: Row, tolerance: float) -> list[str]:
    found = []
    if old.status != new.status:
        found.append(f"status {new.status}, was {old.status}")
    if old.check != new.check:
        found.append(f"check {new.check or 'none'}, was {old.check or 'none'}")
    # Where a limit stopped both, value and bound depend on the machine's speed.
    names = ("objective", "bound") if old.status == new.status and old.status in _PROVEN else ()
    for name in names:
        was, is_ = getattr(old, name), getattr(new, name)
        if (was is None) != (is_ is None) or (
            was is not None and abs(was - is_) > tolerance * max(1.0, abs(was))
        ):
            found.append(f"{name} {_number(is_)}, was {_number(was)}")
    return found


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.9g}"


def _is_slower(old: Row, new: Row, ratio: float) -> bool:
    if old.total_seconds is None or new.total_seconds is None:
        return False
    return new.total_seconds > max(ratio * old.total_seconds, SHORTEST_SECONDS)
