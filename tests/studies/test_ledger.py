"""The ledger keeps each finished run once, whoever writes, and is read wherever it is."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil
import pytest
from support.studies import do, kept

from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies import ledger as ledger_module
from msmrta_opt.studies.ledger import Ledger, _identity
from msmrta_opt.studies.record import Record, frame
from msmrta_opt.studies.runs import current, runs
from msmrta_opt.studies.specification import Study

OLD = Path(__file__).parents[1] / "data" / "ledger_of_layout_1"

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


# ------------------------------------------------------------------- layouts, and what they keep


@pytest.fixture
def earlier(tmp_path: Path) -> Path:
    """A study whose ledger an earlier version kept, with a column for each metric."""
    shutil.copytree(OLD, tmp_path / "earlier")
    return tmp_path / "earlier" / "study.toml"


def test_a_ledger_of_an_earlier_layout_is_read_with_its_metrics(earlier: Path) -> None:
    study = Study.read(earlier)
    with sqlite3.connect(study.ledger) as database:
        told = database.execute("SELECT key, distance, latency FROM runs").fetchall()
    with Ledger(study.ledger, read_only=True) as ledger:
        found = {record.key: record for record in ledger.records()}
    assert len(found) == 8
    for key, distance, latency in told:
        metrics = found[key].metrics
        assert (metrics.get("distance"), metrics.get("latency")) == (distance, latency)
    planned = [record for record in found.values() if record.method == "planner"]
    assert len(planned) == 6
    assert all(record.metrics.keys() >= {"n_served", "makespan"} for record in planned)


def test_a_ledger_of_an_earlier_layout_is_gone_on_with_and_loses_nothing(earlier: Path) -> None:
    before = {record.key: record for record in kept(earlier)}
    text = earlier.read_text(encoding="utf-8")
    assert "models" in text
    earlier.write_text(text.replace("seed = [0, 1]", "seed = [0, 1, 2]"), encoding="utf-8")
    added = do(earlier)
    assert {0, 1, 2} >= {record.seed for record in added if record.contender == "random"} >= {2}
    after = {record.key: record for record in kept(earlier)}
    assert after.items() >= before.items()
    # What is of this version, and what is of that one alone, is one table.
    study = Study.read(earlier)
    table = frame(current(runs(study), after.values()))
    assert len(table) == len(runs(study)) == 10
    assert (table.distance[table.method == "planner"] > 0).all()


def test_a_metric_that_is_new_needs_no_new_layout(path: Path) -> None:
    new = replace(RECORD, key="new", metrics_json='{"n_served": 1, "novelty": 2.5}')
    with Ledger(path) as ledger:
        ledger.add(RECORD)
        ledger.add(new)
    with Ledger(path, read_only=True) as ledger:
        table = frame(list(ledger.records()))
    assert table.novelty.isna().tolist() == [True, False]
    assert table.columns.get_loc("novelty") > table.columns.get_loc("distance")
    with sqlite3.connect(path) as database:
        assert "novelty" not in [
            name for _, name, *_ in database.execute("PRAGMA table_info(runs)")
        ]


# -------------------------------------------------------------------------- reading, and its place


@contextmanager
def a_strangers_rights() -> Iterator[None]:
    """Those of a user who owns nothing here; the superuser may write anywhere."""
    if os.geteuid():
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def shelf() -> Iterator[Path]:
    """A folder that all may enter and nobody writes into, once the test has closed it."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        yield folder
        folder.chmod(0o755)


@pytest.mark.parametrize("writable_file", [True, False])
@pytest.mark.parametrize("left_by", ["a writer that closed it", "a writer that goes on", "a kill"])
def test_a_ledger_is_read_where_nothing_can_be_written(
    shelf: Path, left_by: str, writable_file: bool
) -> None:
    path = shelf / "ledger [1] 100% #?.sqlite"
    writer = Ledger(path)
    writer.add(RECORD)
    if left_by == "a writer that closed it":
        writer.close()
    if left_by == "a kill":
        shutil.copytree(shelf, shelf / "left")
        path = shelf / "left" / path.name
        path.with_name(f"{path.name}-shm").unlink()
    path.chmod(0o644 if writable_file else 0o444)
    path.parent.chmod(0o555)
    before = sorted(path.parent.iterdir())
    with a_strangers_rights(), Ledger(path, read_only=True) as ledger:
        assert list(ledger.records()) == [RECORD]
        assert ledger.get("k") == RECORD
        assert ledger.missions() == {}
    assert sorted(path.parent.iterdir()) == before
    with (
        a_strangers_rights(),
        pytest.raises(InputError, match="permissions"),
        Ledger(path) as ledger,
    ):
        ledger.add(replace(RECORD, key="other"))
    path.parent.chmod(0o755)
    if left_by == "a writer that goes on":
        writer.close()


def test_reading_leaves_nothing_behind(path: Path) -> None:
    with Ledger(path) as ledger:
        ledger.add(RECORD)
    before = [(item.name, item.read_bytes()) for item in path.parent.iterdir()]
    with Ledger(path, read_only=True) as ledger:
        assert list(ledger.records()) == [RECORD]
    assert [(item.name, item.read_bytes()) for item in path.parent.iterdir()] == before


# ------------------------------------------------------------------ what goes wrong is one clear line


def test_a_lock_that_is_held_for_long_is_said_so_and_nothing_is_lost(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ledger_module, "PATIENCE_SECONDS", 0.25)
    with Ledger(path) as ledger:
        ledger.add(RECORD)
        holder = sqlite3.connect(path, isolation_level=None)
        holder.execute("BEGIN EXCLUSIVE")
        with pytest.raises(InputError, match="is locked by another program"):
            ledger.claim("other")
        holder.execute("ROLLBACK")
        holder.close()
        ledger.add(replace(RECORD, key="other"))
        assert [record.key for record in ledger.records()] == ["k", "other"]


def test_a_result_waits_for_a_lock_however_long_and_says_so_once(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ledger_module, "PATIENCE_SECONDS", -1.0)
    with Ledger(path) as ledger:
        holder = sqlite3.connect(path, isolation_level=None)
        holder.execute("BEGIN EXCLUSIVE")
        waits = iter(range(5))

        def until_the_fifth(_: float) -> None:
            if next(waits) == 4:
                holder.execute("ROLLBACK")

        monkeypatch.setattr(ledger_module.time, "sleep", until_the_fifth)
        ledger.add(RECORD)
        holder.close()
        assert ledger.get("k") == RECORD
    said = capsys.readouterr().err
    assert said == f"{path}: locked by another program; a result waits until it can be kept\n"


def test_an_interruption_ends_the_waiting_of_a_result(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ledger_module, "LAST_SECONDS", -1.0)
    with Ledger(path) as ledger:
        holder = sqlite3.connect(path, isolation_level=None)
        holder.execute("BEGIN EXCLUSIVE")
        monkeypatch.setattr(ledger_module, "interrupted", lambda: True)
        with pytest.raises(InputError, match="is locked by another program"):
            ledger.add(RECORD)
        holder.close()


def test_a_lock_that_is_given_back_in_time_is_waited_for(path: Path) -> None:
    with Ledger(path) as ledger:
        holder = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        holder.execute("BEGIN EXCLUSIVE")
        release = threading.Timer(0.2, holder.execute, ["ROLLBACK"])
        release.start()
        ledger.add(RECORD)
        release.join()
        holder.close()
        assert ledger.get("k") == RECORD


def test_a_full_disk_is_said_so_and_nothing_is_lost(path: Path) -> None:
    with Ledger(path) as ledger:
        ledger.add(RECORD)
        (pages,) = ledger._database.execute("PRAGMA page_count").fetchone()
        ledger._database.execute(f"PRAGMA max_page_count = {pages}")
        with pytest.raises(InputError, match="the disk is full"):
            ledger.add(replace(RECORD, key="large", error="x" * 2**20))
        assert ledger.get("large") is None
        ledger.add(replace(RECORD, key="small"))
    with sqlite3.connect(path) as database:
        assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    with Ledger(path, read_only=True) as ledger:
        assert [record.key for record in ledger.records()] == ["k", "small"]


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        ("options_json", "{", "options_json: broken JSON"),
        ("options_json", "[]", "options_json: []; give an object as JSON"),
        ("seconds_json", '{"a": 1}', "seconds_json: "),
        ("metrics_json", '{"distance": NaN}', "metrics_json: "),
        ("n_robots", "many", "n_robots: 'many'; give a whole number"),
        ("seconds", b"1", "seconds: "),
        ("stage", 1.5, None),  # a column of texts makes a text of it
    ],
)
def test_a_run_that_is_damaged_is_named(
    path: Path, column: str, value: object, said: str | None
) -> None:
    with Ledger(path) as ledger:
        ledger.add(RECORD)
    with sqlite3.connect(path) as database:
        database.execute(f"UPDATE runs SET {column} = ?", (value,))
    with Ledger(path, read_only=True) as ledger:
        if said is None:
            assert next(ledger.records()).stage == "1.5"
            return
        with pytest.raises(InputError) as caught:
            list(ledger.records())
    assert f"damaged: run 'k': {said}" in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_ledger_that_is_cut_short_is_one_line(path: Path) -> None:
    with Ledger(path) as ledger:
        for i in range(50):
            ledger.add(replace(RECORD, key=f"{i:03}", error="x" * 500))
    path.write_bytes(path.read_bytes()[: 3 * 4096])
    with pytest.raises(InputError, match="not a ledger that can be used"):
        list(Ledger(path, read_only=True).records())


def test_a_process_is_known_again_though_the_clock_has_been_set(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Ledger(path) as mine, Ledger(path) as other:
        other._owner = _identity(psutil.Process(os.getppid()))
        assert other.claim("k")
        born = psutil.Process.create_time
        monkeypatch.setattr(psutil.Process, "create_time", lambda self: born(self) + 3600)
        monkeypatch.setattr(psutil, "boot_time", lambda: 0.0)
        assert mine.claimed_elsewhere(["k"]) == {"k"}
        assert not mine.claim("k")
