"""Running things in processes of their own, with limits, so that one failure takes nothing down.

Processes are forked from a server that has loaded the libraries and solved nothing: a fork after a
threaded solve can hang, and a fresh interpreter would pay for the imports each time. joblib hands
the runs out; each of its threads only watches over the process of its run.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from types import ModuleType
from typing import Any, Literal

import psutil

from ..mission.errors import InputError, MsmrtaError

POLL_SECONDS = 0.02
"""How often a run is looked at while it says nothing."""
MEMORY_SECONDS = 0.1
"""How often its memory is, which takes longer to find out."""

_starting = threading.Lock()
"""Held while a process starts, since that changes what belongs to the whole interpreter."""


@dataclass(frozen=True)
class Failure:
    """A run that gave no result."""

    reason: Literal["raised", "crashed", "timed out", "out of memory", "stopped"]
    message: str


@dataclass(frozen=True)
class Limits:
    """What a run may use: seconds of wall time, and MiB of resident memory with its children's.

    Raises
    ------
    InputError
        If a limit is not positive.
    """

    time: float | None = None
    memory: float | None = None

    def __post_init__(self) -> None:
        _check_positive(time_limit=self.time, memory_limit=self.memory)


def run_isolated(
    function: Callable[..., Any],
    calls: Iterable[tuple[Any, ...]],
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
    calls : iterable of tuple
        Picklable arguments; taken one by one as their turn comes.
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
    from joblib import Parallel, delayed

    _check_positive(jobs=jobs)
    limits = Limits(time_limit, memory_limit)
    stop = threading.Event()

    def watched(index: int, call: tuple[Any, ...]) -> tuple[int, Any]:
        return index, run_alone(function, call, limits=limits, preload=preload, stop=stop)

    parallel = Parallel(
        n_jobs=jobs,
        backend="threading",
        batch_size=1,
        pre_dispatch=jobs,
        return_as="generator_unordered",
    )
    results = parallel(delayed(watched)(index, call) for index, call in enumerate(calls))
    try:
        for result in results:  # noqa: UP028 - closing must not reach joblib before it sets `stop`
            yield result
    finally:
        stop.set()
        with warnings.catch_warnings():
            # That runs were cancelled is what closing asked for.
            warnings.simplefilter("ignore")
            results.close()


def run_alone(
    function: Callable[..., Any],
    call: tuple[Any, ...],
    *,
    limits: Limits | None = None,
    preload: Sequence[str] = (),
    stop: threading.Event | None = None,
) -> Any:
    """Call ``function(*call)`` in a process of its own; returns its result, or a `Failure`.

    Once `stop` is set, the process is killed.
    """
    if stop is not None and stop.is_set():
        return Failure("stopped", "not begun")
    receiver, sender = multiprocessing.Pipe(duplex=False)
    with _starting, _as_a_plain_parent():
        process = _context(preload).Process(target=_call, args=(sender, function, call))
        process.daemon = True
        process.start()
    sender.close()
    try:
        return _watch(process, receiver, limits or Limits(), stop)
    finally:
        if process.is_alive():
            process.kill()
        process.join()
        receiver.close()


def _check_positive(**values: float | None) -> None:
    for name, value in values.items():
        if value is not None and not value > 0:
            raise InputError(f"{value!r}; give more than 0", field=name)


def _context(preload: Sequence[str]) -> Any:
    if sys.platform == "win32" or "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(preload))
    return context


@contextmanager
def _as_a_plain_parent() -> Iterator[None]:
    """Hide what would keep this process from starting one that runs a module's function.

    A new process would run the main script again, which may come without a guard, or from standard
    input, where it cannot be found. And a worker of a cluster may itself be a daemon, which
    multiprocessing lets have no children; these end with it, see `_end_with_parent`.
    """
    main = sys.modules["__main__"]
    config: dict[str, Any] = getattr(multiprocessing.current_process(), "_config", {})
    daemon = config.pop("daemon", None)
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
        if daemon is not None:
            config["daemon"] = daemon


def _call(sender: Connection, function: Callable[..., Any], call: tuple[Any, ...]) -> None:
    # Ctrl-C is the parent's to handle; it ends its processes itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    try:
        message: Any = function(*call)
    except MemoryError:
        message = Failure("out of memory", "the process ran out of memory")
    except MsmrtaError as error:
        message = Failure("raised", str(error))
    except Exception as error:
        # Whatever a user's model raises is news about that run, not the end of the others.
        message = Failure("raised", f"{type(error).__name__}: {error}")
    try:
        sender.send(message)
    except Exception as error:
        # Pickling comes before sending, so nothing has been sent yet.
        said = f"the result cannot be sent ({type(error).__name__}: {error})"
        sender.send(Failure("raised", said))
    sender.close()


def _end_with_parent() -> None:
    """End this process, whatever it is doing, once its parent is gone."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _watch(process: Any, receiver: Connection, limits: Limits, stop: threading.Event | None) -> Any:
    """What the run of `process` comes to."""
    began = weighed = time.monotonic()
    while True:
        # In this order: a run that answers and ends between the two questions has answered.
        alive = process.is_alive()
        if receiver.poll(POLL_SECONDS if alive else 0):
            try:
                return receiver.recv()
            except (EOFError, OSError):
                return _post_mortem(process)
            except Exception as error:
                said = f"the result cannot be read ({type(error).__name__}: {error})"
                return Failure("raised", said)
        if not alive:
            return _post_mortem(process)
        if stop is not None and stop.is_set():
            return Failure("stopped", "killed on request")
        now = time.monotonic()
        if limits.time is not None and now - began > limits.time:
            return Failure("timed out", f"killed after {limits.time:g} s")
        if limits.memory is not None and now - weighed > MEMORY_SECONDS:
            weighed = now
            if _resident(process.pid) > limits.memory * 2**20:
                return Failure("out of memory", f"killed past {limits.memory:g} MiB")


def _post_mortem(process: Any) -> Failure:
    process.join(timeout=5)
    code = process.exitcode
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
