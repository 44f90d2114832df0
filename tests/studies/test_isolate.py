"""Whatever a run does, it is one failure with a reason, and the others are whole."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import psutil
import pytest
from support.misbehaviour import do, double, note_or_wait

from msmrta_opt.mission.errors import InputError
from msmrta_opt.studies.isolate import Failure, run_isolated

MISBEHAVIOUR = {
    "kill": ("crashed", "killed by SIGKILL"),
    "abort": ("crashed", "killed by SIGABRT"),
    "exit": ("crashed", "ended with exit status 3 and no result"),
    "leave": ("crashed", "ended with exit status 0 and no result"),
    "hang": ("timed out", "killed after 10 s"),
    "eat": ("out of memory", "killed past 600 MiB"),
    "raise": ("raised", "ZeroDivisionError: division by zero"),
    "lambda": ("raised", "the result cannot be sent"),
}


def is_gone(pid: int) -> bool:
    """Whether the process has ended, within a patience that only a failure uses up."""
    for _ in range(200):
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
    found = dict(run_isolated(do, calls, jobs=2, time_limit=10, memory_limit=600))
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


@pytest.mark.parametrize("wrong", [{"jobs": 0}, {"time_limit": 0.0}, {"memory_limit": -1.0}])
def test_limits_that_nothing_can_meet_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        list(run_isolated(double, [(1,)], **wrong))


def test_a_script_without_a_guard_is_not_run_again(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import operator\n"
        "from msmrta_opt.studies.isolate import run_isolated\n"
        "print(list(run_isolated(operator.neg, [(1,), (2,)])))\n"
    )
    answer = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert (answer.stdout, answer.stderr) == ("[(0, -1), (1, -2)]\n", "")
