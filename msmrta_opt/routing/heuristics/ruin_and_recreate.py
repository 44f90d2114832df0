"""Local search on routes and on who serves what: ruin and recreate under simulated annealing.

A step takes strings of consecutive visits out of routes that lie close together, and puts their
requirements back one by one where they cost least, whoever can serve them; so relocations, swaps,
or-opt moves and reassignments of requirements, and splits of victims over robots, are all special cases
of one move. Worse routes are accepted with a probability that falls as the search goes on.

Source: Christiaens and Vanden Berghe, *Slack induction by string removals for vehicle routing problems*
(2020); the requirements and the splitting of victims are ours.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable
from itertools import count
from typing import Protocol

import numpy as np

from ...mission.errors import InputError
from ..objectives import DEFAULT, Objective, objective_of
from ..parameters import HeuristicsParameters
from ..problem import SUMS, Routes, RoutingData, faults
from ..stop import MaximumIterations, StoppingCriterion

TELL_SECONDS = 0.1
"""Between two tellings of better routes."""


def ruin_and_recreate(
    data: RoutingData,
    routes: Routes,
    objective: str | Objective = DEFAULT,
    *,
    stop: StoppingCriterion | None = None,
    seed: int = 0,
    parameters: HeuristicsParameters | None = None,
    improved: Callable[[Routes], object] | None = None,
) -> Routes:
    """Routes at least as good as `routes`, by local search.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    routes : Routes
        Feasible routes to begin with.
    objective : str or Objective
        What to minimise; one of `objectives.OBJECTIVES`.
    stop : StoppingCriterion, optional
        When to end. With a maximum of iterations the same seed gives the same routes; with a maximum
        runtime they depend on the machine's speed. By default a fixed number of iterations.
    seed : int
        Of all random choices.
    parameters : HeuristicsParameters, optional
        How to search.
    improved : callable, optional
        Given better routes while the search goes on, at most every `TELL_SECONDS`.

    Raises
    ------
    InputError
        If `routes` are not feasible, or there is no such objective.
    """
    aim = objective_of(objective)
    if wrong := faults(data, routes):
        raise InputError(f"these routes cannot be improved: {wrong[0]}", field="routes")
    if not data.required.any():
        return routes
    parameters = parameters or HeuristicsParameters()
    search = _search(data, routes, aim, parameters, seed)
    best, told = math.inf, -math.inf

    def tell(cost: float) -> None:
        nonlocal best, told
        if improved is None or cost >= best or time.monotonic() < told + TELL_SECONDS:
            return
        improved(search.best_routes())
        best, told = cost, time.monotonic()

    search.run(stop or MaximumIterations(parameters.default_iterations), tell)
    found = search.best_routes()
    # Sums are taken in another order here than there: equal routes are no improvement.
    better = aim.value(data, found) < aim.value(data, routes) * (1.0 - SUMS)
    return found if better else routes


class Search(Protocol):
    """A search that has been begun."""

    def run(self, stop: StoppingCriterion, improved: Callable[[float], None]) -> None:
        """Search until `stop`; what the best routes cost is told now and then."""

    def best_routes(self) -> Routes:
        """The best routes found."""


def _search(
    data: RoutingData, routes: Routes, aim: Objective, parameters: HeuristicsParameters, seed: int
) -> Search:
    """The compiled search, where numba is there and it knows the objective."""
    if aim.is_compiled:
        try:
            from .compiled_search import CompiledSearch
        except ImportError:
            pass
        else:
            return CompiledSearch(data, routes, aim, parameters, seed)
    return _Search(data, routes, aim, parameters, random.Random(seed))


class _Search:
    """The state of one search. Routes hold victims; `who` the robot of each requirement.

    While a requirement is taken out, its robot is -1.
    """

    def __init__(
        self,
        data: RoutingData,
        routes: Routes,
        objective: Objective,
        parameters: HeuristicsParameters,
        rng: random.Random,
    ) -> None:
        self.data, self.objective, self.parameters, self.rng = data, objective, parameters, rng
        # Read once per place looked at.
        self.blink = parameters.blink
        required = [(int(v), int(k)) for v, k in np.argwhere(data.required)]
        place = {need: g for g, need in enumerate(required)}
        self.victim = [v for v, _ in required]
        self.kind = [k for _, k in required]
        self.needs: list[list[int]] = [[] for _ in range(data.n_victims)]
        for g, v in enumerate(self.victim):
            self.needs[v].append(g)
        self.service = [float(data.service[v, k]) for v, k in required]
        self.able = [[int(r) for r in np.flatnonzero(data.able[:, v, k])] for v, k in required]
        # Plain lists: reading single numbers from numpy arrays is several times slower.
        self.leave: list[list[float]] = data.leave.tolist()
        self.between: list[list[list[float]]] = data.between.tolist()
        self.back: list[list[float]] = data.back.tolist()
        self.endurance = (data.endurance * (1.0 + SUMS)).tolist()
        self.longest_walk = (data.longest_walk * (1.0 + SUMS)).tolist()
        self.priority = data.priority.tolist()
        self.near: dict[int, list[int]] = {v: near.tolist() for v, near in data.nearest.items()}
        self.needed = sorted(self.near)

        self.routes = [[v for v, _ in route] for route in routes]
        self.who = [0] * len(required)
        for r, route in enumerate(routes):
            for v, kinds in route:
                for k in kinds:
                    self.who[place[v, k]] = r
        self.busy = [self._busy(r) for r in range(data.n_robots)]
        """Time and travel of each robot on its route."""
        self.nearest: list[dict[int, tuple[float, int]]] = [{} for _ in routes]
        """For each robot and victim, on its route as it is: the travel that it adds, and the place."""
        self.cost = self._cost()
        self.best = (self.cost, list(self.routes), list(self.who))

    def run(self, stop: StoppingCriterion, improved: Callable[[float], None]) -> None:
        """Search until `stop`, over whose time and iterations the temperature falls."""
        n_shares = 1 if self.objective.only_last else self.data.n_robots
        scale = self.cost / n_shares
        first = self.parameters.first_temperature
        fall = self.parameters.last_temperature / first
        seconds, iterations = stop.seconds_left(), stop.maximum_iterations
        spent = 0.0
        for step in count():
            if step % 64 == 0:
                improved(self.best[0])
                left = stop.seconds_left()
                if left <= 0.0:
                    return
                spent = 1.0 - left / seconds if math.isfinite(seconds) else 0.0
            if step >= iterations:
                return
            self._step(first * scale * fall ** max(spent, step / iterations))

    def best_routes(self) -> Routes:
        """The best routes found."""
        _, routes, who = self.best
        return tuple(
            tuple((v, tuple(self.kind[g] for g in self.needs[v] if who[g] == r)) for v in route)
            for r, route in enumerate(routes)
        )

    def _step(self, temperature: float) -> None:
        before = list(self.routes), list(self.who), list(self.busy), list(self.nearest)
        whole = self._recreate(self._ruin())
        cost = self._cost() if whole else math.inf
        if cost >= self.cost - temperature * math.log(self.rng.random() or 1e-12):
            self.routes, self.who, self.busy, self.nearest = before
            return
        self.cost = cost
        if cost < self.best[0] * (1.0 - SUMS):
            self.best = (cost, list(self.routes), list(self.who))

    def _ruin(self) -> list[int]:
        """Take out strings of visits around a random victim; returns their requirements."""
        rng, routes, parameters = self.rng, self.routes, self.parameters
        used = [route for route in routes if route]
        mean = sum(map(len, used)) / len(used)
        longest = max(1.0, min(parameters.longest_string, mean))
        n_strings = int(rng.random() * (4 * parameters.average_removed / (1 + longest))) + 1
        removed: list[int] = []
        ruined: set[int] = set()
        for v in self.near[rng.choice(self.needed)]:
            if len(ruined) >= n_strings:
                break
            for r in {self.who[g] for g in self.needs[v]} - ruined:
                route = routes[r]
                if v not in route:
                    continue
                length = int(rng.random() * min(longest, len(route))) + 1
                at = route.index(v)
                low = max(0, at - length + 1)
                start = rng.randint(low, min(at, len(route) - length))
                for w in route[start : start + length]:
                    removed += [g for g in self.needs[w] if self.who[g] == r]
                self._reroute(r, route[:start] + route[start + length :])
                ruined.add(r)
        for g in removed:
            self.who[g] = -1
        for r in ruined:
            self.busy[r] = self._busy(r)
        return removed

    def _reroute(self, r: int, route: list[int]) -> None:
        """Give robot `r` another route; `busy` is up to the caller."""
        self.routes[r] = route
        self.nearest[r] = {}

    def _recreate(self, removed: list[int]) -> bool:
        """Put requirements back, each where it costs least; whether all of them could be."""
        rng = self.rng
        order = rng.random()
        if order < 0.5:
            rng.shuffle(removed)
        elif order < 0.8:
            removed.sort(key=lambda g: len(self.able[g]))
        else:
            removed.sort(key=lambda g: -self.service[g])
        share = self.parameters.perturbed_steps
        perturbed = rng.random() < share
        busy = self.busy
        for g in removed:
            v = self.victim[g]
            best, choice = math.inf, (-1, -1, 0.0)
            for r in self.able[g]:
                delay, added, at = self._insertion(r, g)
                total, walk = busy[r][0] + added + self.service[g], busy[r][1] + added
                if total > self.endurance[r] or walk > self.longest_walk[r]:
                    continue
                cost = total + added if self.objective.insertion == "finish" else delay
                if perturbed and rng.random() < share:
                    cost *= rng.random()
                if cost < best:
                    best, choice = cost, (r, at, added)
            r, at, added = choice
            if r < 0:
                return False
            busy[r] = busy[r][0] + added + self.service[g], busy[r][1] + added
            if at >= 0:
                self._reroute(r, [*self.routes[r][:at], v, *self.routes[r][at:]])
            self.who[g] = r
        return True

    def _insertion(self, r: int, g: int) -> tuple[float, float, int]:
        """The cost of serving `g` by `r`, the added travel, and the place.

        The place is -1 where r visits the victim already. The cost is the added travel, or by how
        much weighted completion times grow, as the objective says.
        """
        v, route = self.victim[g], self.routes[r]
        if self.objective.insertion == "completion":
            return self._soonest(r, g)
        if v in route:
            return 0.0, 0.0, -1
        known = self.nearest[r].get(v)
        if known is None:
            place = self._nearest(r, v)
            known = self.nearest[r][v] = self._added(r, v, place), place
        added, place = known
        return added, added, place

    def _nearest(self, r: int, v: int) -> int:
        """The place at which visiting `v` adds the smallest travel."""
        route = self.routes[r]
        if not route:
            return 0
        to_v = self.between[r][v]
        leave, blink = self.leave[r], self.rng.random
        first = route[0]
        best, place = leave[v] + to_v[first] - leave[first], 0
        before = first
        for i in range(1, len(route)):
            after = route[i]
            added = to_v[before] + to_v[after] - self.between[r][before][after]
            if added < best and blink() > self.blink:
                best, place = added, i
            before = after
        back = self.back[r]
        if to_v[before] + back[v] - back[before] < best:
            place = len(route)
        return place

    def _soonest(self, r: int, g: int) -> tuple[float, float, int]:
        """As `_insertion`, at the place that adds the minimum to weighted completion times.

        Victims that r visits later are taken to complete with its visit, even where another robot
        completes them: the true cost is found when all is put back.
        """
        v, route, service = self.victim[g], self.routes[r], self.service[g]
        done = self._done(r)
        weight = sum(self.priority[w] for w in route)
        elsewhere = max(
            (self._done(q)[self.routes[q].index(v)] for q in self._others(v, r)), default=0.0
        )
        best, place, travel = math.inf, len(route), 0.0
        for i, w in enumerate((*route, -1)):
            if w == v:
                return service * weight, 0.0, -1
            added = self._added(r, v, i)
            leave = self.between[r][route[i - 1]][v] if i else self.leave[r][v]
            own = (done[i - 1] if i else 0.0) + leave + service
            cost = self.priority[v] * max(own - elsewhere, 0.0) + (added + service) * weight
            if cost < best and (w < 0 or self.rng.random() > self.blink):
                best, place, travel = cost, i, added
            weight -= self.priority[w] if w >= 0 else 0.0
        return best, travel, place

    def _added(self, r: int, v: int, place: int) -> float:
        """The travel that visiting `v` at `place` adds."""
        route, between = self.routes[r], self.between[r]
        if not route:
            return self.leave[r][v] + self.back[r][v]
        if place == 0:
            return self.leave[r][v] + between[v][route[0]] - self.leave[r][route[0]]
        before = route[place - 1]
        if place == len(route):
            return between[before][v] + self.back[r][v] - self.back[r][before]
        after = route[place]
        return between[before][v] + between[v][after] - between[before][after]

    def _others(self, v: int, r: int) -> set[int]:
        """The other robots that serve `v`."""
        return {self.who[g] for g in self.needs[v]} - {r, -1}

    def _done(self, r: int) -> list[float]:
        """When each visit of robot `r` is done."""
        clock, last = 0.0, -1
        done = []
        for v in self.routes[r]:
            clock += self.leave[r][v] if last < 0 else self.between[r][last][v]
            for g in self.needs[v]:
                if self.who[g] == r:
                    clock += self.service[g]
            done.append(clock)
            last = v
        return done

    def _busy(self, r: int) -> tuple[float, float]:
        """Time and travel of robot `r` on its route."""
        route = self.routes[r]
        if not route:
            return 0.0, 0.0
        between = self.between[r]
        travel = self.leave[r][route[0]] + self.back[r][route[-1]]
        for i in range(len(route) - 1):
            travel += between[route[i]][route[i + 1]]
        service = 0.0
        for v in route:
            for g in self.needs[v]:
                if self.who[g] == r:
                    service += self.service[g]
        return travel + service, travel

    def _cost(self) -> float:
        busy = [total for total, _ in self.busy]
        completion = self._completion() if self.objective.of_victims else []
        worth = self.objective.of_times(busy, completion, self.priority)
        # Among equal makespans the smallest total leads on: a flat objective has no slope.
        return worth + 1e-4 * sum(busy) if self.objective.only_last else worth

    def _completion(self) -> list[float]:
        """When each victim is complete."""
        completion = [0.0] * self.data.n_victims
        for r, route in enumerate(self.routes):
            for v, clock in zip(route, self._done(r), strict=True):
                completion[v] = max(completion[v], clock)
        return completion
