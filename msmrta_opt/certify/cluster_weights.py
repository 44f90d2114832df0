"""Eq. 1 worked out again: what the robots that took clusters can do there, weighted by ψ.

The weight of robot r in cluster c is ``(1 − ψ) w + ψ w_full``: w counts the requirements of c's members
that r can serve, w_full those of members all of whose requirements it serves.
"""

from __future__ import annotations

from fractions import Fraction

from ..mission.exact import exact
from ..mission.instance import Robot, Victim
from ..mission.plan import Plan
from .walking import components

LINEAR = ("cluster_one_to_one", "cluster_printed", "cluster_budgeted")
"""Shipped formulations whose objective is the sum of these weights."""
STAGE = "Eq. 1"
TOLERANCE = Fraction(1, 10**6)


def doubts(plan: Plan) -> list[str]:
    """Where a certificate of Eq. 1 does not claim what the plan's clusters are worth, a line each.

    Only of plans whose options say how Eq. 1 was read, and of the formulations in `LINEAR`. Their files
    can be edited, so this is no proof that something is wrong.

    Parameters
    ----------
    plan : Plan
        One that passes its own check (`plan.problems`).
    """
    options = plan.options
    psi, weights = options.get("psi"), options.get("weights")
    if not isinstance(psi, (int, float)) or weights not in ("text", "authors"):
        return []
    found = []
    for certificate in plan.certificates:
        if certificate.stage != STAGE or certificate.model not in LINEAR:
            continue
        value = _worth(plan, exact(psi), authors=weights == "authors")
        claimed = certificate.objective
        slack = TOLERANCE * max(Fraction(1), abs(value))
        if claimed is not None and abs(exact(claimed) - value) > slack:
            found.append(
                f"the certificate of {STAGE} claims {claimed:.9g}, where the robots that took clusters"
                f" are worth {float(value):.9g} by {certificate.model} as it is shipped"
            )
    return found


def _worth(plan: Plan, psi: Fraction, *, authors: bool) -> Fraction:
    component = components(plan.instance.map)
    victims = {victim.id: victim for victim in plan.known.victims}
    robots = {robot.id: robot for robot in plan.instance.robots}
    total = Fraction(0)
    for cluster in plan.clusters:
        for robot in (robots[r] for r in cluster.robots):
            for victim in (victims[v] for v in cluster.victims):
                if component[robot.start] == component[victim.cell]:
                    partial, full = _met(robot, victim, authors=authors)
                    total += (1 - psi) * partial + psi * full
    return total


def _met(robot: Robot, victim: Victim, *, authors: bool) -> tuple[int, int]:
    """What counts in w and in w_full."""
    met = len(set(robot.capabilities) & set(victim.requirements))
    full = met if met == len(victim.requirements) else 0
    return (met - full if authors else met), full
