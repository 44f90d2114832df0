from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from support.stage_missions import mission

from msmrta_opt.mission.errors import ModelError
from msmrta_opt.mission.grid import Cell
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.data import VictimData
from msmrta_opt.stages.cluster_assignment import cluster_assignment
from msmrta_opt.stages.clustering import clustering
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.performance_analysis import performance_analysis
from msmrta_opt.stages.requirement_analysis import requirement_analysis
from msmrta_opt.stages.situation import Situation, Stop, without
from msmrta_opt.stages.victim_assignment import VictimAssignment, victim_assignment

A, B, C = 0, 1, 2
PRINTED, ONE_TO_ONE, COVERING, BALANCED = (
    f"victim_{name}" for name in ("printed", "one_to_one", "covering", "balanced")
)


def b3_of(
    instance: Instance, stops: Sequence[Stop] = (), preset: str = "paper", **options: Any
) -> tuple[VictimAssignment, VictimData]:
    """Stage B3 after `stops`, and the data of its Eq. 2."""
    chosen = StagedOptions.of(preset, **options)
    situation = Situation.of(instance)
    remaining = without(situation.available, stops)
    data = performance_analysis(situation, stops, remaining, chosen)
    return victim_assignment(situation, stops, remaining, data, chosen), data


# Each formulation on a small mission

CORRIDOR = ["." * 10]
# Both robots have A; robot 0 at 0, robot 1 at 9; all four victims are in the half of robot 0.
FOUR = mission(CORRIDOR, [((0, 0), "A"), ((0, 9), "A")], [((0, c), "A") for c in (4, 1, 3, 2)])


def queues(b3: VictimAssignment, n_robots: int = 2) -> list[list[int | None]]:
    return [[stop.victim for stop in b3.stops if stop.robot == r] for r in range(n_robots)]


def test_as_printed_nobody_is_assigned() -> None:
    b3, _ = b3_of(FOUR, victim_model=PRINTED)
    assert b3.stops == []
    assert b3.solution is not None
    assert b3.solution.objective == 0


def test_one_to_one_each_robot_takes_one_victim_at_the_least_cost() -> None:
    # Victims at 4, 1, 3, 2. Robot 0 to 1 and robot 1 to 4: 1 + 5 cells, the fewest of two robots
    # at two victims.
    assert queues(b3_of(FOUR, victim_model=ONE_TO_ONE)[0]) == [[1], [0]]


def test_covering_each_victim_gets_its_cheapest_robot_and_is_visited_nearest_first() -> None:
    # All are nearer to robot 0, which finds them at 1, 2, 3 and 4 although 4 is listed first.
    assert queues(b3_of(FOUR, victim_model=COVERING)[0]) == [[1, 3, 2, 0], []]


def test_balanced_every_victim_is_covered_and_the_busiest_robot_is_least_busy() -> None:
    # Half of success counts (β = 1/2, nobody fails): (c + 2) / 2 for robot 0 and (9 - c + 2) / 2
    # for robot 1, with c in 1, 2, 3, 4. If robot 1 takes 4, it is at 3.5 and robot 0 at 6; if it
    # takes 4 and 3, it is at 7.5 and robot 0 at 3.5. So it takes 4 alone; 3 alone (4 against 6.5)
    # or any other is worse.
    b3, _ = b3_of(FOUR, victim_model=BALANCED)
    assert queues(b3) == [[1, 3, 2], [0]]
    assert b3.solution is not None
    assert b3.solution.objective == pytest.approx(6.0)


def test_nearest_first_is_from_where_stage_b2_leaves_the_robot() -> None:
    b2 = [Stop(0, (0, 8), "B2")]
    b3, _ = b3_of(
        mission(CORRIDOR, [((0, 0), "A")], [((0, 1), "A"), ((0, 7), "A")]),
        b2,
        victim_model=COVERING,
    )
    assert queues(b3, 1) == [[1, 0]]


def test_beta_weighs_what_is_left_to_others_against_time() -> None:
    # The victim needs A and B. Robot 0 beside it has A: success 1 + 2, failure 3. Robot 1 has both:
    # success 9 + 5, failure 0. At β = 0.9: 0.3 + 2.7 against 1.4.
    robots: list[tuple[Cell, str]] = [((0, 1), "A"), ((0, 9), "AB")]
    instance = mission(CORRIDOR, robots, [((0, 0), "AB")])
    assert b3_of(instance, beta=0.0)[0].stops == [Stop(0, (0, 0), "B3", 0, (A,))]
    assert b3_of(instance, beta=0.9)[0].stops == [Stop(1, (0, 0), "B3", 0, (A, B))]


def test_a_robot_serves_what_remains_of_what_it_can() -> None:
    # A is done by stage B2, and C needs another robot.
    robots: list[tuple[Cell, str]] = [((0, 1), "AB"), ((0, 9), "A")]
    instance = mission(CORRIDOR, robots, [((0, 0), "ABC")])
    b3, _ = b3_of(instance, [Stop(1, (0, 0), "B2", 0, (A,))])
    assert b3.stops == [Stop(0, (0, 0), "B3", 0, (B,))]


@pytest.mark.parametrize("model", [PRINTED, ONE_TO_ONE, COVERING, BALANCED])
def test_where_nothing_remains_nothing_is_solved(model: str) -> None:
    robots: list[tuple[Cell, str]] = [((0, 0), "A")]
    done = mission(CORRIDOR, robots, [((0, 1), "A")])
    b3, _ = b3_of(done, [Stop(0, (0, 1), "B2", 0, (A,))], victim_model=model)
    assert (b3.stops, b3.solution) == ([], None)
    # Nobody has B, and victim 1 is behind a wall.
    hopeless = mission([".@."], robots, [((0, 0), "B"), ((0, 2), "A")])
    b3, _ = b3_of(hopeless, victim_model=model)
    assert (b3.stops, b3.solution) == ([], None)


# The paper's mission, against all assignments there are


@pytest.fixture(params=["paper", "authors"])
def preset(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def after_b2(instance: Instance, preset: str) -> list[Stop]:
    options = StagedOptions.of(preset)
    situation = Situation.of(instance)
    analysis = requirement_analysis(instance.P, instance.Q)
    return cluster_assignment(situation, analysis, clustering(situation, options), options).stops


def costs(data: VictimData, beta: float = 0.5) -> NDArray[np.float64]:
    return (1 - beta) * data.success + beta * data.failure


def chosen(b3: VictimAssignment) -> set[tuple[int, int]]:
    return {(stop.robot, stop.victim) for stop in b3.stops if stop.victim is not None}


# Who has an open requirement after stage B2 and who can serve something of it, from Tables 1 and 2
# and stage B2: {0: [1, 0], 1: [3], 2: [], 3: [9, 7]}, or {0: [1, 0], 3: [9]} in the authors' way.
CAN_SERVE = {
    "paper": {
        0: {1},
        1: {1, 2},
        2: {0},
        4: {0, 1, 3},
        5: {1, 2},
        6: {1, 2, 3},
        8: {0, 3},
        9: {1, 2},
    },
    "authors": {
        0: {1},
        1: {1, 2},
        2: {0},
        3: {1, 2},
        4: {0, 1, 3},
        5: {1, 2},
        6: {1, 2, 3},
        7: {0, 1, 3},
        8: {0, 3},
        9: {1, 2},
    },
}


def test_the_victims_that_remain_are_those_with_an_open_requirement(
    paper: Instance, preset: str
) -> None:
    _, data = b3_of(paper, after_b2(paper, preset), preset)
    able = {v: set(np.flatnonzero(data.can_serve[:, v]).tolist()) for v in range(10)}
    assert {v: robots for v, robots in able.items() if robots} == CAN_SERVE[preset]


def test_one_to_one_is_the_cheapest_of_all_ways_to_give_each_robot_a_victim(
    paper: Instance, preset: str
) -> None:
    b3, data = b3_of(paper, after_b2(paper, preset), preset, victim_model=ONE_TO_ONE)
    able, cost = CAN_SERVE[preset], costs(data)
    value: dict[tuple[int, ...], float] = {
        victims: sum(cost[r, v] for r, v in enumerate(victims))
        for victims in itertools.permutations(able, 4)
        if all(r in able[v] for r, v in enumerate(victims))
    }
    assert len(chosen(b3)) == 4
    visited = tuple(v for _, v in sorted(chosen(b3)))
    assert value[visited] == pytest.approx(min(value.values()))
    # Each at most once, and each of the four robots exactly once.
    assert [r for r, _ in sorted(chosen(b3))] == [0, 1, 2, 3]


def test_covering_gives_every_remaining_victim_its_cheapest_robot(
    paper: Instance, preset: str
) -> None:
    b3, data = b3_of(paper, after_b2(paper, preset), preset, victim_model=COVERING)
    able, cost = CAN_SERVE[preset], costs(data)
    assert sorted(v for _, v in chosen(b3)) == sorted(able)
    for r, v in chosen(b3):
        assert cost[r, v] == pytest.approx(min(cost[other, v] for other in able[v]))


def test_balanced_is_the_least_busy_of_all_ways_to_cover_the_remaining_victims(
    paper: Instance, preset: str
) -> None:
    b3, data = b3_of(paper, after_b2(paper, preset), preset, victim_model=BALANCED)
    able = CAN_SERVE[preset]

    def busiest(robots: Sequence[int]) -> float:
        load = data.busy / 2
        for r, v in zip(robots, able, strict=True):
            load[r] += (data.success[r, v] - data.busy[r]) / 2 + data.failure[r, v] / 2
        return float(load.max())

    assert sorted(v for _, v in chosen(b3)) == sorted(able)
    robot_of = {v: r for r, v in chosen(b3)}
    minimum = min(busiest(robots) for robots in itertools.product(*able.values()))
    assert busiest([robot_of[v] for v in able]) == pytest.approx(minimum)


@pytest.mark.parametrize("model", [ONE_TO_ONE, COVERING, BALANCED])
def test_whoever_comes_serves_all_that_remains_of_what_it_has(
    paper: Instance, preset: str, model: str
) -> None:
    stops = after_b2(paper, preset)
    remaining = without(Situation.of(paper).available, stops)
    for stop in b3_of(paper, stops, preset, victim_model=model)[0].stops:
        assert stop.stage == "B3"
        assert stop.victim is not None
        assert stop.cell == paper.cells[stop.victim]
        expected = np.flatnonzero(remaining[stop.victim] & paper.P[stop.robot])
        assert list(stop.kinds) == expected.tolist() != []


# Edited formulations

Edit = Callable[[str, str, str], str]


def test_where_a_formulation_sends_several_robots_the_first_serves_what_both_could(
    edit: Edit,
) -> None:
    model = edit(COVERING, "== data.coverable)", "== data.can_serve.sum(axis=0))")
    robots: list[tuple[Cell, str]] = [((0, 0), "AB"), ((0, 5), "BC"), ((0, 9), "B")]
    b3, _ = b3_of(mission(CORRIDOR, robots, [((0, 7), "ABC")]), victim_model=model)
    # Robot 2 finds nothing left to do, so it does not go.
    assert b3.stops == [Stop(0, (0, 7), "B3", 0, (A, B)), Stop(1, (0, 7), "B3", 0, (C,))]


def test_a_formulation_that_sends_a_robot_where_it_can_do_nothing_is_refused(
    edit: Edit,
) -> None:
    # Victim 1 is out of reach and victim 2 needs what nobody has.
    model = edit(PRINTED, "bounds=[0, data.can_serve], ", "bounds=[1, 1], ")
    model_rows = [".....@."]
    victims: list[tuple[Cell, str]] = [((0, 4), "A"), ((0, 6), "A"), ((0, 2), "B")]
    with pytest.raises(ModelError, match=r"may be 1 where data\.can_serve is false"):
        b3_of(mission(model_rows, [((0, 0), "A")], victims), victim_model=model)


def test_a_formulation_without_the_documented_variable_is_refused_by_name(edit: Edit) -> None:
    model = edit(COVERING, 'name="x"', 'name="y"')
    with pytest.raises(ModelError, match=f"^{model}: no variable is called 'x'"):
        b3_of(FOUR, victim_model=model)
