"""Whatever ends a study, what was finished is kept, and nothing is done twice."""

from __future__ import annotations

import random
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import psutil
from studies.test_runner import unmeasured
from support import studies
from support.studies import do, kept, many_runs

from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study

KILLS = 20
PATIENCE_SECONDS = 60


def session(path: Path) -> subprocess.Popen[str]:
    """A process that goes on with the study at `path`, in a session of its own."""
    return subprocess.Popen(
        [sys.executable, studies.__file__, str(path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def have_ended(processes: list[psutil.Process]) -> bool:
    _, alive = psutil.wait_procs(processes, timeout=PATIENCE_SECONDS)
    return not [process for process in alive if process.status() != psutil.STATUS_ZOMBIE]


def test_twenty_kills_lose_nothing_that_was_finished_and_redo_nothing(tmp_path: Path) -> None:
    chance = random.Random(0)
    path = many_runs(tmp_path, 150)
    ledger = Study.read(path).ledger
    todo = {run.key for run in runs(Study.read(path))}
    before: dict[str, object] = {}
    for _ in range(KILLS):
        running = session(path)
        # Sometimes at once, sometimes between two runs, sometimes in the middle of one.
        assert running.stdout is not None
        n_before = chance.choice([0, 1, 1, 3, 6])
        said = [running.stdout.readline().strip() for _ in range(n_before)]
        time.sleep(chance.uniform(0, 0.03 if said else 1.0))
        children = psutil.Process(running.pid).children(recursive=True)
        running.send_signal(signal.SIGKILL)
        said += running.communicate()[0].split()
        assert have_ended(children), "the runs of a killed study end"
        if not ledger.exists():
            continue
        with sqlite3.connect(ledger) as database:
            assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
        after = {record.key: record for record in kept(path)}
        assert after.items() >= before.items(), "what was finished stays as it was"
        # Of the runs that are new, all but the last have been told of since.
        new = after.keys() - before.keys()
        assert set(said) <= new
        assert len(new - set(said)) <= 1
        before = dict(after)
    assert 0 < len(before) < len(todo), "the kills came in the middle of the study"

    do(path, jobs=2)
    after = {record.key: record for record in kept(path)}
    assert after.items() >= before.items()
    assert after.keys() == todo
    (tmp_path / "undisturbed").mkdir()
    undisturbed = many_runs(tmp_path / "undisturbed", 150)
    do(undisturbed, jobs=2)
    assert unmeasured(kept(path)) == unmeasured(kept(undisturbed))


def test_two_studies_at_once_share_the_work(tmp_path: Path) -> None:
    path = many_runs(tmp_path, 40)
    both = [session(path), session(path)]
    told = [running.communicate(timeout=PATIENCE_SECONDS * 2) for running in both]
    assert [running.returncode for running in both] == [0, 0], told
    one, other = (out.split() for out, _ in told)
    assert len(one) + len(other) == 40
    assert {*one, *other} == {record.key for record in kept(path)}


def test_an_interrupted_study_says_how_to_go_on(tmp_path: Path) -> None:
    path = many_runs(tmp_path, 2000)
    command = [sys.executable, "-c", "import sys; from msmrta_opt.cli import main; main()"]
    running = subprocess.Popen(
        [*command, "study", "run", str(path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not (Study.read(path).ledger.exists() and kept(path)):
        assert running.poll() is None, running.communicate()
        time.sleep(0.1)
    children = psutil.Process(running.pid).children(recursive=True)
    running.send_signal(signal.SIGINT)
    out, errors = running.communicate(timeout=PATIENCE_SECONDS)
    assert running.returncode == 130
    assert "interrupted: " in out
    assert f"To go on from there: msmrta study run {path}" in out
    assert "Traceback" not in errors
    assert have_ended(children)
    n_kept = len(kept(path))
    assert 0 < n_kept < 2000
    assert f"interrupted: {n_kept} of 2000 runs are kept." in out
