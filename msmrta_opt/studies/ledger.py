"""The ledger of a study: finished runs in an embedded SQLite database, one transaction each.

Only the coordinator of a study writes. Two coordinators on one ledger share the work: a run is
claimed before it begins, and the claim of a process that has gone is void.
"""

from __future__ import annotations

import platform
import sqlite3
import threading
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any, Self, get_args, get_type_hints

import psutil

from ..mission.errors import InputError
from .record import Record

LAYOUT = 1
"""Of the database, in its ``user_version``; a change of columns is a new one."""
PATIENCE_SECONDS = 60.0
"""How long a transaction waits for another process's."""
SQL_TYPES = {str: "TEXT", int: "INTEGER", float: "REAL"}
COLUMNS = tuple(item.name for item in fields(Record))


class Ledger:
    """Finished runs by key. Use as a context manager, or `close` it.

    Parameters
    ----------
    path : path
        The database; made when there is none.
    create : bool
        Whether a missing one may be made.

    Raises
    ------
    InputError
        If the file is not a ledger, is of another layout, is missing, or cannot be opened.
    """

    def __init__(self, path: str | Path, *, create: bool = True) -> None:
        self.path = Path(path)
        if not create and not self.path.exists():
            raise InputError("no ledger yet; run the study first", file=path)
        try:
            self._database = sqlite3.connect(
                self.path,
                timeout=PATIENCE_SECONDS,
                isolation_level=None,
                check_same_thread=False,
            )
            self._lock = threading.RLock()
            self._open()
        except sqlite3.Error as error:
            raise InputError(f"not a ledger that can be used ({error})", file=path) from None
        me = psutil.Process()
        self._owner = (platform.node(), me.pid, me.create_time())

    def _open(self) -> None:
        database = self._database
        # A write-ahead log survives a killed process whole; only a power cut can lose the last
        # transactions, and such runs are done again.
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA synchronous = NORMAL")
        with self._transaction():
            (layout,) = database.execute("PRAGMA user_version").fetchone()
            if layout == 0 and not database.execute("SELECT 1 FROM sqlite_master").fetchone():
                database.execute(f"CREATE TABLE runs ({_columns()}) WITHOUT ROWID")
                database.execute("CREATE INDEX by_run ON runs (run)")
                database.execute(
                    "CREATE TABLE claims"
                    " (key TEXT PRIMARY KEY, host TEXT, process INTEGER, born REAL) WITHOUT ROWID"
                )
                database.execute(f"PRAGMA user_version = {LAYOUT}")
            elif layout != LAYOUT:
                raise sqlite3.DatabaseError(f"layout {layout}, where this version has {LAYOUT}")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give back what is claimed, and close the file."""
        with self._transaction():
            self._database.execute(
                "DELETE FROM claims WHERE host = ? AND process = ? AND born = ?", self._owner
            )
        self._database.close()

    def add(self, record: Record) -> None:
        """Keep a finished run, for good; one of the same key is replaced only if it had failed."""
        marks = ", ".join("?" for _ in COLUMNS)
        with self._transaction():
            self._database.execute(
                "DELETE FROM runs WHERE key = ? AND outcome != 'finished'", (record.key,)
            )
            self._database.execute(f"INSERT OR IGNORE INTO runs VALUES ({marks})", astuple(record))
            self._database.execute("DELETE FROM claims WHERE key = ?", (record.key,))

    def claim(self, key: str, *, redo: bool = False) -> bool:
        """Whether the run of `key` is now this process's to do.

        It is not when it has been done, unless `redo`, or while another living process has it.
        """
        with self._transaction():
            done = self._database.execute("SELECT 1 FROM runs WHERE key = ?", (key,)).fetchone()
            if done and not redo:
                return False
            held = self._database.execute(
                "SELECT host, process, born FROM claims WHERE key = ?", (key,)
            ).fetchone()
            if held and held != self._owner and _lives(*held):
                return False
            self._database.execute(
                "INSERT OR REPLACE INTO claims VALUES (?, ?, ?, ?)", (key, *self._owner)
            )
            return True

    def claimed_elsewhere(self, keys: Collection[str]) -> set[str]:
        """Those of `keys` that another living process is at."""
        claims = self._database.execute("SELECT key, host, process, born FROM claims").fetchall()
        wanted = set(keys)
        return {
            key
            for key, *owner in claims
            if key in wanted and tuple(owner) != self._owner and _lives(*owner)
        }

    def records(self) -> Iterator[Record]:
        """All runs, in the order of their keys."""
        for row in self._database.execute("SELECT * FROM runs ORDER BY key"):
            yield Record(*row)

    def get(self, key: str) -> Record | None:
        """The run of `key`, if it is there."""
        row = self._database.execute("SELECT * FROM runs WHERE key = ?", (key,)).fetchone()
        return None if row is None else Record(*row)

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        # Runs may be claimed in one thread while another keeps a result.
        with self._lock:
            self._database.execute("BEGIN IMMEDIATE")
            try:
                yield
            except BaseException:
                self._database.execute("ROLLBACK")
                raise
            self._database.execute("COMMIT")


def _columns() -> str:
    """The columns of the table of runs: the fields of `Record`."""
    hints = get_type_hints(Record)
    parts = []
    for name in COLUMNS:
        kinds: tuple[Any, ...] = get_args(hints[name]) or (hints[name],)
        nullable = type(None) in kinds
        (kind,) = (SQL_TYPES[kind] for kind in kinds if kind in SQL_TYPES)
        parts.append(f'"{name}" {kind}' + ("" if nullable else " NOT NULL"))
    parts[0] += " PRIMARY KEY"
    return ", ".join(parts)


def _lives(host: str, process: int, born: float) -> bool:
    """Whether the process of a claim goes on.

    A write-ahead log is shared within one machine only: a claim of another came with a copied file.
    """
    if host != platform.node():
        return False
    try:
        found = psutil.Process(process)
        return bool(found.create_time() == born and found.status() != psutil.STATUS_ZOMBIE)
    except psutil.Error:
        return False
