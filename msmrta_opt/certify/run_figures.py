"""What a run comes to, worked out again from its tracks, services, events and decisions."""

from __future__ import annotations

from collections import defaultdict

from ..mission.grid import GridMap
from ..mission.run import Run
from .walking import components


def figures(run: Run) -> dict[str, float]:
    """Every figure of a run, by name."""
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
    n_available = _available(run)
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


def _available(run: Run) -> int:
    """How many requirements a robot that has them could ever walk to, with all opened cells open."""
    mission = run.plan.instance
    free = mission.map.free.copy()
    for change in run.world.changes:
        if change.free:
            free[change.cell] = True
    part = components(GridMap(free))
    n = 0
    for victim in run.victims:
        near = [robot for robot in mission.robots if part[robot.start] == part[victim.cell]]
        n += sum(any(kind in robot.capabilities for robot in near) for kind in victim.requirements)
    return n
