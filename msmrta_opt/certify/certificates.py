"""The independent check of what the certificates of a plan claim.

Of the joint problem, what was proved before branching is proved again, exactly and without a solver,
from the instance and the stored dual values: by linear duality for total time and makespan
(`linear_relaxation`), by the cheapest routes for latency (`pricing_bound`). What branching added is not
stored, so it stays a claim. Certificates of single programs are held against themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from ..mission.errors import CheckError, InputError
from ..mission.exact import exact
from ..mission.plan import Certificate, Plan
from ..mission.proof import RootProof
from .joint_problem import Joint, figure, service_times
from .linear_relaxation import Relaxation, relaxation
from .pricing_bound import pricing_bound
from .scheduling_bound import scheduling_bound

STAGE = "joint problem"
"""The stage that certificates of bounds on whole plans name."""
OBJECTIVES = ("total_time", "makespan", "latency")
TOLERANCE = 1e-6
"""Difference up to which two values are the same, as a share of what the plan is worth."""
SMALL_PROOFS = ("combinatorial", "root LP", "column generation")
"""Proofs that need no branching, so that they can be checked whole."""


@dataclass(frozen=True, eq=False)
class Recheck:
    """What became of a certificate's bound on the joint problem."""

    certificate: Certificate
    value: Fraction
    """What the plan is worth."""
    proved: Fraction | None
    """What was proved again, rounded up to a possible value; ``None`` if a stored proof fails."""
    relaxation: Relaxation | None = field(default=None, repr=False)
    """The root relaxation, written out again; latency has none."""
    problems: tuple[str, ...] = ()
    """What is wrong, one line each."""

    @property
    def whole(self) -> bool:
        """Whether all of the bound that is claimed was proved again."""
        claimed = self.certificate.bound
        if claimed is None or self.proved is None or self.problems:
            return False
        return not _above(claimed, self.proved, self.value)


def recheck(plan: Plan) -> tuple[Recheck, ...]:
    """Prove the bounds of `plan` again, as far as they were proved before branching.

    Parameters
    ----------
    plan : Plan
        One that passes its own check (`plan.problems`).

    Returns
    -------
    tuple of Recheck
        One for each certificate of the joint problem, in order.

    Raises
    ------
    InputError
        If it has none with a bound: only the exact planner proves one on whole plans.
    """
    found = [certificate for certificate in plan.certificates if certificate.stage == STAGE]
    if not any(certificate.bound is not None for certificate in found):
        raise InputError(
            f"the plan of {plan.planner!r} claims no bound on the joint problem; "
            "give one of 'exact'",
            field="certificates",
        )
    joint = Joint.of(plan)
    return tuple(_recheck(plan, joint, certificate) for certificate in found)


def claim_problems(plan: Plan) -> list[str]:
    """Where certificates claim what is not so, without proving any bound again, one line each.

    Every objective of the joint problem that is claimed is worked out again from the routes; status,
    bound and gap are held against it. Certificates of single programs are held against themselves.

    Parameters
    ----------
    plan : Plan
        One that passes its own check (`plan.problems`).
    """
    wrong = stage_problems(plan)
    for certificate in plan.certificates:
        if certificate.stage != STAGE:
            continue
        if certificate.model not in OBJECTIVES:
            wrong.append(_unknown(certificate))
            continue
        wrong += _contradictions(certificate, worth(plan, certificate.model))
    return wrong or search_problems(plan)


def search_problems(plan: Plan) -> list[str]:
    """Where the record of the search claims more than the plan and its certificates, one line each."""
    search, found = plan.search, [c for c in plan.certificates if c.stage == STAGE]
    if search is None or not found:
        return []
    own = [c for c in found if c.model == search.objective]
    if not own or search.objective not in OBJECTIVES:
        return [f"the search is by {_short(search.objective)}, which no certificate is on"]
    value = worth(plan, search.objective)
    wrong, claimed = [], [c.bound for c in own if c.bound is not None]
    for i, step in enumerate(search.steps):
        if _above(value, step.incumbent, value):
            wrong.append(
                f"search.steps[{i}] has routes worth {step.incumbent:.9g}, "
                f"below the plan's {figure(value)}"
            )
        if step.bound is not None and not any(
            not _above(step.bound, bound, value) for bound in claimed
        ):
            wrong.append(
                f"search.steps[{i}] has the bound {step.bound:.9g}, above the certificate's "
                + (f"{max(claimed):.9g}" if claimed else "none")
            )
    return wrong[:1]


def _unknown(certificate: Certificate) -> str:
    return f"the certificate is on {certificate.model!r}; there are {', '.join(OBJECTIVES)}"


def stage_problems(plan: Plan) -> list[str]:
    """Where certificates of single programs do not agree with themselves, one line each."""
    return [
        f"the certificate of {certificate.stage} {problem}"
        for certificate in plan.certificates
        if certificate.stage != STAGE
        for problem in _stage(certificate)
    ]


def _recheck(plan: Plan, joint: Joint, certificate: Certificate) -> Recheck:
    objective = certificate.model
    if objective not in OBJECTIVES:
        return Recheck(certificate, Fraction(0), None, problems=(_unknown(certificate),))
    value = worth(plan, objective)
    problems = _contradictions(certificate, value)
    proved = joint.each_alone(objective)
    if objective == "latency":
        proved = max(proved, scheduling_bound(joint))
    written = None
    stored = [proof for proof in (certificate.root, certificate.pricing) if proof is not None]
    try:
        for proof in stored:
            kind = proof.objective if isinstance(proof, RootProof) else "latency"
            if kind != objective:
                raise CheckError(f"the root bound is on the {kind}")
            if isinstance(proof, RootProof):
                written = relaxation(joint, proof, value)
                proved = max(proved, written.bound())
            else:
                proved = max(proved, pricing_bound(joint, proof, value))
    except CheckError as error:
        return Recheck(certificate, value, None, problems=(*problems, str(error)))
    proved = joint.up(proved, objective, value)
    if not stored and certificate.proof != "combinatorial":
        problems.append(f"nothing is stored that proves a bound by {certificate.proof}")
    for proof in stored:
        problems += _unproved("root", proof.bound, proved, value)
    if certificate.proof in SMALL_PROOFS and certificate.bound is not None and not problems:
        problems += _unproved("certificate's", certificate.bound, proved, value)
    return Recheck(certificate, value, proved, written, tuple(problems))


def _unproved(whose: str, bound: float, proved: Fraction, value: Fraction) -> list[str]:
    if not _above(bound, proved, value):
        return []
    return [f"the {whose} bound is {bound:.9g}, but only {figure(proved)} is proved"]


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
    bound, objective, gap = certificate.bound, certificate.objective, certificate.gap
    wrong, true = [], figure(value)
    if certificate.sense != "min":
        wrong.append(
            f"the certificate is of a maximisation, where {certificate.model} is minimised"
        )
    if certificate.check != "passed":
        wrong.append(f"the certificate says of its own check {_short(certificate.check)}")
    if certificate.status not in ("optimal", "feasible"):
        wrong.append(f"the status is {_short(certificate.status)}, not optimal or feasible")
    if objective is None or _above(objective, value, value) or _above(value, objective, value):
        said = "nothing" if objective is None else f"{objective:.9g}"
        wrong.append(f"the certificate says {said} for a plan worth {true}")
    proved = certificate.proved
    if proved is not None and _above(proved.bound, value, value):
        wrong.append(
            f"{proved.bound:.9g} is said to be proved, above what the plan is worth, {true}"
        )
    elif proved is not None and proved.status == "proved" and _above(value, proved.bound, value):
        wrong.append(f"the plan is said to be proved at {true}, above what is, {proved.bound:.9g}")
    if bound is None:
        if certificate.status == "optimal" or gap is not None:
            wrong.append("the certificate has no bound that its status and gap could rest on")
        return wrong
    if _above(bound, value, value):
        wrong.append(f"the bound {bound:.9g} is above what the plan is worth, {true}")
    # Searches end at a gap of the tolerance itself, worked out in floats.
    if certificate.status == "optimal" and _above(value, bound, 2 * value):
        wrong.append(f"the plan is called optimal at {true}, above its bound {bound:.9g}")
    open_ = max(Fraction(0), value - Fraction(bound)) / value if value else Fraction(0)
    if gap is None or abs(Fraction(gap) - open_) > 2 * Fraction(TOLERANCE):
        wrong.append(f"the gap is said to be {gap}, and is {figure(open_)}")
    return wrong


def _stage(certificate: Certificate) -> list[str]:
    """Where a program's certificate does not agree with itself."""
    bound, objective, gap = certificate.bound, certificate.objective, certificate.gap
    wrong = []
    if certificate.check != "passed":
        wrong.append(f"says of its own check {_short(certificate.check)}")
    if objective is None and certificate.status == "optimal":
        wrong.append("calls optimal what has no objective")
    if objective is None or bound is None:
        return wrong
    scale = max(1.0, abs(objective), abs(bound))  # costs may cancel out, so nearly 0 is 0
    low, high = (bound, objective) if certificate.sense == "min" else (objective, bound)
    if _above(low, high, scale):
        wrong.append(f"has the bound {bound:.9g} beyond its objective {objective:.9g}")
    if certificate.status == "optimal" and _above(high, low, scale):
        wrong.append(f"calls {objective:.9g} optimal, with a bound of {bound:.9g}")
    if gap is not None and gap < 0:
        wrong.append(f"has the gap {gap:.9g}, which is below 0")
    return wrong


def _short(text: str) -> str:
    return repr(text) if len(text) <= 60 else repr(f"{text[:59]}…")


def _above(a: float | Fraction, b: float | Fraction, scale: float | Fraction) -> bool:
    return Fraction(a) - Fraction(b) > Fraction(TOLERANCE) * Fraction(scale)
