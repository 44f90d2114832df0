"""Doing one run of a study, here, and what it comes to as a record."""

from __future__ import annotations

import gc
import hashlib
import json
import os
import platform
import statistics
import sys
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from ..certify.certificates import STAGE as STAGE_OF_BOUNDS
from ..isolation import Failure
from ..mission.errors import InputError
from ..mission.instance import Instance
from ..mission.plan import Plan
from ..optimise import registry
from ..planners import plan
from ..planners.support.planner import versions
from .compare import Case, solve_case
from .record import FINISHED, Record
from .runs import Planning, Run

MEASURES = (
    *("n_requirements", "n_available", "n_served", "served_share", "victims_fully_served"),
    *("distance", "total_time", "makespan", "latency", "mean_completion", "weighted_completion"),
)
CERTIFIED = ("status", "objective", "bound", "gap", "proof", "n_variables", "n_rows")
SOLVED = (*CERTIFIED, "check", "nodes")


def perform(run: Run) -> Record:
    """Do `run` in this process: warm up, repeat, measure.

    Raises
    ------
    InputError
        If this process has other versions than those that key the run.
    MsmrtaError
        Whatever the planner or the solver raises.
    """
    here = versions()
    for package, version in here.items():
        if run.versions[package] != version:
            raise InputError(
                f"this worker has {version}, the study {run.versions[package]}", field=package
            )
    for folder in run.task.folders:
        registry.add_models(folder)
    for _ in range(run.timing.warm_up):
        _once(run)
    # Or what the libraries hold would be looked through in the middle of some runs and not of others.
    gc.collect()
    gc.freeze()
    results = [_once(run) for _ in range(run.timing.repetitions)]
    seconds = [result["seconds"] for result in results]
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


def failed(run: Run, failure: Failure, limit: float | None) -> Record:
    """The record of a run that gave no result."""
    return replace(_begun(run), outcome=failure.reason, error=failure.message, limit=limit)


def _begun(run: Run) -> Record:
    """What is known of a run before its result."""
    task = run.task
    if isinstance(task, Planning):
        options: dict[str, Any] = dict(task.options)
        asked: dict[str, Any] = {"method": "planner", "planner": task.planner}
    else:
        options = task.options.as_dict() | task.parameters
        options |= {"solver_seed": task.seed, "time_limit": task.time_limit, "gap": task.gap}
        asked = {"method": "formulation", "stage": task.stage, "model": task.model}
        asked["solver"] = task.solver
    return Record(
        key=run.key,
        run=run.run,
        instance=run.instance.name,
        map=run.instance.map.name,
        n_robots=run.instance.n_robots,
        n_victims=run.instance.n_victims,
        contender=run.contender,
        **asked,
        psi=options.get("psi"),
        beta=options.get("beta"),
        seed=options.get("seed"),
        options_json=json.dumps(options, sort_keys=True),
        repetitions=run.timing.repetitions,
        warm_up=run.timing.warm_up,
        versions_json=json.dumps(dict(run.versions), sort_keys=True),
        machine=f"{platform.node()}: {platform.system()} {platform.machine()}, {os.cpu_count()} CPUs",
        finished_at=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _once(run: Run) -> dict[str, Any]:
    """Do the task on an instance with no distance worked out yet, so that all times are alike."""
    instance = Instance.from_document(run.instance.document())
    task = run.task
    return _plan(instance, task) if isinstance(task, Planning) else _solve(instance, task)


def _plan(instance: Instance, task: Planning) -> dict[str, Any]:
    options: dict[str, Any] = dict(task.options)
    made = plan(instance, planner=task.planner, **options)
    metrics = made.metrics.as_dict()
    return {
        **{name: metrics[name] for name in MEASURES},
        **_certified(made),
        "check": "passed",
        "plan_digest": _plan_digest(made),
        "seconds": made.metrics.planning_seconds,
        "stage_seconds_json": json.dumps(made.planning_seconds),
    }


def _certified(made: Plan) -> dict[str, Any]:
    """The certificate of a plan that has one as a whole, as the exact planner's does."""
    whole = [item for item in made.certificates if item.stage == STAGE_OF_BOUNDS]
    return {name: getattr(whole[-1], name) for name in CERTIFIED} if whole else {}


def _plan_digest(made: Plan) -> str:
    """Equal for plans that do the same."""
    routes = [route.model_dump(mode="json") for route in made.routes]
    return hashlib.sha256(json.dumps(routes, sort_keys=True).encode()).hexdigest()[:16]


def _solve(instance: Instance, task: Case) -> dict[str, Any]:
    solution, seconds = solve_case(replace(task, instance=instance))
    return {
        **{name: getattr(solution, name) for name in SOLVED},
        "error": solution.message,
        "outcome": "skipped" if solution.status == "skipped" else FINISHED,
        "seconds": seconds,
        "stage_seconds_json": json.dumps(
            {"canonicalise": solution.canonicalise_seconds, "solve": solution.solve_seconds}
        ),
    }


def _peak_memory() -> float | None:
    """MiB of resident memory at most so far, where the system tells."""
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 2**20
