"""What a run comes to, worked out again from its tracks, services, events and decisions."""

from __future__ import annotations

from collections import defaultdict

from ..mission.run import Run

_NEVER = ("no robot has it", "no capable robot can reach it")


def figures(run: Run) -> dict[str, float]:
    """Every figure of a run, by name."""
    plan = run.plan
    priority = {victim.id: victim.priority for victim in run.victims}
    last: dict[int, float] = {}
    n_served = 0
    lost_work = 0.0
    spent: dict[int, float] = defaultdict(float)
    done: dict[int, float] = {}
    for service in run.services:
        spent[service.robot] += service.ended - service.began
        done[service.robot] = max(done.get(service.robot, 0.0), service.ended)
        if service.done:
            n_served += 1
            last[service.victim] = max(last.get(service.victim, 0.0), service.ended)
        else:
            lost_work += service.ended - service.began
    waited = [event for event in run.events if event.what == "waiting"]
    for event in waited:
        if event.robot is not None:
            done[event.robot] = max(done.get(event.robot, 0.0), event.time)
    speed = {drawn.robot: drawn.speed for drawn in run.world.speeds}
    distance = 0
    for track in run.tracks:
        moves = len(track.cells) - 1
        distance += moves
        spent[track.robot] += moves / speed[track.robot]
        done[track.robot] = max(done.get(track.robot, 0.0), track.times[-1])
    own = {victim.id for victim in plan.instance.victims}
    capable = {kind for robot in plan.instance.robots for kind in robot.capabilities}
    n_available = sum(len(victim.requirements) for victim in plan.instance.victims)
    n_available -= sum(item.reason.value in _NEVER for item in plan.unserved)
    for victim in run.victims:
        if victim.id not in own:
            n_available += len([kind for kind in victim.requirements if kind in capable])
    busy = sum(spent.values())
    finished = sum(done.values())
    still = finished - busy
    return {
        "n_served": n_served,
        "n_available": n_available,
        "served_share": n_served / n_available if n_available else 1.0,
        "distance": distance,
        "total_time": busy,
        "makespan": max(done.values(), default=0.0),
        "latency": sum(priority[victim] * time for victim, time in last.items()),
        "stood_still": still if still > 1e-9 * finished else 0.0,
        "work_lost": lost_work,
        "still_waiting": len(waited),
        "robots_lost": sum(event.what == "lost" for event in run.events),
        "victims_turned_up": sum(e.what in ("announced", "found") for e in run.events),
        "replans": len(run.decisions),
        "changed_visits": sum(decision.changed for decision in run.decisions),
    }
