"""The table of a run's metrics: what was served and when, what was lost, what was decided anew.

As for plans, a metric is one method with its label, unit and direction; tables read `RUN_METRICS`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

from .happened import Decision, Event, Service, Walked, World
from .instance import Victim
from .metrics import CELLS, PERCENT, TIME, Metric, metric
from .plan import Plan

ROUNDING = 1e-9
"""Share of a time up to which two times are the same."""


class _Parts(NamedTuple):
    """What of a run its metrics are worked out from."""

    plan: Plan
    victims: tuple[Victim, ...]
    world: World
    tracks: tuple[Walked, ...]
    services: tuple[Service, ...]
    events: tuple[Event, ...]
    decisions: tuple[Decision, ...]


class RunMetrics:
    """What a run came to.

    Parameters
    ----------
    plan, victims, world, tracks, services, events, decisions
        The parts of the run; that they hold is not looked at.
    """

    def __init__(
        self,
        plan: Plan,
        victims: tuple[Victim, ...],
        world: World,
        tracks: tuple[Walked, ...],
        services: tuple[Service, ...],
        events: tuple[Event, ...],
        decisions: tuple[Decision, ...],
    ) -> None:
        self.run = _Parts(plan, victims, world, tracks, services, events, decisions)

    @metric("requirements served", better="more", heading="served")
    def n_served(self) -> int:
        """Requirements that were served."""
        return len(self._served)

    @metric("requirements available", heading="available")
    def n_available(self) -> int:
        """Requirements of victims that a robot which has them can reach by cells that are ever free.

        Victims that turn up, or are never found, are counted, too.
        """
        return self._n_available

    @metric("served share", PERCENT, better="more")
    def served_share(self) -> float:
        """``n_served / n_available``; 1 if nothing is available."""
        return self.n_served / self.n_available if self.n_available else 1.0

    @metric("distance", CELLS, better="less", heading="cells")
    def distance(self) -> int:
        """Cells walked by all robots."""
        return sum(len(track.cells) - 1 for track in self.run.tracks)

    @metric("total time", TIME, better="less", words="total time, travel and service")
    def total_time(self) -> float:
        """When robots are done, all together, less what they stood still."""
        return sum(self.done_of.values()) - self.stood_still

    @metric("makespan", TIME, better="less")
    def makespan(self) -> float:
        """When the last robot is done, or has waited until the end in vain."""
        return max(self.done_of.values(), default=0.0)

    @metric("latency", TIME, better="less", words="latency, completion times summed by priority")
    def latency(self) -> float:
        """Sum over victims of priority times the time of their last requirement that is served."""
        return float(sum(self._priority[v] * time for v, time in self.completion.items()))

    @metric("time stood still", TIME, better="less", heading="stood still")
    def stood_still(self) -> float:
        """Time in which robots that were not done, nor lost, neither moved nor served."""
        return sum(self._still_of.values())

    @metric("work lost", TIME, better="less")
    def work_lost(self) -> float:
        """Service time spent on what was not finished: the robot was lost over it, or the run ended."""
        return float(sum(s.ended - s.began for s in self.run.services if not s.done))

    @metric("robots still waiting", better="less", heading="waiting")
    def still_waiting(self) -> int:
        """Robots that waited for a way to a visit until the run ended, or they were lost."""
        return len(self._waited)

    @metric("robots lost")
    def robots_lost(self) -> int:
        """Robots that were lost before the end of the run."""
        return sum(event.what == "lost" for event in self.run.events)

    @metric("victims that turned up", heading="turned up")
    def victims_turned_up(self) -> int:
        """Victims that were announced or found during the run."""
        return sum(event.what in ("announced", "found") for event in self.run.events)

    @metric("replans", better="less")
    def replans(self) -> int:
        """Decisions after which some robot had other visits before it."""
        return len(self.run.decisions)

    @metric("changed visits", better="less")
    def changed_visits(self) -> int:
        """Visits that were taken from robots by decisions."""
        return sum(decision.changed for decision in self.run.decisions)

    @cached_property
    def completion(self) -> Mapping[int, float]:
        """When the last requirement of a victim that was served was done, per victim id."""
        last: dict[int, float] = {}
        for service in self.run.services:
            if service.done:
                last[service.victim] = max(last.get(service.victim, 0.0), service.ended)
        return last

    @cached_property
    def done_of(self) -> Mapping[int, float]:
        """When a robot had moved, served or waited in vain for the last time, per robot id."""
        return {
            track.robot: max(
                self._waited.get(track.robot, 0.0), *(end for _, end in _acts(self.run, track))
            )
            for track in self.run.tracks
        }

    def served_by(self, time: float) -> int:
        """Requirements served by a time."""
        return sum(service.done and service.ended <= time for service in self.run.services)

    def as_dict(self) -> dict[str, Any]:
        """All figures by name."""
        return {name: entry.of(self) for name, entry in RUN_METRICS.items()}

    def __repr__(self) -> str:
        return f"RunMetrics({', '.join(f'{k}={v!r}' for k, v in self.as_dict().items())})"

    @cached_property
    def _served(self) -> set[tuple[int, str]]:
        return {(service.victim, service.kind) for service in self.run.services if service.done}

    @cached_property
    def _n_available(self) -> int:
        mission = self.run.plan.instance
        part = self.run.world.ever_free(mission.map).component
        reached = {(kind, part[r.start]) for r in mission.robots for kind in r.capabilities}
        return sum(
            (kind, part[victim.cell]) in reached
            for victim in self.run.victims
            for kind in victim.requirements
        )

    @cached_property
    def _priority(self) -> Mapping[int, float]:
        return {victim.id: victim.priority for victim in self.run.victims}

    @cached_property
    def _waited(self) -> Mapping[int | None, float]:
        """Until when robots waited in vain."""
        return {event.robot: event.time for event in self.run.events if event.what == "waiting"}

    @cached_property
    def _still_of(self) -> Mapping[int, float]:
        still: dict[int, float] = {}
        for track in self.run.tracks:
            clock, total = 0.0, 0.0
            end = self._waited.get(track.robot, 0.0)
            for began, ended in (*_acts(self.run, track), (end, end)):
                if began - clock > ROUNDING * ended:
                    total += began - clock
                clock = max(clock, ended)
            still[track.robot] = total
        return still


def _acts(run: _Parts, track: Walked) -> Iterator[tuple[float, float]]:
    """From when to when a robot moves or serves, in order; first a moment at its start."""
    speed = next(drawn.speed for drawn in run.world.speeds if drawn.robot == track.robot)
    moves = [(time - 1 / speed, time) for time in track.times[1:]]
    serves = [(s.began, s.ended) for s in run.services if s.robot == track.robot]
    yield 0.0, 0.0
    yield from sorted([*moves, *serves], key=lambda act: (act[1], act[0]))


RUN_METRICS: Mapping[str, Metric[Any]] = MappingProxyType(
    {name: entry for name, entry in vars(RunMetrics).items() if isinstance(entry, Metric)}
)
"""All metrics of runs by name, in the order in which tables show them."""
