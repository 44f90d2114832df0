"""Doing runs: here or on a cluster, each in a process of its own, kept in a ledger or not.

This process alone writes the ledger, a transaction a run, so whatever ends it loses nothing that was
finished, and the same call goes on from there.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing
from typing import Any

from ..isolation import Failure, Limits, run_isolated
from ..mission.errors import MsmrtaError
from ..optimise import solvers
from ..planners.support.planner import CLUSTERING
from .ledger import Ledger
from .perform import failed, perform
from .record import Record
from .runs import Run
from .specification import Study

LIBRARIES = (*CLUSTERING, "networkx", "scipy.optimize", "scipy.sparse.csgraph")
"""What stages import when first used; loading it once for all saves most of the time."""
WAIT_SECONDS = 0.5
"""How often another process's runs are looked at, once nothing else is left to do."""

Execute = Callable[[Iterable[Run], Limits], Generator[tuple[Run, Any], None, None]]
"""Does runs within limits, taking them one by one; gives each with its record or its `Failure`."""


def preload() -> tuple[str, ...]:
    """What all runs share: loaded once, in the server that their processes are forked from."""
    own = ("msmrta_opt.studies.perform", "msmrta_opt.studies.preload")
    used = {solver.module for solver in solvers.solvers().values() if solver.installed}
    return (*own, *LIBRARIES, *sorted(used))


def records(
    todo: Iterable[Run], limits: Limits, execute: Execute | None = None
) -> Generator[Record, None, None]:
    """Do `todo`; records come as runs are finished. Closing the iterator ends what still runs.

    Parameters
    ----------
    todo : iterable of Run
        Taken one by one, as their turn comes.
    limits : Limits
        Of each.
    execute : Execute, optional
        What does them; by default this machine, one at a time.
    """
    with closing((execute or locally())(todo, limits)) as results:
        for run, result in results:
            yield failed(run, result, limits) if isinstance(result, Failure) else result


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
    execute = execute or locally(jobs)
    ledger.keep_missions(run.mission for run in todo)
    open_runs = pending(study, todo, ledger, retry=retry)
    redo = {run.key for run in open_runs if ledger.get(run.key) is not None}
    while open_runs:
        claimed = _claimed(open_runs, ledger, redo)
        with closing(records(claimed, limits_of(study), execute)) as finished:
            for record in finished:
                ledger.add(record)
                redo.discard(record.key)
                yield record
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


def locally(jobs: int = 1) -> Execute:
    """Do runs on this machine, `jobs` at a time."""

    def execute(todo: Iterable[Run], limits: Limits) -> Generator[tuple[Run, Any], None, None]:
        begun: dict[int, Run] = {}

        def calls() -> Iterator[tuple[Run]]:
            for index, run in enumerate(todo):
                begun[index] = run
                yield (run,)

        results = run_isolated(perform, calls(), jobs=jobs, limits=limits, preload=preload())
        with closing(results):
            for index, result in results:
                yield begun.pop(index), result

    return execute


def here(todo: Iterable[Run], limits: Limits) -> Generator[tuple[Run, Any], None, None]:
    """Do runs in this process: quicker, but nothing limits them or survives their crash."""
    del limits
    for run in todo:
        try:
            yield run, perform(run, in_own_process=False)
        except MsmrtaError as error:
            yield run, Failure("raised", str(error), error)


def _claimed(todo: Sequence[Run], ledger: Ledger, redo: set[str]) -> Iterator[Run]:
    """Those of `todo` that are this process's to do, each claimed when its turn comes."""
    for run in todo:
        if ledger.claim(run.key, redo=run.key in redo):
            yield run
