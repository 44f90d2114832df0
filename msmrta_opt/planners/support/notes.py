"""What a reader of a plan should know of how it was made, and would not see."""

from __future__ import annotations

from collections.abc import Iterator

from ...mission.plan import Plan
from .improvement import STAGE as IMPROVED

STAGED = "msmrta"


def notes(plan: Plan) -> Iterator[str]:
    """What its planner did not heed, and what it walked beyond what serving needs, a line each."""
    priorities = {victim.priority for victim in plan.instance.victims}
    heeds = plan.options.get("objective") == "latency"
    improved = any(visit.stage == IMPROVED for route in plan.routes for visit in route.visits)
    if priorities - {1.0} and not heeds:
        who = "The staged method" if plan.planner == STAGED else f"Planner {plan.planner}"
        yield (
            f"{who} ignores priorities, which this mission gives; latency weighs them: "
            "--planner exact --objective latency, or --improve 1 --objective latency."
        )
    centres = [cluster for cluster in plan.clusters if cluster.robots and cluster.cell is not None]
    if centres and plan.options.get("through_centre") is True and not improved:
        yield (
            "Routes pass the cells that stand for their clusters' centres, as in the paper; "
            "--direct leaves that out."
        )
