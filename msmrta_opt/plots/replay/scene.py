"""What moves in a film of one plan: robots and their trails, victims, scouts, and the time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import to_rgba
from matplotlib.patches import Wedge
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ...arrays import Floats
from ...mission.instance import Victim
from ...mission.plan import Plan
from ...mission.visibility import FieldOfView
from ..canvas import Scale
from ..marks import number_of
from ..placing import apart
from ..style import INK, MISSED, TURNED_UP, robot_styles

Moving = list[tuple[Axes, Artist]]
"""What is drawn over the ground in one frame."""
RECENT = 0.08
"""Share of the makespan after which the trails of large missions fade."""
SEEN, UNSEEN = "#F5A623", "#8C93A0"
FONT, BADGE = 7.5, 14.0
"""Points of letters, and of a badge from top to bottom."""
TITLE, ABOVE = 10.0, 6.0
"""Points of the letters above the map, and how far above it they stand."""
HALO = withStroke(linewidth=2, foreground="white")


class Schedule(NamedTuple):
    """When a robot is where: at ``times[i]`` on ``cells[i]``, in between on the way or at work."""

    times: Floats
    """Shape ``(n,)``, in time units, ascending."""
    cells: Floats
    """Shape ``(n, 2)``, row and column."""

    def walked(self, t: float, since: float = 0.0) -> Floats:
        """The cells from time `since` up to `t`, and the place at `t`, shape ``(m, 2)``."""
        begin, end = np.searchsorted(self.times, [since, t], side="right")
        here = [np.interp(t, self.times, self.cells[:, axis]) for axis in (0, 1)]
        return np.vstack([self.cells[max(int(begin) - 1, 0) : int(end)], here])


def schedules(plan: Plan) -> dict[int, Schedule]:
    """The schedule of each robot, by id."""
    found = {}
    routes = {route.robot: route for route in plan.routes}
    for robot in plan.instance.robots:
        times, cells, clock = [0.0], [robot.start], 0.0
        route = routes.get(robot.id)
        for visit in route.visits if route else ():
            times += [*np.linspace(clock, visit.arrival, len(visit.cells)), visit.departure]
            cells += [*visit.cells, visit.cells[-1]]
            clock = visit.departure
        if route and route.back:
            home = clock + (len(route.back) - 1) / robot.speed
            times += list(np.linspace(clock, home, len(route.back)))
            cells += route.back
        found[robot.id] = Schedule(np.array(times), np.array(cells, dtype=np.float64))
    return found


class Service(NamedTuple):
    """One requirement of one victim, served by a visit: its wedge, its colour, from when to when."""

    cell: tuple[int, int]
    wedge: tuple[float, float]
    colour: str
    arrival: float
    departure: float
    done: bool = True


def clock(t: float, makespan: float) -> str:
    """A time up to the makespan, to three digits of that, whatever the unit of time."""
    digits = 2 - math.floor(math.log10(makespan)) if makespan else 0
    return f"{round(min(t, makespan), digits):g}"


def _arrival(service: Service) -> float:
    return service.arrival


def _services(plan: Plan) -> list[Service]:
    victims = {victim.id: victim for victim in plan.instance.victims}
    styles, found = robot_styles(plan.instance), []
    for route in plan.routes:
        for visit in route.visits:
            victim, colour = victims[visit.victim], styles[route.robot].colour
            found += [
                Service(victim.cell, wedge_of(victim, kind), colour, visit.arrival, visit.departure)
                for kind in visit.served
            ]
    return found


def wedge_of(victim: Victim, kind: str) -> tuple[float, float]:
    """From where to where a requirement's part of the disc reaches, in degrees."""
    width = 360 / len(victim.requirements)
    end = 90 - width * victim.requirements.index(kind)  # clockwise from the top
    return end - width, end


def _first_seen(plan: Plan) -> NDArray[np.int64]:
    """The step at which scouts first saw each cell, -1 for never, shape ``(n_rows, n_cols)``."""
    first = np.full(plan.instance.map.shape, -1, dtype=np.int64)
    for track in plan.scouting.tracks if plan.scouting else ():
        look, looked = FieldOfView(plan.instance.map, track.visual_field_depth), set()
        for step, cell in enumerate(track.cells):
            if cell not in looked:
                looked.add(cell)
                new = look(cell) & ((first < 0) | (first > step))
                first[new] = step
    return first


class Scene:
    """Draws what moves of one plan, at a step of scouting or at a time."""

    def __init__(self, plan: Plan, ground: Axes, timeline: Axes) -> None:
        self.plan, self.ground, self.timeline = plan, ground, timeline
        self.schedules, self.services = schedules(plan), _services(plan)
        self.styles = robot_styles(plan.instance)
        self.scale = Scale.of(ground, plan.instance.map)
        self.radius = max(0.38, 2.4 / self.scale.cell)
        self.named = self.scale.cell > 8
        self.steps = len(plan.scouting.coverage) - 1 if plan.scouting else -1
        self.first_seen = _first_seen(plan)
        self.makespan, self.n_available = plan.metrics.makespan, plan.metrics.n_available
        self.unserved = {item.victim: 0.0 for item in plan.unserved}
        """Victims of whom something stays unserved, and from when on that is so."""
        self.appears: dict[int, float] = {}
        """When those turn up who are not there from the beginning."""

    def scouting(self, step: int) -> Moving:
        """What has been seen by `step`, what is in sight, the victims found, and the scouts."""
        report, mission = self.plan.scouting, self.plan.instance
        if report is None:
            return [self._victims(set()), self._say("no scouting: all victims were known")]
        step = min(step, self.steps)
        places = {
            track: track.cells[min(step, len(track.cells) - 1)]
            for track in report.tracks
            if track.cells
        }
        tint = np.zeros((*mission.map.shape, 4))
        tint[mission.map.free] = to_rgba(UNSEEN, 0.45)
        tint[(self.first_seen >= 0) & (self.first_seen <= step)] = to_rgba(SEEN, 0.25)
        for track, here in places.items():
            tint[FieldOfView(mission.map, track.visual_field_depth)(here)] = to_rgba(SEEN, 0.6)
        found = {find.victim for find in report.finds if find.step <= step}
        said = f"scouting, step {step} of {self.steps}: {report.coverage[step]:.0%} covered"
        return [
            (self.ground, self.ground.imshow(tint, interpolation="none")),
            self._victims(found),
            *self._badges(
                [(f"S{number_of(x.scout)}", INK, "white") for x in places], [*places.values()]
            ),
            self._say(f"{said}, {len(found)} of {mission.n_victims} victims found"),
        ]

    def mission(self, t: float) -> Moving:
        """Trails, victims as far as they are served, robots, and the time on the timeline."""
        since = 0.0 if self.named else t - RECENT * self.makespan
        walks = [schedule.walked(t, since)[:, ::-1] for schedule in self.schedules.values()]
        styles = [self.styles[robot] for robot in self.schedules]
        step = min(0.5 / max(len(walks) - 1, 1), 2.2 * self.scale.line / self.scale.cell)
        trails = [walk + (i - (len(walks) - 1) / 2) * step for i, walk in enumerate(walks)]
        casing = LineCollection(trails, colors="white", linewidths=self.scale.line + 1.4)
        lines = LineCollection(
            trails,
            colors=[style.colour for style in styles],
            linestyles=[style.line if self.named else "-" for style in styles],
            linewidths=self.scale.line,
        )
        for collection in (casing, lines):
            self.ground.add_collection(collection, autolim=False)
        n_served = sum(t >= service.departure for service in self.services if service.done)
        served = f"{n_served} of {self.n_available} available requirements served"
        return [
            (self.ground, casing),
            (self.ground, lines),
            self._victims(set(), t),
            self._wedges(t),
            *self._robots([walk[-1] for walk in walks], t),
            (self.timeline, self.timeline.axvline(t, color=INK, lw=1.6)),
            self._say(f"time {clock(t, self.makespan)} of {self.makespan:g}: {served}"),
        ]

    def write_names(self) -> None:
        """Write the victims' names beside them, where there is room for any."""
        for victim in self.plan.instance.victims if self.named else ():
            if victim.id not in self.appears:
                name = self._name(victim)
                self.ground.draw_artist(name)
                name.remove()

    def _name(self, victim: Victim) -> Artist:
        row, col = victim.cell
        return self.ground.text(
            col + self.radius, row - self.radius, f"v{number_of(victim.id)}", fontsize=FONT,
            fontweight="bold", color=INK, path_effects=[HALO],
        )  # fmt: skip

    def _victims(self, found: set[int], t: float = 0.0) -> tuple[Axes, Artist]:
        """A disc each, dark for those just found, with a red ring where something stays unserved."""
        victims = [x for x in self.plan.instance.victims if self.appears.get(x.id, 0.0) <= t]
        ringed = [self.unserved.get(victim.id, np.inf) <= t for victim in victims]
        faces = dict.fromkeys(self.appears, TURNED_UP) | dict.fromkeys(found, INK)
        rows, cols = np.array([victim.cell for victim in victims]).reshape(-1, 2).T
        discs = self.ground.scatter(
            cols,
            rows,
            s=(2 * self.radius * self.scale.cell) ** 2,
            c=[faces.get(victim.id, "white") for victim in victims],
            edgecolors=[MISSED if ring else INK for ring in ringed],
            linewidths=[2.0 if ring else 0.8 for ring in ringed],
        )
        return self.ground, discs

    def _wedges(self, t: float) -> tuple[Axes, Artist]:
        """What is served of each victim; what is being served grows from the middle."""
        # What was cut short leaves nothing.
        begun = [x for x in self.services if x.arrival <= t and (x.done or t < x.departure)]
        if not self.named:
            # Dots, in the colour of the robot that was there last.
            last = {service.cell: service.colour for service in sorted(begun, key=_arrival)}
            rows, cols = np.array(list(last)).reshape(-1, 2).T
            size = (2 * self.radius * self.scale.cell) ** 2
            return self.ground, self.ground.scatter(cols, rows, s=size, c=list(last.values()))
        shares = [
            1.0 if t >= x.departure else (t - x.arrival) / (x.departure - x.arrival) for x in begun
        ]
        wedges = PatchCollection(
            [
                Wedge(service.cell[::-1], self.radius * share**0.5, *service.wedge)
                for service, share in zip(begun, shares, strict=True)
            ],
            facecolors=[service.colour for service in begun],
            edgecolors="white",
            linewidths=0.5,
        )
        self.ground.add_collection(wedges, autolim=False)
        return self.ground, wedges

    def _look(self, robot: int, t: float) -> tuple[str, str, str]:
        """What a robot's badge says, on which colour and in which ink."""
        style = self.styles[robot]
        return f"R{number_of(robot)}", style.colour, style.ink

    def _robots(self, places: Sequence[Floats], t: float) -> Moving:
        looks = [self._look(robot, t) for robot in self.schedules]
        if not self.named:
            colours = [colour for _, colour, _ in looks]
            x, y = np.array(places).T
            dots = self.ground.scatter(x, y, s=26, c=colours, edgecolors=INK, linewidths=0.6)
            return [(self.ground, dots)]
        cells = {victim.cell for victim in self.plan.instance.victims}
        below = self.radius + 6 / self.scale.cell  # of the victim that it is at
        at = [(y + (below if (y, x) in cells else 0.0), x) for x, y in places]
        return self._badges(looks, at)

    def _badges(
        self, looks: Sequence[tuple[str, str, str]], at: Sequence[tuple[float, float]]
    ) -> Moving:
        """Badges at places ``(row, col)``, moved aside where one would lie on another."""
        if not looks:
            return []
        sizes = np.array([(BADGE, 0.72 * FONT * len(name) + 7) for name, *_ in looks])
        shape = self.plan.instance.map.shape
        moved = np.array(at, dtype=np.float64)
        if self.named:
            moved = apart(moved, sizes / self.scale.cell, shape, self.scale.margin(shape))
        return [
            self._badge(name, row, col, face, ink)
            for (name, face, ink), (row, col) in zip(looks, moved.tolist(), strict=True)
        ]

    def _badge(self, name: str, row: float, col: float, face: str, ink: str) -> tuple[Axes, Artist]:
        if not self.named:
            (dot,) = self.ground.plot(col, row, "s", ms=5, mfc=face, mec="white")
            return self.ground, dot
        box = {"boxstyle": "round,pad=0.2", "fc": face, "ec": "white", "lw": 0.8}
        return self.ground, self.ground.text(
            col, row, name, ha="center", va="center", fontsize=FONT, fontweight="bold",
            color=ink, bbox=box,
        )  # fmt: skip

    def _say(self, text: str) -> tuple[Axes, Artist]:
        return self.ground, self.ground.annotate(
            text, (0, 1), xycoords="axes fraction", xytext=(0, ABOVE), textcoords="offset points",
            fontsize=TITLE,
        )  # fmt: skip
