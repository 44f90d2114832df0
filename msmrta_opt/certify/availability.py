"""What of a mission no robot can serve, worked out from the instance alone."""

from __future__ import annotations

from ..mission.instance import Instance
from .walking import components


def unavailable(instance: Instance) -> list[str]:
    """Requirements that no robot has, or that none who has them can reach, a line for each kind."""
    component = components(instance.map)
    nobody: dict[str, list[int]] = {}
    unreached: dict[str, list[int]] = {}
    for victim in instance.victims:
        for kind in victim.requirements:
            capable = [robot for robot in instance.robots if kind in robot.capabilities]
            if not capable:
                nobody.setdefault(kind, []).append(victim.id)
            elif not any(component[r.start] == component[victim.cell] for r in capable):
                unreached.setdefault(kind, []).append(victim.id)
    return [
        *(f"no robot has {kind}, which {_victims(ids)}" for kind, ids in nobody.items()),
        *(
            f"no robot that has {kind} can reach {_who(ids)}, which {_needs(ids)} it"
            for kind, ids in unreached.items()
        ),
    ]


def _victims(ids: list[int]) -> str:
    return f"{_who(ids)} {_needs(ids)}"


def _who(ids: list[int]) -> str:
    return f"victim{'' if len(ids) == 1 else 's'} {', '.join(map(str, ids))}"


def _needs(ids: list[int]) -> str:
    return "needs" if len(ids) == 1 else "need"
