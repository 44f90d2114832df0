"""Whatever a run does, it is one failure with a reason, and the others are whole."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import threading
import time
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

import psutil
import pytest
from support.misbehaviour import do, double, note_or_wait, work_until_interrupted

from msmrta_opt.isolation import Failure, Limits, Worker, run_alone, run_isolated
from msmrta_opt.mission.errors import InputError

MISBEHAVIOUR = {
    "kill": ("crashed", "killed by SIGKILL"),
    "abort": ("crashed", "killed by SIGABRT"),
    "exit": ("crashed", "ended with exit status 3 and no result"),
    "leave": ("crashed", "ended with exit status 0 and no result"),
    "eat": ("out of memory", "killed past 400 MiB"),
    "raise": ("raised", "ZeroDivisionError: division by zero"),
    "lambda": ("raised", "the result cannot be sent"),
}


def is_gone(pid: int) -> bool:
    """Whether the process has ended, within a patience that only a failure uses up."""
    for _ in range(1200):
        try:
            if psutil.Process(pid).status() == psutil.STATUS_ZOMBIE:
                return True
        except psutil.NoSuchProcess:
            return True
        time.sleep(0.05)
    return False


@pytest.fixture(scope="module")
def results() -> dict[str, Any]:
    """What came of every misbehaviour, each between two sound runs, two at a time."""
    calls: list[tuple[Any, ...]] = [("right", 0)]
    for i, what in enumerate(MISBEHAVIOUR):
        calls += [(what,), ("right", i + 1)]
    found = dict(run_isolated(do, calls, jobs=2, limits=Limits(memory=400)))
    assert sorted(found) == list(range(len(calls)))
    sound = [found[i] for i in range(0, len(calls), 2)]
    return {"sound": sound, **{calls[i][0]: found[i] for i in range(1, len(calls), 2)}}


@pytest.mark.parametrize("what", MISBEHAVIOUR)
def test_a_run_that_misbehaves_is_a_failure_with_its_reason(
    results: dict[str, Any], what: str
) -> None:
    reason, message = MISBEHAVIOUR[what]
    assert isinstance(results[what], Failure)
    assert results[what].reason == reason
    assert results[what].message.startswith(message)


def test_the_other_runs_are_whole(results: dict[str, Any]) -> None:
    assert results["sound"] == [2 * i for i in range(len(MISBEHAVIOUR) + 1)]


def test_a_run_beyond_its_time_is_killed() -> None:
    failure = run_alone(do, ("hang",), limits=Limits(time=0.1))
    assert (failure.reason, failure.message) == ("timed out", "killed after 0.1 s")


def test_how_a_run_was_killed_is_told_though_another_starts_meanwhile(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A process that starts asks all others for their ends, and an end is told only once."""
    told = forkserver.read_signed
    ids: list[int] = []
    others: list[threading.Thread] = []

    def slowly(sentinel: int) -> int:
        if not ids:  # told first: of the process that is about to be killed
            ids.append(told(sentinel))
            return ids[0]
        if not others:
            others.append(threading.Thread(target=run_alone, args=(double, (1,))))
            others[0].start()
            others[0].join(1)  # it gets no further than its turn
        return told(sentinel)

    monkeypatch.setattr(forkserver, "read_signed", slowly)
    failure = run_alone(do, ("kill",))
    others[0].join()
    assert (failure.reason, failure.message) == ("crashed", "killed by SIGKILL")


def test_an_error_of_the_package_comes_back_as_itself() -> None:
    failure = run_alone(Limits, (-1.0,))
    assert isinstance(failure.error, InputError)
    assert str(failure.error) == failure.message == "time_limit: -1.0; give more than 0"


def test_a_worker_does_one_call_after_another_until_one_ends_it() -> None:
    with Worker() as worker:
        assert [worker.call(double, i) for i in range(3)] == [0, 2, 4]
        assert worker.call(do, "raise").reason == "raised"
        assert (worker.call(os.getpid), worker.is_alive) == (worker.pid, True)
        assert worker.call(do, "leave").reason == "crashed"
        assert not worker.is_alive
        assert worker.call(double, 1).reason == "crashed"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
@pytest.mark.parametrize("preload", [(), None], ids=["forked", "fresh"])
def test_ctrl_c_does_not_reach_a_process_that_is_still_starting(
    preload: tuple[str, ...] | None,
) -> None:
    """A terminal sends it to all, and imports that it cuts off would tell of it in a traceback."""
    with Worker(preload) as worker:
        assert signal.SIGINT in worker.call(signal.pthread_sigmask, signal.SIG_BLOCK, ())


def test_what_a_run_prints_goes_to_standard_error(capfd: pytest.CaptureFixture[str]) -> None:
    with Worker() as worker:
        worker.call(os.system, "echo from a solver")
    assert capfd.readouterr() == ("", "from a solver\n")


PARENT = """
import os, sys, time
from support.misbehaviour import hold
from msmrta_opt.isolation import Worker
with Worker(eval(sys.argv[1])) as worker:
    worker.call(hold, sys.argv[2])
"""


@pytest.mark.parametrize("preload", [None, ()], ids=["fresh", "forked"])
def test_a_worker_ends_with_its_parent_even_where_no_python_runs(
    tmp_path: Path, preload: Any
) -> None:
    note = tmp_path / "pid"
    path = f"import sys; sys.path[:] = {sys.path!r}"
    parent = subprocess.Popen([sys.executable, "-c", path + PARENT, repr(preload), note])
    while not note.exists():
        assert parent.poll() is None
        time.sleep(0.02)
    parent.kill()
    parent.wait()
    assert is_gone(int(note.read_text()))


def test_one_at_a_time_runs_come_in_order() -> None:
    found = list(run_isolated(double, [(5,), (1,), (3,)]))
    assert found == [(0, 10), (1, 2), (2, 6)]


def test_nothing_to_run_gives_nothing() -> None:
    assert list(run_isolated(double, [])) == []


def test_closing_the_iterator_kills_what_still_runs(tmp_path: Path) -> None:
    note = tmp_path / "pid"
    runs = run_isolated(note_or_wait, [("note", str(note)), ("wait", str(note))], jobs=2)
    assert next(runs) == (1, None)
    pid = int(note.read_text())
    assert psutil.pid_exists(pid)
    runs.close()
    assert is_gone(pid)


@pytest.mark.parametrize("wrong", [{"time": 0.0}, {"memory": -1.0}, {"time": math.nan}])
def test_limits_that_nothing_can_meet_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError, match=f"{next(iter(wrong))}_limit: .*give more than 0"):
        Limits(**wrong)
    with pytest.raises(InputError, match="jobs: 0; give more than 0"):
        list(run_isolated(double, [(1,)], jobs=0))


def test_a_script_without_a_guard_is_not_run_again(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import operator\n"
        "from msmrta_opt.isolation import run_isolated\n"
        "print(list(run_isolated(operator.neg, [(1,), (2,)])))\n"
    )
    answer = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert (answer.stdout, answer.stderr) == ("[(0, -1), (1, -2)]\n", "")


def test_a_call_that_is_asked_to_end_gives_what_it_has_and_its_process_goes_on(
    tmp_path: Path,
) -> None:
    with Worker() as worker:
        for name in ("first", "second"):
            begun = tmp_path / name
            given = worker.call(
                work_until_interrupted, str(begun), should_stop=begun.exists, grace=600
            )
            assert given == "what there is"
        assert worker.call(double, 3) == 6


def test_a_call_that_does_not_end_when_it_is_asked_is_killed_after_the_grace() -> None:
    with Worker() as worker:
        found = worker.call(do, "hang", should_stop=lambda: True, grace=0.1)
        assert found == Failure("stopped", "killed on request")
