"""A plan as tables: the paper's Tables 1 and 2 for the mission at hand, routes, metrics, proofs."""

from __future__ import annotations

from collections.abc import Iterable

from ..mission.instance import Instance
from ..mission.metrics import metrics_of
from ..mission.plan import Plan
from ..planners.support.improvement import STAGE as IMPROVED
from ..planners.support.notes import notes
from ..stages.requirement_analysis import requirement_analysis
from .console import say, seconds, table

EMPTY = "∅"


def show_plan(plan: Plan, *, certificates: bool = True) -> None:
    """Print everything about `plan`, its certificates and times last, perhaps without these."""
    _scouting(plan)
    _victims(plan)
    _robots(plan)
    _routes(plan)
    _unserved(plan)
    _metrics(plan)
    for line in notes(plan):
        say(line)
    if certificates:
        show_certificates(plan)


def show_certificates(plan: Plan) -> None:
    """Print how optimal what integer programs found is, and how long planning took."""
    _certificates(plan)
    _times(plan)


def _scouting(plan: Plan) -> None:
    report = plan.scouting
    if report is None:
        return
    n_steps, n_found = len(report.coverage) - 1, len(report.finds)
    say(
        f"Scouting ({report.walk}, seed {report.seed}): {n_found} of {plan.instance.n_victims} "
        f"victims found in {n_steps} steps by {len(report.tracks)} scouts, "
        f"{report.coverage[-1]:.0%} of the reachable area seen; ended: {report.ended}."
    )
    if report.not_found:
        say(f"Not found: victims {_set(report.not_found)}.")
    say()


def _victims(plan: Plan) -> None:
    instance = plan.instance
    analysis = requirement_analysis(instance.P, instance.Q)
    cluster = {v: f"C{c}" for c, record in enumerate(plan.clusters) for v in record.victims}
    rows = [
        (
            victim.id,
            victim.cell,
            cluster.get(victim.id, EMPTY),
            _vector(instance.Q[v]),
            _sets(_robot_ids(instance, robots) for robots in analysis.potential_robots(v)),
        )
        for v, victim in enumerate(instance.victims)
    ]
    kinds = ", ".join(instance.capabilities)
    table(
        "Table 1. Victims: location, cluster, requirements q, and the robots that have each",
        ["victim", "location", "cluster", "q", "L_potential"],
        rows,
    )
    say(f"Kinds, in the order of q and p: {kinds}.\n")


def _robots(plan: Plan) -> None:
    instance = plan.instance
    analysis = requirement_analysis(instance.P, instance.Q)
    stages = list(dict.fromkeys(v.stage for route in plan.routes for v in route.visits))
    if plan.clusters and IMPROVED not in stages:
        stages = sorted({"B2", "B3", "B4", *stages})
    ids = [victim.id for victim in instance.victims]
    rows = []
    for r, robot in enumerate(instance.robots):
        taken = [f"C{c}" for c, record in enumerate(plan.clusters) if robot.id in record.robots]
        visits = plan.route(robot.id).visits
        rows.append(
            (
                robot.id,
                robot.start,
                _vector(instance.P[r]),
                _set(ids[v] for v in analysis.fully(r)),
                _set(ids[v] for v in analysis.partially(r)),
                ", ".join(taken) or EMPTY,
                *(_set(v.victim for v in visits if v.stage == stage) for stage in stages),
            )
        )
    table(
        "Table 2. Robots: location, capabilities p, who they can satisfy, and whom they got",
        ["robot", "location", "p", "L_full", "L_partial", "cluster", *stages],
        rows,
    )
    deferred = [v for record in plan.clusters for v in record.deferred]
    if deferred:
        say(f"Deferred by the wall check, from stage B2 to the next: victims {_set(deferred)}.\n")


def _routes(plan: Plan) -> None:
    rows = [
        (
            route.robot,
            n + 1,
            visit.victim,
            ", ".join(visit.served),
            visit.stage,
            len(visit.cells) - 1,
            visit.arrival,
            visit.departure,
        )
        for route in plan.routes
        for n, visit in enumerate(route.visits)
    ]
    table(
        "Routes (cells; time units)",
        ["robot", "stop", "victim", "serves", "stage", "cells", "arrival", "departure"],
        rows,
    )


def _unserved(plan: Plan) -> None:
    if plan.unserved:
        rows = [(item.victim, item.kind, item.reason) for item in plan.unserved]
        table("Unserved", ["victim", "requirement", "why"], rows)


def _metrics(plan: Plan) -> None:
    rows = [(entry.words, entry.text(plan.metrics)) for entry in metrics_of("plan")]
    table("Metrics", ["metric", "value"], rows)


def _certificates(plan: Plan) -> None:
    rows = [
        (
            item.stage,
            item.model,
            item.sense,
            item.objective,
            item.bound,
            item.gap,
            item.status,
            item.check,
            f"{item.solver} {item.version}",
            item.how,
        )
        for item in plan.certificates
    ]
    if rows:
        columns = [
            *("program", "model", "sense", "objective", "bound", "gap"),
            *("status", "check", "solver", "proof"),
        ]
        table("Certificates of the integer programs", columns, rows)


def _times(plan: Plan) -> None:
    stages = ", ".join(f"{stage} {seconds(t)}" for stage, t in plan.planning_seconds.items())
    say(f"Planning time {seconds(plan.metrics.planning_seconds)}: {stages}.")


def _vector(row: Iterable[bool]) -> str:
    return f"[{', '.join(str(int(value)) for value in row)}]"


def _set(values: Iterable[int]) -> str:
    values = list(values)
    return f"[{', '.join(map(str, values))}]" if values else EMPTY


def _sets(sets: Iterable[list[int]]) -> str:
    return f"[{', '.join(_set(values) for values in sets)}]"


def _robot_ids(instance: Instance, robots: Iterable[int]) -> list[int]:
    return [instance.robots[r].id for r in robots]
