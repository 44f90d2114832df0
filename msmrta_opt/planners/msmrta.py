"""The staged planner: Algorithm 1 of the paper, line for line."""

from __future__ import annotations

from typing import Any

from ..mission.instance import Instance
from ..mission.plan import Plan
from ..stages.cluster_assignment import cluster_assignment, cluster_data
from ..stages.clustering import clustering
from ..stages.path_planning import path_planning
from ..stages.performance_analysis import performance_analysis
from ..stages.requirement_analysis import missing_capabilities, requirement_analysis
from ..stages.robot_assignment import robot_assignment
from ..stages.scouting import scouting
from ..stages.situation import Situation, without
from ..stages.victim_assignment import victim_assignment
from .base import Planner, Stopwatch
from .options import PRESETS, StagedOptions
from .record import assemble, known_victims


def run(instance: Instance, *, preset: str = "paper", **changes: Any) -> Plan:
    """Plan `instance` by Algorithm 1; the options are those of `StagedOptions`."""
    options = StagedOptions.of(preset, **changes)
    watch = Stopwatch()
    report = None
    if instance.scouts:
        with watch("scouting"):
            report = scouting(
                instance,
                walk=options.walk,
                shared_table=options.shared_table,
                seed=options.seed,
            )
    known = known_victims(instance, report)
    with watch("requirement analysis"):
        situation = Situation.of(known)
        analysis = requirement_analysis(known.P, known.Q)
        missing = missing_capabilities(known.Q, analysis.potential, situation.reach)
    with watch("clustering"):
        clusters = clustering(
            situation, seed=options.seed, use_pinned=options.pinned_clusters
        )
    with watch("cluster assignment"):
        eq1 = cluster_data(
            situation, analysis, clusters, weights=options.weights, budget=options.budget
        )
        b2 = cluster_assignment(
            situation,
            analysis,
            clusters,
            eq1,
            model=options.cluster_model,
            psi=options.psi,
            members=options.members,
            through_centre=options.through_centre,
        )
        remaining = without(situation.available, b2.stops)
    with watch("performance analysis"):
        eq2 = performance_analysis(
            situation,
            b2.stops,
            remaining,
            performance=options.performance,
            budget=options.budget,
        )
    with watch("victim assignment"):
        b3 = victim_assignment(
            situation, b2.stops, remaining, eq2, model=options.victim_model, beta=options.beta
        )
        remaining = without(remaining, b3.stops)
    with watch("robot assignment"):
        stops = [*b2.stops, *b3.stops]
        b4 = robot_assignment(situation, stops, remaining, analysis, award=options.award)
    with watch("path planning"):
        routes = path_planning(known, [*stops, *b4])
    return assemble(
        instance,
        known,
        planner="msmrta",
        options={"preset": preset, **options.as_dict()},
        routes=routes,
        missing=missing,
        report=report,
        clusters=clusters,
        b2=b2,
        solutions={"Eq. 1": b2.solution, "Eq. 2": b3.solution},
        seconds=watch.seconds,
    )


PLANNER = Planner("msmrta", "the paper's staged method (MSMRTA)", run, presets=PRESETS)
