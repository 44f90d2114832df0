"""The exact planner beside general solvers: total time, the same missions, the same seconds.

    python benchmarks/rivals.py [--missions 10] [--seconds 60] [--sizes 4x20 10x50 10x100]
                                [--only exact PyVRP …]

OR-Tools' routing library, PyVRP (`pip install pyvrp`), and CP-SAT on the arc model, as far as each can
state the problem, which each says for itself below. One thread and one process each, one at a time;
stating the problem counts, importing a library does not. Whatever a solver says its routes cost, it
is turned into routes here, and checked and valued as such; nobody's own cost counts.

For each: the value over the best of all, and the gap to the greatest bound that anyone proved, median
and worst; where a solver proves a bound, its own gap too.

Service times add up to the same whoever serves, so that only travel is minimised, as whole multiples
of its step. Of two requirements of a victim the one that more robots can serve costs nothing: whoever
serves the other takes it along. So vehicle routing gets only the least flexible ones, one client each,
without loss; `Clients` puts the others back. Clients of one victim are no travel apart.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from exact import mission
from numpy.typing import NDArray

from msmrta_opt.isolation import Failure, Limits, run_isolated
from msmrta_opt.routing.objective_step import objective_step
from msmrta_opt.routing.objectives import OBJECTIVES
from msmrta_opt.routing.problem import Routes, RoutingData, faults
from msmrta_opt.routing.stop import relative_gap
from msmrta_opt.stages.joint_routing import routing_data
from msmrta_opt.stages.situation import Situation

Ints = NDArray[np.int64]
TOTAL_TIME = OBJECTIVES["total_time"]

FINEST = 1e-3
"""Time units in place of a step, where travel times have none."""
OURS = "exact"
NEEDS = {"OR-Tools routing": "ortools", "PyVRP": "pyvrp", "CP-SAT": "ortools"}
GRACE = 300.0
"""Seconds past the limit after which a run is killed."""


@dataclass(frozen=True)
class Found:
    """What a solver says of a problem."""

    routes: Routes | None
    bound: float | None
    """On total time, for solvers that have one."""
    seconds: float
    """Spent, on stating the problem too."""


@dataclass(frozen=True, eq=False)
class Clients:
    """Vehicle routing: clients, each to be visited once by a vehicle that may."""

    data: RoutingData

    @cached_property
    def step(self) -> float:
        """Time units of one unit of travel."""
        return objective_step(self.data, TOTAL_TIME).step or FINEST

    @cached_property
    def clients(self) -> list[tuple[int, int]]:
        """Victims and kinds that are not served along with another of the same victim."""
        chosen: list[tuple[int, int]] = []
        for v in range(self.data.n_victims):
            kinds = np.flatnonzero(self.data.required[v])
            able = {int(k): set(np.flatnonzero(self.data.able[:, v, k])) for k in kinds}
            fewest: list[int] = []
            for k in sorted(able, key=lambda k: (len(able[k]), k)):
                if not any(able[other] <= able[k] for other in fewest):
                    fewest.append(k)
            chosen += [(v, k) for k in fewest]
        return chosen

    @cached_property
    def victims(self) -> Ints:
        """Of the clients, ``(n_clients,)``."""
        return np.array([v for v, _ in self.clients], dtype=np.int64)

    def may(self, r: int) -> Ints:
        """The clients that robot r may visit."""
        return np.array(
            [c for c, (v, k) in enumerate(self.clients) if self.data.able[r, v, k]], int
        )

    def travel(self, r: int) -> Ints:
        """Of robot r from client to client, then from its start and back to it.

        Shape ``(n_clients + 1, n_clients + 1)``; 0 where it cannot walk.
        """
        n, at = len(self.clients), self.victims
        whole = np.zeros((n + 1, n + 1))
        whole[:n, :n] = self.data.between[r][np.ix_(at, at)]
        whole[n, :n] = self.data.leave[r, at]
        whole[:n, n] = self.data.back[r, at]
        return np.rint(whole / self.step).astype(np.int64)

    def routes(self, tours: Sequence[Sequence[int]]) -> Routes:
        """Ours, of each robot's clients in order, with what it serves along with them."""
        served: list[dict[int, list[int]]] = []
        for tour in tours:
            visits: dict[int, list[int]] = {}
            for client in tour:
                v, k = self.clients[client]
                visits.setdefault(v, []).append(k)
            served.append(visits)
        for v, k in np.argwhere(self.data.required):
            if (v, k) not in self.clients:
                there = [r for r, visits in enumerate(served) if v in visits]
                taker = next((r for r in there if self.data.able[r, v, k]), None)
                if taker is not None:
                    served[taker][int(v)].append(int(k))
        return tuple(tuple((v, tuple(kinds)) for v, kinds in one.items()) for one in served)


def routing(data: RoutingData, seconds: float) -> Found:
    """OR-Tools' routing library: guided local search from parallel cheapest insertion.

    It states the whole problem: starts of their own, a common end that is no travel away where routes
    are open, travel times by vehicle, and vehicles allowed by client. It proves no bound.
    """
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    began = time.monotonic()
    problem = Clients(data)
    n, n_robots = len(problem.clients), data.n_robots
    starts, end = list(range(n, n + n_robots)), n + n_robots
    manager = pywrapcp.RoutingIndexManager(end + 1, n_robots, starts, [end] * n_robots)
    model = pywrapcp.RoutingModel(manager)
    for r in range(n_robots):
        travel = problem.travel(r)
        matrix = np.zeros((end + 1, end + 1), dtype=np.int64)
        matrix[:n, :n] = travel[:n, :n]
        matrix[n + r, :n], matrix[:n, end] = travel[n, :n], travel[:n, n]
        model.SetArcCostEvaluatorOfVehicle(model.RegisterTransitMatrix(matrix.tolist()), r)
    may = [set(problem.may(r)) for r in range(n_robots)]
    for client in range(n):
        allowed = [r for r in range(n_robots) if client in may[r]]
        model.VehicleVar(manager.NodeToIndex(client)).SetValues(allowed)
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = (
        routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
    )
    parameters.local_search_metaheuristic = (
        routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    )
    left = max(seconds - (time.monotonic() - began), 0.0)
    parameters.time_limit.FromMilliseconds(int(1000 * left))
    found = model.SolveWithParameters(parameters)
    if found is None:
        return Found(None, None, time.monotonic() - began)
    tours = []
    for r in range(n_robots):
        tour, index = [], found.Value(model.NextVar(model.Start(r)))
        while not model.IsEnd(index):
            tour.append(manager.IndexToNode(index))
            index = found.Value(model.NextVar(index))
        tours.append(tour)
    return Found(problem.routes(tours), None, time.monotonic() - began)


def pyvrp(data: RoutingData, seconds: float) -> Found:
    """PyVRP: hybrid genetic or iterated local search, by its version.

    It knows no skills: each vehicle has a profile of its own, in which the way to a client that it may
    not visit is longer than all travel of any solution. It knows no open routes: all end at one depot,
    no travel away where they are open. It proves no bound.
    """
    library = importlib.import_module("pyvrp")
    began = time.monotonic()
    problem = Clients(data)
    n, n_robots = len(problem.clients), data.n_robots
    end = n + n_robots
    longest = max(int(problem.travel(r).max(initial=0)) for r in range(n_robots))
    forbidden = 1 + longest * (n + n_robots)
    matrices = []
    for r in range(n_robots):
        travel = problem.travel(r)
        banned = np.setdiff1d(np.arange(n), problem.may(r))
        matrix = np.zeros((end + 1, end + 1), dtype=np.int64)
        matrix[:n, :n] = travel[:n, :n]
        matrix[n:, :n], matrix[:n, end] = travel[n, :n], travel[:n, n]
        matrix[:, banned] = forbidden
        np.fill_diagonal(matrix, 0)
        matrices.append(matrix)
    stated = library.ProblemData(
        locations=[library.Location(0, 0) for _ in range(end + 1)],
        clients=[library.Client(location=client) for client in range(n)],
        depots=[library.Depot(location=place) for place in range(n, end + 1)],
        vehicle_types=[
            library.VehicleType(start_depot=r, end_depot=n_robots, profile=r)
            for r in range(n_robots)
        ],
        distance_matrices=matrices,
        duration_matrices=[np.zeros_like(matrix) for matrix in matrices],
    )
    left = max(seconds - (time.monotonic() - began), 0.0)
    best = library.solve(stated, stop=library.stop.MaxRuntime(left), collect_stats=False).best
    tours: list[list[int]] = [[] for _ in range(n_robots)]
    for route in best.routes():
        tours[route.vehicle_type()] += [step.idx for step in route if step.is_client()]
    return Found(problem.routes(tours), None, time.monotonic() - began)


def cp_sat(data: RoutingData, seconds: float) -> Found:
    """CP-SAT on the arc model: a circuit a robot, its start and the victims that it visits.

    It states the whole problem, and proves a bound.
    """
    from ortools.sat.python import cp_model

    began = time.monotonic()
    step = objective_step(data, TOTAL_TIME).step or FINEST
    model = cp_model.CpModel()
    served: dict[tuple[int, int], list[Any]] = {}
    cost: list[tuple[int, Any]] = []
    arcs: list[list[tuple[int, int, Any]]] = []
    for r in range(data.n_robots):
        # Node 0 is the start, v + 1 a victim; a loop leaves it out.
        victims = [int(v) for v in np.flatnonzero(data.can_visit[r])]
        idle = model.new_bool_var("")
        own = [(0, 0, idle)]
        for v in victims:
            out = model.new_bool_var("")
            own.append((v + 1, v + 1, out))
            model.add_implication(idle, out)
            ways = [(0, v + 1, data.leave[r, v]), (v + 1, 0, data.back[r, v])]
            ways += [(u + 1, v + 1, data.between[r, u, v]) for u in victims if u != v]
            for tail, head, travel in ways:
                literal = model.new_bool_var("")
                own.append((tail, head, literal))
                cost.append((round(travel / step), literal))
            for k in (int(k) for k in np.flatnonzero(data.able[r, v])):
                here = model.new_bool_var("")
                model.add_implication(here, out.negated())
                served.setdefault((v, k), []).append((r, here))
        model.add_circuit(own)
        arcs.append(own)
    for choices in served.values():
        model.add_exactly_one(literal for _, literal in choices)
    model.minimize(
        cp_model.LinearExpr.weighted_sum([one for _, one in cost], [weight for weight, _ in cost])
    )
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_time_in_seconds = max(seconds - (time.monotonic() - began), 0.1)
    status = solver.solve(model)
    spent = time.monotonic() - began
    bound = None
    if objective_step(data, TOTAL_TIME).step and math.isfinite(solver.best_objective_bound):
        # Without a step, travel is rounded, and so would the bound be.
        bound = data.total_service + step * max(solver.best_objective_bound, 0.0)
    if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return Found(None, bound, spent)
    kinds: dict[tuple[int, int], list[int]] = {}
    for (v, k), choices in served.items():
        for r, literal in choices:
            if solver.boolean_value(literal):
                kinds.setdefault((r, v), []).append(k)
    routes = []
    for r, own in enumerate(arcs):
        onward = {
            tail: head for tail, head, one in own if tail != head and solver.boolean_value(one)
        }
        order, place = [], onward.get(0, 0)
        while place:
            order.append(int(place) - 1)
            place = onward[place]
        # A visit for nothing costs no travel at best: leaving it out is never worse.
        routes.append(tuple((v, tuple(kinds[r, v])) for v in order if (r, v) in kinds))
    return Found(tuple(routes), bound, spent)


RIVALS: dict[str, Callable[[RoutingData, float], Found]] = {
    "OR-Tools routing": routing,
    "PyVRP": pyvrp,
    "CP-SAT": cp_sat,
}
"""By name; each takes the problem and the seconds that it may spend."""


@dataclass(frozen=True)
class Judged:
    """A solution, checked and valued here."""

    value: float | None
    bound: float | None
    seconds: float
    failure: str = ""


@cache
def problem(size: str, number: int) -> RoutingData:
    """The joint problem of a mission."""
    return routing_data(Situation.of(mission(size, number)))


def call(name: str, size: str, number: int, seconds: float) -> Found:
    """By that solver, for a process of its own: OR-Tools and highspy cannot share one."""
    if name != OURS:
        return RIVALS[name](problem(size, number), seconds)
    from msmrta_opt.planners import plan, planners
    from msmrta_opt.planners.support.improvement import routes_of

    planners()  # imports them
    began = time.monotonic()
    made = plan(mission(size, number), planner="exact", time_limit=seconds)
    spent = time.monotonic() - began
    return Found(routes_of(made), made.certificates[0].bound, spent)


def judged(data: RoutingData, given: Found | Failure) -> Judged:
    """What the solution is worth, by our own reckoning; nothing if it is not feasible."""
    if isinstance(given, Failure):
        return Judged(None, None, 0.0, f"{given.reason}: {given.message}")
    if given.routes is None:
        return Judged(None, given.bound, given.seconds, "no solution")
    if wrong := faults(data, given.routes):
        return Judged(None, given.bound, given.seconds, f"not feasible: {wrong[0]}")
    return Judged(TOTAL_TIME.value(data, given.routes), given.bound, given.seconds)


def table(runs: Sequence[dict[str, Judged]]) -> Iterator[str]:
    """A line for each solver; a run is what all of them say of one mission."""
    for name in runs[0]:
        ratios, open_, own, ended = [], [], [], []
        for run in runs:
            one = run[name]
            ended.append(one.seconds)
            if one.value is None:
                continue
            bound = max((j.bound for j in run.values() if j.bound is not None), default=0.0)
            ratios.append(one.value / min(j.value for j in run.values() if j.value is not None))
            open_.append(relative_gap(one.value, bound))
            if one.bound is not None:
                own.append(relative_gap(one.value, one.bound))
        cells = [f"{len(ratios)} of {len(runs)} solved"]
        if ratios:
            cells.append(f"value/best {statistics.median(ratios):.4f} ({max(ratios):.4f})")
            cells.append(f"gap to the best bound {statistics.median(open_):.2%} ({max(open_):.2%})")
        if own:
            cells.append(f"to its own {statistics.median(own):.2%} ({max(own):.2%})")
        cells.append(f"{statistics.median(ended):.1f} s")
        yield f"  {name:17s}" + "; ".join(cells)


def main() -> None:
    # Another process finds the function by its module's name, which here is not the script's.
    from rivals import call

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--missions", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--sizes", nargs="+", default=["4x20", "10x50", "10x100"])
    parser.add_argument("--only", nargs="+", default=[OURS, *RIVALS], choices=[OURS, *RIVALS])
    arguments = parser.parse_args()
    names = []
    for name in arguments.only:
        if name in NEEDS and importlib.util.find_spec(NEEDS[name]) is None:
            print(f"{name} is left out: pip install {NEEDS[name]}")
        else:
            names.append(name)
    for size in arguments.sizes:
        numbers = range(arguments.missions)
        calls = [(name, size, number, arguments.seconds) for number in numbers for name in names]
        runs: list[dict[str, Judged]] = [{} for _ in numbers]
        results = run_isolated(call, calls, limits=Limits(arguments.seconds + GRACE))
        for index, given in results:
            name, _, number, _ = calls[index]
            runs[number][name] = one = judged(problem(size, number), given)
            said = one.failure or f"{one.value:.6g}"
            bound = "" if one.bound is None else f", bound {one.bound:.6g}"
            print(
                f"{size} mission {number}, {name}: {said}{bound}, {one.seconds:.1f} s", flush=True
            )
        print(f"{size}, {arguments.seconds:g} s: median (worst) of {arguments.missions} missions")
        for line in table(runs):
            print(line, flush=True)


if __name__ == "__main__":
    main()
