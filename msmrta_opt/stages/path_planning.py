"""Path planning (Algorithm 1, Path-Planning): the cells that each robot walks, and its times.

The walks are those of A* with the distance from the goal as its heuristic (`GridMap.walks`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..mission.errors import CheckError
from ..mission.grid import Cell
from ..mission.instance import Instance
from ..mission.plan import Route, Visit
from .situation import Stop


def path_planning(instance: Instance, stops: Sequence[Stop]) -> tuple[Route, ...]:
    """The route of each robot through its stops, in their order.

    Stops without a victim are passed on the way to the next victim; those after a robot's last
    victim are not walked to, so a robot that serves nobody stays at its start.

    Raises
    ------
    CheckError
        If no walk leads from a stop to the next.
    """
    queues: list[list[Stop]] = [[] for _ in instance.robots]
    for stop in stops:
        queues[stop.robot].append(stop)
    starts: list[Cell] = []
    for robot, queue in zip(instance.robots, queues, strict=True):
        starts += [robot.start, *(stop.cell for stop in queue[:-1])][: len(queue)]
    walks = iter(instance.map.walks(starts, [stop.cell for queue in queues for stop in queue]))
    service = instance.service.tolist()
    return tuple(_route(instance, r, queue, walks, service) for r, queue in enumerate(queues))


def _route(
    instance: Instance,
    robot: int,
    stops: Sequence[Stop],
    walks: Iterator[list[Cell]],
    service: list[list[float]],
) -> Route:
    record = instance.robots[robot]
    visits: list[Visit] = []
    leg: list[Cell] = [record.start]
    clock = 0.0
    for stop in stops:
        walk = next(walks)
        if not walk:
            raise CheckError(f"robot {record.id}: no walk leads from {leg[-1]} to {stop.cell}")
        leg = [*leg, *walk[1:]] if len(leg) > 1 else walk
        if stop.victim is None:
            continue
        arrival = clock + (len(leg) - 1) / record.speed
        serving = 0.0
        for k in stop.kinds:
            serving += service[stop.victim][k]
        clock = arrival + serving
        # Nothing of it comes from outside, and the plan is checked.
        visits.append(
            Visit.model_construct(
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
