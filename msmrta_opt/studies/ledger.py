"""The ledger of a study: finished runs in an embedded SQLite database, one transaction each.

Only the coordinator of a study writes. Two coordinators on one ledger share the work: a run is
claimed before it begins, and the claim of a process that has gone is void.

A field of `Record` that a ledger lacks becomes a column of it when it is next written, and metrics are
one column, so that no new field or metric makes an old ledger unreadable.
"""

from __future__ import annotations

import platform
import shutil
import sqlite3
import sys
import tempfile
import time
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import astuple, fields
from functools import cache
from pathlib import Path
from typing import Any, Self

import psutil

from ..interruption import interrupted
from ..mission.errors import InputError
from .missions import Known, Mission
from .record import Record, kinds_of_fields, record_of

LAYOUT = 2
"""Of the database, in its ``user_version``; layout 1 had a column for each metric."""
PATIENCE_SECONDS = 60.0
"""How long a transaction waits for another process's."""
LAST_SECONDS = 1.0
"""The same once the user has asked for an end."""
POLL_SECONDS = 0.1
"""How often it tries; SQLite's own waiting would let no Ctrl-C through."""
SQL_TYPES = {str: "TEXT", int: "INTEGER", float: "REAL"}
SAID = {
    sqlite3.SQLITE_BUSY: "is locked by another program; end that and run this again",
    sqlite3.SQLITE_FULL: "the disk is full; make room and run this again",
    sqlite3.SQLITE_READONLY: "cannot be written; change its permissions, or those of its folder",
    sqlite3.SQLITE_CANTOPEN: "cannot be opened; change its permissions, or those of its folder",
    sqlite3.SQLITE_IOERR: "its disk fails, or is full; make room and run this again",
}
"""What to do about SQLite's errors, by code."""


class Ledger:
    """Finished runs by key. Use as a context manager, or `close` it.

    Parameters
    ----------
    path : path
        The database; made when there is none.
    read_only : bool
        Only read it, so that it may be where nothing can be written; it must be there.

    Raises
    ------
    InputError
        If the file is not a ledger, is of a later layout, is missing, damaged or locked, or cannot be
        opened; methods likewise. What was kept before stays.
    """

    def __init__(self, path: str | Path, *, read_only: bool = False) -> None:
        self.path = Path(path)
        self._copy: tempfile.TemporaryDirectory[str] | None = None
        if read_only and not self.path.exists():
            raise InputError("no ledger yet; run the study first", file=path)
        self._read_only = read_only
        self._owner = _identity(psutil.Process())
        with self._explained(), ExitStack() as unless_opened:
            self._database = _connected(self.path, "?mode=rw" if read_only else "")
            # Whatever it is by then: the file, or a copy of it.
            unless_opened.callback(lambda: self._database.close())
            if read_only:
                self._open_to_read()
            else:
                self._prepare()
            unless_opened.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give back what is claimed, and close the file."""
        try:
            if not self._read_only:
                # A claim that cannot be given back ends with this process.
                with suppress(InputError), self._transaction():
                    self._execute(
                        "DELETE FROM claims WHERE host = ? AND process = ? AND born = ?",
                        self._owner,
                    )
        finally:
            self._database.close()
            if self._copy is not None:
                self._copy.cleanup()

    def add(self, record: Record) -> None:
        """Keep a finished run, for good; one of the same key is replaced only if it had failed.

        It would be lost otherwise, so this waits for a lock until there is none, or an interruption.
        """
        columns = [item.name for item in fields(Record)]
        names, marks = ", ".join(f'"{name}"' for name in columns), ", ".join("?" for _ in columns)
        with self._transaction(must=True):
            self._execute("DELETE FROM runs WHERE key = ? AND outcome != 'finished'", (record.key,))
            self._execute(f"INSERT OR IGNORE INTO runs ({names}) VALUES ({marks})", astuple(record))
            self._execute("DELETE FROM claims WHERE key = ?", (record.key,))

    def claim(self, key: str, *, redo: bool = False) -> bool:
        """Whether the run of `key` is now this process's to do.

        It is not when it has been done, unless `redo`, or while another living process has it.
        """
        with self._transaction():
            if not redo and self._execute("SELECT 1 FROM runs WHERE key = ?", (key,)).fetchone():
                return False
            held = self._execute(
                "SELECT host, process, born FROM claims WHERE key = ?", (key,)
            ).fetchone()
            if held and tuple(held) != self._owner and _lives(*held):
                return False
            self._execute("INSERT OR REPLACE INTO claims VALUES (?, ?, ?, ?)", (key, *self._owner))
            return True

    def claimed_elsewhere(self, keys: Collection[str]) -> set[str]:
        """Those of `keys` that another living process is at."""
        with self._explained():
            claims = self._execute("SELECT key, host, process, born FROM claims").fetchall()
        wanted = set(keys)
        return {
            key
            for key, *owner in claims
            if key in wanted and tuple(owner) != self._owner and _lives(*owner)
        }

    def records(self) -> Iterator[Record]:
        """All runs, in the order of their keys."""
        with self._explained():
            for row in self._execute("SELECT * FROM runs ORDER BY key"):
                yield self._record(row)

    def get(self, key: str) -> Record | None:
        """The run of `key`, if it is there."""
        with self._explained():
            row = self._execute("SELECT * FROM runs WHERE key = ?", (key,)).fetchone()
            return None if row is None else self._record(row)

    def missions(self) -> Known:
        """The missions that were made for the study, by recipe."""
        with self._explained():
            if not self._columns("missions"):
                return {}
            rows = self._execute("SELECT recipe, name, digest FROM missions")
            return {recipe: (name, digest) for recipe, name, digest in rows}

    def keep_missions(self, missions: Iterable[Mission]) -> None:
        """Remember what missions are called, so that to look at the study makes none of them anew."""
        rows = {m.recipe: (m.recipe, m.name, m.digest) for m in missions if m.recipe}
        with self._transaction():
            self._database.executemany(
                "INSERT OR REPLACE INTO missions VALUES (?, ?, ?)", rows.values()
            )

    def _execute(self, command: str, values: tuple[Any, ...] = ()) -> sqlite3.Cursor:
        return _patiently(lambda: self._database.execute(command, values))

    def _columns(self, table: str) -> set[str]:
        return {name for _, name, *_ in self._execute(f"PRAGMA table_info({table})")}

    def _record(self, row: sqlite3.Row) -> Record:
        try:
            return record_of(dict(row))
        except InputError as error:
            raise InputError(f"damaged: run {row['key']!r}: {error}", file=self.path) from None

    def _layout(self) -> int:
        """The layout, 0 of an empty file."""
        layout = int(self._execute("PRAGMA user_version").fetchone()[0])
        is_empty = not self._execute("SELECT 1 FROM sqlite_master").fetchone()
        if layout > LAYOUT or (layout == 0 and not is_empty):
            raise InputError(
                f"not a ledger that can be used: layout {layout}, where this version has {LAYOUT}",
                file=self.path,
            )
        return layout

    def _prepare(self) -> None:
        """Make the tables, or add what a ledger of before lacks."""
        # A write-ahead log survives a killed process whole; only a power cut can lose the last
        # transactions, and such runs are done again.
        self._layout()  # before anything is changed
        self._execute("PRAGMA journal_mode = WAL")
        self._execute("PRAGMA synchronous = NORMAL")
        with self._transaction():
            if not self._layout():
                self._execute(
                    f"CREATE TABLE runs ({', '.join(_definitions().values())}) WITHOUT ROWID"
                )
                self._execute("CREATE INDEX by_run ON runs (run)")
                self._execute(
                    "CREATE TABLE claims"
                    " (key TEXT PRIMARY KEY, host TEXT, process INTEGER, born REAL) WITHOUT ROWID"
                )
            there = self._columns("runs")
            for name, definition in _definitions().items():
                if name not in there:
                    self._execute(f"ALTER TABLE runs ADD COLUMN {definition}")
            self._execute(
                "CREATE TABLE IF NOT EXISTS missions"
                " (recipe TEXT PRIMARY KEY, name TEXT NOT NULL, digest TEXT NOT NULL) WITHOUT ROWID"
            )
            self._execute(f"PRAGMA user_version = {LAYOUT}")

    def _open_to_read(self) -> None:
        """See that the file can be read, or take a copy where SQLite would have to write beside it."""
        try:
            self._layout()
            return
        except sqlite3.OperationalError as error:
            if _code(error) not in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN):
                raise
        self._database.close()
        self._copy = tempfile.TemporaryDirectory()
        copy = Path(self._copy.name) / "ledger.sqlite"
        shutil.copyfile(self.path, copy)
        log = self.path.with_name(f"{self.path.name}-wal")
        if log.exists():
            shutil.copyfile(log, copy.with_name("ledger.sqlite-wal"))
        self._database = _connected(copy)
        self._layout()

    @contextmanager
    def _transaction(self, *, must: bool = False) -> Iterator[None]:
        with self._explained():
            said = f"{self.path}: locked by another program; a result waits until it can be kept"
            _patiently(lambda: self._database.execute("BEGIN IMMEDIATE"), said if must else "")
            try:
                yield
                self._execute("COMMIT")
            except BaseException:
                if self._database.in_transaction:
                    self._database.execute("ROLLBACK")
                raise

    @contextmanager
    def _explained(self) -> Iterator[None]:
        """Say of this file what SQLite finds wrong with it."""
        try:
            yield
        except sqlite3.Error as error:
            known = SAID.get(_code(error), f"not a ledger that can be used ({error})")
            raise InputError(known, file=self.path) from None
        except UnicodeDecodeError:  # in what SQLite quotes of a damaged file
            raise InputError("not a ledger that can be used (damaged)", file=self.path) from None
        except OSError as error:
            raise InputError(f"cannot be read ({error.strerror})", file=self.path) from None


def _connected(path: Path, mode: str = "") -> sqlite3.Connection:
    database = sqlite3.connect(
        path.absolute().as_uri() + mode, uri=True, timeout=0, isolation_level=None
    )
    database.row_factory = sqlite3.Row
    return database


def _patiently(ask: Callable[[], sqlite3.Cursor], if_long: str = "") -> sqlite3.Cursor:
    """Ask until nobody else holds the lock, and for ever once `if_long` has been said."""
    began, said = time.monotonic(), False
    while True:
        try:
            return ask()
        except sqlite3.OperationalError as error:
            patience = LAST_SECONDS if interrupted() else PATIENCE_SECONDS
            is_long = time.monotonic() - began > patience
            if _code(error) != sqlite3.SQLITE_BUSY or (is_long and (interrupted() or not if_long)):
                raise
        if is_long and not said:
            said = True
            print(if_long, file=sys.stderr, flush=True)
        time.sleep(POLL_SECONDS)


def _code(error: sqlite3.Error) -> int:
    """SQLite's primary code of an error, 0 if it is the module's own."""
    return int(getattr(error, "sqlite_errorcode", 0)) & 0xFF


@cache
def _definitions() -> dict[str, str]:
    """The columns of the table of runs: the fields of `Record`."""
    found = {}
    for item in fields(Record):
        kinds = kinds_of_fields()[item.name]
        (kind,) = (SQL_TYPES[kind] for kind in kinds if kind in SQL_TYPES)
        found[item.name] = f'"{item.name}" {kind}'
        if type(None) not in kinds:
            default = item.default if isinstance(item.default, int) else f"'{item.default}'"
            given = f" DEFAULT {default}" if isinstance(item.default, (int, str)) else ""
            found[item.name] += f" NOT NULL{given}"
    found["key"] += " PRIMARY KEY"
    return found


def _identity(process: psutil.Process) -> tuple[str, int, float]:
    """What tells a process from all others: machine, id, and when it was born."""
    return _host(), process.pid, _born(process)


@cache
def _host() -> str:
    """The machine, since it was started."""
    with suppress(OSError):
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
        return f"{platform.node()} {boot}"
    return platform.node()


def _born(process: psutil.Process) -> float:
    """When a process was born, by a clock that nobody sets: on Linux in ticks since the start."""
    with suppress(OSError):
        # The name, in brackets, may hold anything; the 22nd field is the 20th after it.
        stat = Path(f"/proc/{process.pid}/stat").read_text(encoding="utf-8", errors="replace")
        return float(stat.rpartition(")")[2].split()[19])
    return float(process.create_time())


def _lives(host: str, process: int, born: float) -> bool:
    """Whether the process of a claim goes on.

    A write-ahead log is shared within one machine only: a claim of another came with a copied file.
    """
    if host != _host():
        return False
    try:
        found = psutil.Process(process)
        return _identity(found) == (host, process, born) and found.status() != psutil.STATUS_ZOMBIE
    except psutil.Error:
        return False
