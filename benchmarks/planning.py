"""How long Algorithm 1 takes, stage by stage, against the least it could take.

The floor, measured beside each plan on the same mission, is the work that no implementation avoids:
the walking distances by one compiled breadth-first search per start and victim, one K-means fit
(of a single start, on one thread), and two linear assignments of the sizes of Eq. 1 and Eq. 2. All times
but those of start-up are of the processor, so that other work on the machine counts little.

    python benchmarks/planning.py [--repetitions 5] [--maps DIR]
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from unittest.mock import patch

import numpy as np
from scipy.optimize import linear_sum_assignment
from sklearn.cluster import KMeans
from threadpoolctl import threadpool_limits

import msmrta_opt as mo

ROBOTS = (2, 4, 6, 8, 10)
VICTIMS = (10, 40, 70, 100)
MAPS = Path(__file__).parents[1] / "instances" / "maps"


def median(
    function: Callable[[], object],
    repetitions: int,
    clock: Callable[[], float] = time.process_time,
) -> float:
    """Median seconds of a call."""
    times = []
    for _ in range(repetitions):
        began = clock()
        function()
        times.append(clock() - began)
    return statistics.median(times)


def floor(mission: mo.Instance) -> Callable[[], None]:
    """The least work of Algorithm 1 from instance to assignment, on the data of `mission`."""
    random = np.random.RandomState(0)
    n, m = mission.n_robots, mission.n_victims
    locations = np.array(mission.cells, dtype=float)
    k = min(n, len(np.unique(locations, axis=0)))
    sources = np.array([*mission.starts, *mission.cells])
    search = mission.map.search
    eq1, eq2 = random.random_sample((n, k)), random.random_sample((n, m))

    def work() -> None:
        search.fields(sources)
        KMeans(n_clusters=k, init="random", n_init=1, random_state=0).fit(locations)
        linear_sum_assignment(eq1)
        linear_sum_assignment(eq2)

    return work


def measure(grid: mo.GridMap, n_robots: int, n_victims: int, repetitions: int) -> dict[str, float]:
    """Median seconds per stage, of the floor, and of the whole call, over fresh missions."""
    stages: dict[str, list[float]] = {}
    floors, assigned, whole = [], [], []
    for seed in range(repetitions):
        mission = mo.generate_mission(grid, n_robots, n_victims, seed=seed, solvable=False)
        began = time.process_time()
        plan = mo.plan(mission)
        whole.append(time.process_time() - began)
        for stage, seconds in plan.planning_seconds.items():
            stages.setdefault(stage, []).append(seconds)
        walking = plan.planning_seconds["path planning"]
        assigned.append(sum(plan.planning_seconds.values()) - walking)
        floors.append(median(floor(mission), 3))
    row = {stage: statistics.median(times) for stage, times in stages.items()}
    row["to assignment"] = statistics.median(assigned)
    row["whole call"] = statistics.median(whole)
    row["floor"] = statistics.median(floors)
    row["ratio"] = statistics.median(a / b for a, b in zip(assigned, floors, strict=True))
    row["whole ratio"] = statistics.median(a / b for a, b in zip(whole, assigned, strict=True))
    return row


def measure_all(
    grids: list[mo.GridMap], repetitions: int
) -> dict[tuple[str, int, int], dict[str, float]]:
    """`measure` for every map and size."""
    return {
        (grid.name, n, m): measure(grid, n, m, repetitions)
        for grid in grids
        for n in ROBOTS
        for m in VICTIMS
    }


def start_up(repetitions: int) -> None:
    """Print what starting costs, against importing numpy."""
    first = f"import msmrta_opt as mo; mo.plan(mo.read({str(MAPS.parent / 'two_rooms.json')!r}))"
    helped = "import sys; sys.argv = ['msmrta', '--help']; from msmrta_opt.cli import main; main()"
    commands = {
        "import numpy": [sys.executable, "-c", "import numpy"],
        "import msmrta_opt": [sys.executable, "-c", "import msmrta_opt"],
        "msmrta --help": [sys.executable, "-c", helped],
        "first plan": [sys.executable, "-c", first],
    }
    seconds = {
        name: median(
            partial(subprocess.run, command, check=True, capture_output=True),
            repetitions,
            time.perf_counter,
        )
        for name, command in commands.items()
    }
    for name, value in seconds.items():
        print(f"{name:20s} {value * 1e3:7.1f} ms   {value / seconds['import numpy']:5.2f}× numpy")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--maps", type=Path, default=MAPS)
    arguments = parser.parse_args()
    grids = [mo.read_map(path) for path in sorted(arguments.maps.glob("*.map"))]
    mo.plan(mo.generate_mission(grids[0], 2, 10, seed=0, solvable=False))  # loads the libraries

    # Stages are timed by whatever clock there is.
    with threadpool_limits(1), patch("time.perf_counter", time.process_time):
        rows = measure_all(grids, arguments.repetitions)
    columns = [c for c in next(iter(rows.values())) if c != "scouting"]
    print("Median milliseconds per stage; ratios are to the floor of the same run")
    print("map    N   M " + " ".join(f"{column[:13]:>13s}" for column in columns))
    for (name, n, m), row in rows.items():
        cells = [row[c] if "ratio" in c else row[c] * 1e3 for c in columns]
        print(f"{name:5s} {n:2d} {m:3d} " + " ".join(f"{cell:13.2f}" for cell in cells))

    print()
    for n, m in ((4, 10), (ROBOTS[-1], VICTIMS[-1])):
        own = [row for (_, *size), row in rows.items() if size == [n, m]]
        names = ("to assignment", "floor", "ratio", "whole ratio")
        whole, minimum, ratio, more = (statistics.median([row[x] for row in own]) for x in names)
        print(
            f"{n} × {m}: to assignment {whole * 1e3:.1f} ms, floor {minimum * 1e3:.1f} ms,"
            f" {ratio:.2f}× its floor; the whole call {more:.2f}× that"
        )
    size = np.log([n * m for _, n, m in rows])
    for what in ("to assignment", "path planning"):
        seconds = np.log([row[what] for row in rows.values()])
        print(f"growth of {what}: (N M)^{np.polyfit(size, seconds, 1)[0]:.2f}")
    print()
    start_up(arguments.repetitions)


if __name__ == "__main__":
    main()
