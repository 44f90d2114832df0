"""A hundred robots for thousands of victims on 512 × 512 cells: time and memory of a staged plan.

The floor, measured beside each plan, is that of its own distances: one compiled breadth-first search for
each walk of the plan, only as far as it leads.

    python benchmarks/scale.py [--victims 500 1000 5000] [--robots 100] [--side 512]
"""

from __future__ import annotations

import argparse
import resource
import time

import numpy as np

import msmrta_opt as mo


def floor(plan: mo.Plan) -> float:
    """Seconds that the distances of the walks of `plan` take."""
    legs = [visit.cells for route in plan.routes for visit in route.visits]
    began = time.perf_counter()
    plan.instance.map.lengths([leg[0] for leg in legs], [leg[-1] for leg in legs])
    return time.perf_counter() - began


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--victims", type=int, nargs="+", default=[500, 1000, 2000, 5000])
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--side", type=int, default=512)
    arguments = parser.parse_args()
    mo.plan(mo.random_mission(mo.rooms(20, 20, seed=1), 3, 10, seed=0))  # loads the libraries
    grid = mo.rooms(arguments.side, arguments.side, seed=1)
    print("victims  plan, checked (s)  floor (s)  ratio  cells walked  memory so far (MiB)")
    seconds = []
    for n_victims in arguments.victims:
        mission = mo.random_mission(grid, arguments.robots, n_victims, seed=1)
        began = time.perf_counter()
        plan = mo.plan(mission)
        seconds.append(time.perf_counter() - began)
        least = floor(plan)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"{n_victims:7d}  {seconds[-1]:17.2f}  {least:9.2f}  {seconds[-1] / least:5.2f}"
            f"  {plan.metrics.distance:12d}  {memory:19.0f}",
            flush=True,
        )
    if len(seconds) > 1:
        slope = np.polyfit(np.log(arguments.victims), np.log(seconds), 1)[0]
        print(f"growth: victims^{slope:.2f}")


if __name__ == "__main__":
    main()
