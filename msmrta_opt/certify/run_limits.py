"""Whether robots keep to the limits of the plan in a run, as far as they can see to it.

How far they walk is known before, until a cell is blocked; how long they are busy, where besides
nothing takes longer than planned. Elsewhere a limit may be broken by what nobody could know.
"""

from __future__ import annotations

from collections.abc import Iterator

from .joint_problem import Limits, service_times
from .run_facts import Facts
from .run_orders import CLOSE, blocked_from, may_stand


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
        is_back = track.cells[-1] == facts.robots[robot].start
        services = (item.time for item in run.world.services)
        if limits.returns and not is_back and not may_stand(run, robot, services):
            yield f"robot {robot} does not return to its start"


def _is_no_slower(facts: Facts) -> bool:
    """Whether no robot is slower than planned, and no service takes longer."""
    planned = service_times(facts.mission)
    return all(facts.speed[robot.id] >= robot.speed for robot in facts.mission.robots) and all(
        item.time <= planned[item.victim, item.kind]
        for item in facts.run.world.services
        if (item.victim, item.kind) in planned
    )
