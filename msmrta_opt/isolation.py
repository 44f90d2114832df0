"""Functions called in processes of their own, with limits, so that one failure takes nothing down.

There is one kind of process, the `Worker`: it calls what it is given and sends back what comes of it.
A run of a study or of a comparison has a worker to itself, forked from a server that has loaded the
libraries and solved nothing: a fork after a threaded solve can hang, and a fresh interpreter would pay
for the imports each time. A solver that cannot share our process has a fresh interpreter, which is kept.
"""

from __future__ import annotations

import multiprocessing
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor
from concurrent.futures import wait as wait_for
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from multiprocessing import resource_tracker
from multiprocessing.connection import wait
from types import ModuleType
from typing import Any

from .mission.errors import InputError
from .worker_process import END, POLL_SECONDS, serve
from .worker_process import Failure as Failure

MEMORY_SECONDS = 0.1
"""How often its memory is, which takes longer to find out."""

_processes = threading.Lock()
"""Held while a process starts or is asked for its end.

Starting changes what belongs to the whole interpreter. And multiprocessing asks all processes for their
ends whenever it starts one: of two threads that ask at once, one reads the exit status and the other
takes the end of the pipe for a status of 255.
"""


@dataclass(frozen=True)
class Limits:
    """What a call may use: seconds of wall time, and MiB of resident memory with its children's.

    Raises
    ------
    InputError
        If a limit is not positive.
    """

    time: float | None = None
    memory: float | None = None

    def __post_init__(self) -> None:
        _check_positive(time_limit=self.time, memory_limit=self.memory)


class Worker:
    """A process that calls functions one after another, until it is closed or one of them ends it.

    What a function prints goes to standard error, and Ctrl-C does not reach it: that is its parent's to
    handle. It ends with its parent, however that ends.

    Parameters
    ----------
    preload : sequence of str, optional
        Modules that its server has loaded; by default it is a fresh interpreter.
    """

    def __init__(self, preload: Sequence[str] | None = None) -> None:
        context = _context(preload)
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs,), daemon=True)
        with _processes, _as_a_plain_parent(), _without_ctrl_c():
            self._process.start()
        theirs.close()

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def pid(self) -> int:
        """The process's id."""
        return int(self._process.pid)

    @property
    def is_alive(self) -> bool:
        """Whether the process goes on."""
        return not wait([self._process.sentinel], 0)

    def call(
        self,
        function: Callable[..., Any],
        *arguments: Any,
        limits: Limits | None = None,
        should_stop: Callable[[], bool] | None = None,
        grace: float = 0.0,
    ) -> Any:
        """What ``function(*arguments)`` returns there, or a `Failure`.

        After a failure other than ``"raised"`` the worker is of no more use, and is to be closed.

        Parameters
        ----------
        function : callable
            At the top level of a module, so that another process can import it.
        *arguments
            Picklable.
        limits : Limits, optional
            Of this call.
        should_stop : callable, optional
            Looked at while the call goes on: once true, nobody waits for it any more.
        grace : float
            Seconds for which it is waited for then all the same; it is told by `interrupted`.
        """
        try:
            self._connection.send((function, arguments))
        except OSError:
            return self._post_mortem()
        limits = limits or Limits()
        began = weighed = time.monotonic()
        asked: float | None = None
        while True:
            ready = wait([self._connection, self._process.sentinel], POLL_SECONDS)
            # In this order: a call that answers and ends between two questions has answered.
            if self._connection in ready:
                try:
                    return self._connection.recv()
                except (EOFError, OSError):
                    return self._post_mortem()
                except Exception as error:
                    said = f"the result cannot be read ({type(error).__name__}: {error})"
                    return Failure("raised", said)
            if ready:
                return self._post_mortem()
            now = time.monotonic()
            if asked is None and should_stop is not None and should_stop():
                asked = now
                with suppress(OSError):
                    self._connection.send(END)
            if asked is not None and now - asked >= grace:
                return Failure("stopped", "killed on request")
            if limits.time is not None and now - began > limits.time:
                return Failure("timed out", f"killed after {limits.time:g} s")
            if limits.memory is not None and now - weighed > MEMORY_SECONDS:
                weighed = now
                if _resident(self.pid) > limits.memory * 2**20:
                    return Failure("out of memory", f"killed past {limits.memory:g} MiB")

    def close(self) -> None:
        """End the process, whatever it is doing."""
        with _processes:
            self._process.kill()
        self._end()
        self._connection.close()

    def _end(self) -> int | None:
        """The exit status of the process, which is ending."""
        wait([self._process.sentinel], 5)
        with _processes:
            self._process.join(5)
            code: int | None = self._process.exitcode
        return code

    def _post_mortem(self) -> Failure:
        code = self._end()
        if code is not None and code < 0:
            return Failure("crashed", f"killed by {signal.Signals(-code).name}")
        return Failure("crashed", f"ended with exit status {code} and no result")


def run_alone(
    function: Callable[..., Any],
    call: tuple[Any, ...],
    *,
    limits: Limits | None = None,
    preload: Sequence[str] = (),
    should_stop: Callable[[], bool] | None = None,
) -> Any:
    """Call ``function(*call)`` in a process of its own; returns its result, or a `Failure`."""
    if should_stop is not None and should_stop():
        return Failure("stopped", "not begun")
    with Worker(preload) as worker:
        return worker.call(function, *call, limits=limits, should_stop=should_stop)


def run_isolated(
    function: Callable[..., Any],
    calls: Iterable[tuple[Any, ...]],
    *,
    jobs: int = 1,
    limits: Limits | None = None,
    preload: Sequence[str] = (),
    reuse: bool = False,
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
    limits : Limits, optional
        Of each call, which is killed beyond them.
    preload : sequence of str
        Modules that all processes share.
    reuse : bool
        Whether a process does one call after another, for calls that leave nothing behind.

    Yields
    ------
    index, result
        As they finish: the position in `calls`, and what the function returned or a `Failure`.
        Closing the iterator kills what still runs.

    Raises
    ------
    InputError
        If `jobs` is not positive.
    """
    _check_positive(jobs=jobs)
    stop = threading.Event()
    kept: deque[Worker] = deque()

    def watched(index: int, call: tuple[Any, ...]) -> tuple[int, Any]:
        if not reuse:
            return index, run_alone(
                function, call, limits=limits, preload=preload, should_stop=stop.is_set
            )
        if stop.is_set():
            return index, Failure("stopped", "not begun")
        try:
            worker = kept.pop()
        except IndexError:
            worker = Worker(preload)
        found = worker.call(function, *call, limits=limits, should_stop=stop.is_set)
        if isinstance(found, Failure) and found.reason != "raised":
            worker.close()
        else:
            kept.append(worker)
        return index, found

    # Each thread only watches over the process of its call.
    with _closing_all(kept), ThreadPoolExecutor(jobs) as threads:
        going: set[Future[tuple[int, Any]]] = set()
        waiting = enumerate(calls)
        try:
            while True:
                more = islice(waiting, jobs - len(going))
                going |= {threads.submit(watched, index, call) for index, call in more}
                if not going:
                    return
                finished, going = wait_for(going, return_when=FIRST_COMPLETED)
                for future in finished:
                    yield future.result()
        finally:
            stop.set()


@contextmanager
def _closing_all(workers: deque[Worker]) -> Iterator[None]:
    """Close, at the end, the workers that there are then."""
    try:
        yield
    finally:
        for worker in workers:
            worker.close()


def _check_positive(**values: float | None) -> None:
    for name, value in values.items():
        if value is not None and not value > 0:
            raise InputError(f"{value!r}; give more than 0", field=name)


def _context(preload: Sequence[str] | None) -> Any:
    if preload is None or "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(preload))
    return context


@contextmanager
def _as_a_plain_parent() -> Iterator[None]:
    """Hide what would keep this process from starting one that runs a module's function.

    A new process would run the main script again, which may come without a guard, or from standard
    input, where it cannot be found. And a worker of a cluster may itself be a daemon, which
    multiprocessing lets have no children; these end with it, see `worker_process`.
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


@contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """Start what is started so that Ctrl-C does not reach it, not even while it still imports."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # which would let signals in again when it is started
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _resident(pid: int) -> int:
    """Bytes of process `pid` and of its children: some solvers work in a process of their own."""
    import psutil

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
