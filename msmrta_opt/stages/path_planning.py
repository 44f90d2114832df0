"""Path planning (Algorithm 1, Path-Planning): the cells that each robot walks, by A*, and its times."""

from __future__ import annotations

from collections.abc import Sequence

from ..mission.grid import Cell
from ..mission.instance import Instance
from ..mission.plan import Route, Visit
from .situation import Stop


def path_planning(instance: Instance, stops: Sequence[Stop]) -> tuple[Route, ...]:
    """The route of each robot through its stops, in their order.

    Stops without a victim are passed on the way to the next victim; those after a robot's last
    victim are not walked to, so a robot that serves nobody stays at its start.
    """
    return tuple(
        _route(instance, r, [stop for stop in stops if stop.robot == r])
        for r in range(instance.n_robots)
    )


def _route(instance: Instance, robot: int, stops: Sequence[Stop]) -> Route:
    record = instance.robots[robot]
    visits: list[Visit] = []
    leg: list[Cell] = [record.start]
    clock = 0.0
    for stop in stops:
        leg.extend(instance.map.walk(leg[-1], stop.cell)[1:])
        if stop.victim is None:
            continue
        arrival = clock + (len(leg) - 1) / record.speed
        clock = arrival + float(instance.service[stop.victim, list(stop.kinds)].sum())
        visits.append(
            Visit(
                victim=instance.victims[stop.victim].id,
                served=tuple(instance.capabilities[k] for k in stop.kinds),
                stage=stop.stage,
                cells=tuple(leg),
                arrival=arrival,
                departure=clock,
            )
        )
        leg = [stop.cell]
    return Route(robot=record.id, visits=tuple(visits))
