"""The table of a comparison, a row a solve: its columns, from records and back."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, get_args

from ..mission.errors import InputError, shown
from ..optimise.solution import Status
from .record import FINISHED, SKIPPED, Record, record_of

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: Mapping[str, Callable[[Record], Any]] = MappingProxyType(
    {
        "instance": lambda record: record.instance,
        "stage": lambda record: record.stage,
        "model": lambda record: record.model,
        "solver": lambda record: record.solver,
        "seed": lambda record: record.solver_seed,
        "status": lambda record: record.verdict,
        "sense": lambda record: record.sense or "",
        "objective": lambda record: record.objective,
        "bound": lambda record: record.bound,
        "gap": lambda record: record.gap,
        "objective_size": lambda record: record.objective_size,
        "check": lambda record: record.check or "",
        "proof": lambda record: record.proof or "",
        "message": lambda record: record.reason,
        "canonicalise_seconds": lambda record: record.stage_seconds.get("canonicalise"),
        "solve_seconds": lambda record: record.stage_seconds.get("solve"),
        "total_seconds": lambda record: record.seconds,
        "nodes": lambda record: record.nodes,
        "n_variables": lambda record: record.n_variables,
        "n_rows": lambda record: record.n_rows,
        "solver_version": lambda record: record.solver_version or "",
        "machine": lambda record: record.machine,
    }
)
"""What each column says of a record. Times are in seconds."""
WHOLE = frozenset({"seed", "nodes", "n_variables", "n_rows"})
_FIELDS = MappingProxyType({"message": "error", "total_seconds": "seconds"})
"""Columns that are fields of a record by another name."""
_PARTS = ("seed", "canonicalise_seconds", "solve_seconds")
"""Columns that are parts of a field."""
_FROM_ZERO = (
    *("canonicalise_seconds", "solve_seconds", "total_seconds", "gap"),
    "objective_size",
    *("seed", "nodes", "n_variables", "n_rows"),
)
"""Columns of numbers that are 0 or more."""
_STATUSES = get_args(Status)
_CHECKED: tuple[tuple[str, tuple[Any, ...], str], ...] = (
    ("seed", (int,), "a whole number"),
    ("canonicalise_seconds", (int, float), "a number"),
    ("solve_seconds", (int, float), "a number"),
    ("status", _STATUSES, f"one of {', '.join(_STATUSES)}"),
    ("sense", ("min", "max", ""), "one of min, max"),
)
"""What `record_of` does not check: columns, the types or values they may have, and what to say."""


def documents_of(records: Sequence[Record]) -> list[dict[str, Any]]:
    """The rows of `records`, ready for JSON."""
    return [{name: said(record) for name, said in COLUMNS.items()} for record in records]


def table_of(records: Sequence[Record]) -> pd.DataFrame:
    """The records as a pandas table."""
    import pandas as pd

    return pd.DataFrame(documents_of(records), columns=list(COLUMNS))


def records_of(rows: Sequence[Record] | pd.DataFrame) -> Sequence[Record]:
    """The records of a comparison, whether they come as they are or as `table_of` makes them.

    Raises
    ------
    InputError
        If the table lacks columns, or one holds what it should not.
    """
    if isinstance(rows, Sequence):
        return rows
    named = [name for name in rows.index.names if name is not None]
    table = rows.reset_index(level=named) if named else rows
    if missing := [name for name in COLUMNS if name not in table.columns]:
        raise InputError(
            f"{', '.join(missing)}; give the table as compare returns it", field="missing columns"
        )
    plain = table[list(COLUMNS)].astype(object).where(table[list(COLUMNS)].notna(), None)
    return [
        record_of_row({name: _whole(name, value) for name, value in row.items()})
        for row in plain.to_dict("records")
    ]


def record_of_row(row: Mapping[str, Any]) -> Record:
    """The record of one row; columns that it lacks are as if nothing were known.

    Raises
    ------
    InputError
        Naming the column, the offending value and what would be right.
    """
    for name in row:
        if name not in COLUMNS:
            raise InputError("there is no such field; correct its name or remove it", field=name)
    for name in ("instance", "stage", "model", "solver", "status"):
        if row.get(name) is None:
            raise InputError("is missing; give it, for it has no default", field=name)
    for name, kinds, right in _CHECKED:
        if row.get(name) is not None and not (type(row[name]) in kinds or row[name] in kinds):
            raise InputError(f"{shown(row[name])}; give {right}", field=name)
    for name in _FROM_ZERO:
        if isinstance(row.get(name), (int, float)) and row[name] < 0:
            raise InputError(f"{shown(row[name])}; give a number, 0 or more", field=name)
    values = {_FIELDS.get(name, name): x for name, x in row.items() if name not in _PARTS}
    seconds = {name: row.get(f"{name}_seconds") for name in ("canonicalise", "solve")}
    values["stage_seconds_json"] = json.dumps(seconds)
    values["options_json"] = json.dumps({"solver_seed": row.get("seed")})
    values["outcome"] = SKIPPED if row["status"] == SKIPPED else FINISHED
    try:
        return record_of({name: x for name, x in values.items() if x is not None})
    except InputError as error:
        column = next((c for c, name in _FIELDS.items() if name == error.field), error.field)
        raise InputError(error.problem, field=column) from None


def _whole(name: str, value: Any) -> Any:
    """The value as a record has it: a column of whole numbers with gaps has become one of floats."""
    return int(value) if name in WHOLE and value is not None else value
