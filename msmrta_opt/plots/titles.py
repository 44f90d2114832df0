"""What a plan is, in a few words."""

from __future__ import annotations

from ..mission.instance import Instance
from ..mission.plan import Plan
from ..mission.run import Run
from .lettering import shortened


def name_of(instance: Instance) -> str:
    """The mission's name."""
    return " ".join(instance.name.split()) or "unnamed mission"


def says(plan: Plan | Run) -> str:
    """Who planned, what was done to the plan, and what is proven of it; of a run its policy.

    So ``msmrta + 1 s local search``, or ``exact: optimal, bound 1218.33``, or ``keep, seed 3``.
    """
    if isinstance(plan, Run):
        return f"{shortened(plan.policy)}, seed {plan.seed}"
    said = shortened(plan.planner)
    improve = plan.options.get("improve", False)
    if improve is not False:
        searched = "" if improve is True else f"{improve:g} s "
        said += f" + {searched}local search"
    proofs = [item for item in plan.certificates if item.stage.startswith("joint")]
    if proofs and proofs[-1].bound is not None:
        last = proofs[-1]
        said += f": {last.status.replace('_', ' ')}, bound {last.bound:.6g}"
        if last.gap:
            said += f", gap {last.gap:.1%}"
    return said
