"""Ruin and recreate on arrays: the state of one search, and its compiled steps in blocks."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import count

import numpy as np

from ...arrays import Floats, Ints
from ..objectives import Objective
from ..parameters import HeuristicsParameters
from ..problem import Routes, RoutingData
from ..stop import StoppingCriterion
from .compiled_state import COMPLETION, FINISH, TRAVEL, Problem, Settings, State
from .compiled_steps import begin, steps

BLOCK = 64
"""Steps at one temperature, between two looks at the clock."""
INSERTION = {"travel": TRAVEL, "finish": FINISH, "completion": COMPLETION}


class CompiledSearch:
    """One search from `routes`; the same for the same seed and number of iterations."""

    def __init__(
        self,
        data: RoutingData,
        routes: Routes,
        objective: Objective,
        parameters: HeuristicsParameters,
        seed: int,
    ) -> None:
        self.parameters, self.n_shares = parameters, 1 if objective.only_last else data.n_robots
        required = np.argwhere(data.required)
        self.kind = required[:, 1].tolist()
        self.problem = _problem(data, required, parameters.neighbours)
        self.state = _state(self.problem, data, required, routes, seed)
        self.settings = Settings(
            INSERTION[objective.insertion],
            objective.only_last,
            objective.of_victims,
            parameters.average_removed,
            parameters.longest_string,
            float(parameters.blink),
            float(parameters.perturbed_steps),
            parameters.candidates,
        )
        begin(self.problem, self.state, self.settings)

    def run(self, stop: StoppingCriterion, improved: Callable[[float], None]) -> None:
        """Search until `stop`, over whose time and iterations the temperature falls."""
        scale = max(float(self.state.cost[0]) / self.n_shares, 1e-9)
        first = self.parameters.first_temperature
        fall = self.parameters.last_temperature / first
        seconds, iterations = stop.seconds_left(), stop.maximum_iterations
        for made in count(step=BLOCK):
            left = stop.seconds_left()
            if left <= 0.0 or made >= iterations:
                return
            spent = 1.0 - left / seconds if math.isfinite(seconds) else 0.0
            temperature = first * scale * fall ** max(spent, made / iterations)
            # Rounded, since the last digits of a power differ from machine to machine.
            block = int(min(BLOCK, iterations - made))
            steps(self.problem, self.state, self.settings, float(f"{temperature:.9g}"), block)
            improved(float(self.state.cost[1]))

    def best_routes(self) -> Routes:
        """The best routes found."""
        first, who = self.problem.first.tolist(), self.state.best_who.tolist()
        found = []
        for r, n in enumerate(self.state.best_length.tolist()):
            route = self.state.best_route[r, :n].tolist()
            own = ([g for g in range(first[v], first[v + 1]) if who[g] == r] for v in route)
            visits = zip(route, own, strict=True)
            found.append(tuple((v, tuple(self.kind[g] for g in needs)) for v, needs in visits))
        return tuple(found)


def _problem(data: RoutingData, required: Ints, neighbours: int) -> Problem:
    victim, kind = required.T
    needed = np.flatnonzero(np.bincount(victim, minlength=data.n_victims))
    able = np.ascontiguousarray(data.able[:, victim, kind].T)
    near = np.zeros((data.n_victims, min(neighbours, len(needed))), np.int64)
    for v, others in data.nearest_of(near.shape[1]).items():
        near[v] = others
        if v not in near[v]:  # many on one cell
            near[v, -1] = v
    return Problem(
        leave=_own(data.leave),
        back=_own(data.back),
        length=_own(data.length),
        speed=_own(data.speed),
        endurance=_own(data.endurance),
        longest_walk=_own(data.longest_walk),
        first=np.searchsorted(victim, np.arange(data.n_victims + 1)).astype(np.int64),
        victim=victim.astype(np.int64),
        service=data.service[victim, kind].astype(float),
        able=able,
        n_able=able.sum(axis=1).astype(np.int64),
        near=near,
        needed=needed.astype(np.int64),
        priority=_own(data.priority),
    )


def _own(array: Floats) -> Floats:
    """A copy that may be written to, as the kernels' signature has it."""
    return np.array(array, dtype=np.float64, order="C")


def _state(p: Problem, data: RoutingData, required: Ints, routes: Routes, seed: int) -> State:
    n, m, n_needs = data.n_robots, data.n_victims, len(required)
    place = {(v, k): g for g, (v, k) in enumerate(required.tolist())}

    def ints(*shape: int, fill: int = 0) -> Ints:
        return np.full(shape, fill, np.int64)

    route, length, who, at = ints(n, m), ints(n), ints(n_needs), ints(n, m, fill=-1)
    for r, visits in enumerate(routes):
        length[r] = len(visits)
        for i, (v, kinds) in enumerate(visits):
            route[r, i], at[r, v] = v, i
            for k in kinds:
                who[place[v, k]] = r
    return State(
        route=route,
        length=length,
        who=who,
        at=at,
        busy=np.zeros(n),
        travel=np.zeros(n),
        added=np.zeros((n, m)),
        place=ints(n, m),
        stamp=ints(n, m, fill=-1),
        version=ints(n),
        saved_route=ints(n, m),
        saved=ints(n, 2, fill=-1),
        saved_times=np.zeros((n, 2)),
        touched=ints(n),
        moved=ints(n_needs),
        moved_from=ints(n_needs),
        asked=ints(n),
        candidates=ints(n),
        done=np.zeros(m),
        completion=np.zeros(m),
        best_route=route.copy(),
        best_length=length.copy(),
        best_who=who.copy(),
        cost=np.zeros(2),
        counts=ints(4),
        random=np.array([seed], np.uint64),
    )
