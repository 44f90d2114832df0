"""The proof of a plan: that no other is better, in a file that anybody can check."""

from __future__ import annotations

import math
import time
from pathlib import Path

from ...certify.certificates import STAGE
from ...certify.joint_proof import check_joint_proof
from ...mission.errors import InputError
from ...mission.plan import Plan, Route
from ...proofs.prove import Proof
from ...proofs.tree import Limits
from ...routing.objectives import DEFAULT, OBJECTIVES, Method, Objective, objective_of
from ...routing.problem import faults
from ...routing.proofs.prover import prove_routes
from .explicit_model import problem_of
from .improvement import routes_of

METHOD: Method = "branch and cut"
"""Whose objectives can be proved to the last branch."""
TIME_LIMIT = 600.0
"""Seconds."""
SIZE_LIMIT = 50e6
"""Bytes."""


def require_provable(objective: str) -> Objective:
    """The objective of that name.

    Raises
    ------
    InputError
        If there is none, or its optima cannot be proved to the last branch.
    """
    aim = objective_of(objective)
    if aim.method != METHOD:
        names = " or ".join(name for name, one in OBJECTIVES.items() if one.method == METHOD)
        raise InputError(
            f"{aim.name!r} has no proof to the last branch; give {names}", field="objective"
        )
    return aim


def prove_plan(
    plan: Plan,
    *,
    path: str | Path,
    objective: str | None = None,
    time_limit: float | None = TIME_LIMIT,
    size_limit: float | None = SIZE_LIMIT,
) -> Proof:
    """Prove that no plan of the mission is better than `plan`, in a VIPR 1.0 certificate.

    Parameters
    ----------
    plan : Plan
        One that passes its check, best one of the planner ``exact``. Its limits hold.
    path : path
        Where the certificate goes.
    objective : str, optional
        ``total_time`` or ``makespan``; by default that of the plan's certificate.
    time_limit : float, optional
        Seconds. If they do not suffice, the root relaxation's bound is written.
    size_limit : float, optional
        Bytes of derivations after which the search for a proof stops.

    Raises
    ------
    InputError
        If the plan or the objective is none that can be proved, or the file cannot be written.
    CheckError
        If the certificate does not pass its check.
    """
    began = time.perf_counter()
    claimed = next((c for c in plan.certificates if c.stage == STAGE), None)
    aim = require_provable(objective or (claimed.model if claimed else DEFAULT))
    data = problem_of(plan)
    given = {route.robot: route for route in plan.routes}
    every = tuple(given.get(robot.id, Route(robot=robot.id)) for robot in plan.known.robots)
    routes = routes_of(plan.model_copy(update={"routes": every}))
    if wrong := faults(data, routes):
        raise InputError(f"the plan does not hold: {wrong[0]}", field="plan")
    limits = Limits(
        math.inf if time_limit is None else began + time_limit,
        math.inf if size_limit is None else size_limit,
    )
    name = plan.instance.name or "a mission"
    found = prove_routes(
        data, aim, routes, plan.known, path, limits=limits,
        comments=(f"{aim.name} of a plan for {name}",),
    )  # fmt: skip
    written = time.perf_counter()
    checked = check_joint_proof(path, plan)
    proved = checked.whole
    return Proof(
        status="proved" if proved else "partial",
        sense="min",
        value=float(checked.value),
        bound=float(checked.bound),
        exact_value=checked.value,
        exact_bound=checked.bound,
        claimed_by=f"{claimed.solver} {claimed.version}" if claimed else plan.planner,
        claimed_status=claimed.status if claimed else "feasible",
        claimed_value=float(checked.value),
        contradiction=""
        if found.better is None or claimed is None or claimed.status != "optimal"
        else f"it claims that {float(checked.value):.9g} is optimal, and there are routes of "
        f"{float(found.better):.9g}",
        remark="" if proved else found.remark,
        nodes=found.nodes,
        leaves=found.leaves,
        derivations=found.derivations,
        size=found.size,
        seconds=written - began,
        check_seconds=time.perf_counter() - written,
        path=str(path),
    )
