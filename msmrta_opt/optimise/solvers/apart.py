"""A process of its own for solvers that cannot share ours.

OR-Tools brings its own copy of the HiGHS library: in one process with highspy, which cvxpy loads,
each of the two may find the other's and fail to import (google/or-tools#5246). GLPK ends its process
on an error. So they work in a child process, which is started when first needed and then kept.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import IO

from ...mission.errors import MsmrtaError, SolverError
from ..program import Program
from .base import Options, Outcome

_lock = threading.Lock()
_worker: tuple[int, subprocess.Popen[bytes]] | None = None


def run_apart(
    function: Callable[[Program, Options], Outcome], program: Program, options: Options
) -> Outcome:
    """Return ``function(program, options)``, worked out in the child process.

    Parameters
    ----------
    function : callable
        At the top level of a module, so that the child can import it.
    program : Program
        The arrays.
    options : Options
        What was asked for. A log goes to standard error.

    Raises
    ------
    SolverError
        If the child dies, or `function` fails.
    """
    with _lock:
        worker = _running()
        try:
            requests, answers = worker.stdin, worker.stdout
            if requests is None or answers is None:  # never: both were asked for
                raise SolverError("the solver's process has no pipes")
            pickle.dump((function, program, options), requests)
            requests.flush()
            answer: Outcome | MsmrtaError = pickle.load(answers)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError) as error:
            code = _end()
            raise SolverError(f"the solver's process died with exit status {code}") from error
        except BaseException:  # above all KeyboardInterrupt: nobody waits for the answer any more
            _end()
            raise
    if isinstance(answer, MsmrtaError):
        raise answer
    return answer


def serve() -> None:
    """Answer requests from standard input until it ends; run by the child process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    requests = sys.stdin.buffer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # solvers print to standard output, which carries the answers
    while True:
        try:
            function, program, options = pickle.load(requests)
        except EOFError:
            return
        _end_with_parent(requests, busy=True)
        try:
            answer = function(program, options)
        except MsmrtaError as error:
            answer = error
        except Exception as error:
            answer = SolverError(f"{type(error).__name__}: {error}")
        _end_with_parent(requests, busy=False)
        try:
            pickle.dump(answer, answers)
            answers.flush()
        except BrokenPipeError:  # nobody waits for it any more
            os._exit(0)


def _end_with_parent(requests: IO[bytes], *, busy: bool) -> None:
    """Let the end of the parent end this process even inside a solver, where Python sees nothing."""
    if sys.platform == "win32":
        return
    import fcntl

    # A pipe that hangs up sends SIGIO, whose default is to terminate; so would the next request.
    flags = fcntl.fcntl(requests, fcntl.F_GETFL)
    fcntl.fcntl(requests, fcntl.F_SETOWN, os.getpid())
    wanted = flags | os.O_ASYNC if busy else flags & ~os.O_ASYNC
    fcntl.fcntl(requests, fcntl.F_SETFL, wanted)


def _running() -> subprocess.Popen[bytes]:
    global _worker
    # A fork of this process must not share its child.
    if _worker is None or _worker[0] != os.getpid() or _worker[1].poll() is not None:
        code = f"import sys; sys.path[:] = {sys.path!r}; from {__name__} import serve; serve()"
        process = subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        _worker = os.getpid(), process
    return _worker[1]


def _end() -> int | None:
    """End the child; its exit status."""
    global _worker
    if _worker is None or _worker[0] != os.getpid():
        return None
    process = _worker[1]
    _worker = None
    process.kill()
    with process:
        return process.wait()


atexit.register(_end)
