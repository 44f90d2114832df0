"""The table of metrics: what a plan serves, how far its robots walk, when its victims are done.

A metric is one method of `Metrics` with its label, unit and direction. A new one is one more of them,
and no other file changes: the tables and pictures of plans, reports, the ledgers of studies and the
figures of trade-offs all read `METRICS`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, Generic, Literal, TypeVar, overload

from .instance import Instance
from .route import Route, Unserved

Value = TypeVar("Value", int, float)
Better = Literal["more", "less", "neither"]
Place = Literal["plan", "plans", "report"]
A_FEW = 10
"""Robots up to which each is told of in a line."""
EVERYWHERE: tuple[Place, ...] = ("plan", "plans", "report")
CELLS, TIME, PERCENT = "cells", "time units", "%"


class Metric(Generic[Value]):
    """One metric: a property of `Metrics`, with what tables and pictures say of it.

    Parameters
    ----------
    of : callable
        Its value from `Metrics`.
    label : str
        What it is called.
    unit : str
        Of what is shown; a share, from 0 to 1, is shown in percent.
    better : {"more", "less", "neither"}
        Which way plans get better.
    words : str
        The label in the table of one plan, where there is room.
    heading : str
        The label where columns are narrow.
    shown : sequence of {"plan", "plans", "report"}
        Where: in the table of one plan, beside others in a table of plans, in a study's report.
    detail : callable, optional
        What the table of one plan says, where that is more than the value with its unit.
    """

    def __init__(
        self,
        of: Callable[[Any], Value],
        *,
        label: str,
        unit: str,
        better: Better,
        words: str,
        heading: str,
        shown: tuple[Place, ...],
        detail: Callable[[Any], str] | None,
    ) -> None:
        self.of: Callable[[Any], Value] = of
        self.name, self.__doc__ = of.__name__, of.__doc__
        self.label, self.unit, self.better = label, unit, better
        self.words, self.heading = words or label, heading or label
        self.shown, self._detail = shown, detail

    @overload
    def __get__(self, instance: None, owner: Any) -> Metric[Value]: ...
    @overload
    def __get__(self, instance: object, owner: Any) -> Value: ...
    def __get__(self, instance: object | None, owner: Any) -> Metric[Value] | Value:
        return self if instance is None else self.of(instance)

    @property
    def title(self) -> str:
        """The label with its unit."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    def scaled(self, value: Any) -> Any:
        """A value, or an array of them, in the unit that is shown."""
        return 100 * value if self.unit == PERCENT else value

    def text(self, metrics: Any) -> str:
        """What the table of one plan says."""
        if self._detail is not None:
            return self._detail(metrics)
        return f"{self.scaled(self.of(metrics)):.6g} {self.unit}".strip()


def metric(
    label: str,
    unit: str = "",
    *,
    better: Better = "neither",
    words: str = "",
    heading: str = "",
    shown: tuple[Place, ...] = EVERYWHERE,
    detail: Callable[[Any], str] | None = None,
) -> Callable[[Callable[[Any], Value]], Metric[Value]]:
    """Make a method of `Metrics` a `Metric`, whose parameters these are."""

    def make(of: Callable[[Any], Value]) -> Metric[Value]:
        return Metric(
            of,
            label=label,
            unit=unit,
            better=better,
            words=words,
            heading=heading,
            shown=shown,
            detail=detail,
        )

    return make


@dataclass(frozen=True)
class Metrics:
    """The figures of one plan: what robots do, and the metrics that follow.

    Distances are in cells, times in time units; a victim completes when its last served
    requirement does, and only victims with a served requirement count in completion times.
    """

    instance: Instance
    routes: tuple[Route, ...]
    unserved: tuple[Unserved, ...] = ()
    planning_seconds: float = 0.0
    """Wall time of planning, all stages."""

    @metric("requirements", shown=())
    def n_requirements(self) -> int:
        """Requirements of all victims."""
        return sum(len(victim.requirements) for victim in self.instance.victims)

    @metric("available requirements", shown=())
    def n_available(self) -> int:
        """Requirements that a capable robot can reach (of victims that are known)."""
        return self.n_requirements - sum(not item.reason.limits for item in self.unserved)

    @metric(
        "available requirements served",
        better="more",
        heading="served",
        shown=("plan", "plans"),
        detail=lambda m: f"{m.n_served} of {m.n_available} ({m.served_share:.0%})",
    )
    def n_served(self) -> int:
        """Requirements served."""
        return sum(len(kinds) for kinds in self._served.values())

    @metric("served share", PERCENT, better="more", shown=("report",))
    def served_share(self) -> float:
        """``n_served / n_available``; 1 if nothing is available."""
        return self.n_served / self.n_available if self.n_available else 1.0

    @metric(
        "victims fully served",
        better="more",
        shown=("plan",),
        detail=lambda m: f"{m.victims_fully_served} of {m.instance.n_victims}",
    )
    def victims_fully_served(self) -> int:
        """Victims all of whose requirements are served."""
        return sum(set(v.requirements) == self._served[v.id] for v in self.instance.victims)

    @metric(
        "distance",
        CELLS,
        better="less",
        heading="cells",
        detail=lambda m: f"{m.distance} cells{_each(m.distance_of)}",
    )
    def distance(self) -> int:
        """Cells walked by all robots."""
        return sum(self.distance_of.values())

    @metric("total time", TIME, better="less", words="total time, travel and service")
    def total_time(self) -> float:
        """Travel and service time of all robots."""
        # Routes have no waiting, so a robot's finishing time is its travel and service time.
        return sum(self.finished_of.values())

    @metric("makespan", TIME, better="less")
    def makespan(self) -> float:
        """When the last robot is done."""
        return max(self.finished_of.values(), default=0.0)

    @metric(
        "latency",
        TIME,
        better="less",
        words="latency, completion times summed by priority",
        shown=("plan", "report"),
    )
    def latency(self) -> float:
        """Sum over victims of priority times completion time."""
        return float(sum(self._priority[v] * time for v, time in self._completion.items()))

    @metric(
        "mean completion time",
        TIME,
        better="less",
        words="mean completion time of victims",
        heading="mean completion",
    )
    def mean_completion(self) -> float:
        """Mean completion time of victims; 0 if none is served."""
        times = self._completion.values()
        return sum(times) / len(times) if times else 0.0

    @metric(
        "weighted completion time",
        TIME,
        better="less",
        words="the same, weighted by priority",
        shown=("plan",),
    )
    def weighted_completion(self) -> float:
        """Mean completion time of victims, weighted by priority; 0 if the weights sum to 0."""
        weights = sum(self._priority[v] for v in self._completion)
        return self.latency / weights if weights else 0.0

    @cached_property
    def distance_of(self) -> Mapping[int, int]:
        """Cells walked, per robot id."""
        return {route.robot: route.distance for route in self.routes}

    def as_dict(self) -> dict[str, Any]:
        """All figures by name."""
        return {
            **{name: entry.of(self) for name, entry in METRICS.items()},
            "distance_of": dict(self.distance_of),
            "planning_seconds": self.planning_seconds,
        }

    def __repr__(self) -> str:
        return f"Metrics({', '.join(f'{k}={v!r}' for k, v in self.as_dict().items())})"

    @cached_property
    def _served(self) -> Mapping[int, set[str]]:
        """The kinds that are served, per victim id."""
        served: dict[int, set[str]] = {victim.id: set() for victim in self.instance.victims}
        for route in self.routes:
            for visit in route.visits:
                served[visit.victim].update(visit.served)
        return served

    @cached_property
    def _completion(self) -> Mapping[int, float]:
        """When the last served requirement of a victim is done, per victim id."""
        completion: dict[int, float] = {}
        for route in self.routes:
            for visit in route.visits:
                if visit.served:
                    earlier = completion.get(visit.victim, 0.0)
                    completion[visit.victim] = max(earlier, visit.departure)
        return completion

    @cached_property
    def finished_of(self) -> Mapping[int, float]:
        """When a robot is done, its way back included, per robot id."""
        finished = {robot.id: 0.0 for robot in self.instance.robots}
        speed = {robot.id: robot.speed for robot in self.instance.robots}
        for route in self.routes:
            if route.visits:
                home = max(len(route.back) - 1, 0) / speed[route.robot]
                finished[route.robot] = route.visits[-1].departure + home
        return finished

    @cached_property
    def _priority(self) -> Mapping[int, float]:
        return {victim.id: victim.priority for victim in self.instance.victims}


def _each(of_robot: Mapping[int, int]) -> str:
    """The values of a few robots."""
    if len(of_robot) > A_FEW:
        return ""
    return f" ({', '.join(f'{robot}: {value}' for robot, value in of_robot.items())})"


METRICS: Mapping[str, Metric[Any]] = MappingProxyType(
    {name: entry for name, entry in vars(Metrics).items() if isinstance(entry, Metric)}
)
"""All metrics by name, in the order in which tables show them."""


def metrics_of(place: Place) -> list[Metric[Any]]:
    """The metrics that `place` shows, in its order."""
    return [entry for entry in METRICS.values() if place in entry.shown]
