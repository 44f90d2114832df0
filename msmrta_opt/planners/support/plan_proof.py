"""The proof of a plan: that no other is better, in a file that anybody can check."""

from __future__ import annotations

import math
import time
from pathlib import Path

from ...certify.certificates import STAGE, TOLERANCE
from ...certify.plan_proof import TREE, check_plan_proof, digest_of
from ...mission.errors import InputError
from ...mission.files import write_text
from ...mission.plan import Certificate, Plan, Route
from ...mission.proof import LatencyTree, ProofFile
from ...proofs.prove import Proof
from ...proofs.tree import Limits
from ...routing.objectives import DEFAULT, Objective, objective_of
from ...routing.problem import faults
from ...routing.proofs.latency import Grown, prove_latency
from ...routing.proofs.prover import Found, prove_routes
from .explicit_model import problem_of
from .improvement import routes_of

VIPR = ".vipr"
TIME_LIMIT = 600.0
"""Seconds."""
SIZE_LIMIT = 50e6
"""Bytes."""


def require_suffix(objective: str, path: str | Path) -> None:
    """Refuse a file of another suffix than the proofs of an objective have."""
    aim = objective_of(objective)
    suffix = VIPR if aim.method == "branch and cut" else TREE
    if Path(path).suffix != suffix:
        raise InputError(f"{str(path)!r}; of a {aim.title} the suffix is {suffix}", field="proof")


def prove_plan(
    plan: Plan,
    *,
    path: str | Path,
    objective: str | None = None,
    time_limit: float | None = TIME_LIMIT,
    size_limit: float | None = SIZE_LIMIT,
) -> Proof:
    """Prove that no plan of the mission is better than `plan`, in a file that anybody can check.

    Parameters
    ----------
    plan : Plan
        One that passes its check, best one of the planner ``exact``. Its limits hold.
    path : path
        Where the proof goes: a VIPR 1.0 certificate (``.vipr``), or of a latency a tree (``.json``).
    objective : str, optional
        By default that of the plan's certificate.
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
    aim = objective_of(objective or (claimed.model if claimed else DEFAULT))
    require_suffix(aim.name, path)
    limits = Limits(
        math.inf if time_limit is None else began + time_limit,
        math.inf if size_limit is None else size_limit,
    )
    if aim.method == "branch and cut":
        found = _certificate(plan, aim, Path(path), limits)
    else:
        found = _tree(plan, claimed, Path(path), limits)
    written = time.perf_counter()
    checked = check_plan_proof(path, plan)
    value = float(checked.value)
    contradiction = ""
    if found.better is not None and claimed is not None and claimed.status == "optimal":
        better = f"{float(found.better):.9g}"
        contradiction = f"it claims that {value:.9g} is optimal, and there are routes of {better}"
    return Proof(
        status="proved" if checked.whole else "partial",
        sense="min",
        value=value,
        bound=float(checked.bound),
        exact_value=checked.value,
        exact_bound=checked.bound,
        claimed_by=f"{claimed.solver} {claimed.version}" if claimed else plan.planner,
        claimed_status=claimed.status if claimed else "feasible",
        claimed_value=value,
        contradiction=contradiction,
        remark="" if checked.whole else found.remark,
        nodes=found.nodes,
        leaves=found.leaves,
        derivations=found.derivations,
        size=Path(path).stat().st_size,
        seconds=written - began,
        check_seconds=time.perf_counter() - written,
        path=str(path),
    )


def with_proof(plan: Plan, proof: Proof) -> Plan:
    """`plan`, whose certificate says what is proved of it, and by which file.

    Parameters
    ----------
    plan : Plan
        One of the planner ``exact``.
    proof : Proof
        What `prove_plan` gave for it; its file is still there.

    Raises
    ------
    InputError
        If the plan has no certificate that it is of, or the file cannot be read.
    """
    values = {item.objective for item in plan.certificates if item.stage == STAGE}
    if proof.bound is None or not any(
        value is not None and math.isclose(value, proof.value or 0.0, rel_tol=TOLERANCE)
        for value in values
    ):
        raise InputError("the plan has no certificate that the proof could be of", field="plan")
    proved = ProofFile(
        status="proved" if proof.status == "proved" else "partial",
        bound=proof.bound,
        digest=digest_of(proof.path),
        size=proof.size,
        leaves=proof.leaves,
        seconds=proof.seconds,
        check_seconds=proof.check_seconds,
        remark=proof.remark,
    )
    certificates = tuple(
        item.model_copy(update={"proved": proved}) if item.stage == STAGE else item
        for item in plan.certificates
    )
    return plan.model_copy(update={"certificates": certificates})


def _certificate(plan: Plan, aim: Objective, path: Path, limits: Limits) -> Found:
    """A VIPR certificate of a total time or a makespan."""
    data = problem_of(plan)
    given = {route.robot: route for route in plan.routes}
    every = tuple(given.get(robot.id, Route(robot=robot.id)) for robot in plan.known.robots)
    routes = routes_of(plan.model_copy(update={"routes": every}))
    if wrong := faults(data, routes):
        raise InputError(f"the plan does not hold: {wrong[0]}", field="plan")
    name = plan.instance.name or "a mission"
    comments = (f"{aim.name} of a plan for {name}",)
    return prove_routes(data, aim, routes, plan.known, path, limits=limits, comments=comments)


def _tree(plan: Plan, claimed: Certificate | None, path: Path, limits: Limits) -> Found:
    """The tree of a latency, from where its certificate's dual values end."""
    root = None if claimed is None else claimed.pricing
    found = Grown((), 0, "the certificate holds no dual values" if root is None else "")
    if root is not None:
        found = prove_latency(plan, root, limits)
    proof = LatencyTree(root=root, leaves=found.leaves)
    write_text(path, proof.model_dump_json(exclude_defaults=True) + "\n")
    return Found(found.remark, None, found.nodes, len(found.leaves), 0)
