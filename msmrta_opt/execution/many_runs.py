"""A plan executed many times: every policy on the same seeds, here or in several processes.

What comes of a seed does not depend on how many processes there are, nor on the other seeds. Processes
take batches one after another; where all is done sooner than they would start, there are none.
"""

from __future__ import annotations

import math
import time
from collections.abc import Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from ..certify.plan import check_plan
from ..interruption import interrupted
from ..isolation import Failure, run_isolated
from ..mission.errors import CheckError, InputError
from ..mission.plan import Plan
from ..mission.run import Run
from ..mission.scenario import Scenario
from .execute import execute_checked
from .simulation import GivenUpError

BATCH_SECONDS = 0.5
"""How long a batch of seeds takes, about."""
STARTING_SECONDS = 10.0
"""How long what is left must take for processes to be worth their start."""
TRIED = 2
"""Seeds that are done here first; the first pays for imports, and the last says how long one takes."""
PRELOAD = ("msmrta_opt.execution.many_runs", "msmrta_opt.planners", "networkx")


@dataclass(frozen=True)
class Outcome:
    """What one run came to.

    Among ``figures``, the robots that are lost are those until the last of the runs that are compared
    has ended: policies on the same seed lose the same.
    ``served`` holds by victim when the last of its requirements that any robot has was served, for
    those of which all were; ``victims`` are those that turned up, served or not.
    """

    policy: str
    seed: int
    figures: Mapping[str, float]
    served: Mapping[int, float]
    victims: tuple[int, ...] = ()


def execute_many(
    plan: Plan,
    scenario: Scenario,
    policies: Mapping[str, Mapping[str, Any]],
    seeds: Sequence[int],
    *,
    jobs: int = 1,
) -> Generator[Outcome, None, None]:
    """Execute `plan` with each policy on each seed; ends early once the user asks.

    Parameters
    ----------
    plan : Plan
        One that holds.
    scenario : Scenario
        What may happen.
    policies : mapping
        The policies' options by their names.
    seeds : sequence of int
        Policies on the same seed meet the same world.
    jobs : int
        How many processes at most; with one, all is done in this.

    Yields
    ------
    Outcome
        As they are finished: all policies' on a seed before those on another one.

    Raises
    ------
    InputError, CheckError
        As `execute`.
    """
    if jobs < 1:
        raise InputError(f"{jobs!r}; give 1 or more", field="jobs")
    check_plan(plan)
    scenario.check_for(plan.instance)
    seconds = 0.0
    for done, seed in enumerate(seeds):
        if interrupted():
            return
        left = seeds[done:]
        if jobs > 1 and done >= TRIED and seconds * len(left) > STARTING_SECONDS:
            yield from _elsewhere(plan, scenario, policies, left, jobs, seconds)
            return
        began = time.perf_counter()
        yield from outcomes(plan, scenario, policies, [seed])
        seconds = time.perf_counter() - began


def _elsewhere(
    plan: Plan,
    scenario: Scenario,
    policies: Mapping[str, Mapping[str, Any]],
    seeds: Sequence[int],
    jobs: int,
    seconds: float,
) -> Generator[Outcome, None, None]:
    """The same in processes, where a seed takes so many seconds; no batch is more than a fair share."""
    size = max(min(int(BATCH_SECONDS / seconds), math.ceil(len(seeds) / jobs)), 1)
    calls = [(plan, scenario, policies, seeds[i : i + size]) for i in range(0, len(seeds), size)]
    with closing(run_isolated(outcomes, calls, jobs=jobs, preload=PRELOAD, reuse=True)) as results:
        for _, found in results:
            if isinstance(found, Failure):
                raise found.error or CheckError(f"a run {found.reason}: {found.message}")
            yield from found
            if interrupted():
                return


def outcomes(
    plan: Plan,
    scenario: Scenario,
    policies: Mapping[str, Mapping[str, Any]],
    seeds: Sequence[int],
) -> list[Outcome]:
    """What comes of these seeds, one after the other; a module's function for other processes.

    It ends early once the user asks; the seed in work is then left out.
    """
    found: list[Outcome] = []
    for seed in seeds:
        try:
            runs = [
                execute_checked(plan, scenario, name, seed, o, interrupted)
                for name, o in policies.items()
            ]
        except GivenUpError:
            break
        end = max((run.end for run in runs), default=0.0)
        found += [_outcome(run, end) for run in runs]
    return found


def _outcome(run: Run, end: float) -> Outcome:
    capable = {kind for robot in run.plan.instance.robots for kind in robot.capabilities}
    done = {(service.victim, service.kind) for service in run.services if service.done}
    completion = run.metrics.completion
    whole = (
        victim.id
        for victim in run.victims
        if all((victim.id, k) in done for k in victim.requirements if k in capable)
    )
    served = {ident: completion[ident] for ident in whole if ident in completion}
    lost = sum(loss.time <= end for loss in run.world.lost)
    figures = {**run.figures, "robots_lost": lost}
    there = {victim.id for victim in run.plan.instance.victims}
    turned_up = tuple(victim.id for victim in run.victims if victim.id not in there)
    return Outcome(run.policy, run.seed, figures, served, turned_up)
