"""What robots were told to do in a run, by the plan and by decisions, and whether they did it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from ..mission.route import Visit
from ..mission.run import Queued, Run, Service

CLOSE = 1e-9
"""Share of a time up to which two times are the same."""
Order = tuple[int, tuple[str, ...]]
"""A victim, and what to serve there."""


@dataclass(frozen=True)
class Followed:
    """What is wrong with how a robot followed what it was told, and at which victim it was stopped."""

    problems: tuple[str, ...]
    stopped: int | None = None


def told(run: Run) -> list[Mapping[int, list[Order]]]:
    """What robots are told to do: by the plan, then by decisions."""
    first = {route.robot: orders_of(route.visits) for route in run.plan.routes}
    later = ({q.robot: orders_of(q.visits) for q in d.after} for d in run.decisions)
    return [first, *later]


def followed(run: Run) -> Mapping[int, Followed]:
    """Whether robots do what they are told, visit by visit, unless they leave it out or are stopped."""
    queues = told(run)
    left: list[Mapping[int, list[Order]]] = [
        {q.robot: orders_of(q.visits) for q in d.before} for d in run.decisions
    ]
    found = {}
    for track in run.tracks:
        robot = track.robot
        orders: list[Order] = []
        for given, rest in zip(queues, [*left, {}], strict=True):
            queue = given.get(robot, [])
            orders += queue[: len(queue) - len(rest.get(robot, []))]
        found[robot] = _follow(run, robot, orders)
    return found


def _follow(run: Run, robot: int, orders: Sequence[Order]) -> Followed:
    wrong: list[str] = []
    stopped: int | None = None
    skips: dict[int | None, list[float]] = {}
    for event in run.events:
        if event.what == "skipped" and event.robot == robot:
            skips.setdefault(event.victim, []).append(event.time)
    done = [service for service in run.services if service.robot == robot]
    for victim, kinds in orders:
        visit = [(victim, kind) for kind in kinds]
        missed = skips.get(victim)
        if missed and not (done and done[0].began < missed[0]):
            missed.pop(0)
        elif [(s.victim, s.kind) for s in done[: len(visit)] if s.done] == visit:
            done = done[len(visit) :]
        elif may_stop(run, robot, victim, kinds):
            begun = [(s.victim, s.kind) for s in done]
            done = [] if begun == visit[: len(begun)] else done
            stopped = victim
            break
        else:
            wrong.append(f"robot {robot} does not do at victim {victim} what it is told")
            break
    if done:
        wrong.append(f"{said_of(done[0])} without being told")
    if any(skips.values()):
        wrong.append(f"robot {robot} leaves out visits that it was not told to make")
    return Followed(tuple(wrong), stopped)


def visits_for_nothing(run: Run, robot: int) -> list[Visit]:
    """Those of the plan on which a robot serves nothing."""
    routes = (route for route in run.plan.routes if route.robot == robot)
    return [visit for route in routes for visit in route.visits if not visit.served]


def said_of(service: Service) -> str:
    """A service in words."""
    return f"robot {service.robot} serves {service.kind} at victim {service.victim}"


def orders_of(visits: Sequence[Visit | Queued]) -> list[Order]:
    """Whom to visit and what to serve there; a visit for nothing leaves no trace."""
    return [(visit.victim, visit.served) for visit in visits if visit.served]


def blocked_from(run: Run) -> float:
    """When a cell is blocked for the first time; infinity if none is."""
    return min((c.time for c in run.world.changes if not c.free), default=math.inf)


def stopped_at(run: Run, robot: int) -> float:
    """When a robot is stopped, whatever it is doing: it is lost, or the scenario says so."""
    ends = [loss.time for loss in run.world.lost if loss.robot == robot]
    return min([*ends, math.inf if run.scenario.until is None else run.scenario.until])


def may_stop(run: Run, robot: int, victim: int, kinds: tuple[str, ...]) -> bool:
    """Whether a robot may never be done with a visit that it was told to make.

    It may if it was lost over it, or the run ended, at the latest on the next step or service that it
    would have finished; or if it waits, or a cell was blocked by then, for which it may have waited.
    """
    if any(event.what == "waiting" and event.robot == robot for event in run.events):
        return True
    if math.isinf(stopped_at(run, robot)):
        return False
    times = {(item.victim, item.kind): item.time for item in run.world.services}
    return may_stand(run, robot, [times[victim, kind] for kind in kinds])


def may_stand(run: Run, robot: int, services: Iterable[float]) -> bool:
    """Whether a robot may stay where it was last.

    It may if it is stopped, or a cell is blocked, by when it would have finished a step, or one of
    `services`, so many time units long, that it began when something was last heard of it.
    """
    end = stopped_at(run, robot)
    track = next(track for track in run.tracks if track.robot == robot)
    step = 1 / next(drawn.speed for drawn in run.world.speeds if drawn.robot == robot)
    last = max(
        track.times[-1],
        *(s.ended for s in run.services if s.robot == robot),
        *(decision.time for decision in run.decisions if decision.time < end),
        0.0,
    )
    return min(end, blocked_from(run)) <= (last + max([step, *services])) * (1 + CLOSE)
