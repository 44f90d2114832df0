"""Whether the events of a run are those that follow from all else that is said of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Set
from itertools import pairwise

import numpy as np

from ..mission.grid import Cell
from ..mission.run import Change
from .run_facts import Facts
from .run_orders import CLOSE


def problems(facts: Facts) -> Iterator[str]:
    """The events are those that follow from all else, in the order of their times."""
    said = facts.run.events
    if any(a.time > b.time for a, b in pairwise(said)):
        yield "the events are not in the order of their times"
    last = facts.end
    true: Counter[tuple[object, ...]] = Counter()
    for s in facts.run.services:
        true[s.ended, "served" if s.done else "cut short", s.robot, s.victim, s.kind, None] += 1
    for decision in facts.run.decisions:
        true[decision.time, "decided", None, None, None, None] += 1
    for cell, changes in facts.changes.items():
        free = facts.mission.map.is_free(cell)
        for change in changes:
            if change.free != free and change.time <= last:
                free, what = change.free, "opened" if change.free else "blocked"
                true[change.time, what, None, None, None, cell] += 1
    for victim, time in facts.known.items():
        sight = facts.seen.get(victim)
        if sight is not None and sight[0] == time and time not in facts.announced[victim]:
            true[time, "found", sight[1], victim, None, None] += 1
        elif time is not None and time <= last:
            true[time, "announced", None, victim, None, None] += 1
    for robot, time in facts.lost.items():
        if time <= last:
            true[time, "lost", robot, None, None, facts.at(robot, time)] += 1
    told_of = {(e.time, e.cell) for e in said if e.what == "noticed"}
    for time, cell in _noticed(facts, told_of):
        true[time, "noticed", None, None, None, cell] += 1
    found: Counter[tuple[object, ...]] = Counter(
        (e.time, e.what, None if e.what == "noticed" else e.robot, e.victim, e.kind, e.cell)
        for e in said
        if e.what not in ("skipped", "waiting")
    )
    yield from (f"an event is missing: {_event(event)}" for event in true - found)
    yield from (f"an event did not happen: {_event(event)}" for event in found - true)
    for event in said:
        if event.what == "noticed" and not _is_beside(facts, event.time, event.robot, event.cell):
            yield f"robot {event.robot} cannot notice {event.cell} at {event.time:g}"


def _noticed(facts: Facts, said: Set[tuple[float, Cell | None]]) -> Iterator[tuple[float, Cell]]:
    """When it becomes known that a cell is not as it was thought to be.

    Where it is not sure whether a robot stood somewhere, and looked, it is as is `said`.
    """
    free = {cell: facts.mission.map.is_free(cell) for cell in facts.changes}
    thought = dict(free)
    at_once = facts.run.scenario.notice == "at_once"
    looks: dict[float, list[Cell]] = {}
    for track in facts.run.tracks:
        for cell, time in zip(track.cells, track.times, strict=True):
            if time < facts.lost.get(track.robot, np.inf):
                looks.setdefault(time, []).append(cell)
    changed: dict[float, list[Change]] = {}
    for change in facts.run.world.changes:
        if change.time > facts.end:
            break
        changed.setdefault(change.time, []).append(change)
    for time in sorted({*changed, *(() if at_once else looks)}):
        for change in changed.get(time, ()):
            free[change.cell] = change.free
        if at_once:
            seen = {change.cell for change in changed[time]}
        else:
            here, last = list(looks.get(time, [])), []
            if time in changed:
                here += _standing(facts, time, surely=True)
                last = list(_standing(facts, time, surely=False))
            seen = {cell for place in here for cell in _beside(place)}
            maybe = {cell for place in last for cell in _beside(place)}
            seen |= {cell for cell in maybe if (time, cell) in said}
        for cell in seen & free.keys():
            if thought[cell] != free[cell]:
                thought[cell] = free[cell]
                yield time, cell


def _standing(facts: Facts, time: float, *, surely: bool) -> Iterator[Cell]:
    """Where robots are that are not lost by a time, and not under way to another cell.

    Not sure is it of those that may have been within a move when they were lost, or the run ended, and
    of those that set out at that time, give and take rounding.
    """
    until = facts.run.scenario.until
    horizon = np.inf if until is None else until
    for track in facts.run.tracks:
        loss = facts.lost.get(track.robot, np.inf)
        number = int(np.searchsorted(track.times, time))
        if loss <= time:
            continue
        if number == len(track.times):
            step = (1.0 + CLOSE) / facts.speed[track.robot]
            if surely == (time + step <= min(loss, horizon)):
                yield track.cells[-1]
            continue
        ahead = track.times[number] - 1 / facts.speed[track.robot] - time
        close = abs(ahead) <= CLOSE * track.times[number]
        if close != surely and (close or ahead > 0):
            yield track.cells[max(number - 1, 0)]


def _is_beside(facts: Facts, time: float, robot: int | None, cell: Cell | None) -> bool:
    if facts.run.scenario.notice == "at_once" or cell is None:
        return robot is None
    if robot is None or robot not in facts.tracks:
        return False
    return any(cell in _beside(place) for place in facts.places(robot, time))


def _beside(cell: Cell) -> tuple[Cell, ...]:
    row, col = cell
    return (row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)


def _event(event: tuple[object, ...]) -> str:
    time, what, *whom = event
    return f"{what} ({', '.join(str(item) for item in whom if item is not None)}) at {time:g}"
