"""A process of its own for solvers that cannot share ours.

OR-Tools brings its own copy of the HiGHS library: in one process with highspy, which cvxpy loads,
each of the two may find the other's and fail to import (google/or-tools#5246). GLPK ends its process
on an error. So they work in a child process, which is started when first needed and then kept.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable

from ...interruption import interrupted
from ...isolation import Failure, Worker
from ...mission.errors import SolverError
from ..program import Program
from .base import Options, Outcome

GRACE_SECONDS = 1.0
"""For a solver that is asked to end with its incumbent, before its process is killed."""

_lock = threading.Lock()
_worker: tuple[int, Worker] | None = None
"""The process that started it, whose child it is, and no fork's of that process."""


def run_apart(
    function: Callable[[Program, Options], Outcome], program: Program, options: Options
) -> Outcome:
    """Return ``function(program, options)``, worked out in the child process.

    Parameters
    ----------
    function : callable
        At the top level of a module, so that the child can import it. If it looks at `interrupted`, it
        can end with its incumbent.
    program : Program
        The arrays.
    options : Options
        What was asked for. A log goes to standard error.

    Raises
    ------
    SolverError
        If the child dies, or `function` fails.
    """
    global _worker
    with _lock:
        if _worker is None or _worker[0] != os.getpid() or not _worker[1].is_alive:
            _worker = os.getpid(), Worker()
        kept = False
        try:
            outcome: Outcome | Failure = _worker[1].call(
                function, program, options, should_stop=interrupted, grace=GRACE_SECONDS
            )
            kept = not isinstance(outcome, Failure) or outcome.reason == "raised"
        finally:
            if not kept:  # above all after Ctrl-C: nobody waits for the outcome any more
                end()
    if isinstance(outcome, Outcome):
        return outcome
    if outcome.reason == "raised":
        raise outcome.error or SolverError(outcome.message)
    if interrupted():
        return Outcome("no_solution", message="interrupted: it could not be asked for an incumbent")
    raise SolverError(f"the solver's process {outcome.message}")


def end() -> None:
    """End the child process, if there is one; the next request starts another."""
    global _worker
    if _worker is not None and _worker[0] == os.getpid():
        _worker[1].close()
    _worker = None
