"""MRGA against calculations by hand; the cost is that of the docstring of ``planners/mrga.py``.

All robots walk at speed 1. α = 0.25 and β = 0.20, so that 1 − α + β = 0.95.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pytest
from support.amounts import sample

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.mission.plan import Plan
from msmrta_opt.planners import plan

DOORS = grid_from_rows(["....@....", ".@@.@.@..", ".........", "@.@@.@@.@", "....@...."])


def line(
    length: int,
    times: Mapping[str, float],
    robots: Sequence[tuple[int, str]],
    victims: Sequence[tuple[int, str]],
) -> Instance:
    """A mission on one row: robots and victims as (column, kinds), kinds of one letter."""
    return Instance(
        map=grid_from_rows(["." * length]),
        capabilities=tuple(times),
        service_time=dict(times),
        robots=tuple(
            Robot(id=r, start=(0, col), speed=1, capabilities=tuple(kinds))
            for r, (col, kinds) in enumerate(robots)
        ),
        victims=tuple(
            Victim(id=v, cell=(0, col), requirements=tuple(kinds))
            for v, (col, kinds) in enumerate(victims)
        ),
    )


def served(made: Plan) -> dict[int, list[tuple[int, str]]]:
    """What each robot serves: (victim, kinds) in order."""
    return {
        route.robot: [(visit.victim, "".join(visit.served)) for visit in route.visits]
        for route in made.routes
    }


def test_a_long_service_is_put_off_although_it_is_nearer() -> None:
    """One robot at 4 that has A (4 time units) and B (40); both kinds have redundancy 1.

    (3) The nearest goal is victim 0's A at 5: cost 1, makespan 1, position 5.
    (4) B of victim 1 at 7: 0.25 (40 + 1) + 0.95 · 2 + 0.20 (1 · 40) / 1 = 20.15;
        A of victim 2 at 1: 0.25 (4 + 1) + 0.95 · 4 + 0.20 (1 · 4) / 1 = 5.85, the cheapest.
        Then what is left.
    """
    mission = line(10, {"A": 4, "B": 40}, [(4, "AB")], [(5, "A"), (7, "B"), (1, "A")])
    made = plan(mission, planner="mrga")
    assert served(made) == {0: [(0, "A"), (2, "A"), (1, "B")]}


def test_two_robots_start_in_their_clusters_and_then_take_the_cheapest_pair() -> None:
    """Robot 0 at 2 has A and B, robot 1 at 8 has A. A takes 2, B takes 6; redundancy 2 and 1.

    (1) Clusters: victims 0 (at 0: A, B) and 1 (at 1: B); victims 2 (at 10: A) and 3 (at 11: A, B).
    (2) Goals they can do: robot 0 has 3 and 3, robot 1 has 1 and 2: robot 0 left, robot 1 right.
    (3) Robot 0: B of 1, cost 1. Robot 1: A of 2, cost 2.
    (4) Robot 0 at 1, makespan 1, has done a B; robot 1 at 10, makespan 2, has done an A.
        r0: A of 0: 0.25 · 3 + 0.95 · 1 + 0 = 1.70      B of 0: 0.25 · 7 + 0.95 + 0.2 · 6 = 3.90
            A of 3: 0.25 · 3 + 0.95 · 10 + 0 = 10.25    B of 3: 1.75 + 9.50 + 1.20 = 12.45
        r1: A of 0: 0.25 · 4 + 9.50 + 0.2 · 2 / 2 = 10.70    A of 3: 1 + 0.95 + 0.20 = 2.15
        Robot 0 takes A of 0 for 1.70: makespan 2.70, at 0.
        r0: B of 0: 0.25 · 8.7 + 0 + 1.2 = 3.375    A of 3: 1.175 + 10.45 + 0.2 = 11.825
        r1: A of 3 is still 2.15 and the cheapest: robot 1 takes it.
        Only robot 0 has B: B of 0 for 3.375, B of 3 last.
    """
    mission = line(
        12, {"A": 2, "B": 6}, [(2, "AB"), (8, "A")], [(0, "AB"), (1, "B"), (10, "A"), (11, "AB")]
    )
    made = plan(mission, planner="mrga")
    assert served(made) == {0: [(1, "B"), (0, "AB"), (3, "B")], 1: [(2, "A"), (3, "A")]}
    times = {r.robot: [(v.arrival, v.departure) for v in r.visits] for r in made.routes}
    assert times == {0: [(1, 7), (8, 16), (27, 33)], 1: [(2, 4), (5, 7)]}


def test_a_robot_without_a_goal_bids_its_distance_alone() -> None:
    """Both victims stand at 3, so there is one cluster. Robot 0 at 0 has A and B, robot 1 at 6 has A.

    (2) Robot 0 can do 3 goals, robot 1 two: robot 0 has the cluster.
    (3) Robot 0: A of 0, cost 3. Robot 1 has no goal yet.
    (4) r0: B of 0: 0.25 (4 + 3) + 0 = 1.75    A of 1: 0.25 (10 + 3) + 0.2 · 10 / 2 = 4.25
        r1: A of 1: 3. Robot 0 takes B of 0: makespan 4.75.
        r0: A of 1: 0.25 · 14.75 + 1 = 4.6875; r1: 3, so it is robot 1's. (By the other formula it
        would bid 0.25 · 10 + 0.95 · 3 = 5.35, and robot 0 would win.)
    """
    mission = line(7, {"A": 10, "B": 4}, [(0, "AB"), (6, "A")], [(3, "AB"), (3, "A")])
    assert served(plan(mission, planner="mrga")) == {0: [(0, "AB")], 1: [(1, "A")]}


def test_with_alpha_and_beta_zero_only_the_distance_counts() -> None:
    """The first mission above: from 5, victim 1 at 7 is nearer than victim 2 at 1."""
    mission = line(10, {"A": 4, "B": 40}, [(4, "AB")], [(5, "A"), (7, "B"), (1, "A")])
    made = plan(mission, planner="mrga", alpha=0, beta=0)
    assert served(made) == {0: [(0, "A"), (1, "B"), (2, "A")]}


@pytest.mark.parametrize("seed", sample(range(8), 3))
def test_a_path_search_for_each_distance_gives_the_routes_of_the_table(seed: int) -> None:
    mission = generate_mission(DOORS, 3, 8, seed=seed, solvable=False)
    table, search = (plan(mission, planner="mrga", distances=d) for d in ("table", "search"))
    assert table.routes == search.routes
    assert table.unserved == search.unserved


@pytest.mark.parametrize(
    ("option", "value", "right"),
    [
        ("distances", "guess", "give one of search, table"),
        ("alpha", -0.1, "give a number from 0 to 1"),
        ("alpha", "much", "give a number from 0 to 1"),
        ("beta", 1.5, "give a number from 0 to 1"),
        ("beta", float("nan"), "give a number from 0 to 1"),
    ],
)
def test_an_option_out_of_range_is_refused(
    option: str, value: object, right: str, paper: Instance
) -> None:
    with pytest.raises(InputError, match=right) as caught:
        plan(paper, planner="mrga", **{option: value})  # type: ignore[arg-type]
    assert caught.value.field == option
