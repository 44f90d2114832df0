"""A plan executed event by event, cell by cell, in a world that its robots do not know.

At every time at which something happens: first what the world does (robots lost, cells blocked or
opened, victims announced), then what robots finish, and what they notice; if that is news, the policy
decides; then robots that are free begin what is next. A move that has begun is completed, also into a
cell that is blocked meanwhile; none begins into a blocked one.

A run ends at the scenario's ``until``, where what is under way is cut short. Without it, it ends when
nothing more can happen to the mission: nobody moves or serves, all that the scenario has at a time has
happened (a robot that has a time may be lost before it at a rate), and nobody who may be lost at a rate
waits for a way.

The time of a robot's i-th cell on a walk is when it set out plus i / speed, as plans have it, so that
without uncertainty and events every time is that of the plan to the last bit.
"""

from __future__ import annotations

import heapq
import math
import time as wall
from collections.abc import Callable
from dataclasses import replace

from ..mission.grid import Cell
from ..mission.instance import Victim
from ..mission.plan import Plan
from ..mission.run import (
    Change,
    Decision,
    Event,
    Loss,
    Service,
    Unknown,
    Walked,
    World,
)
from ..mission.scenario import Scenario
from .body import Body, bodies_of, visits_of
from .deciding import give, look_ahead, state_of
from .knowledge import Knowledge, happenings
from .state import Blocked, Decide, Task


class GivenUpError(Exception):
    """A run that was given up before its end: nothing is known of it."""


class Simulation:
    """One execution; `run` fills the lists of what happened.

    Parameters
    ----------
    plan : Plan
        One that holds.
    scenario : Scenario
        How robots notice and see.
    world : World
        What it came to.
    decide : Decide
        The policy, asked whenever there is news.
    blocked : Blocked
        What robots do before a blocked cell.
    given_up : callable
        Asked again and again whether nobody waits for the run any more.
    """

    def __init__(
        self,
        plan: Plan,
        scenario: Scenario,
        world: World,
        decide: Decide,
        blocked: Blocked,
        given_up: Callable[[], bool] = lambda: False,
    ) -> None:
        self.given_up = given_up
        self.scenario, self.decide, self.blocked = scenario, decide, blocked
        self.service = {(drawn.victim, drawn.kind): drawn.time for drawn in world.services}
        self.world = Knowledge(plan.instance, world, scenario.visual_field_depth)
        self.bodies = bodies_of(plan, world)
        self.by_id = {body.robot.id: body for body in self.bodies}
        self.acts: list[tuple[float, int]] = []
        self.happenings = happenings(world)
        self.horizon = math.inf if scenario.until is None else scenario.until
        self.have_a_time = {table.robot for table in scenario.lost if table.time is not None}
        self.news: list[Event] = []
        self.left_out: set[tuple[int, int | None, int]] = set()
        self.services: list[Service] = []
        self.events: list[Event] = []
        self.decisions: list[Decision] = []
        self.deciding_seconds = 0.0

    def run(self) -> None:
        """Execute until the end.

        Raises
        ------
        GivenUpError
            If nobody waits for it any more.
        """
        now, after = 0.0, 0.0
        for body in self.bodies:
            body.cells.append(body.cell)
            body.times.append(0.0)
        self._happen(0.0)
        for body in self.bodies:
            if not body.lost:
                self._look(body, 0.0)
        while after <= self.horizon and not math.isinf(after):
            if self.given_up():
                raise GivenUpError
            now = after
            self._happen(now)
            self._finish(now)
            if self.news:
                self._decide(now)
            self._begin_all(now)
            while self.news:  # visits that are left out
                self._decide(now)
                self._begin_all(now)
            after = self._next()
        self._end(now if math.isinf(self.horizon) else self.horizon)

    def tracks(self) -> tuple[Walked, ...]:
        """Where robots were."""
        return tuple(
            Walked(robot=body.robot.id, cells=tuple(body.cells), times=tuple(body.times))
            for body in self.bodies
        )

    def ordered_services(self) -> tuple[Service, ...]:
        """What was served, robot by robot, each in its order."""
        number = {body.robot.id: body.number for body in self.bodies}
        return tuple(sorted(self.services, key=lambda service: number[service.robot]))

    def _next(self) -> float:
        """The next time at which something happens that matters; infinity if there is none."""
        while self.acts and self.bodies[self.acts[0][1]].until != self.acts[0][0]:
            heapq.heappop(self.acts)  # of a robot that was lost
        times = [self.acts[0][0]] if self.acts else []
        if self.acts or any(self._matters(item) for _, _, item in self.happenings):
            times += [self.happenings[0][0]] if self.happenings else []
        return min(times, default=math.inf)

    def _matters(self, item: Loss | Change | Unknown) -> bool:
        """Whether it is waited for: all is that comes by the end, or at a time, or to who waits."""
        if not isinstance(item, Loss) or not math.isinf(self.horizon):
            return True
        return item.robot in self.have_a_time or self.by_id[item.robot].is_waiting

    def _end(self, now: float) -> None:
        """Cut short what is being served, and tell who still waits."""
        for body in self.bodies:
            if body.is_waiting:
                self._tell_wait(body, now)
            elif body.is_serving and not body.lost and body.began < now:
                self._cut_short(body, now)

    # What the world does

    def _happen(self, now: float) -> None:
        changed: list[Cell] = []
        while self.happenings and self.happenings[0][0] == now:
            _, _, item = self.happenings.popleft()
            if isinstance(item, Loss):
                self._lose(self.by_id[item.robot], now)
            elif isinstance(item, Change):
                if self.world.change(item.cell, item.free):
                    self._tell(now, "opened" if item.free else "blocked", cell=item.cell)
                    changed.append(item.cell)
            elif item.victim.id in self.world.hidden:
                self._meet(item.victim, Event(time=now, what="announced", victim=item.victim.id))
        if not changed:
            return
        if self.scenario.notice == "at_once":
            for cell in changed:
                self._notice(cell, now, None)
        else:
            for body in self.bodies:
                if not body.lost and body.into is None:
                    self._look(body, now)

    def _lose(self, body: Body, now: float) -> None:
        if body.is_serving:
            self._cut_short(body, now)
        elif body.is_waiting:
            self._tell_wait(body, now)
        body.lost, body.until = True, None
        self.news.append(self._tell(now, "lost", robot=body.robot.id, cell=body.cell))

    def _cut_short(self, body: Body, now: float) -> None:
        assert body.task is not None
        victim, kind = body.task.victim, body.task.served[body.kind or 0]
        self._serve(body, kind, now, done=False)
        self._tell(now, "cut short", robot=body.robot.id, victim=victim, kind=kind)

    def _tell_wait(self, body: Body, now: float) -> None:
        assert body.task is not None
        self._tell(now, "waiting", robot=body.robot.id, victim=body.task.victim)

    def _look(self, body: Body, now: float) -> None:
        """What a robot notices from the cell in which it stands."""
        for victim in self.world.in_sight(body.cell):
            found = Event(time=now, what="found", victim=victim.id, robot=body.robot.id)
            self._meet(victim, found)
        if self.scenario.notice == "before" and self.scenario.corridors:
            for cell in self.world.beside(body.cell):
                self._notice(cell, now, body.robot.id)

    def _notice(self, cell: Cell, now: float, robot: int | None) -> None:
        if self.world.notice(cell):
            self.news.append(self._tell(now, "noticed", robot=robot, cell=cell))

    def _meet(self, victim: Victim, event: Event) -> None:
        """A victim that is known from now on."""
        self.world.meet(victim)
        self.events.append(event)
        self.news.append(event)

    def _tell(self, now: float, what: str, **whom: object) -> Event:
        event = Event.model_validate({"time": now, "what": what, **whom})
        self.events.append(event)
        return event

    # What robots do

    def _finish(self, now: float) -> None:
        """End what ends now."""
        while self.acts and self.acts[0][0] == now:
            body = self.bodies[heapq.heappop(self.acts)[1]]
            if body.until != now:
                continue
            body.until = None
            if body.into is not None:
                body.cell, body.into = body.into, None
                body.step += 1
                body.cells.append(body.cell)
                body.times.append(now)
                self._look(body, now)
            elif body.kind is not None and body.task is not None and body.task.victim is not None:
                kind = body.task.served[body.kind]
                self._serve(body, kind, now, done=True)
                self.world.unserved[body.task.victim].remove(kind)
                who = {"robot": body.robot.id, "victim": body.task.victim, "kind": kind}
                self._tell(now, "served", **who)
                body.kind, body.began = body.kind + 1, now
                if body.kind == len(body.task.served):
                    body.kind, body.task = None, None

    def _serve(self, body: Body, kind: str, now: float, *, done: bool) -> None:
        assert body.task is not None
        assert body.task.victim is not None
        body.served_for += now - body.began
        self.services.append(
            Service(
                robot=body.robot.id,
                victim=body.task.victim,
                kind=kind,
                began=body.began,
                ended=now,
                done=done,
            )
        )

    def _begin_all(self, now: float) -> None:
        for body in self.bodies:
            if body.until is None and not body.lost:
                self._begin(body, now)

    def _begin(self, body: Body, now: float) -> None:
        """Let a robot that is free do what is next."""
        if body.kind is not None:  # the next kind of a visit
            self._until(body, body.ends[body.kind])
            return
        while body.stuck != self.world.version and (body.task is not None or body.queue):
            task = body.task or body.queue.popleft()
            if body.leg is None:
                body.leg, body.step, body.base = self._way(body, task), 0, now
            elif body.step == 0:  # it has waited
                body.base = now
            body.task, body.stuck = task, None
            if body.leg is None:
                self._hold(body, now)
            elif body.step + 1 < len(body.leg):
                ahead = body.leg[body.step + 1]
                if self.world.known[ahead]:
                    body.into = ahead
                    self._until(body, body.base + (body.step + 1) / body.speed)
                    return
                if self.blocked == "detour":
                    body.task, body.leg = replace(task, cells=()), None
                else:
                    body.leg, body.step = body.leg[body.step :], 0
                    self._hold(body, now)
            elif task.victim is not None and task.served:
                self._begin_visit(body, task, task.victim, now)
                return
            else:
                body.task, body.leg = None, None

    def _hold(self, body: Body, now: float) -> None:
        """There is no way on: the robot waits for another map, or leaves the visit out."""
        if self.blocked == "wait":
            body.stuck = self.world.version
            return
        if body.task is not None and body.task.victim is not None:
            event = self._tell(now, "skipped", robot=body.robot.id, victim=body.task.victim)
            once = (body.robot.id, body.task.victim, self.world.version)
            if once not in self.left_out:  # who is told so again leaves it out again
                self.left_out.add(once)
                self.news.append(event)
        body.task, body.leg = None, None

    def _begin_visit(self, body: Body, task: Task, victim: int, now: float) -> None:
        serving, body.ends = 0.0, []
        for kind in task.served:
            serving += self.service[victim, kind]
            body.ends.append(now + serving)
        body.kind, body.began, body.leg = 0, now, None
        self._until(body, body.ends[0])

    def _until(self, body: Body, end: float) -> None:
        body.until = end
        heapq.heappush(self.acts, (end, body.number))

    def _way(self, body: Body, task: Task) -> list[Cell] | None:
        """The walk of the plan, if it begins here, or the shortest that is known; or none."""
        if task.cells and task.cells[0] == body.cell:
            planned = list(task.cells)
            if self.blocked != "detour" or all(self.world.known[cell] for cell in planned[1:]):
                return planned
        goal = body.robot.start if task.victim is None else self.world.victims[task.victim].cell
        if goal == body.cell:
            return [goal]
        (walk,) = self.world.grid.walks([body.cell], [goal])
        return walk or None

    # What the policy decides

    def _decide(self, now: float) -> None:
        news, self.news = tuple(self.news), []
        standing = [body for body in self.bodies if not body.lost]
        state = state_of(standing, self.world, now, news)
        began = wall.perf_counter()
        answer = self.decide(state)
        self.deciding_seconds += wall.perf_counter() - began
        before = [visits_of(body) for body in standing]
        if answer is not None:
            for robot, tasks in answer.items():
                give(self.by_id[robot], tasks)
        after = [visits_of(body) for body in standing]
        if after != before:
            changed = sum(
                len({v.victim for v in old.visits} - {v.victim for v in new.visits})
                for old, new in zip(before, after, strict=True)
            )
            self.decisions.append(
                Decision(time=now, before=tuple(before), after=tuple(after), changed=changed)
            )
            self._tell(now, "decided")
        if self.blocked == "detour":
            for body in standing:
                look_ahead(body, self.world)
