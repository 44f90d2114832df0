"""What is left of a mission as a joint problem of its own: for policies that decide anew.

Robots that are left start where they are free next; what is under way is committed and no part of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from ..arrays import Bools, Floats
from ..mission.grid import Cell
from ..mission.instance import Instance
from ..routing.objectives import Objective
from ..routing.problem import Routes, RoutingData
from ..stages.joint_routing import routing_data
from ..stages.situation import Situation
from .state import Queues, Situated, State, Task

List = list[tuple[int, tuple[int, ...]]]
Lists = list[List]


@dataclass(frozen=True, eq=False)
class Remaining:
    """What can still be served, by whom, and who was to do it.

    Parameters
    ----------
    state : State
        What is known.
    mission : Instance
        The robots that are left, and the victims with what is open of them.
    homes : sequence of cells
        Where each of these robots began.
    limits : mapping
        Those of the plan, by name; what a robot was busy and walked until now is used up.
    left_out : set of pairs
        Robots and victims that they have left out, to whom they do not go again.
    """

    state: State
    mission: Instance
    homes: Sequence[Cell]
    limits: Mapping[str, Any]
    left_out: Set[tuple[int, int]] = frozenset()

    @classmethod
    def of(
        cls, state: State, situated: Situated, left_out: Set[tuple[int, int]] = frozenset()
    ) -> Remaining | None:
        """The rest of a mission; ``None`` if nothing, or nobody, is left.

        Where robots wait before blocked cells, these are counted on to open.
        """
        free = state.grid.free.copy()
        if situated.options["blocked"] == "wait":
            free |= situated.plan.instance.map.free
        for robot in state.robots:  # who stands in a blocked cell may leave it
            free[robot.cell] = True
        here = {robot.robot: robot.cell for robot in state.robots}
        left = [robot for robot in state.mission.robots if robot.id in here]
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
        if not (left and victims):
            return None
        grid = replace(state.grid, free=free)
        robots = tuple(robot.model_copy(update={"start": here[robot.id]}) for robot in left)
        return cls(
            state,
            state.mission.replace(map=grid, robots=robots, victims=victims, scouts=()),
            [robot.start for robot in left],
            situated.plan.limits,
            left_out,
        )

    @cached_property
    def data(self) -> RoutingData:
        """The joint problem of what the repaired plan serves; ``planned``: who was to visit whom.

        Without limits that is all that can be served.
        """
        all_of_it = self._all
        served = np.zeros_like(all_of_it.required)
        for route in self.repaired():
            for v, kinds in route:
                served[v, list(kinds)] = True
        return replace(all_of_it, able=all_of_it.able & served[None])

    @cached_property
    def _all(self) -> RoutingData:
        given = routing_data(Situation.of(self.mission), homes=self.homes, **self._limits_left())
        able = given.able.copy()
        robots, victims = given.ids["r"], given.ids["v"]
        for robot, victim in self.left_out:
            if robot in robots and victim in victims:
                able[robots.index(robot), victims.index(victim)] = False
        planned = np.zeros((given.n_robots, given.n_victims), dtype=bool)
        for r, route in enumerate(self.kept_of(able)):
            planned[r, [v for v, _ in route]] = True
        return replace(given, able=able, planned=planned, ready=self.ready())

    def _limits_left(self) -> dict[str, Any]:
        used = {
            "endurance": [robot.busy for robot in self.state.robots],
            "longest_walk": [robot.walked for robot in self.state.robots],
        }
        return {
            name: np.maximum(limit - np.array(used[name]), 0.0) if name in used else limit
            for name, limit in self.limits.items()
        }

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
        """The visits that robots were to make, and what nobody was to do where it adds minimum travel.

        Of all open requirements and robots that can serve them, the pair that adds the least comes
        first (ties: first robot, then first victim); the robot takes all that it can serve there.
        No robot goes beyond its limits: the last of its visits are taken from it until it does not,
        and what fits nobody's is left out.
        """
        data = self._all
        routes = self.kept_of(data.able)
        for r, route in enumerate(routes):
            while not fits(data, r, route):
                route.pop()
        left = data.required.copy()
        for route in routes:
            for v, kinds in route:
                left[v, list(kinds)] = False
        while True:
            offers = []
            for r in range(data.n_robots):
                for v in np.flatnonzero((data.able[r] & left).any(axis=1)).tolist():
                    added, place = cheapest(data, r, routes[r], v)
                    kinds = self._fitting(r, v, routes[r], place, data.able[r, v] & left[v])
                    if kinds:
                        offers.append((added, r, v, place, kinds))
            if not offers:
                return tuple(tuple(route) for route in routes)
            _, r, v, place, kinds = min(offers, key=lambda offer: offer[:3])
            left[v, list(kinds)] = False
            insert(routes[r], v, kinds, place)

    def _fitting(
        self, robot: int, victim: int, route: List, place: int, wanted: Bools
    ) -> tuple[int, ...]:
        """As many of the kinds that are wanted, ``(n_kinds,)``, as fit within the robot's limits."""
        kinds = tuple(int(k) for k in np.flatnonzero(wanted))
        if not self.limits:
            return kinds
        taken: tuple[int, ...] = ()
        for k in kinds:
            tried = list(route)
            insert(tried, victim, (*taken, k), place)
            if fits(self._all, robot, tried):
                taken = (*taken, k)
        return taken

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
        for r, (robot, route) in enumerate(zip(self.state.robots, routes, strict=True)):
            old = {(task.victim, task.served): task for task in robot.queue}
            tasks: list[Task] = []
            last: int | None = None
            for v, kinds in route:
                victim = self.mission.victims[v].id
                served = tuple(self.mission.capabilities[k] for k in kinds)
                task = old.get((victim, served), Task(victim, served))
                if self.limits and len(task.cells) - 1 > self._moves(r, last, v):
                    task = Task(victim, served)
                tasks.append(task)
                last = v
            if self.limits.get("return_to_start") and (tasks or robot.cell != self.homes[r]):
                tasks.append(Task(None))
            queues[robot.robot] = tasks
        return queues

    def _moves(self, robot: int, last: int | None, victim: int) -> int:
        """How many cells it is from a victim, or from where a robot is, to the next."""
        data = self._all
        way = data.leave[robot, victim] if last is None else data.way(robot, last, victim)
        return round(float(way * data.speed[robot]))


def cheapest(
    data: RoutingData, robot: int, route: Sequence[tuple[int, tuple[int, ...]]], victim: int
) -> tuple[float, int]:
    """The minimum travel that a visit adds to a route, and its place; nothing where there is one."""
    victims = [v for v, _ in route]
    if victim in victims:
        return 0.0, victims.index(victim)
    best, place = np.inf, 0
    for i in range(len(victims) + 1):
        before = data.leave[robot, victim]
        if i:
            before = data.way(robot, victims[i - 1], victim)
        added = before + data.back[robot, victim]
        if i == len(victims) and i:
            added -= data.back[robot, victims[-1]]
        if i < len(victims):
            after = victims[i]
            direct = data.way(robot, victims[i - 1], after) if i else data.leave[robot, after]
            added = before + data.way(robot, victim, after) - direct
        if added < best:
            best, place = float(added), i
    return best, place


def fits(data: RoutingData, robot: int, route: Sequence[tuple[int, tuple[int, ...]]]) -> bool:
    """Whether a robot keeps to its limits on a route."""
    if not route:
        return True
    victims = [v for v, _ in route]
    travel = data.leave[robot, victims[0]] + data.back[robot, victims[-1]]
    travel += sum(data.way(robot, a, b) for a, b in pairwise(victims))
    busy = travel + sum(data.service[v, list(kinds)].sum() for v, kinds in route)
    return bool(travel <= data.longest_walk[robot] and busy <= data.endurance[robot])


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
