from __future__ import annotations

import random
from collections.abc import Sequence

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.amounts import examples
from support.stage_missions import mission

from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.requirement_analysis import requirement_analysis
from msmrta_opt.stages.robot_assignment import robot_assignment
from msmrta_opt.stages.situation import Situation, Stop, without

A, B, C = 0, 1, 2
SEALED, SEQUENTIAL = "sealed", "sequential"


def corridor(robots: dict[int, str], victims: dict[int, str]) -> Instance:
    """Robots and victims by column and kinds, in a corridor of twelve cells."""
    return mission(
        ["." * 12],
        [((0, column), has) for column, has in robots.items()],
        [((0, column), needs) for column, needs in victims.items()],
    )


def b4_of(instance: Instance, award: str = SEALED, before: Sequence[Stop] = ()) -> list[Stop]:
    situation = Situation.of(instance)
    return robot_assignment(
        situation,
        before,
        without(situation.available, before),
        requirement_analysis(instance.P, instance.Q),
        StagedOptions.of(award=award),
    )


def awards(b4: Sequence[Stop]) -> dict[tuple[int | None, int], int]:
    """Who serves each requirement (victim, kind)."""
    won = {(stop.victim, k): stop.robot for stop in b4 for k in stop.kinds}
    assert len(won) == sum(len(stop.kinds) for stop in b4), "a requirement was awarded twice"
    return won


@pytest.fixture(params=[SEALED, SEQUENTIAL])
def award(request: pytest.FixtureRequest) -> str:
    return str(request.param)


# Who wins


def test_the_nearest_robot_that_has_the_kind_wins(award: str) -> None:
    # Robot 1 stands there without A; robot 2 is 3 away, robot 0 is 5 away.
    instance = corridor({0: "A", 5: "B", 8: "A"}, {5: "A"})
    assert b4_of(instance, award) == [Stop(2, (0, 5), "B4", 0, (A,))]


def test_ties_go_to_the_lowest_id(award: str) -> None:
    instance = corridor({3: "B", 7: "A", 5: "A"}, {6: "A"})
    assert b4_of(instance, award) == [Stop(1, (0, 6), "B4", 0, (A,))]


def test_near_means_by_walking_not_as_the_crow_flies(award: str) -> None:
    # Robot 0 is 2 away as the crow flies and 6 around the wall; robot 1 is 5 away.
    rows = [".@.......", ".@.......", "........."]
    instance = mission(rows, [((0, 0), "A"), ((0, 7), "A")], [((0, 2), "A")])
    assert awards(b4_of(instance, award)) == {(0, A): 1}


def test_speed_does_not_count(award: str) -> None:
    instance = corridor({0: "A", 5: "A"}, {2: "A"})
    fast = instance.robots[1].model_copy(update={"speed": 100.0})
    instance = instance.replace(robots=(instance.robots[0], fast))
    assert awards(b4_of(instance, award)) == {(0, A): 0}


def test_a_robot_that_cannot_reach_the_victim_does_not_bid(award: str) -> None:
    instance = mission(["..@...."], [((0, 1), "A"), ((0, 6), "A")], [((0, 3), "A")])
    assert awards(b4_of(instance, award)) == {(0, A): 1}


def test_what_nobody_can_serve_is_not_announced(award: str) -> None:
    # Nobody has C, and victim 1 is out of robot 0's reach.
    instance = mission(["..@."], [((0, 0), "A")], [((0, 1), "AC"), ((0, 3), "A")])
    assert b4_of(instance, award) == [Stop(0, (0, 1), "B4", 0, (A,))]


def test_where_nothing_is_open_nothing_is_awarded(award: str) -> None:
    instance = corridor({0: "A"}, {5: "A"})
    assert b4_of(instance, award, [Stop(0, (0, 5), "B2", 0, (A,))]) == []


def test_each_kind_of_a_victim_goes_to_its_own_nearest_robot(award: str) -> None:
    instance = corridor({0: "C", 4: "B", 8: "A"}, {6: "ABC"})
    assert awards(b4_of(instance, award)) == {(0, A): 2, (0, B): 1, (0, C): 0}


def test_a_robot_that_wins_several_kinds_of_a_victim_comes_once(award: str) -> None:
    # Robot 1 is nearest for A and C; B is robot 0's.
    instance = corridor({0: "B", 5: "AC"}, {6: "ABC"})
    assert sorted(b4_of(instance, award), key=lambda stop: stop.robot) == [
        Stop(0, (0, 6), "B4", 0, (B,)),
        Stop(1, (0, 6), "B4", 0, (A, C)),
    ]


# Bids are from where queues end


def test_a_robot_bids_from_the_end_of_its_queue(award: str) -> None:
    # From their starts robot 0 would be nearer to column 2; its queue ends at 11.
    instance = corridor({0: "A", 6: "A"}, {2: "A", 11: "A"})
    before = [Stop(0, (0, 11), "B3", 1, (A,))]
    assert awards(b4_of(instance, award, before)) == {(0, A): 1}


def test_a_centre_at_the_end_of_a_queue_is_where_it_ends(award: str) -> None:
    instance = corridor({0: "A", 6: "A"}, {2: "A"})
    assert awards(b4_of(instance, award, [Stop(0, (0, 11), "B2")])) == {(0, A): 1}


def test_a_robot_without_tasks_bids_from_its_start(award: str) -> None:
    # The authors' program leaves it out. Robot 1 has a task 2 away, robot 0 has none and is 1 away.
    instance = corridor({3: "A", 10: "A"}, {4: "A", 6: "A"})
    before = [Stop(1, (0, 6), "B3", 1, (A,))]
    assert awards(b4_of(instance, award, before)) == {(0, A): 0}


def test_a_bid_belongs_to_the_robot_that_makes_it(award: str) -> None:
    # In the authors' program bids shift to lower robots when some do not bid. Robots 1 and 3 bid, 6
    # and 2 cells.
    instance = corridor({5: "B", 0: "A", 11: "B", 8: "A"}, {6: "A"})
    assert awards(b4_of(instance, award)) == {(0, A): 3}


# Sealed and sequential


def test_sealed_bids_do_not_know_of_awards_and_sequential_ones_do() -> None:
    # Robot 0 at 3 is nearest to both: 3 against 9 cells to column 0, 2 against 4 to column 5. Once
    # it has won column 0, it is 5 away from column 5, and robot 1 is 4 away.
    instance = corridor({3: "A", 9: "A"}, {0: "A", 5: "A"})
    assert awards(b4_of(instance, SEALED)) == {(0, A): 0, (1, A): 0}
    assert awards(b4_of(instance, SEQUENTIAL)) == {(0, A): 0, (1, A): 1}


def test_sequential_awards_may_also_bring_a_robot_nearer() -> None:
    # Robot 0 wins column 4 (4 against 7 cells). From there column 7 is 3 away, as near as for
    # robot 1, and robot 0 is first; sealed, it is 7 away.
    instance = corridor({0: "A", 10: "A"}, {4: "A", 7: "A"})
    assert awards(b4_of(instance, SEALED)) == {(0, A): 0, (1, A): 1}
    assert awards(b4_of(instance, SEQUENTIAL)) == {(0, A): 0, (1, A): 0}


def test_in_sequence_a_robot_that_has_won_a_kind_is_at_the_victim_for_the_next() -> None:
    # A: robot 1, 1 away, ahead of robot 2. B: robot 1 is there now; sealed, robot 0 is as near as
    # robot 1 and comes first. (C keeps either from satisfying the victim fully.)
    instance = corridor({7: "B", 5: "AB", 9: "AC"}, {6: "ABC"})
    assert awards(b4_of(instance, SEALED)) == {(0, A): 1, (0, B): 0, (0, C): 2}
    assert awards(b4_of(instance, SEQUENTIAL)) == {(0, A): 1, (0, B): 1, (0, C): 2}


# Full satisfaction


def test_a_winner_that_fully_satisfies_the_victim_takes_all_and_nobody_else_comes(
    award: str,
) -> None:
    # A would be robot 0's, 1 away. B is won by robot 1, 3 away, which has both.
    instance = corridor({5: "A", 9: "AB"}, {6: "AB"})
    assert b4_of(instance, award) == [Stop(1, (0, 6), "B4", 0, (A, B))]


def test_a_full_winner_takes_what_remains_and_not_what_is_done(award: str) -> None:
    instance = corridor({5: "A", 9: "ABC", 11: "C"}, {6: "ABC"})
    before = [Stop(2, (0, 6), "B2", 0, (C,))]
    assert b4_of(instance, award, before) == [Stop(1, (0, 6), "B4", 0, (A, B))]


def test_a_robot_that_would_satisfy_the_victim_fully_but_wins_nothing_does_not_come(
    award: str,
) -> None:
    instance = corridor({5: "A", 7: "B", 10: "AB"}, {6: "AB"})
    assert awards(b4_of(instance, award)) == {(0, A): 0, (0, B): 1}


def test_to_satisfy_fully_is_to_have_all_that_the_victim_needs_even_what_nobody_has(
    award: str,
) -> None:
    # Robot 1 has all that is available of victim 0, yet C keeps it from satisfying it fully.
    instance = corridor({5: "A", 9: "AB"}, {6: "ABC"})
    assert awards(b4_of(instance, award)) == {(0, A): 0, (0, B): 1}


def test_a_robot_that_a_full_winner_spares_bids_next_from_where_it_still_is() -> None:
    # Victim 0 at 6: A would be robot 0's (2 away), until robot 1 (4 away) wins B and takes both. So
    # robot 0 is still at 4, and 1 away from victim 1 at 3: nearer than robot 2 at 1.
    instance = corridor({4: "A", 10: "AB", 1: "A"}, {6: "AB", 3: "A"})
    expected = {(0, A): 1, (0, B): 1, (1, A): 0}
    assert awards(b4_of(instance, SEALED)) == expected
    assert awards(b4_of(instance, SEQUENTIAL)) == expected


# Against plain loops


def auction(seed: int) -> tuple[Instance, list[Stop]]:
    """A small mission with walls, and queues that serve some of it."""
    # By a seed alone, for hypothesis draws mostly missions in which nobody competes.
    chance = random.Random(seed)
    n_columns = chance.randint(3, 9)
    rows = ["".join(chance.choices(".....@", k=n_columns)) for _ in range(chance.randint(1, 5))]
    instance = generate_mission(
        grid_from_rows([*rows, "." * n_columns]),
        chance.randint(1, 5),
        chance.randint(0, 8),
        seed=seed,
        per_robot=(0, 5),
        per_victim=chance.choice([(0, 4), (2, 3)]),
        solvable=False,
    )
    able = Situation.of(instance).able
    open_ = np.array(able.any(axis=0))
    stops = []
    for v, cell in enumerate(instance.cells):
        for r in range(instance.n_robots):
            kinds = tuple(k for k in range(instance.n_kinds) if open_[v, k] and able[r, v, k])
            if kinds and chance.random() < 0.2:
                stops.append(Stop(r, cell, "B2", v, kinds[:1]))
                open_[v, kinds[0]] = False
    return instance, stops


@settings(max_examples=examples(500))
@given(seed=st.integers(0, 2**32 - 1), award=st.sampled_from([SEALED, SEQUENTIAL]))
def test_awards_are_those_that_plain_loops_make(seed: int, award: str) -> None:
    instance, before = auction(seed)
    walk = dict(nx.all_pairs_shortest_path_length(instance.map.graph))
    ends = [robot.start for robot in instance.robots]
    done: set[tuple[int | None, int]] = set()
    for stop in before:
        ends[stop.robot] = stop.cell
        done.update((stop.victim, k) for k in stop.kinds)

    expected: dict[tuple[int | None, int], int] = {}
    for v, victim in enumerate(instance.victims):
        needs = {instance.capabilities.index(kind) for kind in victim.requirements}
        has = [
            {instance.capabilities.index(kind) for kind in robot.capabilities}
            for robot in instance.robots
        ]
        places = list(ends)
        winners: dict[int, int] = {}
        for k in sorted(needs):
            bids = [
                (walk[places[r]][victim.cell], r)
                for r in range(instance.n_robots)
                if k in has[r] and victim.cell in walk[places[r]]
            ]
            if bids and (v, k) not in done:
                winners[k] = min(bids)[1]
                if award == SEQUENTIAL:
                    places[winners[k]] = victim.cell
        full = {r for r in winners.values() if needs <= has[r]}
        assert len(full) <= 1
        for r in full:
            winners = dict.fromkeys(winners, r)
        if award == SEQUENTIAL:
            for r in winners.values():
                ends[r] = victim.cell
        expected.update({(v, k): r for k, r in winners.items()})

    b4 = b4_of(instance, award, before)
    assert awards(b4) == expected
    assert len({(stop.robot, stop.victim) for stop in b4}) == len(b4)
    assert all(stop.stage == "B4" and stop.kinds == tuple(sorted(stop.kinds)) for stop in b4)
