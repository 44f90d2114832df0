"""What planners lose against a proven bound, and what a second of local search takes back.

    python benchmarks/improvement.py [--seconds 20]

Total time of each plan over the exact planner's bound on it, median and worst over two seeded missions
on each of maps 0, 2 and 3. A figure above 1 is the sum of the plan's loss and of the bound's gap.
"""

from __future__ import annotations

import argparse
import statistics
from pathlib import Path

import msmrta_opt as mo

MAPS = Path(__file__).parents[1] / "instances" / "maps"
SIZES = ((4, 20), (10, 50), (10, 100))


def ratios(mission: mo.Instance, seconds: float) -> dict[str, float]:
    """Total time over the bound, by way of planning."""
    exact = mo.plan(mission, planner="exact", time_limit=seconds)
    bound = exact.certificates[0].bound
    if not bound:
        raise SystemExit(f"{mission.name} has nothing to serve")
    plans = {
        "staged": mo.plan(mission),
        "MRGA": mo.plan(mission, planner="mrga"),
        "auctions": mo.plan(mission, planner="ssi"),
        "staged, 1 s": mo.plan(mission, improve=1.0),
        "exact": exact,
    }
    return {name: plan.metrics.total_time / bound for name, plan in plans.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="for the exact planner")
    seconds = parser.parse_args().seconds
    grids = [mo.read_map(MAPS / f"map{i}.map") for i in (0, 2, 3)]
    print("robots × victims: median (worst) of total time over its bound")
    for n_robots, n_victims in SIZES:
        rows = [
            ratios(
                mo.generate_mission(grid, n_robots, n_victims, seed=seed, solvable=False), seconds
            )
            for grid in grids
            for seed in (1, 2)
        ]
        cells = []
        for name in rows[0]:
            values = [row[name] for row in rows]
            cells.append(f"{name} {statistics.median(values):.4f} ({max(values):.4f})")
        print(f"{n_robots} × {n_victims}: " + ", ".join(cells))


if __name__ == "__main__":
    main()
