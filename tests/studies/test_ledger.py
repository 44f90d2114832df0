"""The ledger keeps each finished run once, whoever writes."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.ledger import Ledger, _identity
from msmrta_opt.studies.record import Record

RECORD = Record(
    key="k",
    run="r",
    instance="i",
    map="m",
    n_robots=1,
    n_victims=2,
    contender="c",
    method="planner",
    psi=0.5,
    seconds=0.25,
    metrics_json='{"n_served": 2}',
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "ledger.sqlite"


def test_what_is_added_comes_back_the_same_after_opening_again(path: Path) -> None:
    with Ledger(path) as ledger:
        ledger.add(RECORD)
    with Ledger(path) as ledger:
        assert list(ledger.records()) == [RECORD]
        assert ledger.get("k") == RECORD
        assert ledger.get("other") is None


def test_a_finished_run_is_never_replaced_and_a_failed_one_is(path: Path) -> None:
    failed = replace(RECORD, outcome="timed out", limit=1.0)
    with Ledger(path) as ledger:
        ledger.add(failed)
        ledger.add(RECORD)
        assert list(ledger.records()) == [RECORD]
        ledger.add(replace(RECORD, seconds=9.0))
        ledger.add(failed)
        assert list(ledger.records()) == [RECORD]


def test_a_run_is_one_processs_to_do_until_it_is_done(path: Path) -> None:
    with Ledger(path) as mine, Ledger(path) as other:
        other._owner = _identity(psutil.Process(os.getppid()))
        assert mine.claim("k")
        assert mine.claim("k"), "what is claimed already stays claimed"
        assert not other.claim("k")
        assert other.claimed_elsewhere(["k", "l"]) == {"k"}
        mine.add(RECORD)
        assert not other.claim("k")
        assert other.claim("k", redo=True)
        assert other.claimed_elsewhere(["k"]) == set()


def test_the_claim_of_a_process_that_has_gone_is_void(path: Path) -> None:
    script = (
        "import os, sys\n"
        "from msmrta_opt.studies.ledger import Ledger\n"
        "assert Ledger(sys.argv[1]).claim('k')\n"
        "os._exit(9)\n"
    )
    with Ledger(path) as ledger:
        assert subprocess.run([sys.executable, "-c", script, str(path)]).returncode == 9
        assert ledger.claimed_elsewhere(["k"]) == set()
        assert ledger.claim("k")


def test_closing_gives_back_what_is_claimed(path: Path) -> None:
    with Ledger(path) as ledger:
        assert ledger.claim("k")
    with sqlite3.connect(path) as database:
        assert database.execute("SELECT * FROM claims").fetchall() == []


@pytest.mark.parametrize("contents", [b"not a database, but long enough to be one" * 50, b"{}"])
def test_a_file_that_is_no_ledger_is_refused_and_left_alone(path: Path, contents: bytes) -> None:
    path.write_bytes(contents)
    with pytest.raises(InputError, match="not a ledger"):
        Ledger(path)
    assert path.read_bytes() == contents


def test_another_database_is_refused_and_left_alone(path: Path) -> None:
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE shopping (item TEXT)")
    with pytest.raises(InputError, match="not a ledger"):
        Ledger(path)
    with sqlite3.connect(path) as database:
        (tables,) = database.execute("SELECT group_concat(name) FROM sqlite_master").fetchall()
    assert tables == ("shopping",)


def test_a_ledger_of_another_layout_is_refused(path: Path) -> None:
    Ledger(path).close()
    with sqlite3.connect(path) as database:
        database.execute("PRAGMA user_version = 99")
    with pytest.raises(InputError, match="layout 99, where this version has 2"):
        Ledger(path)


def test_a_missing_ledger_can_be_asked_to_be_there(path: Path) -> None:
    with pytest.raises(InputError, match="no ledger yet"):
        Ledger(path, read_only=True)
    assert not path.exists()
