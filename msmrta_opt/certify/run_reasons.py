"""Whether what robots do in a run has a reason: none waits, wanders or leaves out without one.

Where some cell is blocked at some time, robots may wait for it, go round it, or give up; how well they
choose is the policy's own. Where none ever is, the plan and the decisions leave them no choice.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from ..mission.run import Run

CLOSE = 1e-9
"""Share of a time up to which two times are the same."""
BLOCKED = ("wait", "skip", "detour")
NEWS = ("lost", "noticed", "announced", "found")
"""Events that are followed by a decision."""


def blocked_from(run: Run) -> float:
    """When a cell is blocked for the first time; infinity if none is."""
    return min((c.time for c in run.world.changes if not c.free), default=math.inf)


def problems(run: Run) -> Iterator[str]:
    """What is done for no reason, one line each; for runs that are right otherwise."""
    blocked = run.options.get("blocked", BLOCKED[0])
    if blocked not in BLOCKED:
        yield f"the option blocked is {blocked!r}, which should be one of {', '.join(BLOCKED)}"
    if run.policy == "keep" and run.decisions:
        yield "the policy keep decides nothing, and there are decisions"
    news = {event.time for event in run.events if event.what in NEWS}
    for decision in run.decisions:
        if decision.time not in news:
            yield f"there is no news at {decision.time:g}, when something is decided"
    first = blocked_from(run)
    robots = {robot.id for robot in run.plan.instance.robots}
    victims = {victim.id for victim in run.victims}
    for event in run.events:
        if event.what != "skipped":
            continue
        if event.robot not in robots or event.victim not in victims or event.kind or event.cell:
            yield f"what is left out at {event.time:g} is no visit of a robot to a victim"
        elif event.time < first:
            yield f"robot {event.robot} leaves out a visit at {event.time:g}, when nothing is blocked"
    if not run.world.changes and not run.decisions:
        planned = {route.robot: route.cells for route in run.plan.routes}
        for track in run.tracks:
            cells = planned.get(track.robot) or track.cells[:1]
            if tuple(track.cells) != tuple(cells[: len(track.cells)]):
                yield f"robot {track.robot} goes another way than the plan, for no reason"


def may_stop(run: Run, robot: int, victim: int, kinds: tuple[str, ...]) -> bool:
    """Whether a robot may never be done with a visit that it was told to make.

    It may if it was lost over it, at the latest on the next step or service that it would have
    finished; or if it may be waiting, or have waited, for a cell that was blocked.
    """
    is_blocked = not math.isinf(blocked_from(run))
    if is_blocked and run.options.get("blocked") == "wait":
        return True
    loss = next((loss.time for loss in run.world.lost if loss.robot == robot), None)
    if loss is None or is_blocked:
        return loss is not None
    track = next(track for track in run.tracks if track.robot == robot)
    step = 1 / next(drawn.speed for drawn in run.world.speeds if drawn.robot == robot)
    times = {(item.victim, item.kind): item.time for item in run.world.services}
    last = max(
        track.times[-1],
        *(s.ended for s in run.services if s.robot == robot),
        *(decision.time for decision in run.decisions if decision.time < loss),
        0.0,
    )
    longest = max(step, *(times[victim, kind] for kind in kinds))
    return loss <= (last + longest) * (1 + CLOSE)
