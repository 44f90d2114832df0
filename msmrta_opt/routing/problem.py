"""The joint problem in arrays, its solutions, and when things happen on them.

Serve every requirement exactly once; a victim may be split over robots, a robot may serve several
requirements in one visit and visits a victim at most once; routes are open, from the start cells,
unless robots return. Walking is symmetric: between two victims a robot takes the same time both ways.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from ..arrays import Bools, Floats, Ints
from ..optimise.axes import Axis, derived, over
from ..optimise.mission_data import MissionData

Visit = tuple[int, tuple[int, ...]]
"""A victim, and the kinds served there."""
Routes = tuple[tuple[Visit, ...], ...]
"""Per robot its visits in order; a robot without visits stays at home."""

SUMS = 1e-12
"""Relative difference of two sums of the same floats in different orders, at the maximum."""


@dataclass(frozen=True, eq=False)
class RoutingData(MissionData):
    """The joint problem, by positions; all times in time units.

    The stage reads binary variables ``x`` over (r, i, j), robot r goes from place i to victim j;
    ``y`` over (r, v), it visits victim v; and ``a`` over (r, v, k), it serves kind k there. Places i
    are the victims and, last, the robot's start. Requirements that no robot can serve are left out
    before. Travel times of pairs that a robot cannot walk mean nothing and are 0; `able` says which
    victims it can reach at all, and those that it can reach it can walk between.
    """

    stage = "routing"
    axes = MappingProxyType(
        {
            "r": Axis("robot"),
            "i": Axis("place", of="v", last="start"),
            "v": Axis("victim"),
            "j": Axis("next victim", of="v"),
            "k": Axis("kind"),
        }
    )
    solution = MappingProxyType({"x": ("r", "i", "j"), "y": ("r", "v"), "a": ("r", "v", "k")})
    may_be_one = MappingProxyType({"x": "can_go", "y": "can_visit", "a": "able"})

    leave: Floats = field(metadata=over("r", "v", unit="time units"))
    """Travel of robot r from its start to victim v."""
    length: Floats
    """How long the ways between victims are, symmetric: a table for each robot, ``(n_robots, n_victims,
    n_victims)``, or one for all, ``(1, n_victims, n_victims)``. Divided by `speed` it is travel."""
    back: Floats = field(metadata=over("r", "v", unit="time units"))
    """Travel of r from v back to its start; zero for open routes."""
    service: Floats = field(metadata=over("v", "k", unit="time units"))
    """Service time of kind k at victim v."""
    able: Bools = field(metadata=over("r", "v", "k"))
    """Whether r can serve kind k at v: needed, capable, and reachable."""
    priority: Floats = field(metadata=over("v"))
    """Weight of victim v's completion time."""
    endurance: Floats = field(metadata=over("r", infinite=True, unit="time units"))
    """Longest time that r may be busy, ``inf`` for no limit."""
    longest_walk: Floats = field(metadata=over("r", infinite=True, unit="time units"))
    """Longest travel time of r, ``inf`` for no limit."""
    speed: Floats = field(default_factory=lambda: np.ones(0), kw_only=True)
    """Length that r covers in one time unit, over (r); 1 where none is given."""
    is_metric: bool = field(default=False, kw_only=True)
    """Whether it is known that no detour is shorter than the direct way, as for walks."""
    planned: Bools = field(
        default_factory=lambda: np.zeros((0, 0), dtype=bool), kw_only=True, metadata=over("r", "v")
    )
    """Whether r was to visit v by the plan in force; nowhere if there is none."""
    ready: Floats = field(
        default_factory=lambda: np.zeros(0),
        kw_only=True,
        metadata=over("r", unit="time units"),
    )
    """When r is done with what is under way, from now; 0 if nothing is."""
    time_unit: float = field(default=1.0, kw_only=True)
    """What 1 of these times is in the mission's time units; a power of two."""
    priority_unit: float = field(default=1.0, kw_only=True)
    """What 1 of these priorities is in the mission's; a power of two."""

    def __post_init__(self) -> None:
        if not len(self.speed):
            object.__setattr__(self, "speed", np.ones(len(self.leave)))
        if not self.planned.size:
            object.__setattr__(self, "planned", np.zeros(self.able.shape[:2], dtype=bool))
        if not len(self.ready):
            object.__setattr__(self, "ready", np.zeros(len(self.leave)))
        super().__post_init__()
        n, m, _ = self.able.shape
        if self.length.shape not in ((n, m, m), (1, m, m)) or self.speed.shape != (n,):
            raise ValueError(
                f"length has shape {self.length.shape}; give {(n, m, m)}, or {(1, m, m)} with a speed"
                " for each robot"
            )
        if not np.isfinite(self.length).all() or not (self.speed > 0).all():
            raise ValueError(
                "length holds values that are not finite, or speed some that are not > 0"
            )

    def way(self, robot: Any, victim: Any, other: Any) -> Any:
        """Travel of robots from victims to others: numbers, or arrays of one shape."""
        own = robot if len(self.length) > 1 else 0
        return self.length[own, victim, other] / self.speed[robot]

    def ways(self, robot: int, victims: Ints) -> Floats:
        """Travel of one robot between some victims, ``(len(victims), len(victims))``."""
        own = self.length[robot if len(self.length) > 1 else 0]
        return np.asarray(own[np.ix_(victims, victims)] / self.speed[robot])

    @derived("r", "v", "j", unit="time units")
    def between(self) -> Floats:
        """Travel of robot r between victims, symmetric."""
        return np.asarray(self.length / self.speed[:, None, None])

    @property
    def n_robots(self) -> int:
        """N."""
        return int(self.able.shape[0])

    @property
    def n_victims(self) -> int:
        """M."""
        return int(self.able.shape[1])

    @property
    def n_kinds(self) -> int:
        """Number of kinds of requirement."""
        return int(self.able.shape[2])

    @derived("v", "k")
    def required(self) -> Bools:
        """Requirements to be served."""
        return np.asarray(self.able.any(axis=0))

    @derived("r", "v")
    def can_visit(self) -> Bools:
        """Whether r can serve something at v."""
        return np.asarray(self.able.any(axis=2))

    @derived("r", "i", "j", unit="time units")
    def travel(self) -> Floats:
        """Travel of r from place i to victim j."""
        return np.concatenate([self.between, self.leave[:, None, :]], axis=1)

    @derived("r", "i", "j")
    def can_go(self) -> Bools:
        """Whether r can serve something at j ≠ i, and at i if that is a victim."""
        here = np.pad(self.can_visit, ((0, 0), (0, 1)), constant_values=True)
        elsewhere = ~np.eye(self.n_victims + 1, self.n_victims, dtype=bool)
        return np.asarray(here[:, :, None] & self.can_visit[:, None, :] & elsewhere)

    @derived("r", "i", unit="victims")
    def onward(self) -> Ints:
        """Number of victims that r can go to from place i."""
        return np.asarray(self.can_go.sum(axis=2))

    @derived("r", unit="victims")
    def maximum_visits(self) -> Ints:
        """Number of victims that r can visit, at least 1."""
        return np.asarray(np.maximum(self.can_visit.sum(axis=1), 1))

    @derived("r", unit="time units")
    def maximum_travel(self) -> Floats:
        """Travel time that no route of r exceeds: a finite big-M.

        The longest walk, but no more than the longest way to each victim and the longest way back.
        """
        longest = (self.travel * self.can_go).max(axis=1).sum(axis=1) + self.back.max(axis=1)
        return np.asarray(np.minimum(self.longest_walk, longest))

    @derived("r", unit="time units")
    def maximum_busy(self) -> Floats:
        """Time that no route of r exceeds: a finite big-M.

        Its endurance, but no more than its maximum travel and the service of all that it can serve.
        """
        service = (self.service * self.able).sum(axis=(1, 2))
        return np.asarray(np.minimum(self.endurance, self.maximum_travel + service))

    @cached_property
    def nearest(self) -> dict[int, Ints]:
        """The victims that need something, the nearest first, for each of them."""
        return self.nearest_of(self.n_victims)

    def nearest_of(self, many: int) -> dict[int, Ints]:
        """The same, of each at most so many."""
        needed = np.flatnonzero(self.required.any(axis=1))
        far = self.between.max(axis=0) if len(self.length) > 1 else self.length[0]
        # One after the other: all orders at once are as large as all ways.
        return {int(v): needed[np.argsort(far[v, needed], kind="stable")[:many]] for v in needed}

    @property
    def total_service(self) -> float:
        """Service time of all requirements: part of the total time of all routes."""
        return float(self.service[self.required].sum())


@dataclass(frozen=True, eq=False)
class Times:
    """When things happen on `Routes`."""

    travel: Floats
    """Travel per robot, the way back included, ``(n_robots,)``."""
    busy: Floats
    """When each robot is done, 0 if it stays at home, ``(n_robots,)``."""
    completion: Floats
    """When each victim's last requirement is done, 0 if none is served, ``(n_victims,)``."""


def times(data: RoutingData, routes: Routes) -> Times:
    """Travel, finishing and completion times of `routes`."""
    travel = np.zeros(data.n_robots)
    busy = np.zeros(data.n_robots)
    completion = np.zeros(data.n_victims)
    for r, route in enumerate(routes):
        last: int | None = None
        for v, kinds in route:
            step = data.leave[r, v] if last is None else data.way(r, last, v)
            travel[r] += step
            busy[r] += step + data.service[v, list(kinds)].sum()
            completion[v] = max(completion[v], busy[r])
            last = v
        if last is not None:
            travel[r] += data.back[r, last]
            busy[r] += data.back[r, last]
    return Times(travel, busy, completion)


def faults(data: RoutingData, routes: Routes) -> list[str]:
    """What is wrong with `routes`, one line each, in ids; empty if nothing is."""
    wrong: list[str] = []
    served: Counter[tuple[int, int]] = Counter()
    if len(routes) != data.n_robots:
        return [f"{len(routes)} routes for {data.n_robots} robots"]
    robots, victims, kinds_named = data.ids["r"], data.ids["v"], data.ids["k"]
    for robot, r, route in zip(robots, range(data.n_robots), routes, strict=True):
        visits = Counter(v for v, _ in route)
        wrong += [
            f"robot {robot} visits victim {victims[v]} {n} times"
            for v, n in visits.items()
            if n > 1
        ]
        for v, kinds in route:
            if not kinds:
                wrong.append(f"robot {robot} visits victim {victims[v]} for nothing")
            for k in kinds:
                served[v, k] += 1
                if not data.able[r, v, k]:
                    what = f"kind {kinds_named[k]} at victim {victims[v]}"
                    wrong.append(f"robot {robot} cannot serve {what}")
    for v, k in np.argwhere(data.required).tolist():
        if served[v, k] != 1:
            what = f"kind {kinds_named[k]} at victim {victims[v]}"
            wrong.append(f"{what} is served {served[v, k]} times")
    at = times(data, routes)
    for robot, busy, travel, endurance, longest_walk in zip(
        robots, at.busy, at.travel, data.endurance, data.longest_walk, strict=True
    ):
        if busy > endurance * (1 + SUMS):
            wrong.append(f"robot {robot} is busy for {busy:g}, beyond {endurance:g}")
        if travel > longest_walk * (1 + SUMS):
            wrong.append(f"robot {robot} travels for {travel:g}, beyond {longest_walk:g}")
    return wrong
