"""The records of which a run is made: the world it met, where robots were, what they served and when."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field, NonNegativeInt

from .fields import Amount, CellField, Id, Speed
from .grid import GridMap
from .instance import Victim
from .proof import Finite
from .route import PlanRecord, Time

MAX_TOLD = 4
"""Changes of a decision that are told by name."""


class DrawnSpeed(PlanRecord):
    """The speed at which a robot moves, in cells per time unit."""

    robot: Id
    speed: Speed


class DrawnService(PlanRecord):
    """How long serving a kind at a victim takes, in time units."""

    victim: Id
    kind: str
    time: Amount


class Loss(PlanRecord):
    """A robot that does nothing any more from a time on."""

    robot: Id
    time: Amount


class Unknown(PlanRecord):
    """A victim that nobody knows of at first; ``announced`` is when everybody does."""

    victim: Victim
    announced: Amount | None = None


class Change(PlanRecord):
    """A cell that is free, or blocked, from a time on."""

    time: Amount
    cell: CellField
    free: bool


class World(PlanRecord):
    """What a scenario came to: all that is random, drawn before anything happens.

    It is the same whatever the policy does. ``changes`` are in the order in which they happen.
    """

    speeds: tuple[DrawnSpeed, ...]
    services: tuple[DrawnService, ...]
    lost: tuple[Loss, ...] = ()
    unknown: tuple[Unknown, ...] = ()
    changes: tuple[Change, ...] = ()

    def ever_free(self, grid: GridMap) -> GridMap:
        """The map with every cell free that is free in `grid` or at any time after."""
        opened = [
            change.cell for change in self.changes if change.free and not grid.free[change.cell]
        ]
        if not opened:
            return grid
        free = grid.free.copy()
        free[tuple(zip(*opened, strict=True))] = True
        return replace(grid, free=free)


class Walked(PlanRecord):
    """The cells in which a robot was, its start first, and when it came into each."""

    robot: Id
    cells: Annotated[tuple[CellField, ...], Field(min_length=1)]
    times: Annotated[tuple[Time, ...], Field(min_length=1)]


class Service(PlanRecord):
    """A robot that serves a requirement; not ``done`` if it was lost over it, or the run ended."""

    robot: Id
    victim: Id
    kind: str
    began: Time
    ended: Time
    done: bool = True


What = Literal[
    "lost",
    "announced",
    "found",
    "blocked",
    "opened",
    "noticed",
    "served",
    "cut short",
    "skipped",
    "waiting",
    "decided",
]


class Event(PlanRecord):
    """Something that happened, to whom and where."""

    time: Time
    what: What
    robot: Id | None = None
    victim: Id | None = None
    kind: str | None = None
    cell: CellField | None = None

    def __str__(self) -> str:
        words = [self.what] + ([self.kind, "at"] if self.kind else [])
        words += [] if self.victim is None else [f"victim {self.victim}"]
        who = "" if self.robot is None else f"robot {self.robot}"
        if self.what == "waiting":
            where = "back" if self.victim is None else f"to victim {self.victim}"
            return f"{who} still waits for a way {where}"
        if self.what == "lost":
            return f"lost {who} in {list(self.cell or ())}"
        words += [] if self.cell is None else [f"{list(self.cell)}"]
        return " ".join([*words, *(["by", who] if who else [])])


class Queued(PlanRecord):
    """A visit to come."""

    victim: Id
    served: tuple[str, ...]


class Queue(PlanRecord):
    """The visits to come of a robot, in their order; without the one that is under way."""

    robot: Id
    visits: tuple[Queued, ...]


class Hindsight(PlanRecord):
    """A run beside the best that could have been, had all been known from the beginning.

    By an objective: what the ``run`` came to, the ``best`` routes found that serve the same, and the
    ``bound`` below which no policy that serves the same can come. ``proved`` is whether the best is
    proved to be optimal.
    """

    objective: str
    run: Finite
    best: Finite
    bound: Finite
    proved: bool

    @property
    def regret(self) -> tuple[float, float]:
        """What not knowing cost: at least, and at most; the same where the best is proved."""
        minimum = max(self.run - self.best, 0.0)
        return minimum, minimum if self.proved else max(self.run - self.bound, 0.0)

    def __str__(self) -> str:
        low, high = self.regret
        cost = f"{low:.6g}" if self.proved else f"{low:.6g} to {high:.6g}"
        how = "optimal" if self.proved else f"no less than {self.bound:.6g}"
        return (
            f"{self.objective} {self.run:.6g}; with all known from the beginning {self.best:.6g} "
            f"({how}); regret {cost}"
        )


class Decision(PlanRecord):
    """A policy's: what every robot that is left was to do before it, and is to do after it.

    ``changed`` is the number of visits that are taken from a robot.
    """

    time: Time
    before: tuple[Queue, ...]
    after: tuple[Queue, ...]
    changed: NonNegativeInt

    def __str__(self) -> str:
        """Who is told to do what he was not, for instance ``victim 50 Aid to robot 3``."""
        before, after = _robots(self.before), _robots(self.after)
        given = [
            f"victim {victim} {kind} to robot {robot}"
            for (victim, kind), robot in after.items()
            if before.get((victim, kind)) != robot
        ]
        dropped = [f"victim {victim} {kind} to nobody" for victim, kind in before.keys() - after]
        moved = [*given, *sorted(dropped)]
        more = [f"{len(moved) - MAX_TOLD} more"] if len(moved) > MAX_TOLD else []
        return "decided: " + ("; ".join([*moved[:MAX_TOLD], *more]) or "nothing is changed")


def _robots(queues: tuple[Queue, ...]) -> dict[tuple[int, str], int]:
    """Who is to serve which requirement."""
    return {
        (visit.victim, kind): queue.robot
        for queue in queues
        for visit in queue.visits
        for kind in visit.served
    }
