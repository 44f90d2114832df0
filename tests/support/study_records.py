"""Records of studies that were never run, for the tests of reports: every number by formula."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any

from msmrta_opt.mission.metrics import METRICS
from msmrta_opt.studies.record import Record
from msmrta_opt.studies.specification import Study

MACHINE = "desk: Linux x86_64, 2 CPUs"


def study_of(**changes: Any) -> Study:
    """A study with a title and something to run."""
    document = {
        "title": "A study",
        "instances": [{"files": "*.json"}],
        "planners": [{"planner": "msmrta"}],
    }
    return Study.model_validate(document | changes)


def record(instance: str, contender: str, seconds: float | None = 1.0, **changes: Any) -> Record:
    """A planner's run on a map of 2 robots and 3 victims, unless `changes` say otherwise."""
    values: dict[str, Any] = {
        "map": "map0",
        "n_robots": 2,
        "n_victims": 3,
        "method": "planner",
        "planner": "msmrta",
        "seconds": seconds,
        "seconds_low": seconds,
        "seconds_high": seconds,
        "seconds_json": json.dumps([] if seconds is None else [seconds]),
        "versions_json": '{"msmrta_opt": "0.1.0", "numpy": "2.4.6"}',
        "machine": MACHINE,
        "finished_at": "2026-01-02T03:04:05+00:00",
    }
    if "outcome" in changes:
        values |= {"seconds": None, "seconds_low": None, "seconds_high": None}
        values |= {"seconds_json": "[]"}
    values |= changes
    measured = {name: values.pop(name) for name in METRICS if name in values}
    values["metrics_json"] = json.dumps(measured)
    name = f"{instance}/{contender}/{values.get('seed')}"
    return Record(key=name, run=name, instance=instance, contender=contender, **values)


def solve(instance: str, model: str, solver: str, seconds: float = 1.0, **changes: Any) -> Record:
    """A solve of a formulation to optimality, unless `changes` say otherwise."""
    values: dict[str, Any] = {"status": "optimal", "gap": 0.0, "check": "passed"}
    return record(
        instance,
        f"{model} by {solver}",
        seconds,
        **({"method": "formulation", "planner": None} | values | changes),
        stage="cluster",
        model=model,
        solver=solver,
    )


def grid_records(
    *,
    maps: Iterable[str] = ("map0", "map1", "map2", "map3"),
    robots: Iterable[int] = range(2, 11),
    victims: Iterable[int] = range(10, 101, 10),
    contenders: Mapping[str, float] | None = None,
    seeds: Iterable[int] = (0,),
) -> list[Record]:
    """A study over a grid: planning time = scale · robots^0.5 · victims^1.5, with some failures.

    The last contender times out on the largest missions, is not run on the smallest, and raises
    on one seed's mission in the middle.
    """
    scales = contenders or {"msmrta": 1e-5, "greedy": 3e-6, "mrga": 4e-4}
    last = list(scales)[-1]
    found = []
    for map_name, n, m, seed in product(maps, robots, victims, seeds):
        for who, scale in scales.items():
            if who == last and n == 2 and m == 10:
                continue
            shape = {"map": map_name, "n_robots": n, "n_victims": m}
            instance = f"{map_name}-{n}x{m}-{seed}"
            options = {"planner": who, "options_json": json.dumps({"preset": "paper"})}
            if who == last and n * m >= 900:
                outcome = {"outcome": "timed out", "error": "took more than 60 s", "limit": 60.0}
                found.append(record(instance, who, **shape, **options, **outcome))
                continue
            if who == last and n == 5 and m == 50 and seed == max(seeds):
                outcome = {"outcome": "raised", "error": "ValueError: <b>no</b> & never"}
                found.append(record(instance, who, **shape, **options, **outcome))
                continue
            # A ripple of a fixed kind, so that curves are not all straight.
            ripple = 1 + 0.3 * ((7 * n + 3 * m + 5 * seed + len(who)) % 11) / 11
            seconds = scale * n**0.5 * m**1.5 * ripple
            repeated = [seconds * 0.9, seconds, seconds * 1.2]
            found.append(
                record(
                    instance, who, seconds, **shape, **options,
                    seconds_low=repeated[0], seconds_high=repeated[2],
                    seconds_json=json.dumps(repeated), repetitions=3,
                    n_requirements=2 * m, n_available=2 * m - 1, n_served=2 * m - 1,
                    served_share=1.0 - (0.002 * n if who == "greedy" else 0.0),
                    distance=round(20 * m**0.7 * n**0.3 * ripple), total_time=80.0 * m,
                    makespan=90.0 * m / n * ripple, latency=40.0 * m * m / n * ripple,
                    mean_completion=40.0 * m / n * ripple, peak_memory=180.0 + m,
                )
            )  # fmt: skip
    return found


def solving_records() -> list[Record]:
    """Two formulations by three solvers on eight instances, one solver stopping early at times."""
    found = []
    for i, model, solver in product(
        range(8), ("cluster_one_to_one", "cluster_budgeted"), ("highs", "scip", "cpsat")
    ):
        seconds = (
            0.01 * (i + 1) ** 1.3 * {"highs": 1.0, "scip": 1.7, "cpsat": 0.8 + 0.2 * i}[solver]
        )
        shape = {
            "n_robots": 4,
            "n_victims": 10 * (i + 1),
            "n_variables": 40 * (i + 1),
            "n_rows": 14,
        }
        stopped = {"status": "feasible", "gap": 0.05} if solver == "scip" and i > 5 else {}
        found.append(solve(f"mission-{i}", model, solver, seconds, nodes=i, **shape, **stopped))
    found.append(
        solve("mission-8", "cluster_budgeted", "scip", outcome="skipped", error="not installed")
    )
    return found
