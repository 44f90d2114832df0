"""Running a study: what is not in the ledger yet, in parallel, each run in a process of its own.

This process alone writes the ledger, a transaction a run, so whatever ends it loses nothing that was
finished, and the same call goes on from there.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing
from typing import Any

from ..isolation import Failure, Limits, run_isolated
from .compare import LIBRARIES
from .ledger import Ledger
from .perform import failed, perform
from .record import Record
from .runs import Run
from .specification import Study

PRELOAD = ("msmrta_opt.studies.perform", "msmrta_opt.studies.preload", *LIBRARIES)
WAIT_SECONDS = 0.5
"""How often another process's runs are looked at, once nothing else is left to do."""

Execute = Callable[[Iterable[Run]], Generator[tuple[Run, Any], None, None]]
"""Does runs, taking them one by one; gives each back with its record or its `Failure`."""


def run_study(
    study: Study,
    todo: Sequence[Run],
    ledger: Ledger,
    *,
    execute: Execute | None = None,
    jobs: int = 1,
    retry: bool = False,
) -> Generator[Record, None, None]:
    """Do those of `todo` that the ledger does not have; their records come as they are kept.

    Closing the iterator ends what is still running.

    Parameters
    ----------
    study : Study
        Its limits apply to each run.
    todo : sequence of Run
        From `runs`.
    ledger : Ledger
        What is done already, and where results go.
    execute : Execute, optional
        What does the runs; by default this machine, `jobs` at a time.
    jobs : int
        How many at a time; more than one makes times less comparable.
    retry : bool
        Do failed runs again.
    """
    execute = execute or locally(study, jobs=jobs)
    open_runs = pending(study, todo, ledger, retry=retry)
    redo = {run.key for run in open_runs if ledger.get(run.key) is not None}
    while open_runs:
        with closing(execute(_claimed(open_runs, ledger, redo))) as results:
            for run, result in results:
                if isinstance(result, Failure):
                    result = failed(run, result, _limit_hit(result, limits_of(study)))
                ledger.add(result)
                redo.discard(run.key)
                yield result
        # What is left is another process's; it is ours if that process has gone.
        open_runs = [run for run in open_runs if run.key in redo or not ledger.get(run.key)]
        if open_runs and ledger.claimed_elsewhere([run.key for run in open_runs]):
            time.sleep(WAIT_SECONDS)


def pending(study: Study, todo: Sequence[Run], ledger: Ledger, *, retry: bool = False) -> list[Run]:
    """Those of `todo` that are still to be done.

    A run that was killed for a limit is, once the study grants it more.
    """
    limits = limits_of(study)

    def is_open(run: Run) -> bool:
        record = ledger.get(run.key)
        if record is None:
            return True
        if not record.failed:
            return False
        if record.limit is None:
            return retry
        granted = limits.time if record.outcome == "timed out" else limits.memory
        return retry or granted is None or granted > record.limit

    return [run for run in todo if is_open(run)]


def limits_of(study: Study) -> Limits:
    """What one run may use: the time of all its repetitions together."""
    plans = study.timing.warm_up + study.timing.repetitions
    seconds = study.limits.seconds
    return Limits(None if seconds is None else seconds * plans, study.limits.memory)


def locally(study: Study, *, jobs: int = 1) -> Execute:
    """Do runs on this machine, `jobs` at a time."""

    def execute(todo: Iterable[Run]) -> Generator[tuple[Run, Any], None, None]:
        begun: dict[int, Run] = {}

        def calls() -> Iterator[tuple[Run]]:
            for index, run in enumerate(todo):
                begun[index] = run
                yield (run,)

        results = run_isolated(
            perform,
            calls(),
            jobs=jobs,
            limits=limits_of(study),
            preload=PRELOAD,
        )
        with closing(results):
            for index, result in results:
                yield begun.pop(index), result

    return execute


def _claimed(todo: Sequence[Run], ledger: Ledger, redo: set[str]) -> Iterator[Run]:
    """Those of `todo` that are this process's to do, each claimed when its turn comes."""
    for run in todo:
        if ledger.claim(run.key, redo=run.key in redo):
            yield run


def _limit_hit(failure: Failure, limits: Limits) -> float | None:
    return {"timed out": limits.time, "out of memory": limits.memory}.get(failure.reason)
