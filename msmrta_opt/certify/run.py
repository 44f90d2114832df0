"""The independent checker of runs.

It shares no code with the simulator, and of policies it knows no more than that `keep` decides
nothing: from the plan, the scenario and the world that are stored, it works out again what the map was
at each time, who could know of whom, how long things took, and what it all came to.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ..mission.errors import CheckError
from ..mission.grid import Cell
from ..mission.run import Run, Walked
from .plan import problems as problems_of_plan
from .run_events import problems as problems_of_events
from .run_facts import Facts
from .run_figures import figures
from .run_limits import problems as problems_of_limits
from .run_orders import CLOSE, blocked_from, orders_of, said_of, stopped_at, told
from .run_reasons import problems as problems_of_reasons
from .run_world import problems as problems_of_world

PROVED = 1e-6
"""Share of a best value within which a bound proves it: rounding in what the exact planner sums up."""


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
    wrong = [
        *check.decisions(),
        *(line for one in check.followed.values() for line in one.problems),
        *problems_of_events(check),
        *_figures(run),
        *_hindsight(run),
    ]
    return wrong or [*problems_of_reasons(check), *problems_of_limits(check)]


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
            wrong.append(f"{said_of(service)}, which nobody needs there")
    wrong += [
        f"robot {track.robot} has {len(track.cells)} cells and {len(track.times)} times"
        for track in run.tracks
        if len(track.cells) != len(track.times)
    ]
    return wrong


def _hindsight(run: Run) -> Iterator[str]:
    """What is claimed of the best fits the run; whether it is the best is only claimed."""
    if (claimed := run.hindsight) is None:
        return
    true, close = figures(run).get(claimed.objective), CLOSE * abs(claimed.run)
    if true is None or abs(claimed.run - true) > close:
        yield f"hindsight has {claimed.objective} {claimed.run:g} for the run, which is not its own"
    if not 0 <= claimed.bound <= claimed.best + close or claimed.best > claimed.run + close:
        yield (
            f"hindsight has a bound of {claimed.bound:g}, a best of {claimed.best:g} and a run of"
            f" {claimed.run:g}, which are not in that order"
        )
    if claimed.proved and claimed.best - claimed.bound > PROVED * abs(claimed.best):
        yield f"hindsight calls {claimed.best:g} optimal, with a bound of {claimed.bound:g}"


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


class _Check(Facts):
    """What robots do, and are told to do."""

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

        As long as no cell is blocked, a robot that has stood still goes on by a decision alone.
        """
        who, step = f"robot {track.robot}", 1 / self.speed[track.robot]
        acts = [(time - step, time, f"moves into {cell}") for cell, time in _entered(track)]
        acts += [
            (s.began, s.ended, f"serves {s.kind} at victim {s.victim}")
            for s in self.serves[track.robot]
        ]
        acts.sort(key=lambda act: (act[1], act[0]))
        clock, end = 0.0, stopped_at(self.run, track.robot)
        blocked = blocked_from(self.run)
        decided = [decision.time for decision in self.run.decisions]
        for began, ended, what in acts:
            leeway = CLOSE * ended
            if ended < began:
                yield f"{who} {what} until {ended:g}, before it begins"
            if began < clock - leeway:
                yield f"{who} {what} from {began:g}, when it is under way until {clock:g}"
            stands = began > clock + leeway and blocked > clock + leeway
            if stands and not any(abs(began - time) <= leeway for time in decided):
                yield f"{who} stands still from {clock:g} to {began:g}, for no reason"
            if ended > end + leeway:
                how = "was lost" if track.robot in self.lost else "the run ended"
                yield f"{who} {what} until {ended:g}, but {how} at {end:g}"
            clock = max(clock, ended)

    def services(self) -> Iterator[str]:
        """Each requirement once, where the victim is, by who can, as long as drawn, once known."""
        drawn = {(item.victim, item.kind): item.time for item in self.run.world.services}
        served = Counter((s.victim, s.kind) for s in self.run.services if s.done)
        for (victim, kind), times in served.items():
            if times > 1:
                yield f"{kind} at victim {victim} is served {times} times"
        for service in self.run.services:
            said, spent = said_of(service), service.ended - service.began
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
            if not service.done and stopped_at(self.run, service.robot) != service.ended:
                yield f"{said} until {service.ended:g} without an end, though it is not stopped then"
            if not service.done and spent > true + leeway:
                yield f"{said} for {spent:g} without an end, where {true:g} is enough"

    def decisions(self) -> Iterator[str]:
        """Robots that are left get visits that they can make, of victims that are known."""
        ended = {(s.victim, s.kind): s.ended for s in self.run.services if s.done}
        for decision, last in zip(self.run.decisions, told(self.run), strict=False):
            where = f"the decision at {decision.time:g}"
            before = {queue.robot: queue.visits for queue in decision.before}
            after = {queue.robot: queue.visits for queue in decision.after}
            left = [r for r in self.robots if self.lost.get(r, np.inf) > decision.time]
            if any([q.robot for q in qs] != left for qs in (decision.before, decision.after)):
                yield f"{where} is not about robots {', '.join(map(str, left))}, which are left"
                continue
            given: Counter[tuple[int, str]] = Counter()
            for robot in left:
                planned, orders = orders_of(before[robot]), last.get(robot, [])
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


def _entered(track: Walked) -> list[tuple[Cell, float]]:
    return list(zip(track.cells[1:], track.times[1:], strict=True))
