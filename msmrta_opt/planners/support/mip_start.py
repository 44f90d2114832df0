"""Any plan as a MIP start of the joint formulations: an incumbent before the first node."""

from __future__ import annotations

import numpy as np

from ...arrays import Floats
from ...mission.errors import InputError
from ...mission.plan import Plan, Route
from ...optimise.compile import compile_for
from ...optimise.registry import Formulation
from ...routing.problem import Routes, RoutingData, faults, times
from .improvement import routes_of


def mip_start(
    plan: Plan, data: RoutingData, formulation: str | Formulation = "joint_routing_flow"
) -> dict[str, Floats]:
    """The variables of `formulation` at `plan`, to be given to `solve` as its ``start``.

    Parameters
    ----------
    plan : Plan
        Any planner's. A robot's later visits to a victim are joined to its first, and visits for
        nothing are left out.
    data : RoutingData
        The joint problem of the mission that it is a plan for.
    formulation : str or Formulation
        One whose variables include ``x``, ``y`` and ``a``, as those of the stage ``routing`` are; of its
        other variables, those with names and shapes of the shipped ones get their values, too.

    Raises
    ------
    InputError
        If the plan does not fit the data, or the formulation is not of this kind.
    """
    known = plan.known
    sizes = (known.n_robots, known.n_victims, known.n_kinds)
    if sizes != data.able.shape:
        there, here = (
            f"{n} robots, {m} victims and {kinds} kinds" for n, m, kinds in (sizes, data.able.shape)
        )
        raise InputError(f"a plan for {there}, where the problem has {here}", field="start")
    given = {route.robot: route for route in plan.routes}
    every = tuple(given.get(robot.id, Route(robot=robot.id)) for robot in known.robots)
    routes = routes_of(plan.model_copy(update={"routes": every}))
    if wrong := faults(data, routes):
        raise InputError(f"the plan does not fit: {wrong[0]}", field="start")
    program = compile_for(formulation, data).program()
    values = _values(data, routes)
    return {
        block.name: values[block.name]
        for block in program.columns
        if block.name in values and values[block.name].shape == block.shape
    }


def _values(data: RoutingData, routes: Routes) -> dict[str, Floats]:
    """Every variable of the shipped joint formulations, by name; the start is the last place."""
    n, m, home = data.n_robots, data.n_victims, data.n_victims
    x, flow = np.zeros((n, m + 1, m)), np.zeros((n, m + 1, m))
    y, place, done = np.zeros((n, m)), np.zeros((n, m)), np.zeros((n, m))
    a = np.zeros(data.able.shape)
    for r, route in enumerate(routes):
        here, clock = home, 0.0
        for number, (v, kinds) in enumerate(route):
            travel = data.leave[r, v] if here == home else data.way(r, here, v)
            clock += travel + data.service[v, list(kinds)].sum()
            x[r, here, v], flow[r, here, v] = 1.0, len(route) - number
            y[r, v], place[r, v], done[r, v] = 1.0, number, clock
            a[r, v, list(kinds)] = 1.0
            here = v
    return {
        "x": x,
        "y": y,
        "a": a,
        "f": flow,
        "place": place,
        "done": done,
        "completion": done.max(axis=0, initial=0.0),
        "makespan": np.array(times(data, routes).busy.max(initial=0.0)),
    }
