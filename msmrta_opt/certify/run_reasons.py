"""Whether what robots do in a run has a reason: none waits, wanders or leaves out without one.

Where some cell is blocked at some time, robots may wait for it, go round it, or give up; how well they
choose is the policy's own. Where none ever is, the plan and the decisions leave them no choice.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from .run_facts import Facts
from .run_orders import blocked_from, visits_for_nothing

BLOCKED = ("wait", "skip", "detour")
NEWS = ("lost", "noticed", "announced", "found", "skipped")
"""Events that are followed by a decision."""


def problems(facts: Facts) -> Iterator[str]:
    """What is done for no reason, one line each; for runs that are right otherwise."""
    run = facts.run
    blocked = run.options.get("blocked", BLOCKED[0])
    if blocked not in BLOCKED:
        yield f"the option blocked is {blocked!r}, which should be one of {', '.join(BLOCKED)}"
    if run.policy == "keep" and run.decisions:
        yield "the policy keep decides nothing, and there are decisions"
    news = {event.time for event in run.events if event.what in NEWS}
    for decision in run.decisions:
        if decision.time not in news:
            yield f"there is no news at {decision.time:g}, when something is decided"
    first = blocked_from(run)
    robots = {robot.id for robot in run.plan.instance.robots}
    victims = {victim.id for victim in run.victims}
    yield from _waits(facts)
    for event in run.events:
        if event.what != "skipped":
            continue
        if event.robot not in robots or event.victim not in victims or event.kind or event.cell:
            yield f"what is left out at {event.time:g} is no visit of a robot to a victim"
        elif event.time < first:
            yield f"robot {event.robot} leaves out a visit at {event.time:g}, when nothing is blocked"
    if not run.world.changes and not run.decisions:
        planned = {route.robot: route.cells for route in run.plan.routes}
        for track in run.tracks:
            cells = planned.get(track.robot) or track.cells[:1]
            if tuple(track.cells) != tuple(cells[: len(track.cells)]):
                yield f"robot {track.robot} goes another way than the plan, for no reason"


def _waits(facts: Facts) -> Iterator[str]:
    """Who waited in vain did so for a cell that was blocked, until it was lost or the run ended."""
    run = facts.run
    for event in run.events:
        if event.what != "waiting":
            continue
        if event.robot is None or event.robot not in facts.robots:
            yield f"who waits until {event.time:g} is no robot of the mission"
            continue
        who = f"robot {event.robot}"
        until = min(facts.lost.get(event.robot, math.inf), facts.end)
        undone = {facts.followed[event.robot].stopped}
        undone |= {visit.victim for visit in visits_for_nothing(run, event.robot)}
        back = event.victim is None and not run.plan.limits.get("return_to_start")
        if run.options.get("blocked") != "wait" or event.time < blocked_from(run):
            yield f"{who} waits until {event.time:g}, when nothing is blocked"
        elif event.time != until:
            yield f"{who} waits until {event.time:g}, which should be {until:g}"
        elif event.victim not in undone or back:
            yield f"{who} waits for a way to victim {event.victim}, for no reason"
