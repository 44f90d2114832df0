"""Random plans without a mistake pass the checker, and with one they do not."""

from __future__ import annotations

import random
from collections.abc import Callable

from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.edited_plans import Document, edited, put

from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import (
    Plan,
    Reason,
    Route,
    Unserved,
    Visit,
)

Distances = Callable[[GridMap, Cell], dict[Cell, int]]


def shortest(ground: Distances, grid: GridMap, start: Cell, goal: Cell) -> list[Cell]:
    """A shortest walk, backwards down the distances from the start."""
    found = ground(grid, start)
    walk = [goal]
    while walk[-1] != start:
        row, col = walk[-1]
        beside = ((row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1))
        walk.append(next(c for c in beside if found.get(c) == found[walk[-1]] - 1))
    return walk[::-1]


def thoughtless_plan(instance: Instance, ground: Distances, seed: int) -> Plan:
    """Each available requirement to any robot that can serve it, in any order."""
    chance = random.Random(seed)
    shares: dict[int, list[tuple[int, str]]] = {robot.id: [] for robot in instance.robots}
    unserved = []
    for victim in instance.victims:
        for kind in victim.requirements:
            capable = [robot for robot in instance.robots if kind in robot.capabilities]
            reaching = [r.id for r in capable if victim.cell in ground(instance.map, r.start)]
            if reaching:
                shares[chance.choice(reaching)].append((victim.id, kind))
            else:
                reason = Reason.NO_CAPABLE_ROBOT_REACHES_IT if capable else Reason.NO_ROBOT_HAS_IT
                unserved.append(Unserved(victim=victim.id, kind=kind, reason=reason))
    routes = []
    for robot in instance.robots:
        here, clock, visits = robot.start, 0.0, []
        for victim_id, kind in chance.sample(shares[robot.id], len(shares[robot.id])):
            victim = next(v for v in instance.victims if v.id == victim_id)
            cells = shortest(ground, instance.map, here, victim.cell)
            arrival = clock + (len(cells) - 1) / robot.speed
            here, clock = victim.cell, arrival + instance.service_time[kind]
            visits.append(
                Visit(
                    victim=victim.id,
                    served=(kind,),
                    stage="any",
                    cells=tuple(cells),
                    arrival=arrival,
                    departure=clock,
                )
            )
        routes.append(Route(robot=robot.id, visits=tuple(visits)))
    return Plan(
        instance=instance, planner="thoughtless", routes=tuple(routes), unserved=tuple(unserved)
    )


@st.composite
def missions(draw: st.DrawFn) -> Instance:
    """Random missions on random maps."""
    n_rows, n_cols = draw(st.integers(1, 5)), draw(st.integers(2, 6))
    row = st.text(".@", min_size=n_cols, max_size=n_cols)
    rows = draw(st.lists(row, min_size=n_rows, max_size=n_rows))
    # A last row with a free cell, so that everybody has a place to stand.
    grid = grid_from_rows([*rows, draw(st.sampled_from([".@", "@."])).ljust(n_cols, ".")])
    n_robots, n_victims = draw(st.integers(1, 4)), draw(st.integers(0, 5))
    return generate_mission(
        grid, n_robots, n_victims, seed=draw(st.integers(0, 2**32 - 1)), solvable=False
    )


@settings(max_examples=examples(50))
@given(instance=missions(), seed=st.integers(0, 99))
def test_any_legal_plan_holds(instance: Instance, seed: int, breadth_first: Distances) -> None:
    assert problems(thoughtless_plan(instance, breadth_first, seed)) == []


@settings(max_examples=examples(50))
@given(instance=missions(), seed=st.integers(0, 99), data=st.data())
def test_a_legal_plan_with_one_mistake_does_not_hold(
    instance: Instance, seed: int, data: st.DataObject, breadth_first: Distances
) -> None:
    plan = thoughtless_plan(instance, breadth_first, seed)
    visits = [(r, i) for r, route in enumerate(plan.routes) for i in range(len(route.visits))]
    mistakes: dict[str, Callable[[Document], None]] = {}
    if visits:
        r, i = data.draw(st.sampled_from(visits), label="visit")
        late = data.draw(st.sampled_from([-1.0, 0.01, 1.0]), label="late")
        old = plan.routes[r].visits[i]
        mistakes["serve nothing"] = put(r, i, served=[])
        mistakes["leave at another time"] = put(r, i, departure=max(old.departure + late, 0))
        mistakes["stand still"] = put(r, i, cells=[*old.cells, old.cells[-1]])
        mistakes["belong to nobody"] = lambda document: document["routes"][r].update(robot=1000)
        mistakes["drop the visit"] = lambda document: document["routes"][r]["visits"].pop(i)
    if plan.unserved:
        mistakes["drop an excuse"] = lambda document: document["unserved"].pop()
    for name, mistake in mistakes.items():
        assert problems(edited(plan, mistake)), name


@settings(max_examples=examples(50))
@given(instance=missions(), seed=st.integers(0, 99))
def test_nothing_that_could_be_served_can_be_excused_as_out_of_reach(
    instance: Instance, seed: int, breadth_first: Distances
) -> None:
    plan = thoughtless_plan(instance, breadth_first, seed)
    for route in plan.routes:
        if route.visits:
            *kept, last = route.visits
            excuse = Unserved(
                victim=last.victim, kind=last.served[0], reason=Reason.NO_CAPABLE_ROBOT_REACHES_IT
            )
            routes = [r for r in plan.routes if r is not route]
            routes.append(route.model_copy(update={"visits": tuple(kept)}))
            lazy = Plan(
                instance=instance,
                planner="lazy",
                routes=tuple(routes),
                unserved=(*plan.unserved, excuse),
            )
            (wrong,) = problems(lazy)
            assert wrong.endswith("in truth: available")
