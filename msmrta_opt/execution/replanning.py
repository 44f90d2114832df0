"""What is left of a mission as a joint problem of its own: for policies that decide anew.

Robots that are left start where they are free next; what is under way is committed and no part of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Bools, Floats
from ..mission.instance import Instance
from ..routing.objectives import Objective
from ..routing.problem import Routes, RoutingData
from ..stages.joint_routing import routing_data
from ..stages.situation import Situation
from .state import Queues, State, Task

Lists = list[list[tuple[int, tuple[int, ...]]]]


@dataclass(frozen=True, eq=False)
class Remaining:
    """What can still be served, by whom, and who was to do it.

    Parameters
    ----------
    state : State
        What is known.
    mission : Instance
        The robots that are left, and the victims with what is open of them.
    """

    state: State
    mission: Instance

    @classmethod
    def of(cls, state: State) -> Remaining | None:
        """The rest of a mission; ``None`` if nothing, or nobody, is left."""
        free = state.grid.free.copy()
        for robot in state.robots:  # who stands in a blocked cell may leave it
            free[robot.cell] = True
        here = {robot.robot: robot.cell for robot in state.robots}
        robots = tuple(
            robot.model_copy(update={"start": here[robot.id]})
            for robot in state.mission.robots
            if robot.id in here
        )
        victims = tuple(
            victim.model_copy(
                update={
                    "requirements": state.open[victim.id],
                    "service_time": {
                        kind: time
                        for kind, time in victim.service_time.items()
                        if kind in state.open[victim.id]
                    },
                }
            )
            for victim in state.mission.victims
            if victim.id in state.open and free[victim.cell]
        )
        if not (robots and victims):
            return None
        grid = replace(state.grid, free=free)
        return cls(
            state, state.mission.replace(map=grid, robots=robots, victims=victims, scouts=())
        )

    @cached_property
    def data(self) -> RoutingData:
        """The joint problem; ``planned`` says who was to visit whom."""
        given = routing_data(Situation.of(self.mission))
        planned = np.zeros((given.n_robots, given.n_victims), dtype=bool)
        for r, route in enumerate(self.kept_of(given.able)):
            planned[r, [v for v, _ in route]] = True
        return replace(given, planned=planned, ready=self.ready())

    def kept_of(self, able: Bools) -> Lists:
        """The visits that robots were to make and still can, ``able`` over (r, v, k)."""
        position = {victim.id: v for v, victim in enumerate(self.mission.victims)}
        number = {kind: k for k, kind in enumerate(self.mission.capabilities)}
        taken: set[tuple[int, int]] = set()
        routes: Lists = []
        for r, robot in enumerate(self.state.robots):
            visits: dict[int, list[int]] = {}
            for task in robot.queue:
                v = position.get(-1 if task.victim is None else task.victim)
                for kind in task.served if v is not None else ():
                    k = number[kind]
                    if v is not None and able[r, v, k] and (v, k) not in taken:
                        taken.add((v, k))
                        visits.setdefault(v, []).append(k)
            routes.append([(v, tuple(kinds)) for v, kinds in visits.items()])
        return routes

    def repaired(self) -> Routes:
        """The visits that robots were to make, and what nobody was to do where it adds least travel.

        Of all open requirements and robots that can serve them, the pair that adds the least comes
        first (ties: first robot, then first victim); the robot takes all that it can serve there.
        """
        data, routes = self.data, self.kept_of(self.data.able)
        left = data.required.copy()
        for route in routes:
            for v, kinds in route:
                left[v, list(kinds)] = False
        while left.any():
            offers = [
                (*cheapest(data, r, routes[r], int(v)), r, int(v))
                for r in range(data.n_robots)
                for v in np.flatnonzero(left.any(axis=1))
                if (data.able[r, v] & left[v]).any()
            ]
            _, place, r, v = min(offers, key=lambda offer: (offer[0], offer[2], offer[3]))
            kinds = tuple(int(k) for k in np.flatnonzero(data.able[r, v] & left[v]))
            left[v, list(kinds)] = False
            insert(routes[r], v, kinds, place)
        return tuple(tuple(route) for route in routes)

    def ready(self) -> Floats:
        """How long robots are under way still, in time units, ``(n_robots,)``."""
        return np.array([robot.free_at - self.state.time for robot in self.state.robots])

    def worth(self, objective: Objective, routes: Routes) -> float:
        """What routes are worth by an objective, from now on."""
        data = self.data
        if not objective.service_is_constant or objective.only_last or objective.of_victims:
            data = replace(data, leave=data.leave + self.ready()[:, None])
        return objective.value(data, routes)

    def changes(self, routes: Routes) -> int:
        """Visits that are taken from the robots that were to make them."""
        made = np.zeros_like(self.data.planned)
        for r, route in enumerate(routes):
            made[r, [v for v, _ in route]] = True
        return int(np.count_nonzero(self.data.planned & ~made))

    def queues(self, routes: Routes) -> Queues:
        """What robots are to do on `routes`; a visit that stays keeps its walk of the plan."""
        queues: dict[int, Sequence[Task]] = {}
        for robot, route in zip(self.state.robots, routes, strict=True):
            old = {(task.victim, task.served): task for task in robot.queue}
            tasks = []
            for v, kinds in route:
                victim = self.mission.victims[v].id
                served = tuple(self.mission.capabilities[k] for k in kinds)
                tasks.append(old.get((victim, served), Task(victim, served)))
            queues[robot.robot] = tasks
        return queues


def cheapest(
    data: RoutingData, robot: int, route: Sequence[tuple[int, tuple[int, ...]]], victim: int
) -> tuple[float, int]:
    """The least travel that a visit adds to a route, and its place; nothing where there is one."""
    victims = [v for v, _ in route]
    if victim in victims:
        return 0.0, victims.index(victim)
    best, place = np.inf, 0
    for i in range(len(victims) + 1):
        before = data.leave[robot, victim]
        if i:
            before = data.way(robot, victims[i - 1], victim)
        added = before
        if i < len(victims):
            after = victims[i]
            direct = data.way(robot, victims[i - 1], after) if i else data.leave[robot, after]
            added = before + data.way(robot, victim, after) - direct
        if added < best:
            best, place = float(added), i
    return best, place


def insert(
    route: list[tuple[int, tuple[int, ...]]], victim: int, kinds: tuple[int, ...], place: int
) -> None:
    """Serve `kinds` at a victim from a place of the route on, or on the visit that is there."""
    if place < len(route) and route[place][0] == victim:
        route[place] = (victim, (*route[place][1], *kinds))
    else:
        route.insert(place, (victim, kinds))


def towards(data: RoutingData, routes: Routes, old: Mapping[int, int]) -> list[Routes]:
    """From `routes`, step by step, to such in which robots make the visits that they were to make.

    In each step that visit goes back, whole, whose return costs least travel; no step depends on what a
    change is worth.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    routes : Routes
        Where to begin.
    old : mapping
        By victim the robot that was to visit it, for those with one visit that is whole.
    """
    now: Lists = [list(route) for route in routes]
    found: list[Routes] = []
    while True:
        offers = []
        for r, route in enumerate(now):
            for i, (v, kinds) in enumerate(route):
                to = old.get(v, r)
                if to == r or not data.able[to, v, list(kinds)].all():
                    continue
                rest = [*route[:i], *route[i + 1 :]]
                saved, _ = cheapest(data, r, rest, v)
                added, place = cheapest(data, to, now[to], v)
                offers.append((added - saved, r, i, to, place))
        if not offers:
            return found
        _, r, i, to, place = min(offers)
        v, kinds = now[r].pop(i)
        insert(now[to], v, kinds, place)
        found.append(tuple(tuple(route) for route in now))
