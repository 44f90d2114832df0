"""The independent plan checker.

It shares no code with the planners: what is joined on the map, availability, moves, times, clusters and
what scouts see are worked out again from the instance alone.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import pairwise
from math import inf

from ..arrays import Ints
from ..mission.errors import CheckError
from ..mission.exact import exact
from ..mission.grid import Cell
from ..mission.instance import Instance, Robot, Victim
from ..mission.plan import Plan, Reason
from ..mission.route import Route
from . import clusters, scouting
from .joint_problem import ROUNDING, Limits, beyond_limits, figure
from .walking import are_legal, components


def problems(plan: Plan) -> list[str]:
    """Everything that is wrong with `plan`, one line each; empty if it holds.

    Robots and victims exist and each robot has at most one route; routes start at the robot's
    start and move one free cell at a time; each visit ends at its victim, at the right time, and
    serves kinds that the robot has and the victim needs; each available requirement is served
    exactly once; what is unserved is listed once, with the true reason; robots keep to the
    limits that the plan's options say it was made under (``endurance`` in time units,
    ``longest_walk`` in cells, ``return_to_start``); scouts did what is reported of them; and clusters
    are what they are said to be.
    """
    wrong = _names(plan) + _limits(plan) + scouting.problems(plan)
    if wrong:
        return wrong
    component = components(plan.instance.map)
    return [
        *_routes(plan),
        *_within_limits(plan),
        *_services(plan, component),
        *clusters.problems(plan, component),
    ]


def check_plan(plan: Plan) -> Plan:
    """`plan` itself, if it holds.

    Raises
    ------
    CheckError
        If it does not, saying how.
    """
    wrong = problems(plan)
    if wrong:
        more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
        raise CheckError(f"the plan of {plan.planner!r} fails its check: {wrong[0]}{more}")
    return plan


def _names(plan: Plan) -> list[str]:
    robots = {robot.id for robot in plan.instance.robots}
    kinds_of = {victim.id: set(victim.requirements) for victim in plan.instance.victims}
    wrong = []
    for robot, count in Counter(route.robot for route in plan.routes).items():
        if robot not in robots:
            wrong.append(f"there is no robot {robot}")
        if count > 1:
            wrong.append(f"robot {robot} has {count} routes")
    for route in plan.routes:
        for visit in route.visits:
            if visit.victim not in kinds_of:
                there = f"robot {route.robot} visits victim {visit.victim}"
                wrong.append(f"{there}, which is not there")
    wrong.extend(
        f"victim {item.victim} is listed as unserved for {item.kind}, which it does not need"
        for item in plan.unserved
        if item.kind not in kinds_of.get(item.victim, set())
    )
    if plan.scouting is not None:
        wrong.extend(
            f"victim {victim} is listed as not found, and is not there"
            for victim in plan.scouting.not_found
            if victim not in kinds_of
        )
    return wrong


def _limits(plan: Plan) -> list[str]:
    """The limits that the plan was made under are numbers, and whether to return is yes or no."""
    wrong = []
    for name in ("endurance", "longest_walk"):
        limit = plan.limits.get(name)
        number = isinstance(limit, (int, float)) and not isinstance(limit, bool)
        if limit is not None and not (number and 0 <= limit < inf):
            wrong.append(f"option {name} is {_shown(limit)}, which is no number from 0 on")
    returns = plan.limits.get("return_to_start")
    if returns is not None and not isinstance(returns, bool):
        wrong.append(f"option return_to_start is {_shown(returns)}, which is not true or false")
    return wrong


def _shown(value: object) -> str:
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return "too long to show"
    return text if len(text) <= 60 else f"{text[:59]}…"


def _routes(plan: Plan) -> Iterator[str]:
    """Moves legal, stops where they should be, times consistent."""
    instance = plan.instance
    robots = {robot.id: robot for robot in instance.robots}
    victims = {victim.id: victim for victim in instance.victims}
    for route in plan.routes:
        robot = robots[route.robot]
        if _is_plainly_right(route, robot, victims, instance):
            continue
        here, clock, speed = robot.start, Fraction(0), exact(robot.speed)
        for visit in route.visits:
            where = f"robot {robot.id} on its way to victim {visit.victim}"
            victim = victims[visit.victim]
            yield from _walk(instance, where, here, victim.cell, visit.cells)
            clock += (len(visit.cells) - 1) / speed
            if _differs(visit.arrival, clock):
                yield f"{where} arrives at {visit.arrival:g}, which should be {figure(clock)}"
            for kind in visit.served:
                clock += exact(victim.service_time.get(kind, instance.service_time.get(kind, 0.0)))
            if _differs(visit.departure, clock):
                yield f"{where} leaves at {visit.departure:g}, which should be {figure(clock)}"
            here = victim.cell
        if route.back and not route.visits:
            yield f"robot {robot.id} walks without a visit"
        elif route.back:
            where = f"robot {robot.id} on its way back"
            yield from _walk(instance, where, here, robot.start, route.back)


def _is_plainly_right(
    route: Route, robot: Robot, victims: Mapping[int, Victim], instance: Instance
) -> bool:
    """Whether nothing is wrong with `route`, by a margin that no rounding of floats can use up.

    What is not plainly right is looked at move by move, in exact numbers.
    """
    here, clock, margin = robot.start, 0.0, float(ROUNDING) / 2
    for visit in route.visits:
        victim = victims[visit.victim]
        if visit.cells[0] != here or visit.cells[-1] != victim.cell:
            return False
        clock += (len(visit.cells) - 1) / robot.speed
        arrival = clock
        for kind in visit.served:
            clock += victim.service_time.get(kind, instance.service_time.get(kind, 0.0))
        here = victim.cell
        if not (
            abs(visit.arrival - arrival) <= margin * arrival
            and abs(visit.departure - clock) <= margin * clock
        ):
            return False
    if route.back and not (route.visits and (route.back[0], route.back[-1]) == (here, robot.start)):
        return False
    return are_legal(instance.map, [*(visit.cells for visit in route.visits), route.back])


def _differs(said: float, true: Fraction) -> bool:
    return abs(exact(said) - true) > ROUNDING * true


def _within_limits(plan: Plan) -> Iterator[str]:
    """No robot is busy or walks beyond its limits, and all return if they are to."""
    if not plan.limits:
        return
    limits = Limits.of(plan)
    robots = {robot.id: robot for robot in plan.instance.robots}
    for route in plan.routes:
        if not route.visits:
            continue
        robot, last = robots[route.robot], route.visits[-1]
        busy = exact(last.departure) + max(len(route.back) - 1, 0) / exact(robot.speed)
        if limits.too_long(busy):
            limit = figure(exact(plan.limits["endurance"]))
            yield f"robot {robot.id} is busy for {figure(busy)}, beyond its {limit}"
        if limits.too_far(route.distance):
            limit = figure(exact(plan.limits["longest_walk"]))
            yield f"robot {robot.id} walks {route.distance}, beyond its {limit}"
        if limits.returns and not route.back and last.cells[-1] != robot.start:
            yield f"robot {robot.id} stays at {last.cells[-1]} instead of returning"


def _walk(
    instance: Instance, where: str, start: Cell, end: Cell, cells: tuple[Cell, ...]
) -> Iterator[str]:
    if cells[0] != start:
        yield f"{where} sets out from {cells[0]}, but is at {start}"
    if cells[-1] != end:
        yield f"{where} ends at {cells[-1]}, not at {end}"
    for cell in cells:
        if not instance.map.is_free(cell):
            yield f"{where} enters {cell}, which is not a free cell"
    for (r0, c0), (r1, c1) in pairwise(cells):
        if abs(r0 - r1) + abs(c0 - c1) != 1:
            yield f"{where} jumps from {(r0, c0)} to {(r1, c1)}"


def _services(plan: Plan, component: Ints) -> Iterator[str]:
    """Capabilities present, each available requirement served once, the rest rightly listed."""
    instance = plan.instance
    robots = {robot.id: robot for robot in instance.robots}
    kinds_of = {victim.id: victim.requirements for victim in instance.victims}
    hidden = set(plan.scouting.not_found) if plan.scouting else set()
    served: Counter[tuple[int, str]] = Counter()
    for route in plan.routes:
        for visit in route.visits:
            if visit.victim in hidden:
                yield f"victim {visit.victim} is visited, but was not found"
            for kind in visit.served:
                served[visit.victim, kind] += 1
                if kind not in robots[route.robot].capabilities:
                    yield f"robot {route.robot} serves {kind} without having it"
                if kind not in kinds_of[visit.victim]:
                    yield f"victim {visit.victim} is served {kind} without needing it"
    listed = Counter((item.victim, item.kind) for item in plan.unserved)
    said = {(item.victim, item.kind): item.reason for item in plan.unserved}
    beyond = beyond_limits(plan) if any(reason.limits for reason in said.values()) else {}
    for victim in instance.victims:
        for kind in victim.requirements:
            requirement = (victim.id, kind)
            what = f"{kind} of victim {victim.id}"
            if served[requirement] + listed[requirement] != 1:
                yield (
                    f"{what} is served {served[requirement]}× and unserved {listed[requirement]}×"
                )
            if not listed[requirement]:
                continue
            excuse = said[requirement]
            true = _reason(plan, victim.id in hidden, kind, victim.cell, component)
            if true is None and _is_under(plan, excuse):
                true = beyond.get(requirement)
                if true is None:
                    yield f"{what} is unserved, but is within some robot's limits"
                    continue
                if excuse is Reason.BEYOND_ENDURANCE:  # in the files of before, of either limit
                    continue
            if excuse != true:
                yield f"{what} is unserved for {str(excuse)!r}; in truth: {true or 'available'}"


def _is_under(plan: Plan, reason: Reason) -> bool:
    """Whether the plan was made under the limits for which it says that a requirement stays open."""
    given = {name for name in ("endurance", "longest_walk") if plan.limits.get(name) is not None}
    if reason is Reason.BEYOND_ENDURANCE:
        return bool(given)
    return bool(reason.limits) and given.issuperset(reason.limits)


def _reason(plan: Plan, hidden: bool, kind: str, cell: Cell, component: Ints) -> Reason | None:
    """Why a requirement cannot be served, apart from limits; ``None`` if it can."""
    if hidden:
        return Reason.NOT_FOUND
    capable = [robot for robot in plan.instance.robots if kind in robot.capabilities]
    if not capable:
        return Reason.NO_ROBOT_HAS_IT
    if not any(component[robot.start] == component[cell] for robot in capable):
        return Reason.NO_CAPABLE_ROBOT_REACHES_IT
    return None
