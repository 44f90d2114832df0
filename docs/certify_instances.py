"""What is proved about every shipped instance: writes `certified_values.json` beside this file.

    python docs/certify_instances.py [--seconds 60] [NAME …]

Each instance is planned by the exact planner for each objective, and the plan is checked apart from it.
Values that are there are kept unless the new bound or the new value is better, so that a run on a slow
machine takes nothing away; `--anew` begins from nothing, as after an instance has changed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msmrta_opt as mo
from msmrta_opt.routing.objectives import OBJECTIVES

FILE = Path(__file__).with_name("certified_values.json")


def certified(name: str, objective: str, seconds: float) -> dict[str, Any]:
    """The value of a checked plan of the instance, and the bound that is proved."""
    mission = mo.example(name)
    plan = mo.plan(mission, planner="exact", objective=objective, time_limit=seconds)
    mo.check_plan(plan)
    certificate = plan.certificates[0]
    return {
        "instance": name,
        "objective": objective,
        "robots": mission.n_robots,
        "victims": mission.n_victims,
        "value": certificate.objective,
        "bound": certificate.bound,
        "status": certificate.status,
        "proof": certificate.proof,
    }


def better(new: dict[str, Any], old: dict[str, Any] | None) -> dict[str, Any]:
    """Whichever of the two has the smaller gap."""
    if old is None or new["value"] - new["bound"] < old["value"] - old["bound"] - 1e-9:
        return new
    return old


def main(arguments: Sequence[str] | None = None) -> None:
    """Certify the instances that are named, or all."""
    parser = argparse.ArgumentParser(description="Certified values of shipped instances.")
    parser.add_argument("names", nargs="*", help="by default all")
    parser.add_argument("--seconds", type=float, default=60.0, help="for each value")
    parser.add_argument("--anew", action="store_true", help="forget what is there")
    given = parser.parse_args(arguments)
    there = [] if given.anew or not FILE.exists() else json.loads(FILE.read_text(encoding="utf-8"))
    known = {(row["instance"], row["objective"]): row for row in there}
    for name in given.names or mo.examples():
        for objective in OBJECTIVES:
            key = (name, objective)
            known[key] = better(certified(name, objective, given.seconds), known.get(key))
            print(*known[key].values(), flush=True)
            rows = ",\n ".join(json.dumps(known[key]) for key in sorted(known))
            FILE.write_text(f"[{rows}]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
