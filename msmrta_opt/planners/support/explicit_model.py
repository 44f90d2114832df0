"""A plan's problem as an explicit model of the registry, solved again from the plan on.

Another program, of directed arcs and without cuts, for a second opinion on what branch and cut proved.
"""

from __future__ import annotations

from ...mission.plan import Plan
from ...optimise.solution import Solution
from ...optimise.solve import solve
from ...optimise.solvers import get
from ...routing.objectives import objective_of
from ...routing.problem import RoutingData
from ...stages.joint_routing import routing_data
from ...stages.situation import Situation
from .mip_start import mip_start


def problem_of(plan: Plan) -> RoutingData:
    """The joint problem that `plan` solves, with the limits that its options name."""
    return routing_data(Situation.of(plan.known), **plan.limits)


def solve_explicitly(
    plan: Plan, objective: str, *, solver: str | None = None, time_limit: float | None = None
) -> Solution:
    """The explicit model of the problem that `plan` solves, with the plan as MIP start.

    Parameters
    ----------
    plan : Plan
        One that passes its check.
    objective : str
        What to minimise; one of `routing.objectives.OBJECTIVES`.
    solver : str, optional
        Its name; HiGHS by default.
    time_limit : float, optional
        Seconds.
    """
    data = problem_of(plan)
    model, parameters = objective_of(objective).model
    name = solver or "highs"
    start = mip_start(plan, data, model) if "start" in get(name).abilities else None
    return solve(model, data, solver=name, time_limit=time_limit, start=start, **parameters)
