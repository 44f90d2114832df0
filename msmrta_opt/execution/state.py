"""What a policy is shown when something happens, and what it answers with: robots and their visits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from ..mission.grid import Cell, GridMap
from ..mission.instance import Instance, Victim
from ..mission.plan import Plan
from ..mission.run import Event

Blocked = Literal["wait", "skip", "detour"]
"""What a robot does before a blocked cell: stand until it opens, leave the visit out, or go round it
by the shortest way that is known (and leave the visit out where there is none)."""


@dataclass(frozen=True)
class Task:
    """A visit to come: the kinds to serve at a victim, or a walk back, whose victim is ``None``.

    ``cells`` are those of the plan; empty where the way is to be found when the robot sets out.
    """

    victim: int | None
    served: tuple[str, ...] = ()
    cells: tuple[Cell, ...] = ()


@dataclass(frozen=True)
class RobotState:
    """A robot that is not lost: where and when it is free next, and what it is to do then.

    A move or a visit that is under way is committed: `cell` and `free_at` are those of its end, at
    the mission's speeds and service times. `queue` is without it. By then it has moved and served for
    `busy` time units, and walked so many cells.
    """

    robot: int
    cell: Cell
    free_at: float
    queue: tuple[Task, ...]
    busy: float = 0.0
    walked: int = 0


@dataclass(frozen=True)
class State:
    """What is known at a time.

    ``mission`` has the victims that are known; ``grid`` is the map as it is known; ``open`` holds by
    victim the kinds that are not served and not being served; ``news`` is what has just happened.
    """

    time: float
    mission: Instance
    grid: GridMap
    robots: tuple[RobotState, ...]
    open: Mapping[int, tuple[str, ...]]
    news: tuple[Event, ...]

    @property
    def left_out(self) -> set[tuple[int, int]]:
        """Robots and victims, where a visit has just been left out."""
        return {
            (event.robot, event.victim)
            for event in self.news
            if event.what == "skipped" and event.robot is not None and event.victim is not None
        }

    def victim(self, ident: int) -> Victim:
        """The known victim of that id."""
        return next(victim for victim in self.mission.victims if victim.id == ident)


Queues = Mapping[int, Sequence[Task]]
"""By robot what it is to do; robots that are not in it keep what they have."""


@dataclass(frozen=True)
class Situated:
    """What a policy is made for: the plan, its options, the seed."""

    plan: Plan
    options: Mapping[str, Any]
    seed: int


Decide = Callable[[State], Queues | None]


@dataclass(frozen=True, eq=False)
class Policy:
    """A way to react: ``begin(situated)`` gives the function that is asked whenever there is news.

    Parameters
    ----------
    name, title : str
        What it is called, and what it is.
    begin : function
        From what it is for to `Decide`.
    defaults : mapping
        Its options; ``blocked`` is every policy's.
    check : function of options, optional
        Raises `InputError` for values that are wrong, before anything happens.
    load : function of options, optional
        Imports what the policy uses first when it decides: that is start-up, and no time of deciding.
    """

    name: str
    title: str
    begin: Callable[[Situated], Decide]
    defaults: Mapping[str, Any] = field(default_factory=dict)
    check: Callable[[Mapping[str, Any]], object] | None = None
    load: Callable[[Mapping[str, Any]], object] | None = None
