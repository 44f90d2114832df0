"""Ctrl-C and SIGTERM as an event: when it is set, when it raises, and what comes after.

Signals are sent by the process to itself, so that nothing depends on the clock.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

import pytest

from msmrta_opt.interruption import (
    command,
    exit_status,
    interrupted,
    interruptible,
    leave,
    until_interrupted,
)

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")


def send(number: int = signal.SIGINT) -> None:
    os.kill(os.getpid(), number)


def test_ctrl_c_raises_where_nothing_heeds_it() -> None:
    with command(), pytest.raises(KeyboardInterrupt):
        send()


def test_work_that_heeds_it_is_told_and_goes_on() -> None:
    with interruptible():
        assert not interrupted()
        send()
        assert interrupted()


def test_after_the_work_ctrl_c_is_forgotten_and_raises_again() -> None:
    before = signal.getsignal(signal.SIGINT)
    with interruptible():
        send()
    assert not interrupted()
    assert signal.getsignal(signal.SIGINT) is before


def test_a_second_ctrl_c_raises_in_a_program_that_is_no_command_of_ours() -> None:
    with interruptible():
        send()
        with pytest.raises(KeyboardInterrupt):
            send()


def test_work_within_work_is_ended_together() -> None:
    with interruptible():
        with interruptible():
            send()
        assert interrupted()


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_in_a_command_all_that_comes_after_ends_too(number: int, status: int) -> None:
    with command():
        with interruptible():
            send(number)
        assert interrupted()
        with interruptible():
            assert interrupted()
        assert exit_status() == status
    assert not interrupted()


def test_in_a_command_sigterm_raises_like_ctrl_c_until_something_heeds_it() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with command(), pytest.raises(KeyboardInterrupt):
        send(signal.SIGTERM)
    assert signal.getsignal(signal.SIGTERM) is before


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_that_a_library_swallows_ends_what_comes_after(number: int) -> None:
    """As numba's compiler does: what a callback from C raises is printed, and goes no further."""
    with command():
        with suppress(KeyboardInterrupt):
            send(number)
        with interruptible():
            assert interrupted()
    assert not interrupted()


def test_another_thread_works_as_it_is() -> None:
    """Python takes signals in the main thread only."""
    told: list[bool] = []

    def work() -> None:
        with command(), interruptible():
            told.append(interrupted())

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert told == [False]


@pytest.mark.parametrize("second", [signal.SIGINT, signal.SIGTERM])
def test_a_second_signal_ends_a_command_at_once(second: int, tmp_path: Path) -> None:
    """Even before the line that follows it, and what is written stays."""
    written = tmp_path / "written"
    program = (
        "import os, signal, sys\n"
        "from msmrta_opt.interruption import command, interruptible\n"
        "with command(), interruptible():\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        f"    open({str(written)!r}, 'w').close()\n"
        f"    os.kill(os.getpid(), {int(second)})\n"
        "    print('still here')\n"
    )
    root = str(Path(__file__).parents[1])
    ended = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": root},
    )
    assert ended.returncode == -second
    assert ended.stdout == ""
    assert written.exists()


def test_work_that_does_not_end_is_left_to_itself_and_the_process_does_not_wait_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ends: list[int] = []
    monkeypatch.setattr(os, "_exit", ends.append)
    goes_on, told = threading.Event(), threading.Event()
    leave(3)
    with interruptible():
        assert until_interrupted(lambda: None, told.set, patience=0.0)
        assert not told.is_set()
        send()
        assert not until_interrupted(goes_on.wait, told.set, patience=0.0)
    assert told.is_set()
    assert ends == []
    leave(130)
    assert ends == [130]
    goes_on.set()
    for thread in threading.enumerate():
        if thread is not threading.main_thread() and not thread.daemon:
            thread.join()
    leave(130)
    assert ends == [130]


def test_work_is_told_to_end_at_its_limit_and_left_to_itself_where_it_does_not() -> None:
    told = threading.Event()
    assert until_interrupted(lambda: told.wait(), told.set, patience=3600.0, limit=0.0)
    assert told.is_set()
    goes_on = threading.Event()
    assert not until_interrupted(goes_on.wait, lambda: None, patience=0.0, limit=0.0)
    goes_on.set()


def test_work_is_told_to_end_where_ctrl_c_raises() -> None:
    told = threading.Event()

    def work() -> None:
        send()
        told.wait()

    with command(), pytest.raises(KeyboardInterrupt):
        until_interrupted(work, told.set)
    assert told.is_set()
