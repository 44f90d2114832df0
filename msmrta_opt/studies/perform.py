"""Doing one run, here, and what it comes to as a record."""

from __future__ import annotations

import gc
import json
import os
import platform
import statistics
import sys
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from ..isolation import Failure, Limits
from ..mission.errors import InputError
from ..mission.instance import Instance
from ..planners.support.planner import versions
from .record import Record
from .runs import Run
from .tasks import add_folders


def perform(run: Run, *, in_own_process: bool = True) -> Record:
    """Do `run` in this process, which by default has nothing else to do: warm up, repeat, measure.

    Raises
    ------
    InputError
        If this process has other versions than those that key the run.
    MsmrtaError
        Whatever the planner or the solver raises.
    """
    for package, version in versions().items():
        if run.versions[package] != version:
            raise InputError(
                f"this worker has {version}, the study {run.versions[package]}", field=package
            )
    add_folders(run.task.folders)
    if run.timing.warm_up:
        for _ in range(run.timing.warm_up):
            _once(run)
    else:
        run.task.warm_up()
    if in_own_process:
        # Or what the libraries hold would be looked through in the middle of some runs and not of
        # others.
        gc.collect()
        gc.freeze()
    results = [_once(run) for _ in range(run.timing.repetitions)]
    seconds = [result["seconds"] for result in results if "seconds" in result]
    if not seconds:
        return replace(_begun(run), **results[0])
    # Of the middle one, so that its stages add up to what is quoted.
    middle = sorted(results, key=lambda result: result["seconds"])[(len(results) - 1) // 2]
    return replace(
        _begun(run),
        **{
            **results[0],
            "stage_seconds_json": middle["stage_seconds_json"],
            "seconds": statistics.median(seconds),
            "seconds_low": min(seconds),
            "seconds_high": max(seconds),
            "seconds_json": json.dumps(seconds),
            "peak_memory": _peak_memory(),
        },
    )


def failed(run: Run, failure: Failure, limits: Limits) -> Record:
    """The record of a run that gave no result within `limits`."""
    hit = {"timed out": limits.time, "out of memory": limits.memory}.get(failure.reason)
    return replace(_begun(run), outcome=failure.reason, error=failure.message, limit=hit)


def _begun(run: Run) -> Record:
    """What is known of a run before its result."""
    instance = run.instance
    return Record(
        key=run.key,
        run=run.run,
        instance=instance.name,
        map=instance.map.name,
        n_robots=instance.n_robots,
        n_victims=instance.n_victims,
        contender=run.contender,
        **run.task.asked(),
        repetitions=run.timing.repetitions,
        warm_up=run.timing.warm_up,
        versions_json=json.dumps(dict(run.versions), sort_keys=True),
        machine=f"{platform.node()}: {platform.system()} {platform.machine()}, {os.cpu_count()} CPUs",
        finished_at=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _once(run: Run) -> dict[str, Any]:
    """Do the task on an instance with no distance worked out yet, so that all times are alike."""
    return run.task.do(Instance.from_document(run.instance.document()))


def _peak_memory() -> float | None:
    """MiB of resident memory at most so far, where the system tells."""
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 2**20
