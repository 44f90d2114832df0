"""What the process of a `Worker` does: it calls what its parent sends, and says what comes of it.

It heeds no Ctrl-C of its own, but asks its parent; what it prints goes to standard error; and it ends
with its parent, whatever it is doing.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any, Literal

from . import interruption
from .mission.errors import MsmrtaError

END = None
"""What is sent to a worker instead of a call, so that the one that goes on ends."""
POLL_SECONDS = 0.05
"""How often a run is looked at while it says nothing."""


@dataclass(frozen=True)
class Failure:
    """A call that gave no result.

    ``error`` is what it raised, if that was one of the package's own errors.
    """

    reason: Literal["raised", "crashed", "timed out", "out of memory", "stopped"]
    message: str
    error: MsmrtaError | None = None


def serve(connection: Connection) -> None:
    """Call what the parent sends until it sends no more; run by the process of a `Worker`."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _end_with_parent()
    with suppress(OSError):
        os.dup2(2, 1)  # the parent's standard output is for its own results
    with closing(connection):
        while True:
            try:
                asked = connection.recv()
                if asked is END:  # of a call that has ended
                    continue
                function, arguments = asked
            except (EOFError, OSError):
                return
            except Exception as error:
                result: Any = _raised(error)
            else:
                interruption.listen_to_parent(_seldom(connection.poll))
                result = _result_of(function, arguments)
            try:
                connection.send(result)
            except OSError:
                return
            except Exception as error:
                # Pickling comes before sending, so nothing has been sent yet.
                said = f"the result cannot be sent ({type(error).__name__}: {error})"
                connection.send(Failure("raised", said))


def _seldom(look: Callable[[], bool]) -> Callable[[], bool]:
    """`look`, at most once in `POLL_SECONDS`, until it is true; solvers may ask at every step."""
    last, found = -POLL_SECONDS, False

    def looked() -> bool:
        nonlocal last, found
        now = time.monotonic()
        if not found and now - last >= POLL_SECONDS:
            last, found = now, look()
        return found

    return looked


def _result_of(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    try:
        return function(*arguments)
    except MemoryError:
        return Failure("out of memory", "the process ran out of memory")
    except Exception as error:
        # Whatever a user's model raises is news about that call, not the end of the others.
        return _raised(error)


def _raised(error: Exception) -> Failure:
    if isinstance(error, MsmrtaError):
        return Failure("raised", str(error), error)
    return Failure("raised", f"{type(error).__name__}: {error}")


def _end_with_parent() -> None:
    """Let the end of the parent end this process, also inside a solver, where no Python runs."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    if sys.platform == "linux":
        import fcntl

        # A pipe that hangs up sends SIGIO, whose default is to terminate.
        flags = fcntl.fcntl(parent.sentinel, fcntl.F_GETFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, flags | os.O_ASYNC)

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
