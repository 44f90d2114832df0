"""Replanning after a robot is lost: how long a decision takes, and its travel over that of a fresh plan.

    python benchmarks/replanning.py [--size 10x100] [--seconds 0.5] [--seeds 2]

Missions on maps 0, 2 and 3, planned by auctions; a robot is lost when a twentieth of the makespan has
passed. `replan` decides, with so many seconds for planning and search. The fresh plan is of the same
rest of the mission, by auctions and local search, and all of it gets the seconds that the decision took.
Travel is that of all robots from then on, worked out from the cells of both; medians over missions and
seeds.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msmrta_opt as mo
from msmrta_opt.execution.draw import draw_world
from msmrta_opt.execution.policies import policy_of
from msmrta_opt.execution.replanning import Remaining
from msmrta_opt.execution.simulation import Simulation
from msmrta_opt.execution.state import Queues, Situated, State
from msmrta_opt.mission.grid import DistanceTable
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.scenario import Scenario

MAPS = Path(__file__).parents[1] / "instances" / "maps"
NUMBERS = (0, 2, 3)


@dataclass(frozen=True)
class Row:
    """One decision beside one fresh plan."""

    mission: str
    seed: int
    visits: int
    seconds: float
    processor: float
    travel: float
    fresh: float

    @property
    def ratio(self) -> float:
        """Travel over that of the fresh plan."""
        return self.travel / self.fresh


def measured(mission: Instance, seconds: float, seed: int) -> Row:
    """A robot is lost, and the rest is planned anew in both ways."""
    plan = mo.plan(mission, planner="ssi")
    lost = mission.robots[seed % mission.n_robots].id
    scenario = Scenario.from_document(
        {"lost": [{"robot": lost, "time": plan.metrics.makespan / 20}]}
    )
    states: list[State] = []

    def seen(state: State) -> Queues | None:
        states.append(state)
        return None

    Simulation(plan, scenario, draw_world(plan, scenario, seed), seen, "detour").run()
    policy, options = policy_of("replan", {"seconds": seconds})
    situated = Situated(plan, options, seed)
    began, used = time.perf_counter(), time.process_time()
    queues = policy.begin(situated)(states[0])
    taken, used = time.perf_counter() - began, time.process_time() - used
    rest = Remaining.of(states[0], situated)
    if queues is None or rest is None:
        raise SystemExit(f"{mission.name} has nothing left to serve")
    began = time.perf_counter()
    mo.plan(rest.mission, planner="ssi")
    left = max(taken - (time.perf_counter() - began), 0.01)
    fresh = mo.plan(rest.mission, planner="ssi", improve=left)
    return Row(
        mission.name,
        seed,
        sum(len(tasks) for tasks in queues.values()),
        taken,
        used,
        travel_of(rest.mission, queues),
        sum(
            (len(route.cells) - 1) / robot.speed if route.cells else 0.0
            for robot in rest.mission.robots
            for route in fresh.routes
            if route.robot == robot.id
        ),
    )


def travel_of(mission: Instance, queues: Queues) -> float:
    """How long robots walk to make their visits in order, by the shortest ways."""
    cell = {victim.id: victim.cell for victim in mission.victims}
    table = DistanceTable(mission.map, [*mission.starts, *mission.cells])
    total = 0.0
    for robot in mission.robots:
        stops = [cell[task.victim] for task in queues[robot.id] if task.victim is not None]
        walked = table.lengths([robot.start, *stops[:-1]], stops) if stops else []
        total += float(sum(walked)) / robot.speed
    return total


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", default="10x100", help="robots x victims")
    parser.add_argument("--seconds", type=float, default=0.5, help="for a decision")
    parser.add_argument("--seeds", type=int, default=2, help="missions a map, and losses")
    asked = parser.parse_args(arguments)
    n_robots, n_victims = map(int, asked.size.split("x"))
    grids = [mo.read_map(MAPS / f"map{i}.map") for i in NUMBERS]
    first = mo.generate_mission(grids[0], 2, 4, seed=1)
    measured(first, 0.01, 0)  # imports, and what is compiled
    print(
        "| mission | seed | visits to come | seconds | of the processor | travel | fresh plan | ratio |"
    )
    print("|" + " --- |" * 8)
    rows = []
    for grid in grids:
        for seed in range(1, asked.seeds + 1):
            mission = mo.generate_mission(grid, n_robots, n_victims, seed=seed, solvable=False)
            row = measured(mission, asked.seconds, seed)
            rows.append(row)
            print(
                f"| {row.mission} | {row.seed} | {row.visits} | {row.seconds:.2f} |"
                f" {row.processor:.2f} | {row.travel:.0f} | {row.fresh:.0f} | {row.ratio:.4f} |",
                flush=True,
            )
    seconds = statistics.median(row.seconds for row in rows)
    ratio = statistics.median(row.ratio for row in rows)
    used = statistics.median(row.processor for row in rows)
    print(f"| median | | | {seconds:.2f} | {used:.2f} | | | {ratio:.4f} |")
    longest, highest = max(row.seconds for row in rows), max(row.ratio for row in rows)
    print(f"longest {longest:.2f} s, highest ratio {highest:.4f}")


if __name__ == "__main__":
    main()
