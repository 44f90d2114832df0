"""From a planner's working data, by positions, to the plan that people and files see, by ids."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from ...mission.instance import Instance
from ...mission.plan import (
    Certificate,
    Cluster,
    Plan,
    Reason,
    Route,
    ScoutingReport,
    Unserved,
)
from ...optimise.solution import Solution
from ...stages.cluster_assignment import ClusterAssignment
from ...stages.clustering import Clustering
from ...stages.requirement_analysis import Missing
from .planner import Planner, versions


def assemble(
    instance: Instance,
    known: Instance,
    *,
    planner: Planner,
    options: Mapping[str, Any],
    routes: tuple[Route, ...],
    missing: Missing,
    report: ScoutingReport | None = None,
    clusters: Clustering | None = None,
    b2: ClusterAssignment | None = None,
    solutions: Mapping[str, Solution | None] | None = None,
    seconds: Mapping[str, float] | None = None,
) -> Plan:
    """The plan of `planner` for `instance`, of which `known` holds the victims it knew."""
    return Plan(
        instance=instance,
        planner=planner.name,
        options=dict(options),
        promises=planner.limits,
        versions=versions(),
        routes=routes,
        unserved=_unserved(instance, known, missing, report),
        scouting=report,
        clusters=() if clusters is None else _clusters(known, clusters, b2),
        certificates=tuple(
            certificate(stage, solution)
            for stage, solution in (solutions or {}).items()
            if solution is not None
        ),
        planning_seconds=dict(seconds or {}),
    )


def certificate(stage: str, solution: Solution) -> Certificate:
    """What `solution` proves, as a record."""
    return Certificate(
        stage=stage,
        model=solution.formulation,
        sense=solution.sense,
        solver=solution.solver,
        version=solution.solver_version,
        status=solution.status,
        objective=solution.objective,
        bound=solution.bound if isfinite(solution.bound or 0.0) else None,
        gap=solution.gap,
        proof=solution.proof,
        check=solution.check,
        n_variables=solution.n_variables,
        n_rows=solution.n_rows,
        parameters=solution.parameters,
        digest=solution.digest,
    )


def _unserved(
    instance: Instance, known: Instance, missing: Missing, report: ScoutingReport | None
) -> tuple[Unserved, ...]:
    reason: dict[tuple[int, str], Reason] = {}
    causes: tuple[tuple[tuple[tuple[int, int], ...], Reason], ...] = (
        (missing.unavailable, Reason.NO_ROBOT_HAS_IT),
        (missing.unreachable, Reason.NO_CAPABLE_ROBOT_REACHES_IT),
    )
    for pairs, cause in causes:
        for v, k in pairs:
            reason[known.victims[v].id, known.capabilities[k]] = cause
    hidden = set(report.not_found) if report else set()
    found = []
    for victim in instance.victims:
        for kind in victim.requirements:
            why = Reason.NOT_FOUND if victim.id in hidden else reason.get((victim.id, kind))
            if why is not None:
                found.append(Unserved(victim=victim.id, kind=kind, reason=why))
    return tuple(found)


def _clusters(
    known: Instance, clusters: Clustering, b2: ClusterAssignment | None
) -> tuple[Cluster, ...]:
    records = []
    for c, cell in enumerate(clusters.cells):
        members = clusters.members(c)
        row, col = clusters.centres[c]
        robots = [] if b2 is None else [int(r) for r in b2.chosen[:, c].nonzero()[0]]
        deferred = [] if b2 is None else [v for v in members if v in b2.deferred]
        records.append(
            Cluster(
                victims=tuple(known.victims[v].id for v in members),
                centre=(float(row), float(col)),
                cell=cell,
                robots=tuple(known.robots[r].id for r in robots),
                deferred=tuple(known.victims[v].id for v in deferred),
            )
        )
    return tuple(records)
