"""Keep the plan: robots do what it says, whatever happens; visits of lost robots are left undone."""

from __future__ import annotations

from ..state import Decide, Policy, Queues, Situated, State


def begin(situated: Situated) -> Decide:
    """Never decides anything; before a blocked cell the option ``blocked`` counts."""
    del situated
    return _keep


def _keep(state: State) -> Queues | None:
    del state
    return None


POLICY = Policy("keep", "the plan as it is", begin)
