from __future__ import annotations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.stages.requirement_analysis import (
    Bools,
    Missing,
    RequirementAnalysis,
    missing_capabilities,
    requirement_analysis,
)
from msmrta_opt.stages.situation import Situation

FIRE_EXTINGUISHER = 5

NO: list[int] = []  # the paper prints ∅

# Table 1: victim, location, cluster, q, L_potential
TABLE_1: list[tuple[int, Cell, int, list[int], list[list[int]]]] = [
    (0, (16, 7), 0, [0, 1, 1, 0, 0, 0], [NO, [0], [1], NO, NO, NO]),
    (1, (15, 12), 0, [0, 0, 0, 1, 1, 0], [NO, NO, NO, [0, 3], [1, 2], NO]),
    (2, (6, 5), 2, [0, 1, 0, 0, 0, 1], [NO, [0], NO, NO, NO, NO]),
    (3, (11, 4), 2, [0, 0, 1, 0, 1, 0], [NO, NO, [1], NO, [1, 2], NO]),
    (4, (0, 1), 1, [1, 1, 0, 0, 0, 0], [[1, 3], [0], NO, NO, NO, NO]),
    (5, (14, 14), 0, [0, 0, 0, 0, 1, 1], [NO, NO, NO, NO, [1, 2], NO]),
    (6, (14, 12), 0, [1, 0, 0, 0, 1, 0], [[1, 3], NO, NO, NO, [1, 2], NO]),
    (7, (3, 16), 3, [1, 0, 0, 1, 0, 0], [[1, 3], NO, NO, [0, 3], NO, NO]),
    (8, (10, 15), 0, [0, 1, 0, 1, 0, 0], [NO, [0], NO, [0, 3], NO, NO]),
    (9, (0, 12), 3, [1, 0, 0, 0, 1, 0], [[1, 3], NO, NO, NO, [1, 2], NO]),
]

# Table 2: robot, location, p, L_full, L_partial
TABLE_2: list[tuple[int, Cell, list[int], list[int], list[int]]] = [
    (0, (0, 9), [0, 1, 0, 1, 0, 0], [8], [0, 1, 2, 4, 7]),
    (1, (0, 10), [1, 0, 1, 0, 1, 0], [3, 6, 9], [0, 1, 4, 5, 7]),
    (2, (19, 9), [0, 0, 0, 0, 1, 0], [], [1, 3, 5, 6, 9]),
    (3, (19, 10), [1, 0, 0, 1, 0, 0], [7], [1, 4, 6, 8, 9]),
]


def analysis_of(instance: Instance) -> RequirementAnalysis:
    return requirement_analysis(instance.P, instance.Q)


def missing_of(instance: Instance) -> Missing:
    potential = analysis_of(instance).potential
    return missing_capabilities(instance.Q, potential, Situation.of(instance).reach)


def mission(
    rows: list[str], kinds: str, robots: list[tuple[Cell, str]], victims: list[tuple[Cell, str]]
) -> Instance:
    """Robots and victims by cell and kinds, a letter each."""
    return Instance(
        map=grid_from_rows(rows),
        capabilities=tuple(kinds),
        service_time=dict.fromkeys(kinds, 1.0),
        robots=tuple(
            Robot(id=i, start=cell, speed=1.0, capabilities=tuple(has))
            for i, (cell, has) in enumerate(robots)
        ),
        victims=tuple(
            Victim(id=i, cell=cell, requirements=tuple(needs))
            for i, (cell, needs) in enumerate(victims)
        ),
    )


# Tables 1 and 2


@pytest.mark.parametrize(("victim", "cell", "cluster", "q", "potential"), TABLE_1)
def test_the_potential_robots_of_each_victim_are_those_of_table_1(
    paper: Instance,
    victim: int,
    cell: Cell,
    cluster: int,
    q: list[int],
    potential: list[list[int]],
) -> None:
    assert paper.clusters is not None
    assert (paper.cells[victim], paper.clusters[victim]) == (cell, cluster)
    assert paper.Q[victim].astype(int).tolist() == q
    assert analysis_of(paper).potential_robots(victim) == potential


@pytest.mark.parametrize(("robot", "cell", "p", "full", "partial"), TABLE_2)
def test_whom_each_robot_satisfies_fully_and_partially_is_as_in_table_2(
    paper: Instance, robot: int, cell: Cell, p: list[int], full: list[int], partial: list[int]
) -> None:
    assert paper.starts[robot] == cell
    assert paper.P[robot].astype(int).tolist() == p
    assert analysis_of(paper).fully(robot) == full
    assert analysis_of(paper).partially(robot) == partial


def test_victims_2_and_5_of_the_paper_miss_the_fire_extinguisher_and_nobody_misses_more(
    paper: Instance,
) -> None:
    assert missing_of(paper) == Missing(
        unavailable=((2, FIRE_EXTINGUISHER), (5, FIRE_EXTINGUISHER)), unreachable=()
    )


# Algorithm 2


def test_a_robot_is_potential_for_victims_that_it_satisfies_only_partially_too() -> None:
    # The union of L_full and L_partial: robot 0 satisfies victim 0 fully and victim 1 partially.
    analysis = requirement_analysis(
        P=np.array([[1, 0]], dtype=bool), Q=np.array([[1, 0], [1, 1]], dtype=bool)
    )
    assert (analysis.fully(0), analysis.partially(0)) == ([0], [1])
    assert [analysis.potential_robots(v) for v in (0, 1)] == [[[0], []], [[0], []]]


def test_a_victim_without_requirements_is_in_no_set() -> None:
    # U = S = 0: the condition U > 0 of Algorithm 2 keeps it out of L_full.
    analysis = requirement_analysis(P=np.ones((2, 3), dtype=bool), Q=np.zeros((1, 3), dtype=bool))
    assert not analysis.full.any()
    assert not analysis.partial.any()
    assert not analysis.potential.any()


def test_capabilities_that_a_victim_does_not_need_do_not_count() -> None:
    analysis = requirement_analysis(
        P=np.array([[0, 1, 1]], dtype=bool), Q=np.array([[1, 1, 0]], dtype=bool)
    )
    assert (analysis.fully(0), analysis.partially(0)) == ([], [0])


@pytest.mark.parametrize(("n_robots", "n_victims", "n_kinds"), [(2, 0, 3), (1, 2, 0)])
def test_without_victims_or_kinds_the_sets_are_empty(
    n_robots: int, n_victims: int, n_kinds: int
) -> None:
    analysis = requirement_analysis(
        P=np.ones((n_robots, n_kinds), dtype=bool), Q=np.ones((n_victims, n_kinds), dtype=bool)
    )
    assert analysis.full.shape == analysis.partial.shape == (n_robots, n_victims)
    assert analysis.potential.shape == (n_victims, n_kinds, n_robots)
    assert not analysis.full.any()
    assert not analysis.partial.any()


@given(st.data())
def test_the_sets_are_those_of_their_definitions_in_words(data: st.DataObject) -> None:
    n_kinds = data.draw(st.integers(0, 4))
    sizes = st.integers(0, 4)
    P: Bools = data.draw(arrays(np.bool_, (data.draw(sizes), n_kinds)))  # noqa: N806
    Q: Bools = data.draw(arrays(np.bool_, (data.draw(sizes), n_kinds)))  # noqa: N806
    analysis = requirement_analysis(P, Q)
    for v, needs in enumerate({k for k in range(n_kinds) if row[k]} for row in Q):
        for r, has in enumerate({k for k in range(n_kinds) if row[k]} for row in P):
            assert analysis.full[r, v] == (bool(needs) and needs <= has)
            assert analysis.partial[r, v] == (bool(needs & has) and not needs <= has)
            assert {k for k in range(n_kinds) if analysis.potential[v, k, r]} == needs & has


# MissingCap


def test_every_missing_kind_of_a_victim_is_listed_not_only_the_first() -> None:
    instance = mission(["..."], "ABC", [((0, 0), "B")], [((0, 2), "ABC")])
    assert missing_of(instance) == Missing(unavailable=((0, 0), (0, 2)), unreachable=())


def test_a_kind_whose_only_robot_cannot_reach_the_victim_is_listed_apart() -> None:
    # Robot 0 reaches victim 0 but not victim 1 behind the wall; nobody has C.
    instance = mission(["..@."], "ABC", [((0, 0), "AB")], [((0, 1), "AC"), ((0, 3), "AC")])
    assert missing_of(instance) == Missing(unavailable=((0, 2), (1, 2)), unreachable=((1, 0),))


def test_a_kind_is_missing_only_if_all_its_robots_are_cut_off() -> None:
    robots = [((0, 0), "A"), ((0, 3), "A")]
    assert missing_of(mission(["..@.."], "A", robots, [((0, 4), "A")])) == Missing((), ())


def test_a_robot_that_reaches_the_victim_without_the_kind_does_not_help() -> None:
    robots = [((0, 0), "A"), ((0, 3), "B")]
    missing = missing_of(mission(["..@.."], "AB", robots, [((0, 4), "AB")]))
    assert missing == Missing(unavailable=(), unreachable=((0, 0),))


GRIDS = (
    arrays(np.bool_, st.tuples(st.integers(1, 4), st.integers(1, 5))).filter(np.any).map(GridMap)
)


@given(grid=GRIDS, data=st.data())
def test_a_requirement_is_missing_iff_no_robot_that_has_it_walks_there(
    grid: GridMap, data: st.DataObject
) -> None:
    free = st.sampled_from([(int(r), int(c)) for r, c in np.argwhere(grid.free)])
    kinds = st.text("AB", max_size=2).map(lambda text: "".join(sorted(set(text))))
    someone = st.tuples(free, kinds)
    instance = mission(
        list(grid.rows),
        "AB",
        data.draw(st.lists(someone, min_size=1, max_size=3)),
        data.draw(st.lists(someone, max_size=3)),
    )
    unavailable, unreachable = [], []
    for v, victim in enumerate(instance.victims):
        for k, kind in enumerate(instance.capabilities):
            if kind not in victim.requirements:
                continue
            having = [robot for robot in instance.robots if kind in robot.capabilities]
            if not having:
                unavailable.append((v, k))
            elif not any(nx.has_path(grid.graph, robot.start, victim.cell) for robot in having):
                unreachable.append((v, k))
    assert missing_of(instance) == Missing(tuple(unavailable), tuple(unreachable))
