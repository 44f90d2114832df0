"""Whatever ends a study, what was finished is kept, and nothing is done twice."""

from __future__ import annotations

import json
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from studies.test_runner import unmeasured
from support import studies
from support.misbehaviour import write_models
from support.studies import do, kept, many_runs, write_study

from msmrta_opt.studies import runner
from msmrta_opt.studies.runs import runs
from msmrta_opt.studies.specification import Study

PATIENCE_SECONDS = 600
"""Used up by a failure alone."""
N_RUNS = 10
MOMENTS = [
    "open 1",  # the ledger is there, and nothing else
    "claim 1",  # the first run is claimed
    "call 2",  # two runs are going on
    "add 1",  # the first has its result, which is not kept
    "insert 3",  # a result is written, and not committed
    "commit 4",  # it is kept, and nobody has been told
]
"""Where a session stops to be killed: the how-manieth of which step."""


def session(path: Path, *moment: str) -> subprocess.Popen[str]:
    """A process that goes on with the study at `path`, up to a moment if one is given."""
    return subprocess.Popen(
        [sys.executable, studies.__file__, str(path), *moment],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def have_ended(processes: list[psutil.Process]) -> bool:
    _, alive = psutil.wait_procs(processes, timeout=PATIENCE_SECONDS)
    return not [process for process in alive if process.status() != psutil.STATUS_ZOMBIE]


def test_kills_lose_nothing_that_was_finished_and_redo_nothing(tmp_path: Path) -> None:
    path = many_runs(tmp_path, N_RUNS)
    ledger = Study.read(path).ledger
    before: dict[str, object] = {}
    for moment in MOMENTS:
        running = session(path, moment)
        assert running.stdout is not None
        told: list[str] = []
        while (line := running.stdout.readline().strip()) != studies.STOPPED:
            assert line, running.communicate()
            told.append(line)
        children = psutil.Process(running.pid).children(recursive=True)
        running.send_signal(signal.SIGKILL)
        running.communicate()
        assert have_ended(children), "the runs of a killed study end"
        with sqlite3.connect(ledger) as database:
            assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
        after = {record.key: record for record in kept(path)}
        assert after.items() >= before.items(), "what was finished stays as it was"
        # Of the runs that are new, all have been told of but one that was committed just now.
        new = after.keys() - before.keys()
        assert set(told) <= new
        assert len(new - set(told)) == (moment == "commit 4")
        before = dict(after)
    assert 0 < len(before) < N_RUNS, "the kills came in the middle of the study"

    do(path, jobs=2)
    after = {record.key: record for record in kept(path)}
    assert after.items() >= before.items()
    assert after.keys() == {run.key for run in runs(Study.read(path))}
    (tmp_path / "undisturbed").mkdir()
    undisturbed = many_runs(tmp_path / "undisturbed", N_RUNS)
    do(undisturbed, execute=runner.here)
    assert unmeasured(kept(path)) == unmeasured(kept(undisturbed))


def test_two_studies_at_once_share_the_work(tmp_path: Path) -> None:
    path = many_runs(tmp_path, 6)
    both = [session(path), session(path)]
    told = [running.communicate(timeout=PATIENCE_SECONDS) for running in both]
    assert [running.returncode for running in both] == [0, 0], told
    one, other = (out.split() for out, _ in told)
    assert len(one) + len(other) == 6
    assert {*one, *other} == {record.key for record in kept(path)}


@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "SIGTERM"]
)
def test_an_interrupted_study_says_how_to_go_on(
    tmp_path: Path, number: signal.Signals, status: int
) -> None:
    started = tmp_path / "started"
    waits = f"    open({str(started)!r}, 'w').close()\n    time.sleep(600)"
    write_models(tmp_path / "mine", "right", waits=waits)
    path = write_study(
        tmp_path,
        'title = "Waits"\nmodels = ["mine"]\n[[instances]]\nmaps = "open.map"\nrobots = 2\n'
        'victims = 2\n[[formulations]]\nstage = "cluster"\nmodels = ["right", "waits"]\n',
    )
    code = f"import sys; sys.path[:] = {sys.path!r}; from msmrta_opt.cli import main; main()"
    running = subprocess.Popen(
        [sys.executable, "-c", code, "study", "run", str(path), "--json", str(tmp_path / "state")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not started.exists():
        assert running.poll() is None, running.communicate()
        time.sleep(0.05)
    children = psutil.Process(running.pid).children(recursive=True)
    running.send_signal(number)
    out, errors = running.communicate(timeout=PATIENCE_SECONDS)
    assert running.returncode == status
    assert "interrupted: 1 of 2 runs are kept." in out
    state = json.loads((tmp_path / "state").read_text())
    assert [(row["finished"], row["open"]) for row in state["runs"]] == [(1, 0), (0, 1)]
    assert f"To go on from there: msmrta study run {path}" in out
    assert "Traceback" not in errors
    assert have_ended(children)
    assert [record.contender for record in kept(path)] == ["right by auto"]
