"""The independent check of a plan's bound on the joint problem.

What was proved before branching is proved again, exactly and without a solver, from the instance and
the stored prices: by linear duality for total time and makespan (`duality`), by the cheapest routes at
these prices for latency (`pricing`). What branching added is not stored, so it is named and not
re-checked.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from ..mission.errors import CheckError, InputError
from ..mission.exact import exact
from ..mission.plan import Certificate, Plan
from ..mission.proof import RootProof
from .joint_problem import Joint, service_times
from .linear_bound import Relaxation, relaxation
from .pricing_bound import proved as priced
from .queue_bound import in_queues

STAGE = "joint problem"
"""The stage that certificates of bounds on whole plans name."""
TOLERANCE = 1e-6
"""Relative difference up to which two values are the same."""
SMALL_PROOFS = ("combinatorial", "root LP", "column generation")
"""Proofs that need no branching, so that they can be checked whole."""


@dataclass(frozen=True, eq=False)
class Recheck:
    """What became of a certificate's bound."""

    certificate: Certificate
    value: Fraction
    """What the plan is worth."""
    proved: Fraction | None
    """What was proved again, rounded up to a possible value; ``None`` if nothing is stored."""
    relaxation: Relaxation | None = field(default=None, repr=False)
    """The root relaxation, written out again; latency has none."""
    problems: tuple[str, ...] = ()
    """What is wrong, one line each."""

    @property
    def whole(self) -> bool:
        """Whether all of the bound that is claimed was proved again."""
        claimed = self.certificate.bound
        return claimed is not None and self.proved is not None and not _above(claimed, self.proved)


def joint_certificate(plan: Plan) -> Certificate:
    """The certificate of `plan` for the joint problem.

    Raises
    ------
    InputError
        If it has none: only the exact planner proves a bound on whole plans.
    """
    for certificate in plan.certificates:
        if certificate.stage == STAGE and certificate.bound is not None:
            return certificate
    raise InputError(
        f"the plan of {plan.planner!r} claims no bound on the joint problem; give one of 'exact'",
        field="certificates",
    )


def recheck(plan: Plan) -> Recheck:
    """Prove the bound of `plan` again, as far as it was proved before branching.

    Parameters
    ----------
    plan : Plan
        One that passes its own check (`check.problems`).

    Raises
    ------
    InputError
        If it claims no bound on the joint problem.
    """
    certificate = joint_certificate(plan)
    value = worth(plan, certificate.model)
    problems = _contradictions(certificate, value)
    joint = Joint.of(plan)
    proved = joint.at_once(certificate.model)
    if certificate.model == "latency":
        proved = max(proved, in_queues(joint))
    stored, written = certificate.root or certificate.pricing, None
    if stored is not None:
        try:
            kind = stored.objective if isinstance(stored, RootProof) else "latency"
            if kind != certificate.model:
                raise CheckError(f"the root bound is on the {kind}")
            if isinstance(stored, RootProof):
                written = relaxation(joint, stored, value)
                proved = max(proved, written.bound())
            else:
                proved = max(proved, priced(joint, stored, value))
        except CheckError as error:
            return Recheck(certificate, value, None, problems=(*problems, str(error)))
    elif certificate.proof != "combinatorial":
        problems.append(f"nothing is stored that proves a bound by {certificate.proof}")
    proved = joint.up(proved, certificate.model)
    if stored is not None:
        problems += _unproved("root", stored.bound, proved)
    if certificate.proof in SMALL_PROOFS and certificate.bound is not None and not problems:
        problems += _unproved("certificate's", certificate.bound, proved)
    return Recheck(certificate, value, proved, written, tuple(problems))


def _unproved(whose: str, bound: float, proved: Fraction) -> list[str]:
    if not _above(bound, proved):
        return []
    return [f"the {whose} bound is {bound:.9g}, but only {float(proved):.9g} is proved"]


def worth(plan: Plan, objective: str) -> Fraction:
    """What `plan` is worth by `objective`, exactly."""
    service = service_times(plan.instance)
    speed = {robot.id: exact(robot.speed) for robot in plan.instance.robots}
    busy: list[Fraction] = []
    complete: dict[int, Fraction] = {}
    for route in plan.routes:
        clock = Fraction(0)
        for visit in route.visits:
            clock += max(len(visit.cells) - 1, 0) / speed[route.robot]
            clock += sum(service[visit.victim, kind] for kind in visit.served)
            if visit.served:
                complete[visit.victim] = max(complete.get(visit.victim, clock), clock)
        busy.append(clock + max(len(route.back) - 1, 0) / speed[route.robot])
    if objective == "latency":
        weight = {victim.id: exact(victim.priority) for victim in plan.instance.victims}
        return sum((weight[v] * time for v, time in complete.items()), Fraction(0))
    return sum(busy, Fraction(0)) if objective == "total_time" else max(busy, default=Fraction(0))


def _contradictions(certificate: Certificate, value: Fraction) -> list[str]:
    """Where the certificate does not agree with itself, or with the plan."""
    bound, objective, wrong = certificate.bound or 0.0, certificate.objective, []
    if objective is None or _above(objective, value) or _above(value, objective):
        said = "nothing" if objective is None else f"{objective:.9g}"
        wrong.append(f"the certificate says {said} for a plan worth {float(value):.9g}")
    if _above(bound, value):
        wrong.append(f"the bound {bound:.9g} is above what the plan is worth, {float(value):.9g}")
    if certificate.status == "optimal" and _above(value, bound):
        wrong.append(
            f"the plan is called optimal at {float(value):.9g}, above its bound {bound:.9g}"
        )
    opening = max(0.0, float(value) - bound) / float(value) if value else 0.0
    if certificate.gap is None or abs(certificate.gap - opening) > 2 * TOLERANCE:
        wrong.append(f"the gap is said to be {certificate.gap}, and is {opening:.6g}")
    return wrong


def _above(a: float | Fraction, b: float | Fraction) -> bool:
    return float(a) > float(b) + TOLERANCE * max(1.0, abs(float(b)))
