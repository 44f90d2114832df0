"""Whether the world of a run is one that its scenario can come to, for its mission."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

from ..mission.errors import InputError, each_of
from ..mission.instance import Victim
from ..mission.run import Run
from ..mission.scenario import Distribution

CLOSE = 1e-9
"""Share of a factor up to which two are the same."""
SMALLEST, LARGEST = 1e-30, 1e30
"""Speeds and times beyond are cut off there."""


def problems(run: Run) -> list[str]:
    """What the world has that the scenario does not say, or lacks, one line each."""
    try:
        run.scenario.check_for(run.plan.instance)
    except InputError as error:
        return [f"the scenario is for another mission: {one}" for one in each_of(error)]
    if wrong := list(_unknown(run)):
        return wrong
    return [*_speeds(run), *_services(run), *_lost(run), *_changes(run)]


def _can_be(value: float, planned: float, distribution: Distribution) -> bool:
    """Whether a value can come of the planned one, give and take rounding."""
    if planned == 0:
        return value == 0
    if value >= LARGEST or value <= SMALLEST:
        return True
    factor = value / planned
    near = (factor, factor * (1 + CLOSE), factor * (1 - CLOSE))
    ends = distribution.parameters if distribution.distribution != "lognormal" else ()
    close = any(abs(factor - end) <= CLOSE * end for end in ends)
    return close or any(distribution.may_be(one) for one in near)


def _speeds(run: Run) -> Iterator[str]:
    planned = {robot.id: robot.speed for robot in run.plan.instance.robots}
    if sorted(drawn.robot for drawn in run.world.speeds) != sorted(planned):
        yield "the speeds that were drawn are not one for each robot"
        return
    for drawn in run.world.speeds:
        if not _can_be(drawn.speed, planned[drawn.robot], run.scenario.speed_of(drawn.robot)):
            yield f"robot {drawn.robot} cannot have speed {drawn.speed:g} in this scenario"


def _services(run: Run) -> Iterator[str]:
    usual = run.plan.instance.service_time
    planned = {
        (victim.id, kind): victim.service_time.get(kind, usual[kind])
        for victim in run.victims
        for kind in victim.requirements
    }
    if sorted((drawn.victim, drawn.kind) for drawn in run.world.services) != sorted(planned):
        yield "the service times that were drawn are not one for each requirement"
        return
    for drawn in run.world.services:
        of_kind = run.scenario.service_of(drawn.kind)
        if not _can_be(drawn.time, planned[drawn.victim, drawn.kind], of_kind):
            yield f"{drawn.kind} at victim {drawn.victim} cannot take {drawn.time:g}"


def _lost(run: Run) -> Iterator[str]:
    lost = Counter(loss.robot for loss in run.world.lost)
    when = {loss.robot: loss.time for loss in run.world.lost}
    robots = [robot.id for robot in run.plan.instance.robots]
    if any(times > 1 or robot not in robots for robot, times in lost.items()):
        yield "the robots that are lost are not robots of the mission, each once"
        return
    for robot in robots:
        tables = [table for table in run.scenario.lost if table.robot in (None, robot)]
        at = min((table.time for table in tables if table.time is not None), default=None)
        by_rate = any(table.rate is not None for table in tables)
        if not tables and robot in when:
            yield f"robot {robot} is lost, which this scenario does not say"
        elif tables and robot not in when:
            yield f"robot {robot} is never lost, where this scenario says so"
        elif at is not None and (when[robot] > at or (when[robot] < at and not by_rate)):
            yield f"robot {robot} is lost at {when[robot]:g}, where this scenario says {at:g}"


def _unknown(run: Run) -> Iterator[str]:
    hidden = set(run.plan.scouting.not_found) if run.plan.scouting else set()
    true: list[tuple[Victim, float | None]] = []
    true += [(v, None) for v in run.plan.instance.victims if v.id in hidden]
    true += [(table.victim, table.announced) for table in run.scenario.victims]
    if [(item.victim, item.announced) for item in run.world.unknown] != true:
        yield "the victims that are unknown are not those of the scenario and of the scouts"


def _changes(run: Run) -> Iterator[str]:
    true = []
    for corridor in run.scenario.corridors:
        for cell in corridor.cells:
            if corridor.blocked is not None:
                true.append((corridor.blocked, cell, False))
            if corridor.opened is not None:
                true.append((corridor.opened, cell, True))
    said = [(change.time, change.cell, change.free) for change in run.world.changes]
    if sorted(said) != sorted(true):
        yield "the cells that are blocked and opened are not those of the scenario"
    if any(a[0] > b[0] for a, b in pairwise(said)):
        yield "the cells that are blocked and opened are not in the order of their times"
