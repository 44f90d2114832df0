"""Whether robots keep to the limits of the plan in a run, as far as they can see to it.

How far they walk is known before, until a cell is blocked; how long they are busy, where besides
nothing takes longer than planned. Elsewhere a limit may be broken by what nobody could know.
"""

from __future__ import annotations

from collections.abc import Iterator

from .joint_problem import Limits, service_times
from .run_facts import Facts
from .run_orders import CLOSE, blocked_from, stopped_at


def problems(facts: Facts) -> Iterator[str]:
    """Where a robot is busy for too long, walks too far, or does not come back."""
    run, limits = facts.run, Limits.of(facts.run.plan)
    blocked = blocked_from(run)
    for robot, track in facts.tracks.items():
        moves = len(track.cells) - 1
        last = max(track.times[-1], *(s.ended for s in facts.serves[robot]), 0.0)
        if blocked <= last * (1 + CLOSE):
            continue
        busy = moves / facts.speed[robot] + sum(s.ended - s.began for s in facts.serves[robot])
        if limits.longest_walk is not None and moves > limits.longest_walk:
            yield f"robot {robot} walks {moves} cells, beyond {float(limits.longest_walk):g}"
        endurance = limits.endurance
        if endurance is not None and busy > float(endurance) * (1 + CLOSE) and _is_no_slower(facts):
            yield f"robot {robot} is busy for {busy:g}, beyond {float(endurance):g}"
        last = max([last, *(d.time for d in run.decisions if d.time < stopped_at(run, robot))])
        longest = max([1 / facts.speed[robot], *(item.time for item in run.world.services)])
        may_stop = min(stopped_at(run, robot), blocked) <= (last + longest) * (1 + CLOSE)
        if limits.returns and not may_stop and track.cells[-1] != facts.robots[robot].start:
            yield f"robot {robot} does not return to its start"


def _is_no_slower(facts: Facts) -> bool:
    """Whether no robot is slower than planned, and no service takes longer."""
    planned = service_times(facts.mission)
    return all(facts.speed[robot.id] >= robot.speed for robot in facts.mission.robots) and all(
        item.time <= planned[item.victim, item.kind]
        for item in facts.run.world.services
        if (item.victim, item.kind) in planned
    )
