"""From a scenario and a seed to a world: all that is random, drawn before anything happens.

Every robot, and every kind at every victim, has a stream of random numbers of its own, keyed by its id.
So the world does not depend on what a policy does, nor one draw on whether there is another: policies
on the same seed meet the same world (common random numbers).
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator

import numpy as np

from ..mission.instance import Instance, Victim
from ..mission.plan import Plan
from ..mission.run import Change, DrawnService, DrawnSpeed, Loss, Unknown, World
from ..mission.scenario import Distribution, Scenario

SPEED, SERVICE, LOSS = range(3)
"""What a stream is for: the first number of its key."""
SMALLEST, LARGEST = 1e-30, 1e30
"""Speeds and times beyond are taken for these, as missions have no others."""


def draw_world(plan: Plan, scenario: Scenario, seed: int) -> World:
    """What `scenario` comes to for the mission of `plan`.

    Parameters
    ----------
    plan : Plan
        Victims that its scouts did not find are unknown at first, as those of the scenario are.
    scenario : Scenario
        One that fits the mission; see `Scenario.check_for`.
    seed : int
        Of all that is random.
    """
    mission = plan.instance
    hidden = set(plan.scouting.not_found) if plan.scouting else set()
    unknown = [Unknown(victim=v) for v in mission.victims if v.id in hidden]
    unknown += [Unknown(victim=v.victim, announced=v.announced) for v in scenario.victims]
    new = [item.victim for item in unknown if item.victim.id not in hidden]
    return World(
        speeds=tuple(_speeds(mission, scenario, seed)),
        services=tuple(_services(mission, [*mission.victims, *new], scenario, seed)),
        lost=tuple(_losses(mission, scenario, seed)),
        unknown=tuple(unknown),
        changes=tuple(sorted(_changes(scenario), key=lambda change: change.time)),
    )


def stream(seed: int, *key: int) -> np.random.RandomState:
    """The random numbers of a key; numpy keeps those of a `RandomState` for good."""
    return np.random.RandomState(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))


def _speeds(mission: Instance, scenario: Scenario, seed: int) -> Iterator[DrawnSpeed]:
    for robot in mission.robots:
        factor = _factor(scenario.speed_of(robot.id), seed, SPEED, robot.id)
        yield DrawnSpeed(robot=robot.id, speed=_within(robot.speed * factor))


def _services(
    mission: Instance, victims: list[Victim], scenario: Scenario, seed: int
) -> Iterator[DrawnService]:
    of_kind = {kind: scenario.service_of(kind) for kind in mission.capabilities}
    number = {kind: zlib.crc32(kind.encode()) for kind in mission.capabilities}
    for victim in victims:
        for kind in victim.requirements:
            factor = _factor(of_kind[kind], seed, SERVICE, victim.id, number[kind])
            planned = victim.service_time.get(kind, mission.service_time[kind])
            yield DrawnService(victim=victim.id, kind=kind, time=min(planned * factor, LARGEST))


def _within(speed: float) -> float:
    return min(max(speed, SMALLEST), LARGEST)


def _factor(distribution: Distribution, seed: int, *key: int) -> float:
    parameters = distribution.parameters
    if distribution.distribution == "fixed":
        return parameters[0]
    random = stream(seed, *key)
    if distribution.distribution == "lognormal":
        median, sigma = parameters
        return float(median * math.exp(sigma * random.standard_normal()))
    low, mode, high = parameters
    return low if low == high else float(random.triangular(low, mode, high))


def _losses(mission: Instance, scenario: Scenario, seed: int) -> Iterator[Loss]:
    """The first of what may end a robot; each table has a stream of its own."""
    for robot in mission.robots:
        times = []
        for number, table in enumerate(scenario.lost):
            if table.robot not in (None, robot.id):
                continue
            if table.time is not None:
                times.append(table.time)
            elif table.rate is not None:
                share = stream(seed, LOSS, robot.id, number).random_sample()
                times.append(min(-math.log(1.0 - share) / table.rate, LARGEST))
        if times:
            yield Loss(robot=robot.id, time=min(times))


def _changes(scenario: Scenario) -> Iterator[Change]:
    for corridor in scenario.corridors:
        for time, free in ((corridor.blocked, False), (corridor.opened, True)):
            if time is not None:
                for cell in corridor.cells:
                    yield Change(time=time, cell=cell, free=free)
