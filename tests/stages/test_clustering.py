from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import Cell, GridMap
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.stages.clustering import Clustering, clustering
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.situation import Situation

# The published partition of Table 1, and the inertia known for it and for the best partition.
PUBLISHED = [[0, 1, 5, 6, 8], [4], [2, 3], [7, 9]]
PUBLISHED_INERTIA = 84.3
BEST_INERTIA = 77.0


def mission(
    rows: Sequence[str],
    victims: Sequence[Cell],
    *,
    n_robots: int = 1,
    clusters: Sequence[int] | None = None,
) -> Instance:
    grid = grid_from_rows(rows)
    start = min((int(row), int(col)) for row, col in np.argwhere(grid.free))
    return Instance(
        map=grid,
        capabilities=(),
        service_time={},
        robots=tuple(Robot(id=i, start=start, speed=1.0, capabilities=()) for i in range(n_robots)),
        victims=tuple(Victim(id=i, cell=cell, requirements=()) for i, cell in enumerate(victims)),
        clusters=None if clusters is None else tuple(clusters),
    )


def clusters_of(instance: Instance, **options: Any) -> Clustering:
    return clustering(Situation.of(instance), StagedOptions.of(**options))


def inertia_of(instance: Instance, clusters: Clustering) -> float:
    return clusters.inertia(np.array(instance.cells, dtype=float))


# How many


@pytest.mark.parametrize(
    ("n_robots", "victims", "k"),
    [
        (1, [(0, 0), (0, 4)], 1),
        (2, [(0, 0), (0, 2), (0, 4)], 2),
        (5, [(0, 0), (0, 2), (0, 4)], 3),
        (5, [(0, 0), (0, 2), (0, 0), (0, 2)], 2),
        (3, [(0, 1), (0, 1)], 1),
    ],
)
def test_there_are_as_many_clusters_as_robots_but_no_more_than_distinct_victim_cells(
    n_robots: int, victims: list[Cell], k: int
) -> None:
    clusters = clusters_of(mission(["....."], victims, n_robots=n_robots))
    assert clusters.n_clusters == len(clusters.cells) == len(clusters.centres) == k
    assert sorted(set(clusters.labels.tolist())) == list(range(k))
    assert sorted(v for c in range(k) for v in clusters.members(c)) == list(range(len(victims)))


def test_without_victims_there_are_no_clusters() -> None:
    clusters = clusters_of(mission(["..."], []))
    assert (clusters.n_clusters, clusters.labels.shape, clusters.centres.shape) == (0, (0,), (0, 2))


def test_victims_in_one_cell_share_a_cluster() -> None:
    victims = [(0, 0), (0, 4), (0, 0), (0, 4)]
    labels = clusters_of(mission(["....."], victims, n_robots=4)).labels
    assert labels[0] == labels[2] != labels[1] == labels[3]


# Pinned clusters


def test_the_published_clusters_are_used_as_pinned(paper: Instance) -> None:
    clusters = clusters_of(paper)
    assert clusters.pinned
    assert [clusters.members(c) for c in range(clusters.n_clusters)] == PUBLISHED
    assert inertia_of(paper, clusters) == pytest.approx(PUBLISHED_INERTIA)


def test_centres_are_the_mean_locations_of_the_members(paper: Instance) -> None:
    # C0: rows 16 + 15 + 14 + 14 + 10 = 69 and columns 7 + 12 + 14 + 12 + 15 = 60, over 5.
    expected = [(13.8, 12), (0, 1), (8.5, 4.5), (1.5, 14)]
    assert clusters_of(paper).centres == pytest.approx(np.array(expected))


def test_a_centre_of_the_papers_mission_stands_on_the_nearest_free_cell(paper: Instance) -> None:
    # (13.8, 12) is nearest to (14, 12); of the cells around (8.5, 4.5), row 8 is a wall and (9, 4)
    # comes before (9, 5); (1.5, 14) lies between (1, 14) and (2, 14).
    assert clusters_of(paper).cells == [(14, 12), (0, 1), (9, 4), (1, 14)]


def test_pinned_clusters_are_ignored_when_told_so() -> None:
    # Pinned crosswise, each cluster has one victim at either end of the corridor.
    ends = [(0, 0), (0, 1), (0, 8), (0, 9)]
    instance = mission(["." * 10], ends, n_robots=2, clusters=[0, 1, 0, 1])
    clusters = clusters_of(instance, pinned_clusters=False)
    assert not clusters.pinned
    assert sorted(clusters.members(c) for c in (0, 1)) == [[0, 1], [2, 3]]
    pinned = clusters_of(instance, pinned_clusters=True)
    assert pinned.pinned
    assert [pinned.members(c) for c in (0, 1)] == [[0, 2], [1, 3]]


def test_an_instance_without_pinned_clusters_is_clustered_by_location() -> None:
    victims = [(0, 0), (0, 8), (0, 1), (0, 9)]
    clusters = clusters_of(mission(["." * 10], victims, n_robots=2))
    assert not clusters.pinned
    assert sorted(clusters.members(c) for c in (0, 1)) == [[0, 2], [1, 3]]


def test_there_may_be_more_pinned_clusters_than_robots() -> None:
    instance = mission(["....."], [(0, 0), (0, 2), (0, 4)], n_robots=1, clusters=[0, 1, 2])
    assert clusters_of(instance).n_clusters == 3


def test_a_pinned_cluster_of_which_nobody_is_known_is_left_out() -> None:
    known = mission(["....."], [(0, 0), (0, 2), (0, 4)], clusters=[0, 1, 2]).with_victims([0, 2])
    clusters = clusters_of(known)
    assert clusters.labels.tolist() == [0, 1]
    assert clusters.cells == [(0, 0), (0, 4)]


# K-means


def partitions(n_points: int, k: int) -> Iterator[list[int]]:
    """All ways to label points so that k labels occur and first occur in order."""

    def extend(labels: list[int], used: int) -> Iterator[list[int]]:
        if len(labels) == n_points:
            if used == k:
                yield labels
            return
        for label in range(min(used + 1, k)):
            yield from extend([*labels, label], max(used, label + 1))

    return extend([], 0)


def test_no_partition_of_the_papers_mission_is_better_than_the_best_known(
    paper: Instance,
) -> None:
    # Every partition of the ten victims into four clusters, by its definition: the sum of squares
    # less the squared sums over the counts.
    locations = np.array(paper.cells, dtype=float)
    labels = np.array(list(partitions(10, 4)))
    assert len(labels) == 34105  # a Stirling number of the second kind
    members = np.eye(4)[labels]
    sums = np.einsum("pvc,vd->pcd", members, locations)
    inertia = (locations**2).sum() - (sums**2 / members.sum(axis=1)[:, :, None]).sum(axis=(1, 2))
    assert inertia.min() == pytest.approx(BEST_INERTIA)


@pytest.mark.parametrize("seed", range(5))
def test_k_means_finds_the_best_partition_of_the_papers_mission(paper: Instance, seed: int) -> None:
    found = clusters_of(paper, pinned_clusters=False, seed=seed)
    assert inertia_of(paper, found) == pytest.approx(BEST_INERTIA)


@pytest.mark.parametrize("seed", [0, 1, 2**32 - 1])
def test_the_same_seed_gives_the_same_clusters(seed: int) -> None:
    instance = generate_mission(grid_from_rows(["." * 20] * 20), 6, 60, seed=5, solvable=False)
    first, second = (clusters_of(instance, seed=seed) for _ in range(2))
    assert first.labels.tolist() == second.labels.tolist()
    assert first.cells == second.cells


def test_another_seed_may_give_other_clusters() -> None:
    # Nine victims on a lattice: two clusters cut it in rows or in columns, both as good.
    lattice = [(row, col) for row in (0, 2, 4) for col in (0, 2, 4)]
    instance = mission(["....."] * 5, lattice, n_robots=2)
    found = set()
    for seed in range(10):
        clusters = clusters_of(instance, seed=seed)
        found.add(frozenset(tuple(clusters.members(c)) for c in (0, 1)))
    assert len(found) > 1


def test_k_means_leaves_no_victim_nearer_to_another_centre() -> None:
    instance = generate_mission(grid_from_rows(["." * 20] * 20), 5, 40, seed=3, solvable=False)
    clusters = clusters_of(instance)
    for (row, col), label in zip(instance.cells, clusters.labels, strict=True):
        away = [(row - r) ** 2 + (col - c) ** 2 for r, c in clusters.centres]
        assert away[label] == pytest.approx(min(away))


# The cell that stands for a centre


def centre_cell(rows: Sequence[str], victims: Sequence[Cell]) -> Cell:
    """The cell that stands for the centre of one cluster of all victims."""
    return clusters_of(mission(rows, victims, clusters=[0] * len(victims))).cells[0]


@pytest.mark.parametrize(
    ("rows", "victims", "cell"),
    [
        pytest.param(["..."] * 3, [(0, 0), (2, 2)], (1, 1), id="the mean is a free cell"),
        pytest.param(["..."] * 3, [(0, 0), (0, 0), (2, 2)], (1, 1), id="the nearest to (2/3, 2/3)"),
        pytest.param([".."] * 2, [(0, 1), (1, 0)], (0, 0), id="four are as near: smallest row"),
        pytest.param(["@.", ".."], [(0, 1), (1, 0)], (0, 1), id="row goes before column"),
        pytest.param([".....", "..@..", "....."], [(1, 0), (1, 4)], (0, 2), id="mean in a wall"),
        pytest.param(["..@.."], [(0, 0), (0, 4)], (0, 1), id="mean in a wall between rooms"),
        pytest.param(
            # The mean (2, 3) is free but shut off; (0, 3) and (4, 3) are 2 away, (2, 0) is 3 away.
            [".......", ".@@@@@.", ".@...@.", ".@@@@@.", "......."],
            [(2, 0), (2, 6)],
            (0, 3),
            id="mean in a walled-off pocket",
        ),
        pytest.param(
            # The nearest cell, (0, 2), is shut off; the members are in two rooms: either will do.
            [".@.@.", ".@@@."],
            [(0, 0), (0, 4)],
            (0, 0),
            id="a pocket between two rooms, each with a member",
        ),
        pytest.param(["@@@", "@.@", "@@@"], [(1, 1)], (1, 1), id="one victim, itself walled in"),
    ],
)
def test_a_centre_stands_on_the_nearest_free_cell_from_which_a_member_can_be_reached(
    rows: list[str], victims: list[Cell], cell: Cell
) -> None:
    assert centre_cell(rows, victims) == cell


def test_cells_as_near_to_a_mean_of_thirds_go_by_row_all_the_same() -> None:
    # The mean is (5/3, 2/3), and (2, 1) is a wall. (1, 1) is (2/3)² + (1/3)² away and (2, 0) is
    # (1/3)² + (2/3)² away: equal, whatever rounding makes of thirds.
    assert centre_cell(["...", "...", ".@."], [(1, 0), (2, 0), (2, 2)]) == (1, 1)


GRIDS = (
    st.lists(st.lists(st.sampled_from("..@"), min_size=6, max_size=6), min_size=1, max_size=6)
    .map(lambda rows: np.array(rows) == ".")
    .filter(np.any)
    .map(GridMap)
)


@given(grid=GRIDS, n_victims=st.integers(1, 7), seed=st.integers(0, 999))
def test_the_centre_cell_of_a_random_cluster_is_the_nearest_in_exact_arithmetic(
    grid: GridMap, n_victims: int, seed: int
) -> None:
    victims = generate_mission(grid, 1, n_victims, seed=seed, solvable=False).cells
    row, col = (Fraction(sum(axis), n_victims) for axis in zip(*victims, strict=True))

    def key(cell: Cell) -> tuple[Fraction, Cell]:
        return (cell[0] - row) ** 2 + (cell[1] - col) ** 2, cell

    near = {cell for victim in victims for cell in nx.node_connected_component(grid.graph, victim)}
    assert centre_cell(grid.rows, victims) == min(near, key=key)
