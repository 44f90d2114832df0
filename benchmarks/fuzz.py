"""Random missions against the exact planner: bounds that are too high, gaps below 0, plans that fail.

    python benchmarks/fuzz.py [--missions 1000] [--first 0] [--limits 0 0.1] [--jobs 1]

Each mission is planned for every objective, under each time limit, and once more until a SIGINT at a
random moment. Every plan must pass the checker, and its bound must be proved again from what is stored
with it. Every bound that was ever reported is held against the best plan known of that mission and
objective, whoever made it: the staged method, the same improved, or any of the exact planner's runs.
The exit status is 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sys
import threading
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import msmrta_opt as mo
from msmrta_opt.certify.certificates import recheck
from msmrta_opt.certify.plan import problems
from msmrta_opt.isolation import Failure, run_isolated
from msmrta_opt.mission.errors import InputError, NoPlanError
from msmrta_opt.mission.grid import GridMap
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import planners
from msmrta_opt.planners.support.improvement import improve_plan
from msmrta_opt.routing.callbacks import Callbacks, SearchState
from msmrta_opt.routing.objectives import OBJECTIVES

MAPS = Path(__file__).parents[1] / "instances" / "maps"
SPEEDS = ((0.2, 0.3, 0.4), (1.0,), (0.31, 0.7, 1.3), (1 / 3, 0.7))
"""The last have no common step that is worth its name."""
ROUNDING = 1e-6
"""Relative."""
UNTIL_STOPPED = 0.5
"""Seconds that a run to be stopped may take."""
LATEST_STOP = 0.15
"""Seconds after the first report."""
STEPS = 300
"""Of local search on the staged method's plan."""
CHUNK = 10
"""Missions a process."""


@dataclass
class Known:
    """What all runs of one mission and objective have said."""

    values: dict[str, float] = field(default_factory=dict)
    """What plans are worth, by who made them."""
    bounds: dict[str, float] = field(default_factory=dict)
    """The greatest bound that was claimed, by the run."""
    impossible: list[str] = field(default_factory=list)
    """Runs that say that there is no plan."""

    def contradictions(self) -> list[str]:
        """Bounds above a plan's value, and plans that cannot be."""
        if not self.values:
            return []
        best = min(self.values, key=lambda who: self.values[who])
        smallest = self.values[best]
        high = [
            f"bound {bound!r} of the run {who} is above {smallest!r} of {best}"
            for who, bound in self.bounds.items()
            if bound > smallest + ROUNDING * max(1.0, abs(smallest))
        ]
        return high + [
            f"the run {who} says that {best}'s plan cannot be" for who in self.impossible
        ]


@cache
def grid(number: int) -> GridMap:
    return mo.read_map(MAPS / f"map{number}.map")


def mission(number: int) -> tuple[mo.Instance, dict[str, Any]]:
    """The small mission of that number, and the exact planner's options for it.

    Kinds may be had by nobody, victims may need nothing, matter nothing or take their own time, and
    robots may have to return or keep to limits.
    """
    chance = random.Random(number)
    made = mo.generate_mission(
        grid(chance.randrange(4)),
        chance.randint(1, 5),
        chance.randint(0, 9),
        seed=number,
        per_robot=(chance.randint(0, 1), 3),
        per_victim=(0, 3),
        speeds=chance.choice(SPEEDS),
        solvable=False,
    )
    if chance.random() < 0.5:
        made = made.replace(
            victims=tuple(
                victim.model_copy(
                    update={
                        "priority": chance.choice([0.0, 0.5, 1.0, 3.0]),
                        "service_time": {
                            kind: chance.choice([0.0, 7.5, 60.0])
                            for kind in victim.requirements
                            if chance.random() < 0.3
                        },
                    }
                )
                for victim in made.victims
            )
        )
    options: dict[str, Any] = {}
    if chance.random() < 0.2:
        options["return_to_start"] = True
    if chance.random() < 0.1:
        options["endurance"] = chance.uniform(100, 400)
    if chance.random() < 0.1:
        options["longest_walk"] = chance.uniform(15, 60)
    return made, options


def violations(number: int, limits: Sequence[float], objectives: Sequence[str]) -> list[str]:
    """What is wrong with what the exact planner says of mission `number`, one line each."""
    chance = random.Random(-number - 1)
    instance, options = mission(number)
    wrong: list[str] = []
    staged = None if options else mo.plan(instance)
    for objective in objectives:
        known = Known()
        if staged is not None:
            better = improve_plan(staged, objective=objective, iterations=STEPS, seed=number)
            known.values["the staged method"] = getattr(staged.metrics, objective)
            known.values["the staged method, improved"] = getattr(better.metrics, objective)
        for limit in limits:
            who = f"of {limit:g} s"
            wrong += _run(instance, objective, who, known, {**options, "time_limit": limit})
        moment = chance.uniform(0.0, LATEST_STOP)
        who = f"stopped after {moment:.3f} s"
        long = {**options, "time_limit": UNTIL_STOPPED}
        wrong += _run(instance, objective, who, known, long, stop_after=moment)
        wrong += [f"{objective}: {line}" for line in known.contradictions()]
    return [f"mission {number}, {line}" for line in wrong]


def _run(
    instance: mo.Instance,
    objective: str,
    who: str,
    known: Known,
    options: dict[str, Any],
    *,
    stop_after: float | None = None,
) -> list[str]:
    """One run: what is wrong with it by itself; what it says is noted in `known`."""
    wrong: list[str] = []
    history: list[tuple[float, float]] = []
    stopped = _Stop(stop_after)

    class Follow(Callbacks):
        def incumbent_found(self, state: SearchState) -> None:
            if not history:
                stopped.begin()
            history.append((state.value, state.bound))

        def bound_raised(self, state: SearchState, proof: str) -> None:
            del proof
            self.incumbent_found(state)

    try:
        with stopped:
            made = planners()["exact"].run(
                instance, objective=objective, callbacks=Follow(), **options
            )
    except InputError as error:
        if isinstance(error, NoPlanError) and error.proven:
            known.impossible.append(who)
        elif "endurance" not in options and "longest_walk" not in options:
            wrong.append(f"refused: {error}")
        return [f"{objective}, run {who}: {line}" for line in wrong]
    except KeyboardInterrupt as stop:
        steps = traceback.extract_tb(stop.__traceback__)
        where = next((step for step in reversed(steps) if "msmrta_opt" in step.filename), steps[-1])
        at = f"{Path(where.filename).name}, {where.name}"
        return [f"{objective}, run {who}: the stop lost the plan ({at})"]
    except Exception as error:  # whatever it is, it is what is looked for
        return [f"{objective}, run {who}: {type(error).__name__}: {error}"]
    wrong += faults_of(made, objective)
    for (value, bound), (next_value, next_bound) in pairwise(history):
        slack = ROUNDING * max(1.0, abs(value))
        if next_value > value + slack or next_bound < bound - slack:
            wrong.append(f"reported {(next_value, next_bound)} after {(value, bound)}")
    certificate = made.certificates[0]
    history.append((certificate.objective or 0.0, certificate.bound or 0.0))
    known.values[f"the run {who}"] = min(value for value, _ in history)
    known.bounds[who] = max(bound for _, bound in history)
    return [f"{objective}, run {who}: {line}" for line in wrong]


def faults_of(made: Plan, objective: str) -> list[str]:
    """What is wrong with a plan and its certificate by themselves, one line each."""
    wrong = problems(made)
    certificate = made.certificates[0]
    value, bound, gap = certificate.objective, certificate.bound, certificate.gap
    if value is None or bound is None or gap is None:
        return [*wrong, f"value {value}, bound {bound}, gap {gap}"]
    slack = ROUNDING * max(1.0, abs(value))
    if bound > value + slack:
        wrong.append(f"bound {bound!r} above its own value {value!r}")
    if not 0 <= gap <= 1:
        wrong.append(f"gap {gap!r}")
    if abs(value - getattr(made.metrics, objective)) > slack:
        wrong.append(f"value {value!r} is {getattr(made.metrics, objective)!r} by the plan itself")
    if certificate.check != "passed":
        wrong.append(f"check: {certificate.check}")
    return wrong + [f"proved again: {line}" for one in recheck(made) for line in one.problems]


class _Stop:
    """Within it SIGINT comes some seconds after it is told to begin, and one that is late is lost."""

    def __init__(self, seconds: float | None) -> None:
        self.timer: threading.Timer | None = None
        if seconds is not None:
            self.timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
        self.late = False

    def begin(self) -> None:
        if self.timer is not None:
            self.timer.start()

    def press(self, *_: object) -> None:
        if not self.late:
            raise KeyboardInterrupt

    def __enter__(self) -> None:
        self.before = signal.signal(signal.SIGINT, self.press)

    def __exit__(self, *_: object) -> None:
        self.late = True
        if self.timer is not None:
            self.timer.cancel()
            if self.timer.ident is not None:
                self.timer.join()
        signal.signal(signal.SIGINT, self.before)


def chunk(numbers: Sequence[int], limits: Sequence[float]) -> tuple[int, list[str]]:
    """How many missions, and what is wrong with them."""
    return len(numbers), [line for n in numbers for line in violations(n, limits, list(OBJECTIVES))]


def main() -> None:
    # Another process finds the function by its module's name, which here is not the script's.
    from fuzz import chunk

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--missions", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first mission")
    parser.add_argument("--limits", nargs="+", type=float, default=[0.0, 0.1], help="seconds")
    parser.add_argument("--jobs", type=int, default=1, help="processes at a time")
    arguments = parser.parse_args()
    numbers = range(arguments.first, arguments.first + arguments.missions)
    chunks = [numbers[i : i + CHUNK] for i in range(0, len(numbers), CHUNK)]
    began, done, wrong = time.monotonic(), 0, 0
    calls = [(part, arguments.limits) for part in chunks]
    for index, result in run_isolated(
        chunk, calls, jobs=arguments.jobs, preload=["msmrta_opt.planners.exact", "fuzz"]
    ):
        if isinstance(result, Failure):
            n, lines = 0, [f"missions {chunks[index]}: {result.reason}: {result.message}"]
        else:
            n, lines = result
        done, wrong = done + n, wrong + len(lines)
        for line in lines:
            print(line, flush=True)
    runs = done * len(OBJECTIVES) * (len(arguments.limits) + 1)
    print(
        f"{done} missions, {runs} runs of the exact planner in {time.monotonic() - began:.0f} s:"
        f" {wrong or 'no'} violation{'s' if wrong != 1 else ''}"
    )
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
