"""A run as the page of a replay reads it: as a plan, with what came in between.

A visit is one requirement that a robot served, or began to. Walks are given apart from visits, each with
its times, for robots also wait, and turn round on the way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

from ...mission.grid import Cell
from ...mission.run import Decision, Event, Queue, Run, Service, Walked
from ..style import robot_styles
from .data import look, walk_code, wall_runs

STAGES = {"planned": "as planned", "decided": "decided on the way"}
"""Whether the plan had a robot serve a requirement, or a decision did."""
AGREE = 1e-9
"""Share of a time up to which a move follows the one before it without a pause."""


def document_of_run(run: Run) -> dict[str, Any]:
    """What the page shows of `run`, JSON-ready."""
    mission, figures = run.plan.instance, run.metrics
    kinds = {kind: k for k, kind in enumerate(mission.capabilities)}
    position = {victim.id: v for v, victim in enumerate(run.victims)}
    robots = list(_robots(run, kinds, position))
    visits = [visit for robot in robots for visit in robot["visits"]]
    used = [name for name in STAGES if any(visit["stage"] == name for visit in visits)]
    for visit in visits:
        visit["stage"] = used.index(visit["stage"])
    return {
        "name": mission.name or "unnamed mission",
        "shape": list(mission.map.shape),
        "walls": wall_runs(mission.map),
        "kinds": list(kinds),
        "stages": [{"name": name, "title": STAGES[name]} for name in used],
        "robots": robots,
        "victims": list(_victims(run, kinds)),
        "clusters": [],
        "scouting": None,
        "makespan": figures.makespan,
        "totalTime": figures.total_time,
        "distance": figures.distance,
        "available": figures.n_available,
        "run": _what_came(run, position),
    }


def _robots(
    run: Run, kinds: Mapping[str, int], position: Mapping[int, int]
) -> Iterator[dict[str, Any]]:
    styles = robot_styles(run.plan.instance)
    speeds = {drawn.robot: drawn.speed for drawn in run.world.speeds}
    tracks = {track.robot: track for track in run.tracks}
    lost = {event.robot: event.time for event in run.events if event.what == "lost"}
    planned = {
        (route.robot, visit.victim, kind)
        for route in run.plan.routes
        for visit in route.visits
        for kind in visit.served
    }
    for robot in run.plan.instance.robots:
        services = sorted((s for s in run.services if s.robot == robot.id), key=lambda s: s.began)
        track = tracks.get(robot.id, Walked(robot=robot.id, cells=(robot.start,), times=(0.0,)))
        stages = [
            "planned" if (robot.id, service.victim, service.kind) in planned else "decided"
            for service in services
        ]
        yield {
            "id": robot.id,
            "start": list(track.cells[0]),
            "speed": speeds[robot.id],
            "can": [kinds[kind] for kind in robot.capabilities],
            **look(styles[robot.id]),
            "visits": [
                {
                    "victim": position[service.victim],
                    "kinds": [kinds[service.kind]],
                    "stage": stage,
                    "arrival": service.began,
                    "departure": service.ended,
                    "cut": not service.done,
                }
                for service, stage in zip(services, stages, strict=True)
            ],
            "walks": list(_walks(track, speeds[robot.id], services)),
            "home": run.metrics.done_of[robot.id],
            "lost": lost.get(robot.id),
        }


def _walks(
    track: Walked, speed: float, services: list[Service]
) -> Iterator[tuple[float, float, str, int | None]]:
    """The moves that follow each other without a pause: from when, to when, where, to which visit."""
    begins = {service.began: number for number, service in reversed(list(enumerate(services)))}
    cells: list[Cell] = [track.cells[0]]
    began = ended = 0.0
    for (_, cell), (_, time) in zip(pairwise(track.cells), pairwise(track.times), strict=True):
        set_out = time - 1 / speed
        if len(cells) > 1 and set_out - ended > AGREE * time:
            yield began, ended, walk_code(cells), begins.get(ended)
            cells = cells[-1:]
        began = set_out if len(cells) == 1 else began
        cells.append(cell)
        ended = time
    if len(cells) > 1:
        yield began, ended, walk_code(cells), begins.get(ended)


def _victims(run: Run, kinds: Mapping[str, int]) -> Iterator[dict[str, Any]]:
    appeared = {event.victim: event for event in run.events if event.what in ("announced", "found")}
    hidden = {item.victim.id for item in run.world.unknown}
    done = {(service.victim, service.kind) for service in run.services if service.done}
    reasons = {(item.victim, item.kind): str(item.reason) for item in run.plan.unserved}
    for victim in run.victims:
        event = appeared.get(victim.id)
        open_kinds = [kind for kind in victim.requirements if (victim.id, kind) not in done]
        unknown = victim.id in hidden and event is None
        left = "nobody found the victim" if unknown else "was not served"
        yield {
            "id": victim.id,
            "cell": list(victim.cell),
            "priority": victim.priority,
            "needs": [kinds[kind] for kind in victim.requirements],
            "unserved": {kinds[k]: reasons.get((victim.id, k), left) for k in open_kinds},
            # What the plan leaves open is so from the beginning, all else in the end.
            "since": {
                kinds[k]: run.metrics.makespan
                for k in open_kinds
                if (victim.id, k) not in reasons or victim.id in hidden
            },
            "appears": event.time if event else None if unknown else 0,
            "turnedUp": "" if event is None else f"{_said(event)} at {event.time:.6g}",
        }


def _what_came(run: Run, position: Mapping[int, int]) -> dict[str, Any]:
    changed = [event for event in run.events if event.what in ("blocked", "opened")]
    noticed = [event for event in run.events if event.what == "noticed"]
    return {
        "end": max((event.time for event in run.events), default=0.0),
        "changes": [[event.time, *(event.cell or ()), event.what == "opened"] for event in changed],
        "noticed": [[event.time, *(event.cell or ())] for event in noticed],
        "events": list(_events(run)),
        "planned": [
            [
                position[visit.victim]
                for route in run.plan.routes
                if route.robot == robot.id
                for visit in route.visits
            ]
            for robot in run.plan.instance.robots
        ],
        "decisions": [
            {
                "time": decision.time,
                "changed": decision.changed,
                "queues": list(_queues(run, decision, position)),
            }
            for decision in run.decisions
        ],
    }


def _events(run: Run) -> Iterator[tuple[float, str, int | None]]:
    """When, what, and the number of the decision if it is one; without what visits tell."""
    number = 0
    for event in run.events:
        if event.what == "decided":
            changed = run.decisions[number].changed
            plural = "" if changed == 1 else "s"
            yield event.time, f"replanned: {changed} visit{plural} taken from robots", number
            number += 1
        elif event.what not in ("served", "cut short"):
            yield event.time, _said(event), None


def _said(event: Event) -> str:
    """An event as a sentence."""
    place = "" if event.cell is None else f"row {event.cell[0]}, column {event.cell[1]}"
    who = "" if event.robot is None else f" by R{event.robot}"
    return {
        "lost": f"R{event.robot} is lost at {place}",
        "announced": f"v{event.victim} is announced",
        "found": f"v{event.victim} is found{who}",
        "blocked": f"{place} is blocked",
        "opened": f"{place} is opened",
        "noticed": f"{place} is noticed{who}",
        "skipped": f"v{event.victim} is left out{who}",
    }.get(event.what, str(event))


def _queues(
    run: Run, decision: Decision, position: Mapping[int, int]
) -> Iterator[tuple[int, list[int], list[int]]]:
    """Of the robots whose visits to come a decision changed: who, and which victims before and after."""
    number = {robot.id: r for r, robot in enumerate(run.plan.instance.robots)}
    after = {queue.robot: queue for queue in decision.after}
    for before in decision.before:
        if before != after[before.robot]:
            yield (
                number[before.robot],
                _positions(before, position),
                _positions(after[before.robot], position),
            )


def _positions(queue: Queue, position: Mapping[int, int]) -> list[int]:
    return [position[visit.victim] for visit in queue.visits]
