"""Running things in processes of their own, with limits, so that one failure takes nothing down.

Processes are forked from a server that has loaded the libraries and solved nothing: a fork after a
threaded solve can hang, and a fresh interpreter would pay for the imports each time.
"""

from __future__ import annotations

import multiprocessing
import signal
import sys
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from types import ModuleType
from typing import Any, Literal

import psutil

from ..mission.errors import InputError, MsmrtaError

POLL_SECONDS = 0.02
"""How often runs are looked at."""
MEMORY_SECONDS = 0.1
"""How often their memory is, which takes longer to find out."""


@dataclass(frozen=True)
class Failure:
    """A run that gave no result."""

    reason: Literal["raised", "crashed", "timed out", "out of memory"]
    message: str


@dataclass
class _Run:
    index: int
    process: Any
    receiver: Connection
    began: float
    weighed: float = 0.0


def run_isolated(
    function: Callable[..., Any],
    calls: Sequence[tuple[Any, ...]],
    *,
    jobs: int = 1,
    time_limit: float | None = None,
    memory_limit: float | None = None,
    preload: Sequence[str] = (),
) -> Generator[tuple[int, Any], None, None]:
    """Call ``function(*call)`` for each of `calls`, each in a process of its own.

    Parameters
    ----------
    function : callable
        A module's function, so that another process can import it.
    calls : sequence of tuple
        Picklable arguments.
    jobs : int
        How many at a time.
    time_limit : float, optional
        Seconds after which a run is killed.
    memory_limit : float, optional
        MiB of resident memory past which a run is killed, that of its own children included.
    preload : sequence of str
        Modules that all processes share.

    Yields
    ------
    index, result
        As they finish: the position in `calls`, and what the function returned or a `Failure`.
        Closing the iterator kills what still runs.

    Raises
    ------
    InputError
        If `jobs` or a limit is not positive.
    """
    for name, value in {
        "jobs": jobs,
        "time_limit": time_limit,
        "memory_limit": memory_limit,
    }.items():
        if value is not None and not value > 0:
            raise InputError(f"{value!r}; give more than 0", field=name)
    context = _context(preload)
    waiting = list(enumerate(calls))[::-1]
    running: list[_Run] = []
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                index, call = waiting.pop()
                running.append(_start(context, function, index, call))
            wait([run.receiver for run in running], timeout=POLL_SECONDS)
            for run in list(running):
                result = _look(run, time_limit, memory_limit)
                if result is not None:
                    running.remove(run)
                    yield run.index, result[0]
    finally:
        for run in running:
            _end(run)


def _context(preload: Sequence[str]) -> Any:
    if sys.platform == "win32" or "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(preload))
    return context


def _start(context: Any, function: Callable[..., Any], index: int, call: tuple[Any, ...]) -> _Run:
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_call, args=(sender, function, call), daemon=True)
    with _without_main():
        process.start()
    sender.close()
    return _Run(index, process, receiver, time.monotonic())


@contextmanager
def _without_main() -> Iterator[None]:
    """Hide the main script, which a new process would otherwise run again.

    What runs there is a module's function, and a script may come without a guard, or from standard
    input, where it cannot be found again.
    """
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _call(sender: Connection, function: Callable[..., Any], call: tuple[Any, ...]) -> None:
    # Ctrl-C is the parent's to handle; it ends its processes itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        message: tuple[str, Any] = ("result", function(*call))
    except MemoryError:
        message = ("failure", Failure("out of memory", "the process ran out of memory"))
    except MsmrtaError as error:
        message = ("failure", Failure("raised", str(error)))
    except Exception as error:
        # Whatever a user's model raises is news about that run, not the end of the others.
        message = ("failure", Failure("raised", f"{type(error).__name__}: {error}"))
    try:
        sender.send(message)
    except Exception as error:
        # Pickling comes before sending, so nothing has been sent yet.
        said = f"the result cannot be sent ({type(error).__name__}: {error})"
        sender.send(("failure", Failure("raised", said)))
    sender.close()


def _look(run: _Run, time_limit: float | None, memory_limit: float | None) -> tuple[Any] | None:
    """What `run` has come to, in a tuple; ``None`` while it goes on."""
    # In this order: a run that answers and ends between the two questions has answered.
    alive = run.process.is_alive()
    if run.receiver.poll():
        try:
            _, result = run.receiver.recv()
        except (EOFError, OSError):
            return (_post_mortem(run),)
        except Exception as error:
            result = Failure(
                "raised", f"the result cannot be read ({type(error).__name__}: {error})"
            )
        _end(run)
        return (result,)
    if not alive:
        return (_post_mortem(run),)
    if time_limit is not None and time.monotonic() - run.began > time_limit:
        _end(run)
        return (Failure("timed out", f"killed after {time_limit:g} s"),)
    if memory_limit is not None and time.monotonic() - run.weighed > MEMORY_SECONDS:
        run.weighed = time.monotonic()
        if _resident(run.process.pid) > memory_limit * 2**20:
            _end(run)
            return (Failure("out of memory", f"killed past {memory_limit:g} MiB"),)
    return None


def _post_mortem(run: _Run) -> Failure:
    run.process.join(timeout=5)
    code = run.process.exitcode
    _end(run)
    if code is not None and code < 0:
        return Failure("crashed", f"killed by {signal.Signals(-code).name}")
    return Failure("crashed", f"ended with exit status {code} and no result")


def _resident(pid: int) -> int:
    """Bytes of process `pid` and of its children: some solvers work in a process of their own."""
    try:
        process = psutil.Process(pid)
        family = [process, *process.children(recursive=True)]
    except psutil.Error:
        return 0
    total = 0
    for member in family:
        with suppress(psutil.Error):
            total += int(member.memory_info().rss)
    return total


def _end(run: _Run) -> None:
    run.receiver.close()
    if run.process.is_alive():
        run.process.kill()
    run.process.join()
