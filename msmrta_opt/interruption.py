"""Ctrl-C and SIGTERM as an event that long work looks at, so that it ends with the best there is.

Work that can end early opens `interruptible` and asks `interrupted` now and then; it is then not cut
off by `KeyboardInterrupt`, but returns what it has. Within a `command` the event stays set to its end,
so that everything that comes after ends early, too, and what was found is still written.
"""

from __future__ import annotations

import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)
POLL_SECONDS = 0.05
"""How often those look who wait for work that does not look itself."""


@dataclass
class _State:
    """What this process does about signals now."""

    # No `threading.Event`: a handler that sets one waits for ever where its signal comes within `clear`.
    asked: bool = False
    signal: int = signal.SIGINT
    in_command: bool = False
    is_heeded: bool = False
    of_parent: Callable[[], bool] = lambda: False


_now = _State()
_left: list[threading.Thread] = []
"""Work that did not end in time."""


def interrupted() -> bool:
    """Whether the user has asked to end: to be looked at by whatever takes long."""
    return _now.asked or _now.of_parent()


def listen_to_parent(asks: Callable[[], bool]) -> None:
    """In a process that works for another: take what `asks` says for an interruption, too."""
    _now.of_parent = asks


def until_interrupted(
    work: Callable[[], object],
    end: Callable[[], object],
    *,
    patience: float | None = None,
    limit: float | None = None,
) -> bool:
    """Do `work` in a thread, and call `end` again and again once the user asks, until it ends.

    For libraries that look at nothing while they work, but can be told from beside.

    Parameters
    ----------
    work, end : callable
        What to do, and what makes it end.
    patience : float, optional
        Seconds from the user's wish, or from `limit`, on after which the work is left to itself; by
        default it is waited for. What `end` tells it then is to be so in good time: the process ends
        only after it, or by `leave`.
    limit : float, optional
        Seconds after which it is to end as if the user asked.

    Returns
    -------
    bool
        Whether it ended.
    """
    working = threading.Thread(target=work, daemon=patience is None)
    began, asked = time.monotonic(), math.inf
    late = math.inf if limit is None else began + limit
    try:
        working.start()
        while working.is_alive():
            working.join(POLL_SECONDS)
            now = time.monotonic()
            if (interrupted() or now > late) and working.is_alive():
                end()
                asked = min(asked, now)
                if patience is not None and now - asked > patience:
                    _left.append(working)
                    return False
    except BaseException:
        end()
        raise
    return True


def leave(status: int) -> None:
    """End the process at once if work that was left to itself still goes on."""
    if any(thread.is_alive() for thread in _left):
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):
                stream.flush()
        os._exit(status)


def exit_status() -> int:
    """128 and the number of the signal that came, as shells have it: 130 for Ctrl-C, 143 for SIGTERM."""
    return 128 + _now.signal


@contextmanager
def interruptible() -> Iterator[None]:
    """Within it the first Ctrl-C makes `interrupted` true instead of raising `KeyboardInterrupt`.

    For work that looks at `interrupted` and ends with the best it has. Outside the main thread, where
    Python takes no signals, and within another such block it changes nothing.
    """
    if not _in_main_thread() or _now.is_heeded:
        yield
        return
    _now.is_heeded = True
    if _now.in_command:  # which restores it
        yield
        return
    before = signal.signal(signal.SIGINT, _on_signal)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        _now.is_heeded = False
        _now.asked = False


@contextmanager
def command() -> Iterator[None]:
    """Within it SIGTERM is a Ctrl-C, and from the first `interruptible` on both only set the event."""
    if not _in_main_thread():
        yield
        return
    before = {number: signal.signal(number, _on_signal) for number in SIGNALS}
    _now.in_command = True
    _now.signal = signal.SIGINT
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        _now.in_command = _now.is_heeded = False
        _now.asked = False


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()


def _on_signal(number: int, _: Any) -> None:
    _now.signal = number
    if not _now.is_heeded or _now.asked:
        # Where a library calls Python (numba's compiler does), what is raised is lost: so that it is not
        # forgotten, whatever heeds it later is told.
        _now.asked = True
        raise KeyboardInterrupt
    _now.asked = True
    if _now.in_command:
        # The next one ends the process even where no Python runs; files are written whole or not at all.
        for other in SIGNALS:
            signal.signal(other, signal.SIG_DFL)
        with suppress(OSError):
            os.write(2, b"interrupted: ending with what there is; once more ends at once\n")
