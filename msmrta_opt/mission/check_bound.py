"""The independent check of a plan's bound on the joint problem.

The root relaxation is proved again, exactly and without a solver (`duality`), from the instance and
the stored prices. What branch and cut added to it is not stored, so it is named and not re-checked.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from .duality import Relaxation, relaxation
from .errors import CheckError, InputError
from .joint import Joint, exact, service_times
from .plan import Certificate, Plan

STAGE = "joint problem"
"""The stage that certificates of bounds on whole plans name."""
TOLERANCE = 1e-6
"""Relative difference up to which two values are the same."""
SMALL_PROOFS = ("combinatorial", "root LP")
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
    """The root relaxation, written out again."""
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
    """Prove the bound of `plan` again, as far as its root relaxation goes.

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
    if certificate.model not in ("total_time", "makespan"):
        return Recheck(certificate, value, None, problems=tuple(problems))
    joint = Joint.of(plan)
    proved = joint.at_once(certificate.model)
    root, written = certificate.root, None
    if root is not None:
        try:
            if root.objective != certificate.model:
                raise CheckError(f"the root relaxation is of {root.objective}")
            written = relaxation(joint, root, value)
            proved = max(proved, written.bound())
        except CheckError as error:
            problems.append(str(error))
    elif certificate.proof not in SMALL_PROOFS[:1]:
        problems.append(f"no root relaxation is stored for a bound by {certificate.proof}")
    proved = joint.up(proved, certificate.model)
    if root is not None and written is not None:
        problems += _unproved("root", root.bound, proved)
    if certificate.proof in SMALL_PROOFS and certificate.bound is not None and not problems:
        problems += _unproved("certificate's", certificate.bound, proved)
    return Recheck(certificate, value, proved, written, tuple(problems))


def _unproved(whose: str, bound: float, proved: Fraction) -> list[str]:
    if not _above(bound, proved):
        return []
    return [f"the {whose} bound is {bound:.9g}, but only {float(proved):.9g} is proved"]


def worth(plan: Plan, objective: str) -> Fraction:
    """What `plan` is worth by `objective`, exactly (but for latency)."""
    if objective == "latency":
        return Fraction(plan.metrics.latency)
    speed = {robot.id: exact(robot.speed) for robot in plan.instance.robots}
    service = service_times(plan.instance)
    busy = [
        route.distance / speed[route.robot]
        + sum(service[visit.victim, kind] for visit in route.visits for kind in visit.served)
        for route in plan.routes
    ]
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
