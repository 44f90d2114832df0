from __future__ import annotations

from collections.abc import Callable
from typing import Any

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.stage_missions import mission, small_missions

from msmrta_opt.mission.errors import ModelError
from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.instance import Instance
from msmrta_opt.stages.cluster_assignment import ClusterAssignment, cluster_assignment, cluster_data
from msmrta_opt.stages.clustering import Clustering, clustering
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.requirement_analysis import RequirementAnalysis, requirement_analysis
from msmrta_opt.stages.situation import Situation, Stop

A, B, C = 0, 1, 2


def before(
    instance: Instance, options: StagedOptions
) -> tuple[Situation, RequirementAnalysis, Clustering, StagedOptions]:
    """What the stages before hand over."""
    situation = Situation.of(instance)
    analysis = requirement_analysis(instance.P, instance.Q)
    return situation, analysis, clustering(situation, options), options


def b2_of(instance: Instance, preset: str = "paper", **options: Any) -> ClusterAssignment:
    return cluster_assignment(*before(instance, StagedOptions.of(preset, **options)))


def pairs(b2: ClusterAssignment) -> dict[int, list[int]]:
    """The clusters of each robot."""
    return {r: np.flatnonzero(row).tolist() for r, row in enumerate(b2.chosen)}


def served(b2: ClusterAssignment) -> dict[int, list[int | None]]:
    """The victims in each robot's queue, in order."""
    queues: dict[int, list[int | None]] = {r: [] for r in range(len(b2.chosen))}
    for stop in b2.stops:
        if stop.victim is not None:
            queues[stop.robot].append(stop.victim)
    return queues


# The weights of Eq. 1


def test_on_the_papers_mission_the_weights_are_those_of_its_tables(paper: Instance) -> None:
    # C0 = {0, 1, 5, 6, 8}, C1 = {4}, C2 = {2, 3}, C3 = {7, 9}. Each victim of Table 2's L_full
    # counts 2, each of its L_partial 1, since all victims need two kinds.
    data = cluster_data(*before(paper, StagedOptions.of()))
    assert data.w.tolist() == [[4, 1, 1, 1], [5, 1, 2, 3], [3, 0, 1, 1], [3, 1, 0, 3]]
    assert data.w_full.tolist() == [[2, 0, 0, 0], [2, 0, 2, 2], [0, 0, 0, 0], [0, 0, 0, 2]]


def test_the_authors_weights_count_only_victims_that_a_robot_satisfies_partially(
    paper: Instance,
) -> None:
    data = cluster_data(*before(paper, StagedOptions.of(weights="authors")))
    assert data.w.tolist() == [[2, 1, 1, 1], [3, 1, 0, 1], [3, 0, 1, 1], [3, 1, 0, 1]]
    assert data.w_full.tolist() == [[2, 0, 0, 0], [2, 0, 2, 2], [0, 0, 0, 0], [0, 0, 0, 2]]


def test_a_victim_out_of_reach_weighs_nothing() -> None:
    instance = mission(["..@."], [((0, 0), "A")], [((0, 1), "A"), ((0, 3), "AB")], [0, 0])
    data = cluster_data(*before(instance, StagedOptions.of()))
    assert (data.w.tolist(), data.w_full.tolist()) == ([[1]], [[1]])


def test_a_budget_holds_for_every_robot(paper: Instance) -> None:
    assert cluster_data(*before(paper, StagedOptions.of(budget=3))).budget.tolist() == [3] * 4


# Who takes which cluster


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_on_the_papers_mission_robots_go_to_the_clusters_that_they_satisfy_fully(
    paper: Instance, preset: str
) -> None:
    # Of full satisfaction, 2 + 2 + 2 is the most, for robots 0, 1 and 3, in this way only.
    b2 = b2_of(paper, preset, psi=0.95)
    assert pairs(b2) == {0: [0], 1: [2], 2: [1], 3: [3]}
    assert b2.solution is not None
    assert b2.solution.status == "optimal"
    w = 9 if preset == "paper" else 2 + 0 + 0 + 1
    assert b2.solution.objective == pytest.approx(0.05 * w + 0.95 * 6)


def test_without_the_weight_of_full_satisfaction_the_count_of_requirements_decides(
    paper: Instance,
) -> None:
    # 1 + 5 + 1 + 3 = 10; every other matching sums to 9 or less.
    assert pairs(b2_of(paper, psi=0.0)) == {0: [1], 1: [0], 2: [2], 3: [3]}


def test_a_robot_takes_as_many_clusters_as_the_formulation_allows() -> None:
    # Worth 3, 2 and 1 requirements to the one robot.
    victims = [((0, 1), "ABC"), ((0, 3), "AB"), ((0, 5), "A")]
    instance = mission(["......."], [((0, 0), "ABC")], victims, [0, 1, 2])
    assert pairs(b2_of(instance, cluster_model="cluster_one_to_one")) == {0: [0]}
    assert pairs(b2_of(instance, cluster_model="cluster_budgeted", budget=2)) == {0: [0, 1]}
    assert pairs(b2_of(instance, cluster_model="cluster_printed")) == {0: [0, 1, 2]}


def test_without_victims_nothing_is_solved_and_nobody_moves() -> None:
    b2 = b2_of(mission(["..."], [((0, 0), "A")], [], []))
    assert (b2.solution, b2.stops, b2.deferred, b2.chosen.shape) == (None, [], frozenset(), (1, 0))


# Whom they serve, and in which order

OPEN = ["....."] * 5


@pytest.mark.parametrize(
    ("preset", "expected"),
    [
        ("authors", {0: [1, 0], 1: [], 2: [], 3: [9]}),
        # Victims 3 and 7 as well, which robots 1 and 3 satisfy fully: 9 is 3 from (1, 14), 7 is 4.
        ("paper", {0: [1, 0], 1: [3], 2: [], 3: [9, 7]}),
    ],
)
def test_on_the_papers_mission_stage_b2_is_as_worked_out_from_the_tables(
    paper: Instance, preset: str, expected: dict[int, list[int]]
) -> None:
    assert served(b2_of(paper, preset)) == expected


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_victims_2_and_8_of_the_paper_are_behind_walls(paper: Instance, preset: str) -> None:
    assert b2_of(paper, preset).deferred == {2, 8}


def test_members_are_served_by_manhattan_distance_from_the_centre_then_id() -> None:
    # The centre is (2, 2); victims 0 and 3 are 2 away, 1 and 2 are 1 away, 4 stands on it.
    cells = [(1, 1), (2, 3), (2, 1), (3, 3), (2, 2)]
    victims = [(cell, "A") for cell in cells]
    b2 = b2_of(mission(OPEN, [((0, 0), "A")], victims, [0] * 5))
    assert served(b2) == {0: [4, 1, 2, 0, 3]}


def test_a_robot_serves_all_that_it_can_at_a_member_and_passes_by_those_it_cannot_help() -> None:
    victims = [((0, 1), "ABC"), ((0, 3), "B"), ((0, 2), "C")]
    b2 = b2_of(mission(OPEN, [((0, 0), "AC")], victims, [0] * 3))
    assert b2.stops == [
        Stop(0, (0, 2), "B2"),
        Stop(0, (0, 2), "B2", 2, (C,)),
        Stop(0, (0, 1), "B2", 0, (A, C)),
    ]


def test_by_the_authors_rule_only_members_satisfied_partially_are_served() -> None:
    victims = [((0, 1), "AB"), ((0, 3), "A"), ((0, 2), "B")]
    instance = mission(OPEN, [((0, 0), "A")], victims, [0] * 3)
    assert served(b2_of(instance, members="all")) == {0: [0, 1]}
    assert served(b2_of(instance, members="partial")) == {0: [0]}


ROOMS = ["..@..", "..@..", "..@..", "..@..", "....."]


def test_a_member_behind_a_wall_is_deferred() -> None:
    # The centre is (1, 1). Victims 0 and 1 are 2 away, walls or not; victim 2 is 2 away without
    # walls and 8 around them.
    victims = [((0, 0), "A"), ((2, 0), "A"), ((1, 3), "A")]
    b2 = b2_of(mission(ROOMS, [((4, 0), "A")], victims, [0, 0, 0]))
    assert b2.deferred == {2}
    assert served(b2) == {0: [0, 1]}


def test_a_wall_that_costs_no_detour_defers_nobody() -> None:
    # From the centre (1, 1) around the wall at (0, 1): (0, 0) and (0, 2) stay 2 away.
    rows = [".@.", "...", "..."]
    victims = [((0, 0), "A"), ((0, 2), "A"), ((2, 1), "A"), ((2, 1), "A")]
    assert b2_of(mission(rows, [((2, 2), "A")], victims, [0] * 4)).deferred == frozenset()


def test_a_victim_that_cannot_be_reached_from_its_centre_is_deferred() -> None:
    # The mean (0, 2) is in a wall; (0, 1) stands for it, and victim 1 is in the other room.
    victims = [((0, 0), "A"), ((0, 4), "A")]
    b2 = b2_of(mission(["..@.."], [((0, 0), "A")], victims, [0, 0]))
    assert b2.deferred == {1}
    assert served(b2) == {0: [0]}


def test_a_victim_is_deferred_whether_or_not_a_robot_takes_its_cluster() -> None:
    # The robot can do nothing in cluster 0, so it takes cluster 1, in the corner.
    victims = [((0, 0), "C"), ((2, 0), "C"), ((1, 3), "C"), ((4, 4), "ABC")]
    b2 = b2_of(mission(ROOMS, [((4, 0), "AB")], victims, [0, 0, 0, 1]))
    assert pairs(b2) == {0: [1]}
    assert b2.deferred == {2}


# The way there


def test_a_robot_passes_the_centre_of_its_cluster_first_or_not_at_all() -> None:
    victims = [((0, 1), "A"), ((0, 3), "A")]
    instance = mission(OPEN, [((0, 0), "A")], victims, [0, 0])
    visits = [Stop(0, (0, 1), "B2", 0, (A,)), Stop(0, (0, 3), "B2", 1, (A,))]
    assert b2_of(instance, through_centre=True).stops == [Stop(0, (0, 2), "B2"), *visits]
    assert b2_of(instance, through_centre=False).stops == visits


def test_a_robot_with_several_clusters_visits_the_nearest_centre_first() -> None:
    # From column 5: cluster 0 at 7 is 2 away, from there cluster 2 at 9 is 2 away, and cluster 1
    # at 2, though nearer to the start than 9, comes last.
    cells: list[Cell] = [(0, 7), (0, 2), (0, 9)]
    instance = mission(["." * 10], [((0, 5), "A")], [(cell, "A") for cell in cells], [0, 1, 2])
    b2 = b2_of(instance, cluster_model="cluster_printed")
    assert [(stop.cell, stop.victim) for stop in b2.stops] == [
        ((0, 7), None),
        ((0, 7), 0),
        ((0, 9), None),
        ((0, 9), 2),
        ((0, 2), None),
        ((0, 2), 1),
    ]


@pytest.mark.parametrize("through_centre", [True, False])
def test_a_robot_that_cannot_reach_the_centre_stays_away(through_centre: bool) -> None:
    instance = mission(["..@.."], [((0, 0), "A")], [((0, 4), "A")], [0])
    b2 = b2_of(instance, through_centre=through_centre)
    assert pairs(b2) == {0: [0]}
    assert b2.stops == []


# Edited formulations

Edit = Callable[[str, str, str], str]


def test_a_formulation_that_sends_two_robots_to_a_cluster_serves_each_requirement_once(
    edit: Edit,
) -> None:
    model = edit("cluster_printed", "(cp.sum(x, axis=0) <= 1)", "(cp.sum(x, axis=0) <= 2)")
    robots = [((0, 0), "AB"), ((0, 4), "BC")]
    instance = mission(OPEN, robots, [((0, 1), "ABC"), ((0, 3), "B")], [0, 0])
    b2 = b2_of(instance, cluster_model=model)
    assert pairs(b2) == {0: [0], 1: [0]}
    done = [(stop.victim, k) for stop in b2.stops for k in stop.kinds]
    assert sorted(done) == [(0, A), (0, B), (0, C), (1, B)]


def test_a_formulation_without_the_documented_variable_is_refused_by_name(edit: Edit) -> None:
    model = edit("cluster_printed", 'name="x"', 'name="y"')
    with pytest.raises(ModelError, match=f"^{model}: no variable is called 'x'"):
        b2_of(mission(OPEN, [((0, 0), "A")], [((0, 1), "A")], [0]), cluster_model=model)


# Against plain loops


@st.composite
def missions(draw: st.DrawFn) -> Instance:
    """Small missions with walls and random pinned clusters."""
    instance = draw(small_missions())
    labels = st.lists(st.integers(0, 4), min_size=instance.n_victims, max_size=instance.n_victims)
    return instance.replace(clusters=tuple(draw(labels)))


def walks(grid: GridMap) -> dict[Cell, dict[Cell, int]]:
    """Walking distances between all cells that a walk joins."""
    return dict(nx.all_pairs_shortest_path_length(grid.graph))


@given(instance=missions(), weights=st.sampled_from(["text", "authors"]))
def test_the_weights_are_those_that_plain_loops_count(instance: Instance, weights: str) -> None:
    options = StagedOptions.of(weights=weights)
    data = cluster_data(*before(instance, options))
    walk = walks(instance.map)
    assert instance.clusters is not None
    for c, label in enumerate(sorted(set(instance.clusters))):
        for r, robot in enumerate(instance.robots):
            w = w_full = 0
            for victim, of in zip(instance.victims, instance.clusters, strict=True):
                if of != label or victim.cell not in walk[robot.start]:
                    continue
                met = set(victim.requirements) & set(robot.capabilities)
                fully = met == set(victim.requirements)
                if weights == "text" or not fully:
                    w += len(met)
                if fully:
                    w_full += len(met)
            assert (data.w[r, c], data.w_full[r, c]) == (w, w_full)


@given(
    instance=missions(),
    model=st.sampled_from(["cluster_printed", "cluster_one_to_one", "cluster_budgeted"]),
    members=st.sampled_from(["all", "partial"]),
    through_centre=st.booleans(),
)
def test_queues_are_those_that_plain_loops_make_of_the_chosen_clusters(
    instance: Instance, model: str, members: str, through_centre: bool
) -> None:
    options = StagedOptions.of(cluster_model=model, members=members, through_centre=through_centre)
    situation, analysis, clusters, _ = before(instance, options)
    b2 = cluster_assignment(situation, analysis, clusters, options)
    walk = walks(instance.map)

    deferred = set()
    for v, victim in enumerate(instance.victims):
        row, col = clusters.cells[clusters.labels[v]]
        straight = abs(victim.cell[0] - row) + abs(victim.cell[1] - col)
        if walk[row, col].get(victim.cell) != straight:
            deferred.add(v)
    assert b2.deferred == deferred

    expected = []
    for r, robot in enumerate(instance.robots):
        here = robot.start
        wanted: dict[int, list[tuple[int, int, tuple[int, ...]]]] = {}
        for c in range(clusters.n_clusters):
            for v in set(clusters.members(c)) - deferred:
                met = set(instance.victims[v].requirements) & set(robot.capabilities)
                partial = met != set(instance.victims[v].requirements)
                if b2.chosen[r, c] and met and (members == "all" or partial):
                    away = walk[clusters.cells[c]][instance.cells[v]]
                    kinds = tuple(sorted(instance.capabilities.index(kind) for kind in met))
                    wanted.setdefault(c, []).append((away, v, kinds))
        ahead = [c for c in wanted if clusters.cells[c] in walk[robot.start]]
        while ahead:
            c = min(ahead, key=lambda c: (walk[here][clusters.cells[c]], c))
            ahead.remove(c)
            here = clusters.cells[c]
            if through_centre:
                expected.append(Stop(r, here, "B2"))
            for _, v, kinds in sorted(wanted[c]):
                expected.append(Stop(r, instance.cells[v], "B2", v, kinds))
    assert b2.stops == expected
