"""The independent checker of runs.

It shares no code with the simulator, and of policies it knows no more than that `keep` decides
nothing: from the plan, the scenario and the world that are stored, it works out again what the map was
at each time, who could know of whom, how long things took, and what it all came to.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..mission.errors import CheckError
from ..mission.grid import Cell
from ..mission.route import Visit
from ..mission.run import Change, Queued, Run, Service, Walked
from .plan import problems as problems_of_plan
from .run_figures import figures
from .run_reasons import blocked_from, may_stop
from .run_reasons import problems as problems_of_reasons
from .run_world import problems as problems_of_world
from .scouting import in_sight

CLOSE = 1e-9
"""Share of a time up to which two times are the same."""


def problems(run: Run) -> list[str]:
    """Everything that is wrong with `run`, one line each; empty if it holds.

    The plan holds and the world is one that its scenario can come to; robots move from their starts, a
    free cell at a time, at the speed that was drawn, into cells that are free when they begin to; they
    serve victims that are known, where they are, with kinds that they have, for as long as was drawn,
    as the plan or the last decision says; lost robots do nothing any more; events and decisions are
    those that follow, and robots have a reason for what they do (`run_reasons`); the figures are those
    of the run. The seed is only claimed.
    """
    return problems_of_plan(run.plan) or problems_of_execution(run)


def problems_of_execution(run: Run) -> list[str]:
    """The same, where it is known that the plan holds."""
    if wrong := _names(run) or problems_of_world(run):
        return wrong
    check = _Check(run)
    wrong = [line for track in run.tracks for line in check.moves(track)]
    wrong += [line for track in run.tracks for line in check.acts(track)]
    wrong = wrong or list(check.services())
    if wrong:
        return wrong
    wrong = [*check.decisions(), *check.orders(), *check.events(), *_figures(run)]
    return wrong or list(problems_of_reasons(run))


def check_run(run: Run) -> Run:
    """`run` itself, if it holds; its plan is known to.

    Raises
    ------
    CheckError
        If it does not, saying how.
    """
    if wrong := problems_of_execution(run):
        more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
        raise CheckError(f"the run of {run.policy!r} fails its check: {wrong[0]}{more}")
    return run


def _names(run: Run) -> list[str]:
    robots = [robot.id for robot in run.plan.instance.robots]
    tracks = Counter(track.robot for track in run.tracks)
    wrong = [f"robot {r} has {tracks[r]} tracks" for r in robots if tracks[r] != 1]
    wrong += [f"there is no robot {robot}" for robot in tracks if robot not in robots]
    needs = {(victim.id, kind) for victim in run.victims for kind in victim.requirements}
    for service in run.services:
        if service.robot not in robots:
            wrong.append(f"there is no robot {service.robot}, which is said to serve")
        if (service.victim, service.kind) not in needs:
            wrong.append(f"{_said(service)}, which nobody needs there")
    wrong += [
        f"robot {track.robot} has {len(track.cells)} cells and {len(track.times)} times"
        for track in run.tracks
        if len(track.cells) != len(track.times)
    ]
    return wrong


def _said(service: Service) -> str:
    return f"robot {service.robot} serves {service.kind} at victim {service.victim}"


def _figures(run: Run) -> Iterator[str]:
    true = figures(run)
    if run.figures.keys() != true.keys():
        yield f"the figures are {', '.join(run.figures)}; they should be {', '.join(true)}"
        return
    finished = true["total_time"] + true["stood_still"]  # each is what the other leaves of it
    for name, value in true.items():
        size = finished if name in ("total_time", "stood_still") else abs(value)
        if not abs(run.figures[name] - value) <= CLOSE * size:
            yield f"{name} is {run.figures[name]:g}, which should be {value:g}"


_Order = tuple[int, tuple[str, ...]]
_Orders = Mapping[int, list[_Order]]


class _Check:
    """What several parts of the check look at."""

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

    def may_enter(self, cell: Cell, time: float, leeway: float) -> bool:
        """Whether a cell is free at a time, or within the leeway of rounding about it."""
        free = self.mission.map.is_free(cell)
        for change in self.changes.get(cell, ()):
            if change.time > time + leeway:
                break
            if free and change.time >= time - leeway:
                return True
            free = change.free
        return free

    def moves(self, track: Walked) -> Iterator[str]:
        """Cells one from the next, from the start, free when they are entered."""
        who, step = f"robot {track.robot}", 1 / self.speed[track.robot]
        if (track.cells[0], track.times[0]) != (self.robots[track.robot].start, 0.0):
            yield f"{who} begins in {track.cells[0]} at {track.times[0]:g}, not in its start at 0"
        if any(a > b for a, b in pairwise(track.times)):
            yield f"{who} goes back in time"
        for ((r0, c0), (r1, c1)), time in zip(pairwise(track.cells), track.times[1:], strict=True):
            if abs(r0 - r1) + abs(c0 - c1) != 1:
                yield f"{who} jumps from {(r0, c0)} to {(r1, c1)}"
            elif not self.mission.map.contains((r1, c1)):
                yield f"{who} leaves the map at {(r1, c1)}"
            elif not self.may_enter((r1, c1), time - step, CLOSE * time):
                yield f"{who} moves into {(r1, c1)}, which is blocked at {time - step:g}"

    def acts(self, track: Walked) -> Iterator[str]:
        """Moves and services one after the other, each as long as it takes, none after a loss.

        Where no cell is ever blocked, a robot that has stood still goes on by a decision alone.
        """
        who, step = f"robot {track.robot}", 1 / self.speed[track.robot]
        acts = [(time - step, time, f"moves into {cell}") for cell, time in _entered(track)]
        acts += [
            (s.began, s.ended, f"serves {s.kind} at victim {s.victim}")
            for s in self.serves[track.robot]
        ]
        acts.sort(key=lambda act: (act[1], act[0]))
        clock, loss = 0.0, self.lost.get(track.robot)
        may_wait = np.isfinite(blocked_from(self.run))
        decided = [decision.time for decision in self.run.decisions]
        for began, ended, what in acts:
            leeway = CLOSE * ended
            if ended < began:
                yield f"{who} {what} until {ended:g}, before it begins"
            if began < clock - leeway:
                yield f"{who} {what} from {began:g}, when it is under way until {clock:g}"
            stands = began > clock + leeway and not may_wait
            if stands and not any(abs(began - time) <= leeway for time in decided):
                yield f"{who} stands still from {clock:g} to {began:g}, for no reason"
            if loss is not None and ended > loss + leeway:
                yield f"{who} {what} until {ended:g}, but was lost at {loss:g}"
            clock = max(clock, ended)

    def services(self) -> Iterator[str]:
        """Each requirement once, where the victim is, by who can, as long as drawn, once known."""
        drawn = {(item.victim, item.kind): item.time for item in self.run.world.services}
        served = Counter((s.victim, s.kind) for s in self.run.services if s.done)
        for (victim, kind), times in served.items():
            if times > 1:
                yield f"{kind} at victim {victim} is served {times} times"
        for service in self.run.services:
            said, spent = _said(service), service.ended - service.began
            true, leeway = drawn[service.victim, service.kind], CLOSE * service.ended
            if service.kind not in self.robots[service.robot].capabilities:
                yield f"{said} without having it"
            if self.victims[service.victim].cell not in self.places(service.robot, service.began):
                yield f"{said} from another cell"
            known = self.known.get(service.victim, 0.0)
            if known is None or service.began < known:
                when = "ever" if known is None else f"at {known:g}"
                yield f"{said} at {service.began:g}, before it is known {when}"
            if service.done and abs(spent - true) > leeway:
                yield f"{said} for {spent:g}, which should be {true:g}"
            if not service.done and self.lost.get(service.robot) != service.ended:
                yield f"{said} until {service.ended:g} without an end, though it is not lost then"
            if not service.done and spent > true + leeway:
                yield f"{said} for {spent:g} without an end, where {true:g} is enough"

    def at(self, robot: int, time: float) -> Cell:
        """Where a robot is at a time."""
        track = self.tracks[robot]
        return track.cells[max(int(np.searchsorted(track.times, time, side="right")) - 1, 0)]

    def places(self, robot: int, time: float) -> tuple[Cell, ...]:
        """Where a robot is at a time: several cells, where it is so quick that no time passes."""
        track = self.tracks[robot]
        first = max(int(np.searchsorted(track.times, time, side="left")) - 1, 0)
        return track.cells[first : int(np.searchsorted(track.times, time, side="right"))]

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
    def told(self) -> list[_Orders]:
        """What robots are told to do: by the plan, then by decisions."""
        first = {route.robot: _orders(route.visits) for route in self.run.plan.routes}
        later = ({q.robot: _orders(q.visits) for q in d.after} for d in self.run.decisions)
        return [first, *later]

    def orders(self) -> Iterator[str]:
        """Robots do what they are told, visit by visit, unless they leave it out or are lost."""
        before = [{q.robot: _orders(q.visits) for q in d.before} for d in self.run.decisions]
        for robot, services in self.serves.items():
            told: list[_Order] = []
            for queues, left in zip(self.told, [*before, {}], strict=True):
                queue = queues.get(robot, [])
                told += queue[: len(queue) - len(left.get(robot, []))]
            skips: dict[int | None, list[float]] = {}
            for event in self.run.events:
                if event.what == "skipped" and event.robot == robot:
                    skips.setdefault(event.victim, []).append(event.time)
            done = list(services)
            for victim, kinds in told:
                visit = [(victim, kind) for kind in kinds]
                missed = skips.get(victim)
                if missed and not (done and done[0].began < missed[0]):
                    missed.pop(0)
                elif [(s.victim, s.kind) for s in done[: len(visit)]] == visit:
                    done = done[len(visit) :]
                elif may_stop(self.run, robot, victim, kinds):
                    begun = [(s.victim, s.kind) for s in done]
                    done = [] if begun == visit[: len(begun)] else done
                    break
                else:
                    yield f"robot {robot} does not do at victim {victim} what it is told"
                    break
            if done:
                yield f"{_said(done[0])} without being told"
            if any(skips.values()):
                yield f"robot {robot} leaves out visits that it was not told to make"

    def decisions(self) -> Iterator[str]:
        """Robots that are left get visits that they can make, of victims that are known."""
        ended = {(s.victim, s.kind): s.ended for s in self.run.services if s.done}
        for decision, last in zip(self.run.decisions, self.told, strict=False):
            where = f"the decision at {decision.time:g}"
            before = {queue.robot: queue.visits for queue in decision.before}
            after = {queue.robot: queue.visits for queue in decision.after}
            left = [r for r in self.robots if self.lost.get(r, np.inf) > decision.time]
            if list(before) != left or list(after) != left:
                yield f"{where} is not about robots {', '.join(map(str, left))}, which are left"
                continue
            given: Counter[tuple[int, str]] = Counter()
            for robot in left:
                planned, orders = _orders(before[robot]), last.get(robot, [])
                if planned != orders[len(orders) - len(planned) :]:
                    yield f"{where}: robot {robot} was not told before to do what is said"
                for visit in after[robot]:
                    what = f"{where} sends robot {robot} to victim {visit.victim}"
                    given.update((visit.victim, kind) for kind in visit.served)
                    if not set(visit.served) <= set(self.robots[robot].capabilities):
                        yield f"{what} for what it cannot do"
                    known = self.known.get(visit.victim, 0.0)
                    if visit.victim not in self.victims or known is None or known > decision.time:
                        yield f"{what}, which is not known"
                    elif any(
                        ended.get((visit.victim, k), np.inf) < decision.time for k in visit.served
                    ):
                        yield f"{what} for what is served"
            yield from (
                f"{where} has {k} at victim {v} twice" for (v, k), n in given.items() if n > 1
            )
            changed = sum(
                len({v.victim for v in before[r]} - {v.victim for v in after[r]}) for r in left
            )
            if changed != decision.changed:
                yield f"{where} changes {changed} visits, not {decision.changed}"

    def events(self) -> Iterator[str]:
        """The events are those that follow from all else, in the order of their times."""
        said = self.run.events
        if any(a.time > b.time for a, b in pairwise(said)):
            yield "the events are not in the order of their times"
        true: Counter[tuple[object, ...]] = Counter()
        for s in self.run.services:
            true[s.ended, "served" if s.done else "cut short", s.robot, s.victim, s.kind, None] += 1
        for decision in self.run.decisions:
            true[decision.time, "decided", None, None, None, None] += 1
        for cell, changes in self.changes.items():
            free = self.mission.map.is_free(cell)
            for change in changes:
                if change.free != free:
                    free, what = change.free, "opened" if change.free else "blocked"
                    true[change.time, what, None, None, None, cell] += 1
        for victim, time in self.known.items():
            sight = self.seen.get(victim)
            if sight is not None and sight[0] == time and time not in self.announced[victim]:
                true[time, "found", sight[1], victim, None, None] += 1
            elif time is not None:
                true[time, "announced", None, victim, None, None] += 1
        last = max(
            [time for time, *_ in true if isinstance(time, float)]
            + [time for track in self.run.tracks for time in track.times],
            default=0.0,
        )
        told = {event.robot for event in said if event.what == "lost"}
        for robot, time in self.lost.items():
            if time <= last or robot in told:
                true[time, "lost", robot, None, None, self.at(robot, time)] += 1
        told_of = {(e.time, e.cell) for e in said if e.what == "noticed"}
        for time, cell in self.noticed(told_of):
            true[time, "noticed", None, None, None, cell] += 1
        found: Counter[tuple[object, ...]] = Counter(
            (e.time, e.what, None if e.what == "noticed" else e.robot, e.victim, e.kind, e.cell)
            for e in said
            if e.what != "skipped"
        )
        yield from (f"an event is missing: {_event(event)}" for event in true - found)
        yield from (f"an event did not happen: {_event(event)}" for event in found - true)
        for event in said:
            if event.what == "noticed" and not self._is_beside(event.time, event.robot, event.cell):
                yield f"robot {event.robot} cannot notice {event.cell} at {event.time:g}"

    def noticed(self, said: Set[tuple[float, Cell | None]]) -> Iterator[tuple[float, Cell]]:
        """When it becomes known that a cell is not as it was thought to be.

        Where it is not sure whether a robot stood somewhere, and looked, it is as is `said`.
        """
        free = {cell: self.mission.map.is_free(cell) for cell in self.changes}
        thought = dict(free)
        at_once = self.run.scenario.notice == "at_once"
        looks: dict[float, list[Cell]] = {}
        for track in self.run.tracks:
            for cell, time in zip(track.cells, track.times, strict=True):
                if time < self.lost.get(track.robot, np.inf):
                    looks.setdefault(time, []).append(cell)
        changed: dict[float, list[Change]] = {}
        for change in self.run.world.changes:
            changed.setdefault(change.time, []).append(change)
        for time in sorted({*changed, *(() if at_once else looks)}):
            for change in changed.get(time, ()):
                free[change.cell] = change.free
            if at_once:
                seen = {change.cell for change in changed[time]}
            else:
                here, last = list(looks.get(time, [])), []
                if time in changed:
                    here += self._standing(time, surely=True)
                    last = list(self._standing(time, surely=False))
                seen = {cell for place in here for cell in _beside(place)}
                maybe = {cell for place in last for cell in _beside(place)}
                seen |= {cell for cell in maybe if (time, cell) in said}
            for cell in seen & free.keys():
                if thought[cell] != free[cell]:
                    thought[cell] = free[cell]
                    yield time, cell

    def _standing(self, time: float, *, surely: bool) -> Iterator[Cell]:
        """Where robots are that are not lost by a time, and not under way to another cell.

        Not sure is it of those that are lost after their last move, and of those that set out at that
        time, give and take rounding.
        """
        for track in self.run.tracks:
            loss = self.lost.get(track.robot, np.inf)
            number = int(np.searchsorted(track.times, time))
            if loss <= time:
                continue
            if number == len(track.times):
                if surely == bool(np.isinf(loss)):
                    yield track.cells[-1]
                continue
            ahead = track.times[number] - 1 / self.speed[track.robot] - time
            close = abs(ahead) <= CLOSE * track.times[number]
            if close != surely and (close or ahead > 0):
                yield track.cells[max(number - 1, 0)]

    def _is_beside(self, time: float, robot: int | None, cell: Cell | None) -> bool:
        if self.run.scenario.notice == "at_once" or cell is None:
            return robot is None
        if robot is None or robot not in self.tracks:
            return False
        return any(cell in _beside(place) for place in self.places(robot, time))


def _beside(cell: Cell) -> tuple[Cell, ...]:
    row, col = cell
    return (row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)


def _entered(track: Walked) -> list[tuple[Cell, float]]:
    return list(zip(track.cells[1:], track.times[1:], strict=True))


def _orders(visits: Sequence[Visit | Queued]) -> list[_Order]:
    """Whom to visit and what to serve there; a visit for nothing leaves no trace."""
    return [(visit.victim, visit.served) for visit in visits if visit.served]


def _event(event: tuple[object, ...]) -> str:
    time, what, *whom = event
    return f"{what} ({', '.join(str(item) for item in whom if item is not None)}) at {time:g}"
