"""What a policy is shown of a run, and what its answer changes in it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import replace

from ..mission.run import Event
from .body import Body
from .knowledge import Knowledge
from .state import RobotState, State, Task


def state_of(
    standing: Sequence[Body], world: Knowledge, now: float, news: tuple[Event, ...]
) -> State:
    """What is known at `now`, of the robots that are `standing`, for a policy to decide by."""
    under_way = {
        (body.task.victim, kind)
        for body in standing
        if body.is_serving and body.task is not None
        for kind in body.task.served[body.kind or 0 :]
    }
    left = {
        v: tuple(kind for kind in kinds if (v, kind) not in under_way)
        for v, kinds in world.unserved.items()
    }
    return State(
        time=now,
        mission=world.mission,
        grid=world.grid,
        robots=tuple(_robot_state(body, world, now) for body in standing),
        open={v: kinds for v, kinds in left.items() if kinds},
        news=news,
    )


def _robot_state(body: Body, world: Knowledge, now: float) -> RobotState:
    cell, free_at = body.cell, now
    busy, walked = body.served_for, len(body.cells) - 1
    if body.into is not None and body.until is not None:
        cell, free_at, walked = body.into, body.until, walked + 1
    elif body.is_serving and body.task is not None:
        victim = world.victims[body.task.victim or 0]
        times = world.mission.service_time | victim.service_time
        rest = sum(times[kind] for kind in body.task.served[body.kind or 0 :])
        free_at = max(now, body.began + rest)
        busy += free_at - body.began
    busy += walked / body.speed
    return RobotState(body.robot.id, cell, free_at, body.ahead(), busy, walked)


def give(body: Body, tasks: Iterable[Task]) -> None:
    """Let a robot do `tasks` next; it goes on with its walk if the first is where it is going."""
    queue = deque(tasks)
    if body.task is not None and not body.is_serving:
        if queue and queue[0].victim == body.task.victim:
            body.task = queue.popleft()
        else:
            body.task, body.leg = None, None
    body.queue, body.stuck = queue, None


def look_ahead(body: Body, world: Knowledge) -> None:
    """Give up a walk that is known to be blocked further on, or found by the robot itself."""
    if body.leg is None or body.task is None:
        return
    if not body.task.cells or not all(world.known[c] for c in body.leg[body.step + 1 :]):
        body.task, body.leg = replace(body.task, cells=()), None
