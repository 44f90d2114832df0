"""A hundred robots for thousands of victims on 512 × 512 cells: time and memory of every planner.

The floor, measured beside each staged plan, is that of its own distances: one compiled breadth-first
search for each walk of the plan, only as far as it leads. All times are of the processor, so that other
work on the machine counts little, and every plan is checked.

    python benchmarks/scale.py [--victims 500 1000 5000] [--robots 100] [--side 512]
        [--planners msmrta greedy ssi exact] [--time-limit 60]
"""

from __future__ import annotations

import argparse
import resource
import time
from typing import Any

import numpy as np

import msmrta_opt as mo
from msmrta_opt.arrays import Int32s, Ints
from msmrta_opt.compiled import kernel

UNSEEN, WALL = -1, -2


@kernel("int32[::1](int32[::1], int64, int64[::1], int64[::1])")
def lengths(cells: Int32s, width: int, starts: Ints, goals: Ints) -> Int32s:
    """Distance of each start from its goal, on a map of `UNSEEN` cells with a wall all around it."""
    found = np.empty(len(starts), np.int32)
    distance, queue = cells.copy(), np.empty(len(cells) + 1, np.int32)
    for i in range(len(starts)):
        distance[starts[i]], queue[0], head, tail = 0, starts[i], 0, 1
        while distance[goals[i]] == UNSEEN:
            cell = queue[head]
            head += 1
            there = distance[cell] + 1
            for near in (cell - width, cell + width, cell - 1, cell + 1):
                known = distance[near]
                queue[tail] = near
                tail += known == UNSEEN
                distance[near] = there if known == UNSEEN else known
        found[i] = distance[goals[i]]
        for seen in queue[:tail]:
            distance[seen] = UNSEEN
    return found


def floor(plan: mo.Plan) -> float:
    """Seconds that the distances of the walks of `plan` take."""
    walled = np.pad(plan.instance.map.free, 1)
    cells, width = np.where(walled, UNSEEN, WALL).astype(np.int32).ravel(), walled.shape[1]
    legs = [visit.cells for route in plan.routes for visit in route.visits]
    ends = (np.array([leg[i] for leg in legs]) + 1 for i in (0, -1))
    starts, goals = (place[:, 0] * width + place[:, 1] for place in ends)
    began = time.process_time()
    lengths(cells, width, starts, goals)
    return time.process_time() - began


def measure(mission: mo.Instance, planner: str, options: dict[str, Any]) -> tuple[float, mo.Plan]:
    """Seconds of a plan, checked, and the plan."""
    began = time.process_time()
    plan = mo.plan(mission, planner=planner, **options)
    return time.process_time() - began, plan


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--victims", type=int, nargs="+", default=[500, 1000, 2000, 5000])
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--side", type=int, default=512)
    parser.add_argument("--planners", nargs="+", default=["msmrta"])
    parser.add_argument("--time-limit", type=float, default=60.0, help="of the exact planner")
    arguments = parser.parse_args()
    grid = mo.rooms(arguments.side, arguments.side, seed=1)
    small = mo.generate_mission(mo.rooms(20, 20, seed=1), 3, 10, seed=0, solvable=False)
    for planner in arguments.planners:
        limit: dict[str, Any] = {"time_limit": arguments.time_limit} if planner == "exact" else {}
        measure(small, planner, dict.fromkeys(limit, 0.1))  # loads the libraries
        print(f"{planner}\nvictims  seconds  floor  ratio  cells walked  gap  MiB so far")
        seconds = []
        for n_victims in arguments.victims:
            mission = mo.generate_mission(grid, arguments.robots, n_victims, seed=1, solvable=False)
            spent, plan = measure(mission, planner, limit)
            seconds.append(spent)
            minimum = floor(plan)
            gap = next((c.gap for c in plan.certificates if c.stage == "joint problem"), None)
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"{n_victims:7d}  {spent:7.2f}  {minimum:5.2f}  {spent / minimum:5.2f}"
                f"  {plan.metrics.distance:12d}  {'-' if gap is None else f'{gap:.1%}'}"
                f"  {memory:10.0f}",
                flush=True,
            )
        if len(seconds) > 1:
            slope = np.polyfit(np.log(arguments.victims), np.log(seconds), 1)[0]
            print(f"growth: victims^{slope:.2f}")


if __name__ == "__main__":
    main()
