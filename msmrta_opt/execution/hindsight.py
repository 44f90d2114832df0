"""What a run could have been at best, had all been known from the beginning: the price of not knowing.

The joint problem of what the run served, with the speeds and service times that were drawn, all victims
known at once, robots done before they are lost or the run ends, and every cell free that was free at any
time. Whatever
a policy does that serves the same is no better than an optimum of this relaxation, and so its bound is
one on every policy.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np

from ..interruption import interrupted, interruptible
from ..mission.errors import InputError, shown
from ..mission.instance import Instance
from ..mission.run import Hindsight, Run
from ..routing.incumbent import Progress
from ..routing.methods import close_in
from ..routing.objectives import DEFAULT, objective_of
from ..routing.parameters import Parameters
from ..routing.problem import Routes
from ..routing.stop import Interruption, MaximumRuntime
from ..stages.joint_routing import routing_data
from ..stages.situation import Situation


def hindsight(run: Run, *, objective: str = DEFAULT, time_limit: float = 10.0) -> Hindsight:
    """The best that a policy could have made of a run's world, and the regret of the run.

    The plan's own limits are left out, so that it is a bound on what keeps to them, too.

    Parameters
    ----------
    run : Run
        One that holds.
    objective : str
        One of `routing.objectives.OBJECTIVES`.
    time_limit : float
        Seconds to prove an optimum.

    Raises
    ------
    InputError
        If it is no run, there is no such objective, or the limit is none.
    """
    if not isinstance(run, Run):
        raise InputError(f"{shown(run)}; give a run, as msmrta_opt.execute returns it", field="run")
    aim = objective_of(objective)
    if isinstance(time_limit, bool) or not time_limit >= 0:
        raise InputError(f"{time_limit!r}; give a number, 0 or more", field="time_limit")
    came_to = float(getattr(run.metrics, aim.name))
    mission = as_it_turned_out(run)
    if not mission.victims:
        return Hindsight(objective=aim.name, run=came_to, best=0.0, bound=0.0, proved=True)
    end = np.array(ends_of(run))
    data = routing_data(Situation.of(mission))
    data = replace(data, endurance=end * (1 + 1e-9))
    with interruptible():
        progress = Progress(
            data,
            aim,
            routes_of_run(run, mission),
            stop=MaximumRuntime(time_limit) | Interruption(interrupted),
        )
        progress.bound_at_once()
        if not progress.done():
            close_in(progress, seed=0, parameters=Parameters())
    bound = min(progress.bound, progress.value)
    return Hindsight(
        objective=aim.name,
        run=came_to,
        best=progress.value,
        bound=bound,
        proved=progress.closed(),
    )


def ends_of(run: Run) -> list[float]:
    """Until when each robot could do anything: until it is lost, or the run ends."""
    lost = {loss.robot: loss.time for loss in run.world.lost}
    until = np.inf if run.scenario.until is None else run.scenario.until
    return [min(lost.get(robot.id, np.inf), until) for robot in run.plan.instance.robots]


def digest_of_problem(run: Run) -> int:
    """A number that tells apart what `hindsight` solves: the same for runs that serve the same.

    It has 48 bits, so that it is kept exactly where it is a float.
    """
    mission = as_it_turned_out(run)
    victims = [
        (v.id, v.cell, v.requirements, sorted(v.service_time.items())) for v in mission.victims
    ]
    opened = [(c.time, c.cell, c.free) for c in run.world.changes]
    robots = [(r.id, r.speed) for r in mission.robots]
    text = repr((victims, opened, robots, ends_of(run)))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:6])


def as_it_turned_out(run: Run) -> Instance:
    """The mission of what a run served, as its world had it, every cell free that ever was."""
    mission, world = run.plan.instance, run.world
    speed = {drawn.robot: drawn.speed for drawn in world.speeds}
    time = {(drawn.victim, drawn.kind): drawn.time for drawn in world.services}
    done = {(service.victim, service.kind) for service in run.services if service.done}
    served = {
        victim.id: kinds
        for victim in run.victims
        if (kinds := [kind for kind in victim.requirements if (victim.id, kind) in done])
    }
    return mission.replace(
        map=world.ever_free(mission.map),
        scouts=(),
        robots=tuple(
            robot.model_copy(update={"speed": speed[robot.id]}) for robot in mission.robots
        ),
        victims=tuple(
            victim.model_copy(
                update={
                    "requirements": tuple(served[victim.id]),
                    "service_time": {kind: time[victim.id, kind] for kind in served[victim.id]},
                }
            )
            for victim in run.victims
            if victim.id in served
        ),
    )


def routes_of_run(run: Run, mission: Instance) -> Routes:
    """Who served what in which order, by positions; later visits to a victim are joined to the first."""
    position = {victim.id: v for v, victim in enumerate(mission.victims)}
    number = {kind: k for k, kind in enumerate(mission.capabilities)}
    routes = []
    for robot in mission.robots:
        visits: dict[int, list[int]] = {}
        for service in run.services:
            if service.robot == robot.id and service.done:
                visits.setdefault(position[service.victim], []).append(number[service.kind])
        routes.append(tuple((v, tuple(kinds)) for v, kinds in visits.items()))
    return tuple(routes)
