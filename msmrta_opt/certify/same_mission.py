"""Whether a plan is for the mission at hand, and how that differs if it is not."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol, TypeVar

import numpy as np

from ..mission.grid import GridMap
from ..mission.instance import Instance, Robot, Scout, Victim
from ..mission.plan import Plan


class _Member(Protocol):
    @property
    def id(self) -> int: ...


Member = TypeVar("Member", bound=_Member)
Facts = dict[str, Callable[[Member], object]]

ROBOT: Facts[Robot] = {
    "starts elsewhere": lambda robot: robot.start,
    "has another speed": lambda robot: robot.speed,
    "has other capabilities": lambda robot: ", ".join(sorted(robot.capabilities)) or "none",
}
VICTIM: Facts[Victim] = {
    "stands elsewhere": lambda victim: victim.cell,
    "needs something else": lambda victim: ", ".join(sorted(victim.requirements)) or "nothing",
    "has other service times": lambda victim: victim.service_time or "none of its own",
    "has another priority": lambda victim: victim.priority,
}
SCOUT: Facts[Scout] = {
    "starts elsewhere": lambda scout: scout.start,
    "sees another distance": lambda scout: scout.visual_field_depth,
}


def differences(plan: Plan, mission: Instance) -> list[str]:
    """How the mission of `plan` differs from `mission`, one line each; empty if it does not.

    Names, and the order of robots, victims, scouts and kinds, make no difference.
    """
    own = plan.instance
    return [
        *_map(own.map, mission.map),
        *_kinds(own, mission),
        *_members("robot", own.robots, mission.robots, ROBOT),
        *_members("victim", own.victims, mission.victims, VICTIM),
        *_members("scout", own.scouts, mission.scouts, SCOUT),
    ]


def _map(own: GridMap, other: GridMap) -> Iterator[str]:
    if own.shape != other.shape:
        sizes = (f"{rows} × {cols}" for rows, cols in (own.shape, other.shape))
        yield _said("the map has another size", *sizes)
        return
    cells = np.argwhere(own.free != other.free).tolist()
    if cells:
        row, col = cells[0]
        more = f" (and {len(cells) - 1} more cells)" if len(cells) > 1 else ""
        names = ("free", "blocked") if own.free[row, col] else ("blocked", "free")
        yield _said(f"the map differs at {(row, col)}", *names) + more


def _kinds(own: Instance, other: Instance) -> Iterator[str]:
    yield from _missing("kind", own.capabilities, other.capabilities)
    for kind in own.capabilities:
        times = own.service_time[kind], other.service_time.get(kind)
        if None not in times and times[0] != times[1]:
            yield _said(f"serving {kind} takes another time", *times)


def _members(
    kind: str, own: Sequence[Member], other: Sequence[Member], facts: Facts[Member]
) -> Iterator[str]:
    theirs = {member.id: member for member in other}
    yield from _missing(kind, [member.id for member in own], list(theirs))
    for member in own:
        if member.id in theirs:
            for differs, fact in facts.items():
                values = fact(member), fact(theirs[member.id])
                if values[0] != values[1]:
                    yield _said(f"{kind} {member.id} {differs}", *values)


def _missing(kind: str, own: Sequence[object], other: Sequence[object]) -> Iterator[str]:
    yield from (f"{kind} {name} is not in the mission" for name in own if name not in other)
    yield from (f"{kind} {name} is not in the plan" for name in other if name not in own)


def _said(what: str, own: object, other: object) -> str:
    return f"{what}, {own} in the plan and {other} in the mission"
