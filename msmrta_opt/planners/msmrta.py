"""The staged planner: Algorithm 1 of the paper, line for line."""

from __future__ import annotations

from typing import Any

from ..mission.instance import Instance
from ..mission.plan import Plan
from ..stages.cluster_assignment import cluster_assignment
from ..stages.clustering import clustering
from ..stages.options import StagedOptions
from ..stages.path_planning import path_planning
from ..stages.performance_analysis import performance_analysis
from ..stages.requirement_analysis import missing_capabilities, requirement_analysis
from ..stages.robot_assignment import robot_assignment
from ..stages.scouting import scout_mission
from ..stages.situation import Situation, without
from ..stages.victim_assignment import victim_assignment
from .support.planner import CLUSTERING, SOLVING, Planner, Stopwatch
from .support.record import assemble


def run(instance: Instance, *, preset: str = "paper", **changes: Any) -> Plan:
    """Plan `instance` by Algorithm 1; the options are those of `StagedOptions`."""
    options = StagedOptions.of(preset, **changes)
    watch = Stopwatch()
    with watch("scouting"):
        known, report = scout_mission(instance, options)
    with watch("requirement analysis"):
        situation = Situation.of(known)
        analysis = requirement_analysis(known.P, known.Q)
        missing = missing_capabilities(known.Q, analysis.potential, situation.reach)
    with watch("clustering"):
        clusters = clustering(situation, options)
    with watch("cluster assignment"):
        b2 = cluster_assignment(situation, analysis, clusters, options)
        remaining = without(situation.available, b2.stops)
    with watch("performance analysis"):
        times = performance_analysis(situation, b2.stops, remaining, options)
    with watch("victim assignment"):
        b3 = victim_assignment(situation, b2.stops, remaining, times, options)
        remaining = without(remaining, b3.stops)
        stops = [*b2.stops, *b3.stops]
    with watch("robot assignment"):
        b4 = robot_assignment(situation, stops, remaining, analysis, options)
    with watch("path planning"):
        routes = path_planning(known, [*stops, *b4])
    return assemble(
        instance,
        known,
        planner=PLANNER,
        options={"preset": preset, **options.as_dict()},
        routes=routes,
        missing=missing,
        report=report,
        clusters=clusters,
        b2=b2,
        solutions={
            "Clustering": clusters.solution,
            "Eq. 1": b2.solution,
            "Eq. 2": b3.solution,
        },
        seconds=watch.seconds,
    )


PLANNER = Planner(
    "msmrta",
    "the paper's staged method (MSMRTA)",
    run,
    defaults={"preset": "paper", **StagedOptions().as_dict()},
    check=lambda options: StagedOptions.of(**options),
    formulations=lambda options: StagedOptions.of(**options).formulations,
    libraries=(*CLUSTERING, *SOLVING),
)
