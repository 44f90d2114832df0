"""What a reader of a plan should know of how it was made, and would not see."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress

from ...mission.errors import MsmrtaError
from ...mission.plan import Plan
from ...optimise import registry
from ...stages.options import StagedOptions
from .improvement import STAGE as IMPROVED

STAGED = "msmrta"
READ_AS = {"budget": "budget|budgeted_size", "endurance": "endurance|time_left", "apart": "apart"}
"""Options that only formulations heed that read them from their data, and the fields' names there."""


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
    if plan.planner == STAGED:
        yield from _not_read(plan)


def _not_read(plan: Plan) -> Iterator[str]:
    """Options that were given and that no formulation of the plan reads."""
    defaults = StagedOptions()
    models = [str(plan.options[m]) for m in ("cluster_model", "victim_model") if m in plan.options]
    for option in READ_AS:
        if plan.options.get(option) in (None, getattr(defaults, option)):
            continue
        if not any(_reads(name, option) for name in models):
            there = [entry for stage in ("cluster", "victim") for entry in registry.models(stage)]
            would = ", ".join(entry.name for entry in there if _reads(entry.name, option))
            yield f"{option} changes nothing: neither {' nor '.join(models)} reads it; {would} would."


def _reads(name: str, option: str) -> bool:
    """Whether the file of formulation `name` mentions what `option` is in its data."""
    with suppress(MsmrtaError, OSError):
        source = registry.get(name).path.read_text(encoding="utf-8")
        return re.search(rf"\bdata\.({READ_AS[option]})\b", source) is not None
    return False
