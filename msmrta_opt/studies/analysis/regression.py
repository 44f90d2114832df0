"""Solver regression: what changed between two comparisons of the same solves."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...mission.counting import in_full
from ...mission.errors import InputError, shown
from ...mission.files import read_json, write_text
from ...mission.validation import said_of
from ..record import Record
from ..solves import documents_of, record_of_row
from .agreement import TOLERANCE, size_of

FORMAT = "msmrta-comparison/1"
SHORTEST_SECONDS = 0.1
"""Solves quicker than this, then and now, are not called slower: that would be noise."""
_PROVEN = ("optimal", "infeasible", "unbounded")


def save_baseline(
    records: Sequence[Record], path: str | Path, *, before: Sequence[Record] = ()
) -> None:
    """Write `records` as a baseline, a row a line, whole or not at all.

    What is not known is left out. Of a solve in which nothing changed since `before` that row stays, its
    times, versions and node counts included, so that the difference of the two files is what changed.
    """
    old = {row.solve: row for row in before}
    kept = [old[row.solve] if _is_unchanged(old.get(row.solve), row) else row for row in records]
    rows = [
        json.dumps({name: x for name, x in row.items() if x not in (None, "")}, allow_nan=False)
        for row in documents_of(kept)
    ]
    head = json.dumps({"format": FORMAT})[:-1]
    write_text(path, head + ', "rows": [\n' + ",\n".join(rows) + "\n]}\n")


def _is_unchanged(old: Record | None, new: Record) -> bool:
    return old is not None and not _differences(old, new, TOLERANCE) and not _noted(old, new)


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
    found: dict[object, Record] = {}
    for i, row in enumerate(rows):
        if not isinstance(row, dict):
            raise InputError(f"{shown(row)}; give an object", field=f"rows[{i}]", file=path)
        try:
            record = record_of_row(row)
        except InputError as error:
            raise said_of(f"rows[{i}]", error).within(path) from None
        if record.solve in found:
            twice = f"{_name(record)} is given twice; give each solve once"
            raise InputError(twice, field=f"rows[{i}]", file=path)
        found[record.solve] = record
    return list(found.values())


@dataclass(frozen=True)
class Change:
    """One difference of a solve."""

    solve: tuple[str, str | None, str | None, int | None]
    """As `Record.solve`."""
    name: str
    """Of the solve, as people read it."""
    what: str

    def __str__(self) -> str:
        return f"{self.name}: {self.what}"


@dataclass(frozen=True)
class Regression:
    """Two comparisons of the same solves beside each other.

    ``changes`` are differences of what is answered: a regression. ``notes`` are for information:
    another solver version, node count, proof or size of a program.
    """

    before: tuple[Record, ...]
    after: tuple[Record, ...]
    changes: tuple[Change, ...]
    notes: tuple[Change, ...]

    @property
    def lines(self) -> list[str]:
        """The changes, a line each."""
        return [str(change) for change in self.changes]

    @property
    def information(self) -> list[str]:
        """The notes, a line each; what many solves have alike, such as a version, once."""
        alike: dict[str, list[Change]] = {}
        for note in self.notes:
            alike.setdefault(note.what, []).append(note)
        return [
            str(notes[0]) if len(notes) == 1 else f"{what} (in {len(notes)} solves)"
            for what, notes in alike.items()
        ]

    def __repr__(self) -> str:
        counts = len(self.after), len(self.changes), len(self.notes)
        return "Regression({} solves: {} changes, {} notes)".format(*counts)


def regression(
    before: Sequence[Record],
    after: Sequence[Record],
    *,
    tolerance: float = TOLERANCE,
    slower: float | None = None,
) -> Regression:
    """What is different in `after`.

    A change is a status, an objective or a bound beyond `tolerance` (relative, without constants), a
    check, a solve that is missing or new, and, if `slower` is given, a total time beyond that ratio.
    """
    old, new = ({row.solve: row for row in rows} for rows in (before, after))
    found = [
        Change(key, _name(row), "was there before, is missing")
        for key, row in old.items()
        if key not in new
    ]
    found += [
        Change(key, _name(row), "was not there before")
        for key, row in new.items()
        if key not in old
    ]
    notes = []
    for key, row in new.items():
        was = old.get(key)
        if was is None:
            continue
        differences = _differences(was, row, tolerance)
        if slower is not None and _is_slower(was, row, slower):
            differences.append(f"took {row.seconds:.3g} s, was {was.seconds:.3g} s")
        found += [Change(key, _name(row), what) for what in differences]
        notes += [Change(key, _name(row), what) for what in _noted(was, row)]
    return Regression(tuple(before), tuple(after), tuple(found), tuple(notes))


def changes(
    before: Sequence[Record],
    after: Sequence[Record],
    *,
    tolerance: float = TOLERANCE,
    slower: float | None = None,
) -> list[str]:
    """The changes of `regression`, one line each."""
    return regression(before, after, tolerance=tolerance, slower=slower).lines


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
            was is not None and abs(was - is_) > tolerance * size_of(old, new)
        ):
            found.append(f"{name} {_number(is_)}, was {_number(was)}")
    return found


def _noted(old: Record, new: Record) -> list[str]:
    """What differs without being a change; what only one of both knows is none."""
    both = {
        new.solver or "solver": (old.solver_version, new.solver_version),
        "nodes": (old.nodes, new.nodes),
        "variables": (old.n_variables, new.n_variables),
        "rows": (old.n_rows, new.n_rows),
        "proof": (old.proof, new.proof),
    }
    return [
        f"{name} {is_}, was {was}"
        for name, (was, is_) in both.items()
        if was not in (None, "") and is_ not in (None, "") and was != is_
    ]


def _number(value: float | None) -> str:
    return "none" if value is None else in_full(value)


def _is_slower(old: Record, new: Record, ratio: float) -> bool:
    if old.seconds is None or new.seconds is None:
        return False
    return new.seconds > max(ratio * old.seconds, SHORTEST_SECONDS)
