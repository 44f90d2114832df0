"""What the baselines share: everything around the one step in which they differ, the allocation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...mission.instance import Instance
from ...mission.plan import Plan
from ...stages.options import StagedOptions
from ...stages.path_planning import path_planning
from ...stages.requirement_analysis import missing_capabilities, requirement_analysis
from ...stages.scouting import scout_mission
from ...stages.situation import Situation, Stop
from .planner import Planner, Stopwatch
from .record import assemble

Goal = tuple[int, int]
"""One requirement of one victim: positions of the victim and of the kind."""


def plan_by(
    allocate: Callable[[Situation], Sequence[Stop]],
    instance: Instance,
    *,
    planner: Planner,
    seed: int,
    options: Mapping[str, Any],
) -> Plan:
    """Plan `instance` with `allocate`, which queues stops that serve every available requirement.

    Scouting, missing capabilities and path planning are those of Algorithm 1.
    """
    watch = Stopwatch()
    with watch("scouting"):
        known, report = scout_mission(instance, StagedOptions(seed=seed))
    with watch("requirement analysis"):
        situation = Situation.of(known)
        analysis = requirement_analysis(known.P, known.Q)
        missing = missing_capabilities(known.Q, analysis.potential, situation.reach)
    with watch("allocation"):
        stops = allocate(situation)
    with watch("path planning"):
        routes = path_planning(known, stops)
    return assemble(
        instance,
        known,
        planner=planner,
        options={"seed": seed, **options},
        routes=routes,
        missing=missing,
        report=report,
        seconds=watch.seconds,
    )


def goals(situation: Situation) -> list[Goal]:
    """Every available requirement, by victim and kind."""
    return [(int(v), int(k)) for v, k in np.argwhere(situation.available)]


def queue_of(situation: Situation, robot: int, taken: Sequence[Goal], stage: str) -> list[Stop]:
    """The stops of a robot that serves the goals `taken` in their order.

    Goals that follow each other at one victim make one stop.
    """
    stops: list[Stop] = []
    for v, k in taken:
        cell = situation.cells[v]
        if stops and stops[-1].victim == v:
            stops[-1] = Stop(robot, cell, stage, v, (*stops[-1].kinds, k))
        else:
            stops.append(Stop(robot, cell, stage, v, (k,)))
    return stops
