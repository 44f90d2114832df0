"""Repair the plan: everything stays as it is, and what nobody does is inserted where it costs least."""

from __future__ import annotations

from ...planners.support.planner import walk_a_step
from ..replanning import Remaining
from ..state import Decide, Policy, Queues, Situated, State


def begin(situated: Situated) -> Decide:
    """Visits of lost robots, victims that turn up, and visits that robots cannot make any more."""
    left_out: set[tuple[int, int]] = set()

    def repair(state: State) -> Queues | None:
        left_out.update(state.left_out)
        remaining = Remaining.of(state, situated, left_out)
        return None if remaining is None else remaining.queues(remaining.repaired())

    return repair


POLICY = Policy(
    "repair",
    "what nobody does is inserted where it costs least",
    begin,
    load=lambda options: walk_a_step(),
)
