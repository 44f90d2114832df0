"""The other baselines: by hand on corridors, and by the checker on random missions."""

from __future__ import annotations

import random
from itertools import pairwise

import numpy as np
import pytest

from msmrta_opt.arrays import Floats
from msmrta_opt.certify.plan import problems
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan, Reason
from msmrta_opt.planners import plan, planners
from msmrta_opt.planners.ssi import _Insertions

BASELINES = ("greedy", "mrga", "random", "ssi")


def corridor(length: int, robots: dict[int, str], victims: tuple[Victim, ...]) -> Instance:
    """Robots of speed 1 at the columns given, with the kinds given; A takes 1, B takes 2."""
    return Instance(
        map=grid_from_rows(["." * length]),
        capabilities=("A", "B"),
        service_time={"A": 1, "B": 2},
        robots=tuple(
            Robot(id=r, start=(0, col), speed=1, capabilities=tuple(kinds))
            for r, (col, kinds) in enumerate(robots.items())
        ),
        victims=victims,
    )


def victim(v: int, col: int, kinds: str = "A", **own_times: float) -> Victim:
    return Victim(id=v, cell=(0, col), requirements=tuple(kinds), service_time=own_times)


def served(made: Plan) -> dict[int, list[tuple[int, str]]]:
    return {
        route.robot: [(visit.victim, "".join(visit.served)) for visit in route.visits]
        for route in made.routes
    }


def missions(n: int) -> list[Instance]:
    """Small missions with many walls, robots without capabilities, victims without needs."""
    found = []
    for seed in range(n):
        chance = random.Random(seed)
        shape = chance.randint(2, 7), chance.randint(2, 9)
        rows = [
            ["@" if chance.random() < 0.3 else "." for _ in range(shape[1])]
            for _ in range(shape[0])
        ]
        rows[0][0] = "."
        grid = grid_from_rows(["".join(row) for row in rows])
        counts = chance.randint(1, 4), chance.randint(0, 8)
        found.append(
            generate_mission(
                grid, *counts, seed=seed, per_robot=(0, 3), per_victim=(0, 3), solvable=False
            )
        )
    return found


@pytest.fixture(scope="module")
def random_missions() -> list[Instance]:
    return missions(300)


@pytest.mark.parametrize("planner", BASELINES)
def test_plans_of_random_missions_pass_the_check(
    planner: str, random_missions: list[Instance]
) -> None:
    run = planners()[planner].run
    wrong = {i: problems(run(mission)) for i, mission in enumerate(random_missions)}
    assert {i: lines for i, lines in wrong.items() if lines} == {}


def test_the_random_missions_have_what_is_hard(random_missions: list[Instance]) -> None:
    reasons = [{u.reason for u in plan(m, planner="greedy").unserved} for m in random_missions]
    assert sum(Reason.NO_ROBOT_HAS_IT in found for found in reasons) >= 30
    assert sum(Reason.NO_CAPABLE_ROBOT_REACHES_IT in found for found in reasons) >= 30
    assert sum(not mission.victims for mission in random_missions) >= 10


def test_greedy_sends_the_nearest_robot_again_and_again() -> None:
    """Robots at 0 and 9; victims at 2, 4, 8.

    Robot 1 is 1 from the one at 8; robot 0 is 2 from the one at 2; from there the one at 4 is 2
    away, and 4 away from robot 1.
    """
    mission = corridor(10, {0: "A", 9: "A"}, (victim(0, 2), victim(1, 4), victim(2, 8)))
    made = plan(mission, planner="greedy")
    assert served(made) == {0: [(0, "A"), (1, "A")], 1: [(2, "A")]}
    times = {r.robot: [(v.arrival, v.departure) for v in r.visits] for r in made.routes}
    assert times == {0: [(2, 3), (5, 6)], 1: [(1, 2)]}


def test_greedy_leaves_to_another_robot_what_the_nearest_cannot_do() -> None:
    mission = corridor(10, {3: "A", 9: "AB"}, (victim(0, 4, "AB"),))
    assert served(plan(mission, planner="greedy")) == {0: [(0, "A")], 1: [(0, "B")]}


def test_ssi_gives_each_requirement_to_the_lowest_bid() -> None:
    """Robots at 0 and 9; victims at 2, 4, 8; A takes 1.

    Round 1: robot 0 bids 3, 5, 9; robot 1 bids 8, 6, 2: victim 2 to robot 1.
    Round 2: robot 0 bids 3, 5; robot 1, from 8, bids 7, 5: victim 0 to robot 0.
    Round 3: robot 0, from 2, bids 3 on victim 1; robot 1 bids 5: to robot 0.
    """
    mission = corridor(10, {0: "A", 9: "A"}, (victim(0, 2), victim(1, 4), victim(2, 8)))
    assert served(plan(mission, planner="ssi")) == {0: [(0, "A"), (1, "A")], 1: [(2, "A")]}


def test_ssi_inserts_where_it_is_cheapest() -> None:
    """One robot at 0. Victim 0 at 2 takes 10, victim 1 at 5 takes 1: bids 12 and 6.

    Victim 1 comes first; victim 0 then lies on the way: nothing added before it, 3 after it.
    """
    mission = corridor(6, {0: "A"}, (victim(0, 2, A=10), victim(1, 5)))
    assert served(plan(mission, planner="ssi")) == {0: [(0, "A"), (1, "A")]}


def test_ssi_bids_the_service_alone_where_it_already_goes() -> None:
    """Robots at 0 and 6, the victim at 2 needs A (1) and B (2).

    Robot 0 bids 3 and 4, robot 1 bids 5 and 6: A to robot 0, which then bids 2 on B, and robot 1
    still 6.
    """
    mission = corridor(7, {0: "AB", 6: "AB"}, (victim(0, 2, "AB"),))
    assert served(plan(mission, planner="ssi")) == {0: [(0, "AB")], 1: []}


def test_ssi_keeps_the_cheapest_insertion_of_every_victim() -> None:
    """Against looking at every place of the route anew; ties go to the first."""
    random = np.random.default_rng(3)
    for _ in range(20):
        start, where = random.integers(0, 12, 2), random.integers(0, 12, (9, 2))
        to_first = np.abs(where - start).sum(axis=1).astype(float)
        between = np.abs(where[:, None] - where[None]).sum(axis=2).astype(float)
        kept = _Insertions(to_first, between)
        route: list[int] = []
        for v in random.permutation(9).tolist():
            added = [[_length([*route[:at], w, *route[at:]], to_first, between) for w in range(9)]
                     for at in range(len(route) + 1)]  # fmt: skip
            now = _length(route, to_first, between)
            cheapest = np.min(added, axis=0) - now
            cheapest[route] = 0.0
            assert kept.cheapest().tolist() == cheapest.tolist()
            route.insert(int(np.argmin(added, axis=0)[v]), v)
            kept.insert(v)
            assert kept.route == route


def _length(route: list[int], to_first: Floats, between: Floats) -> float:
    legs = sum(float(between[a, b]) for a, b in pairwise(route))
    return legs + (float(to_first[route[0]]) if route else 0.0)


def test_ssi_counts_time_and_not_cells() -> None:
    """Robot 0 is 2 cells away at speed 0.25, so 8 time units; robot 1 is 5 away at speed 1."""
    slow = Robot(id=0, start=(0, 0), speed=0.25, capabilities=("A",))
    mission = corridor(8, {0: "A", 7: "A"}, (victim(0, 2),))
    mission = mission.replace(robots=(slow, mission.robots[1]))
    assert served(plan(mission, planner="ssi")) == {0: [], 1: [(0, "A")]}
    assert served(plan(mission, planner="greedy")) == {0: [(0, "A")], 1: []}


@pytest.mark.parametrize("planner", BASELINES)
def test_the_same_seed_gives_the_same_plan(planner: str, paper: Instance) -> None:
    first, again = (plan(paper, planner=planner, seed=3) for _ in range(2))
    assert first.same_as(again)
    assert plan(first.instance, planner=first.planner, **first.options).same_as(first)


def test_random_plans_differ_by_their_seeds(paper: Instance) -> None:
    known = paper.replace(scouts=())
    routes = {plan(known, planner="random", seed=seed).routes for seed in range(5)}
    assert len(routes) > 1
