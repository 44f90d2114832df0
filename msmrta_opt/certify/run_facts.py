"""What the checker of runs knows of one: where robots were, who saw whom, what was known when."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Mapping
from functools import cached_property

import numpy as np

from ..mission.grid import Cell
from ..mission.run import Change, Run, Service
from .run_orders import CLOSE, Followed, blocked_from, followed
from .scouting import in_sight


class Facts:
    """What several parts of the check look at, worked out of a run.

    Parameters
    ----------
    run : Run
        One with the tracks, services and world that there should be.
    """

    def __init__(self, run: Run) -> None:
        self.run = run
        self.mission = run.plan.instance
        self.robots = {robot.id: robot for robot in self.mission.robots}
        self.victims = {victim.id: victim for victim in run.victims}
        self.tracks = {track.robot: track for track in run.tracks}
        self.speed = {drawn.robot: drawn.speed for drawn in run.world.speeds}
        self.lost = {loss.robot: loss.time for loss in run.world.lost}
        self.changes: dict[Cell, list[Change]] = {}
        for change in run.world.changes:
            self.changes.setdefault(change.cell, []).append(change)
        self.serves: dict[int, list[Service]] = {robot: [] for robot in self.robots}
        for service in run.services:
            self.serves[service.robot].append(service)

    def at(self, robot: int, time: float) -> Cell:
        """Where a robot is at a time."""
        track = self.tracks[robot]
        return track.cells[max(bisect_right(track.times, time) - 1, 0)]

    def places(self, robot: int, time: float) -> tuple[Cell, ...]:
        """Where a robot is at a time: several cells, where it is so quick that no time passes."""
        track = self.tracks[robot]
        first = max(bisect_left(track.times, time) - 1, 0)
        return track.cells[first : bisect_right(track.times, time)]

    @cached_property
    def seen(self) -> Mapping[int, tuple[float, int]]:
        """When robots first see a victim that is unknown, and which of them it is."""
        found: dict[int, tuple[float, int]] = {}
        order = {robot: number for number, robot in enumerate(self.robots)}
        for item in self.run.world.unknown:
            sight = np.zeros(self.mission.map.shape, dtype=bool)
            in_sight(
                self.mission.map, self.run.scenario.visual_field_depth, item.victim.cell, sight
            )
            looks = [
                (time, order[track.robot], track.robot)
                for track in self.run.tracks
                for cell, time in zip(track.cells, track.times, strict=True)
                if sight[cell] and time < self.lost.get(track.robot, np.inf)
            ]
            if looks:
                time, _, robot = min(looks)
                found[item.victim.id] = (time, robot)
        return found

    @cached_property
    def announced(self) -> Mapping[int, tuple[float | None, ...]]:
        """When a victim that is unknown at first is announced, if it is."""
        return {item.victim.id: (item.announced,) for item in self.run.world.unknown}

    @cached_property
    def known(self) -> Mapping[int, float | None]:
        """When a victim that is unknown at first becomes known; ``None`` if it never does."""
        when: dict[int, float | None] = {}
        for item in self.run.world.unknown:
            times = [t for t in (item.announced,) if t is not None]
            times += [self.seen[item.victim.id][0]] if item.victim.id in self.seen else []
            when[item.victim.id] = min(times, default=None)
        return when

    @cached_property
    def followed(self) -> Mapping[int, Followed]:
        """How robots followed what they were told."""
        return followed(self.run)

    @cached_property
    def end(self) -> float:
        """When the run ends: as the scenario says, or with the last of what is waited for.

        That is all that is done, all that comes at a time, and the losses of those who were not done.
        """
        run = self.run
        if run.scenario.until is not None:
            return run.scenario.until
        at_a_time = [table.robot for table in run.scenario.lost if table.rate is None]
        return max(
            *(track.times[-1] for track in run.tracks),
            *(service.ended for service in run.services),
            *(change.time for change in run.world.changes),
            *(item.announced for item in run.world.unknown if item.announced is not None),
            *(
                loss.time
                for loss in run.world.lost
                if loss.robot in at_a_time or not self.is_done(loss.robot)
            ),
            0.0,
        )

    def is_done(self, robot: int) -> bool:
        """Whether a robot did all that it was told, and ended where it was to end.

        Where it was to serve nothing on a visit, its walk is that of the plan.
        """
        if self.followed[robot].stopped is not None:
            return False
        last = self.tracks[robot].cells[-1]
        routes = {route.robot: route for route in self.run.plan.routes}
        visits = routes[robot].visits if robot in routes else ()
        decided = any(queue.robot == robot for d in self.run.decisions for queue in d.before)
        if self.run.plan.limits.get("return_to_start"):
            end = self.robots[robot].start
        elif visits and not visits[-1].served and not decided:
            end = self.victims[visits[-1].victim].cell
        else:
            end = last
        told = any(event.what == "lost" and event.robot == robot for event in self.run.events)
        if told and self._may_move(robot, self.lost[robot]):
            return False
        # Where a cell was blocked, it may have given up the way there.
        return last == end or not (told or math.isinf(blocked_from(self.run)))

    def _may_move(self, robot: int, time: float) -> bool:
        """Whether a move may be under way that was begun before a decision took its reason away."""
        step = (1.0 + CLOSE) / self.speed[robot]
        return any(
            queue.robot == robot and queue.visits and d.time <= time <= d.time + step
            for d in self.run.decisions
            for queue in d.before
        )
