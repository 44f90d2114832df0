"""How far the exact planner closes the gap, by size, objective and time.

    python benchmarks/exact.py [--missions 3] [--seconds 60] [--sizes 4x20 10x50 10x100]
                               [--objectives total_time makespan latency]

Seeded missions over maps 0, 2 and 3 in turn. One run a mission; the gap after fewer seconds is read off
the same run. Peak memory is the process's own, all runs so far included.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import time
from pathlib import Path

import msmrta_opt as mo
from msmrta_opt.optimise.routing.data import Routes

MAPS = Path(__file__).parents[1] / "instances" / "maps"
MARKS = (10.0, 60.0, 300.0)


def gaps(mission: mo.Instance, objective: str, seconds: float) -> tuple[list[float], float]:
    """The gap at each of `MARKS` up to `seconds`, and when the run ended."""
    history: list[tuple[float, float]] = []
    began = time.monotonic()

    def report(routes: Routes, value: float, bound: float, what: str) -> None:
        del routes, what
        history.append((time.monotonic() - began, (value - bound) / value if value else 0.0))

    options = {"objective": objective, "time_limit": seconds, "report": report}
    plan = mo.plan(mission, planner="exact", **options)  # type: ignore[arg-type]
    ended = time.monotonic() - began
    history.append((ended, plan.certificates[0].gap or 0.0))
    marks = [mark for mark in MARKS if mark <= seconds] or [seconds]
    found = []
    for mark in marks:
        before = [gap for when, gap in history if when <= mark]
        found.append(before[-1] if before else 1.0)
    return found, ended


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--missions", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--sizes", nargs="+", default=["4x20", "10x50", "10x100"])
    parser.add_argument("--objectives", nargs="+", default=["total_time", "makespan", "latency"])
    arguments = parser.parse_args()
    grids = [mo.read_map(MAPS / f"map{i}.map") for i in (0, 2, 3)]
    marks = [mark for mark in MARKS if mark <= arguments.seconds] or [arguments.seconds]
    print("gap, median (worst); proven is the share of missions closed at the end")
    for size in arguments.sizes:
        n_robots, n_victims = (int(part) for part in size.split("x"))
        for objective in arguments.objectives:
            runs = [
                gaps(
                    mo.random_mission(grids[i % 3], n_robots, n_victims, seed=100 + i),
                    objective,
                    arguments.seconds,
                )
                for i in range(arguments.missions)
            ]
            cells = [
                f"after {mark:g} s {statistics.median(gap):.2%} ({max(gap):.2%})"
                for mark, gap in zip(
                    marks, zip(*(found for found, _ in runs), strict=True), strict=True
                )
            ]
            proven = sum(found[-1] <= 1e-6 for found, _ in runs)
            ended = statistics.median(when for _, when in runs)
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"{size:7s} {objective:11s} " + ", ".join(cells) + f"; proven {proven} of"
                f" {len(runs)}; ended after {ended:.1f} s; {memory:.0f} MiB",
                flush=True,
            )


if __name__ == "__main__":
    main()
