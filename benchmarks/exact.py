"""How far the exact planner closes the gap, by size, objective and time.

    python benchmarks/exact.py [--quick] [--missions 10] [--seconds 300] [--sizes 4x20 10x50 …]
                               [--objectives total_time makespan latency] [--csv exact.csv] [--jobs 1]

Ten seeded missions of each size over maps 0, 2 and 3, and the paper's; latency on the smallest size
and the paper's only. Each run has a process of its own, and its peak memory is that process's. The
gaps after 10 and 60 s are read off the run of 300 s, by what it reports; a run of so long shares its
time out differently from one that is to end then. Before its first report a run's gap is 100 %.

Runs are appended to the CSV file as they end, with a row for each mark. Those that it already holds
are not made again, so a run that was killed goes on where it was. Another version needs another file.
"""

from __future__ import annotations

import argparse
import csv
import os
import statistics
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import msmrta_opt as mo
from msmrta_opt.isolation import Failure, Limits, run_isolated
from msmrta_opt.routing.callbacks import Callbacks, SearchState
from msmrta_opt.routing.objectives import OBJECTIVES, objective_of
from msmrta_opt.routing.stop import relative_gap

INSTANCES = Path(__file__).parents[1] / "instances"
MAPS = (0, 2, 3)
FIRST_SEED = 100
PAPER = "paper"
"""In place of a size: the paper's mission."""
MARKS = (10.0, 60.0, 300.0)
SIZES = ("4x20", "10x50", "10x100", PAPER)
SLOW, SLOW_SIZES = "branch and price", ("4x20", PAPER)
"""The method that is run on some sizes only."""
PROVEN = 1e-6
GRACE = 300.0
"""Seconds past the limit after which a run is killed: it then has not heeded its limit."""

Key = tuple[str, int, str, float]
"""Size, number, objective, limit in seconds."""


@dataclass(frozen=True)
class State:
    """What is known at some moment of a run."""

    seconds: float
    """Since the call of the planner."""
    value: float
    bound: float

    @property
    def gap(self) -> float:
        """Relative, 0 to 1."""
        return relative_gap(self.value, self.bound)


@dataclass(frozen=True)
class Followed:
    """A run of the exact planner."""

    states: tuple[State, ...]
    """As reported, and at the end."""
    proof: str
    memory: float
    """Peak of resident memory, MiB."""

    def at(self, seconds: float) -> State | None:
        """The state after so many seconds, ``None`` before the first report."""
        before = [state for state in self.states if state.seconds <= seconds]
        return before[-1] if before else None


def mission(size: str, number: int) -> mo.Instance:
    """The mission of that number, of a size such as ``10x50``, on maps 0, 2 and 3 in turn."""
    if size == PAPER:
        return mo.Instance.read(INSTANCES / "paper.json")
    n_robots, n_victims = (int(part) for part in size.split("x"))
    grid = mo.read_map(INSTANCES / "maps" / f"map{MAPS[number % len(MAPS)]}.map")
    return mo.generate_mission(grid, n_robots, n_victims, seed=FIRST_SEED + number, solvable=False)


def follow(size: str, number: int, objective: str, seconds: float) -> Followed:
    """Plan that mission, for a process of its own: its peak memory is counted as the run's."""
    instance = mission(size, number)
    began = time.monotonic()
    states: list[State] = []

    class Follow(Callbacks):
        def incumbent_found(self, state: SearchState) -> None:
            states.append(State(time.monotonic() - began, state.value, state.bound))

        def bound_raised(self, state: SearchState, proof: str) -> None:
            del proof
            self.incumbent_found(state)

    made = mo.plan(
        instance, planner="exact", objective=objective, time_limit=seconds, callbacks=Follow()
    )
    certificate = made.certificates[0]
    assert certificate.objective is not None
    assert certificate.bound is not None
    ended = State(time.monotonic() - began, certificate.objective, certificate.bound)
    return Followed((*states, ended), certificate.proof or "", peak_memory())


def peak_memory() -> float:
    """Peak of this process's resident memory, MiB."""
    import resource

    unit = 2**20 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


@dataclass(frozen=True)
class Row:
    """What was known of a run at one mark, or how it failed."""

    size: str
    number: int
    objective: str
    limit: float
    mark: float
    value: float
    bound: float
    gap: float
    ended: float
    memory: float
    proof: str
    failure: str = ""

    @property
    def key(self) -> Key:
        """Whose row it is."""
        return self.size, self.number, self.objective, self.limit


def marks_until(limit: float) -> list[float]:
    """The marks of a run that ends at `limit` seconds; its end is one."""
    return [*(mark for mark in MARKS if mark < limit), limit]


def rows_of(key: Key, run: Followed | Failure) -> list[Row]:
    """A row for each mark."""
    if isinstance(run, Failure):
        return [Row(*key, key[-1], 0, 0, 1, 0, 0, "", f"{run.reason}: {run.message}")]
    rows = []
    for mark in marks_until(key[-1]):
        state = run.at(mark) if mark < key[-1] else run.states[-1]
        known = (0.0, 0.0, 1.0) if state is None else (state.value, state.bound, state.gap)
        rows.append(Row(*key, mark, *known, run.states[-1].seconds, run.memory, run.proof))
    return rows


def read(path: Path) -> list[Row]:
    """The rows of the file, none if there is no file."""
    if not path.exists():
        return []
    types = {
        item.name: {"str": str, "int": int, "float": float}[str(item.type)] for item in fields(Row)
    }
    with path.open(encoding="utf-8", newline="") as file:
        return [Row(**{n: types[n](v) for n, v in line.items()}) for line in csv.DictReader(file)]


def append(path: Path, rows: Sequence[Row]) -> None:
    """All of a run's rows at once, on the disk when this returns."""
    new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        if new:
            writer.writerow(item.name for item in fields(Row))
        writer.writerows(astuple(row) for row in rows)
        file.flush()
        os.fsync(file.fileno())


def wanted(arguments: argparse.Namespace) -> Iterator[Key]:
    """The runs asked for."""
    for size in arguments.sizes:
        for objective in arguments.objectives:
            if objective_of(objective).method == SLOW and size not in SLOW_SIZES:
                continue
            for number in range(1 if size == PAPER else arguments.missions):
                yield size, number, objective, arguments.seconds


def table(rows: Sequence[Row]) -> Iterator[str]:
    """A line for each size and objective."""
    for group in dict.fromkeys((row.size, row.objective) for row in rows):
        own = [row for row in rows if (row.size, row.objective) == group]
        held = [row for row in own if not row.failure]
        cells = []
        for mark in sorted({row.mark for row in held}):
            gaps = [row.gap for row in held if row.mark == mark]
            cells.append(f"{mark:g} s {statistics.median(gaps):.2%} ({max(gaps):.2%})")
        ends = [row for row in held if row.mark == row.limit]
        if ends:
            proven = sum(row.gap <= PROVEN for row in ends)
            ended = statistics.median(row.ended for row in ends)
            peak = max(row.memory for row in ends)
            cells.append(f"proven {proven} of {len(ends)}")
            cells.append(f"ended after {ended:.1f} s, {peak:.0f} MiB at the peak")
        failed = [row.failure for row in own if row.failure]
        if failed:
            cells.append(f"{len(failed)} failed: {failed[0]}")
        yield f"{group[0]:7s} {group[1]:11s} " + "; ".join(cells)


def main() -> None:
    # Another process finds the function by its module's name, which here is not the script's.
    from exact import follow

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="three missions a size, 10 s each")
    parser.add_argument("--missions", type=int)
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--sizes", nargs="+", default=SIZES)
    parser.add_argument("--objectives", nargs="+", default=list(OBJECTIVES), choices=OBJECTIVES)
    parser.add_argument("--csv", type=Path, default=Path("exact.csv"))
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    arguments = parser.parse_args()
    arguments.missions = arguments.missions or (3 if arguments.quick else 10)
    arguments.seconds = arguments.seconds or (10.0 if arguments.quick else 300.0)
    keys = list(wanted(arguments))
    have = {row.key for row in read(arguments.csv)}
    todo = [key for key in keys if key not in have]
    results = run_isolated(
        follow,
        todo,
        jobs=arguments.jobs,
        limits=Limits(arguments.seconds + GRACE),
        preload=["msmrta_opt.planners.exact", "exact"],
    )
    for index, run in results:
        rows = rows_of(todo[index], run)
        append(arguments.csv, rows)
        last = rows[-1]
        what = last.failure or f"gap {last.gap:.2%} after {last.ended:.1f} s"
        print(f"{last.size} mission {last.number} {last.objective}: {what}", flush=True)
    print("\ngap, median (worst)")
    asked = set(keys)
    for line in table([row for row in read(arguments.csv) if row.key in asked]):
        print(line)


if __name__ == "__main__":
    main()
