"""The independent plan checker.

It shares no code with the planners: reachability comes from its own flood fill, availability, moves
and times are worked out again from the instance alone.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from math import isfinite
from numbers import Real

from ..mission.errors import CheckError
from ..mission.grid import Cell
from ..mission.instance import Instance
from ..mission.plan import Plan, Reason
from .joint_problem import servable

TOLERANCE = 1e-6
"""Time units by which arrival and departure may differ from the walked distance."""


def problems(plan: Plan) -> list[str]:
    """Everything that is wrong with `plan`, one line each; empty if it holds.

    Robots and victims exist and each robot has at most one route; routes start at the robot's
    start and move one free cell at a time; each visit ends at its victim, at the right time, and
    serves kinds that the robot has and the victim needs; each available requirement is served
    exactly once; what is unserved is listed once, with the true reason; and robots keep to the
    limits that the plan's options say it was made under (``endurance`` in time units,
    ``longest_walk`` in cells, ``return_to_start``).
    """
    wrong = _names(plan) + _limits(plan)
    return wrong or _routes(plan) + _within_limits(plan) + _services(plan)


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
        f"victim {item.victim} is listed as unserved for {item.kind}, not its need"
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
        most = plan.limits.get(name)
        number = isinstance(most, Real) and not isinstance(most, bool)
        if most is not None and not (number and isfinite(most) and most >= 0):
            wrong.append(f"option {name} is {most!r}, which is no number from 0 on")
    returns = plan.limits.get("return_to_start")
    if returns is not None and not isinstance(returns, bool):
        wrong.append(f"option return_to_start is {returns!r}, which is not true or false")
    return wrong


def _routes(plan: Plan) -> list[str]:
    """Moves legal, stops where they should be, times consistent."""
    instance = plan.instance
    robots = {robot.id: robot for robot in instance.robots}
    victims = {victim.id: victim for victim in instance.victims}
    wrong: list[str] = []
    for route in plan.routes:
        robot = robots[route.robot]
        here, clock = robot.start, 0.0
        for visit in route.visits:
            where = f"robot {robot.id} on its way to victim {visit.victim}"
            victim = victims[visit.victim]
            wrong.extend(_walk(instance, where, here, victim.cell, visit.cells))
            arrival = clock + (len(visit.cells) - 1) / robot.speed
            if abs(visit.arrival - arrival) > TOLERANCE:
                wrong.append(f"{where} arrives at {visit.arrival:g}, which should be {arrival:g}")
            service = sum(
                victim.service_time.get(kind, instance.service_time.get(kind, 0.0))
                for kind in visit.served
            )
            departure = arrival + service
            if abs(visit.departure - departure) > TOLERANCE:
                wrong.append(
                    f"{where} leaves at {visit.departure:g}, which should be {departure:g}"
                )
            here, clock = victim.cell, departure
        if route.back and not route.visits:
            wrong.append(f"robot {robot.id} walks without a visit")
        elif route.back:
            wrong.extend(
                _walk(instance, f"robot {robot.id} on its way back", here, robot.start, route.back)
            )
    return wrong


def _within_limits(plan: Plan) -> list[str]:
    """No robot is busy or walks beyond its limits, and all return if they are to."""
    endurance, longest_walk = (plan.limits.get(name) for name in ("endurance", "longest_walk"))
    robots = {robot.id: robot for robot in plan.instance.robots}
    wrong = []
    for route in plan.routes:
        if not route.visits:
            continue
        robot, last = robots[route.robot], route.visits[-1]
        busy = last.departure + max(len(route.back) - 1, 0) / robot.speed
        if endurance is not None and busy > endurance + TOLERANCE:
            wrong.append(f"robot {robot.id} is busy for {busy:g}, beyond its {endurance:g}")
        if longest_walk is not None and route.distance > longest_walk:
            wrong.append(f"robot {robot.id} walks {route.distance}, beyond its {longest_walk:g}")
        stays = not route.back and last.cells[-1] != robot.start
        if plan.limits.get("return_to_start") and stays:
            wrong.append(f"robot {robot.id} stays at {last.cells[-1]} instead of returning")
    return wrong


def _walk(
    instance: Instance, where: str, start: Cell, end: Cell, cells: tuple[Cell, ...]
) -> list[str]:
    wrong = []
    if cells[0] != start:
        wrong.append(f"{where} sets out from {cells[0]}, but is at {start}")
    if cells[-1] != end:
        wrong.append(f"{where} ends at {cells[-1]}, not at {end}")
    for row, col in cells:
        if not instance.map.is_free((row, col)):
            wrong.append(f"{where} enters {(row, col)}, which is not a free cell")
    for (r0, c0), (r1, c1) in pairwise(cells):
        if abs(r0 - r1) + abs(c0 - c1) != 1:
            wrong.append(f"{where} jumps from {(r0, c0)} to {(r1, c1)}")
    return wrong


def _services(plan: Plan) -> list[str]:
    """Capabilities present, each available requirement served once, the rest rightly listed."""
    instance = plan.instance
    robots = {robot.id: robot for robot in instance.robots}
    victims = {victim.id: victim for victim in instance.victims}
    hidden = set(plan.scouting.not_found) if plan.scouting else set()
    component = _components(instance)
    wrong: list[str] = []
    served: Counter[tuple[int, str]] = Counter()
    for route in plan.routes:
        for visit in route.visits:
            if visit.victim in hidden:
                wrong.append(f"victim {visit.victim} is visited, but was not found")
            for kind in visit.served:
                served[visit.victim, kind] += 1
                if kind not in robots[route.robot].capabilities:
                    wrong.append(f"robot {route.robot} serves {kind} without having it")
                if kind not in victims[visit.victim].requirements:
                    wrong.append(f"victim {visit.victim} is served {kind} without needing it")
    listed = Counter((item.victim, item.kind) for item in plan.unserved)
    reason = {(item.victim, item.kind): item.reason for item in plan.unserved}
    is_limited = any(said.limits for said in reason.values())
    within = {(v, k) for _, v, k in servable(plan)} if is_limited else set()
    for victim in instance.victims:
        for kind in victim.requirements:
            need = (victim.id, kind)
            what = f"{kind} of victim {victim.id}"
            if served[need] + listed[need] != 1:
                wrong.append(f"{what} is served {served[need]}× and unserved {listed[need]}×")
            capable = [robot for robot in instance.robots if kind in robot.capabilities]
            reaching = [r for r in capable if component[r.start] == component[victim.cell]]
            true = (
                Reason.NOT_FOUND
                if victim.id in hidden
                else Reason.NO_ROBOT_HAS_IT
                if not capable
                else Reason.NO_CAPABLE_ROBOT_REACHES_IT
                if not reaching
                else None
            )
            if listed[need]:
                said = reason[need]
                if true is None and _is_under(plan, said):
                    if need in within:
                        wrong.append(f"{what} is unserved, but is within some robot's limits")
                    continue
                if said != true:
                    wrong.append(
                        f"{what} is unserved for {str(said)!r}; in truth: {true or 'available'}"
                    )
    return wrong


def _is_under(plan: Plan, reason: Reason) -> bool:
    """Whether the plan was made under the limits for which it says that a requirement stays open."""
    given = {name for name in ("endurance", "longest_walk") if plan.limits.get(name) is not None}
    if reason is Reason.BEYOND_ENDURANCE:  # in the files of before, of either limit
        return bool(given)
    return bool(reason.limits) and given.issuperset(reason.limits)


def _components(instance: Instance) -> dict[Cell, int]:
    """The connected component of each free cell, by flood fill."""
    component: dict[Cell, int] = {}
    n_rows, n_cols = instance.map.shape
    free = instance.map.free.tolist()
    for row in range(n_rows):
        for col in range(n_cols):
            if not free[row][col] or (row, col) in component:
                continue
            label = len(component)
            component[row, col] = label
            border = [(row, col)]
            while border:
                r, c = border.pop()
                for cell in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
                    inside = 0 <= cell[0] < n_rows and 0 <= cell[1] < n_cols
                    if inside and free[cell[0]][cell[1]] and cell not in component:
                        component[cell] = label
                        border.append(cell)
    return component
