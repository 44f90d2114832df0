"""Doing the runs of a study on a Dask cluster.

Each worker does a run as this machine would, in a process of its own within its limits. The scheduler
gives the runs of a lost worker to another; results come back to the coordinator, which alone writes the
ledger.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator
from importlib.util import find_spec
from itertools import islice
from typing import Any

from ..isolation import Failure, Limits, run_alone
from ..mission.errors import InputError
from .perform import perform
from .runner import Execute, preload
from .runs import Run

CONNECT_SECONDS = 10.0
RUNS_PER_THREAD = 2
"""Runs that wait at the scheduler or run, per thread of the cluster, so that no worker idles."""


def on_cluster(address: str) -> Execute:
    """Do runs on the cluster of the scheduler at `address`, such as ``tcp://host:8786``.

    Raises
    ------
    InputError
        If Dask is not installed, no scheduler answers, or the cluster has no worker.
    """
    if find_spec("distributed") is None:
        raise InputError("needs Dask; pip install 'msmrta_opt[dask]'", field="--dask")
    from distributed import Client, as_completed

    def execute(todo: Iterable[Run], limits: Limits) -> Generator[tuple[Run, Any], None, None]:
        with _connected(Client, address) as client:
            threads = sum(client.nthreads().values())
            if not threads:
                raise InputError(
                    f"{address} has no worker; start one with dask worker", field="--dask"
                )
            waiting = iter(todo)
            runs: dict[Any, Run] = {}

            def submit() -> Iterator[Any]:
                for run in waiting:
                    future = client.submit(_work, run, limits, key=f"msmrta-{run.key}", pure=False)
                    runs[future.key] = run
                    yield future

            more = submit()
            first = islice(more, RUNS_PER_THREAD * threads)
            finished = as_completed(first, loop=client.loop)
            for future in finished:
                run = runs.pop(future.key)
                yield run, _result_of(future)
                finished.update(islice(more, 1))

    return execute


def _connected(client: Any, address: str) -> Any:
    try:
        return client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        said = (str(error).splitlines() or [type(error).__name__])[0]
        raise InputError(f"no scheduler at {address!r} ({said})", field="--dask") from None


def _work(run: Run, limits: Limits) -> Any:
    """Do `run` on a worker; a `Failure` is a result."""
    return run_alone(perform, (run,), limits=limits, preload=preload())


def _result_of(future: Any) -> Any:
    if future.status == "finished":
        return future.result()
    error = future.exception()
    return Failure("crashed", f"on the cluster: {type(error).__name__}: {error}")
