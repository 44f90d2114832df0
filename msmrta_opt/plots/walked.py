"""What a run came to, as a plan that pictures can draw."""

from __future__ import annotations

from bisect import bisect_right
from itertools import groupby

from ..mission.plan import Plan
from ..mission.route import Route, Visit
from ..mission.run import Run, Walked


def walked(run: Run) -> Plan:
    """What was done, as a plan that pictures can draw: robots at the speeds that they had.

    It keeps to no plan's rules: robots have waited, and served what they did not finish.
    """
    speeds = {drawn.robot: drawn.speed for drawn in run.world.speeds}
    mission = run.plan.instance.replace(
        victims=run.victims,
        robots=[r.model_copy(update={"speed": speeds[r.id]}) for r in run.plan.instance.robots],
    )
    # Not a copy of the plan, which would have the plan's figures with it.
    return Plan.model_construct(
        instance=mission,
        planner=run.policy,
        routes=tuple(_route(run, track) for track in run.tracks),
    )


def _route(run: Run, track: Walked) -> Route:
    own = sorted((s for s in run.services if s.robot == track.robot), key=lambda s: s.began)
    visits, here = [], 0
    for victim, found in groupby(own, key=lambda service: service.victim):
        services = list(found)
        there = bisect_right(track.times, services[0].began) - 1
        visits.append(
            Visit(
                victim=victim,
                served=tuple(service.kind for service in services if service.done),
                stage=run.policy,
                cells=track.cells[here : there + 1],
                arrival=services[0].began,
                departure=services[-1].ended,
            )
        )
        here = there
    rest = track.cells[here:]
    return Route(robot=track.robot, visits=tuple(visits), back=rest if len(rest) > 1 else ())
