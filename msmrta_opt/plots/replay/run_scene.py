"""What moves in a film of one run: as of a plan, and what came in between."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.patches import Rectangle

from ...mission.run import Run, Walked
from ..marks import number_of
from ..style import FADED, INK, robot_styles
from ..walked import walked
from .scene import Moving, Scene, Schedule, Service, wedge_of


class RunScene(Scene):
    """Draws robots until they are lost, victims once they turn up, cells once they are changed."""

    def __init__(self, run: Run, ground: Axes, timeline: Axes) -> None:
        super().__init__(walked(run), ground, timeline)
        figures, events = run.metrics, run.events
        self.run = run
        self.schedules = schedules(run)
        self.services = _services(run)
        self.makespan, self.n_available = figures.makespan, figures.n_available
        self.lost = {event.robot: event.time for event in events if event.what == "lost"}
        told = {e.victim: e.time for e in events if e.what in ("announced", "found")}
        self.appears = {x.victim.id: told.get(x.victim.id, np.inf) for x in run.world.unknown}
        done = {(service.victim, service.kind) for service in run.services if service.done}
        planned = {(item.victim, item.kind) for item in run.plan.unserved}
        # What the plan leaves open is so from the beginning, all else in the end.
        for victim in run.victims:
            left = {(victim.id, kind) for kind in victim.requirements} - done
            if left:
                since = 0.0 if left & planned and victim.id not in self.appears else self.makespan
                self.unserved[victim.id] = since

    def mission(self, t: float) -> Moving:
        """As of a plan; under it cells that are not as they were, over it names of who turned up."""
        free = {x.cell: x.free for x in self.run.world.changes if x.time <= t}
        cells = PatchCollection(
            [Rectangle((col - 0.5, row - 0.5), 1, 1) for row, col in free],
            facecolors=["white" if opened else FADED for opened in free.values()],
            edgecolors=INK,
            hatch="xxxx" if not any(free.values()) else "",
            linewidths=1.0,
        )
        self.ground.add_collection(cells, autolim=False)
        new = [x for x in self.run.victims if x.id in self.appears and self.appears[x.id] <= t]
        names = [(self.ground, self._name(victim)) for victim in new if self.named]
        return [(self.ground, cells), *super().mission(t), *names]

    def _look(self, robot: int, t: float) -> tuple[str, str, str]:
        if t < self.lost.get(robot, np.inf):
            return super()._look(robot, t)
        return f"R{number_of(robot)} lost", INK, "white"


def schedules(run: Run) -> dict[int, Schedule]:
    """The schedule of each robot, by id: it stands still until a move begins."""
    speeds = {drawn.robot: drawn.speed for drawn in run.world.speeds}
    return {track.robot: _schedule(track, speeds[track.robot]) for track in run.tracks}


def _schedule(track: Walked, speed: float) -> Schedule:
    times, cells = [track.times[0]], [track.cells[0]]
    for (before, cell), time in zip(pairwise(track.cells), track.times[1:], strict=True):
        times += [max(time - 1 / speed, times[-1]), time]
        cells += [before, cell]
    return Schedule(np.array(times), np.array(cells, dtype=np.float64))


def _services(run: Run) -> list[Service]:
    victims = {victim.id: victim for victim in run.victims}
    styles = robot_styles(run.plan.instance)
    return [
        Service(
            victims[x.victim].cell, wedge_of(victims[x.victim], x.kind), styles[x.robot].colour,
            x.began, x.ended, x.done,
        )
        for x in run.services
    ]  # fmt: skip
