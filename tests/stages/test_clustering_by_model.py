"""Clustering by a formulation in the place of K-means, alone and in the planner."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from msmrta_opt import plan
from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.grid import Cell
from msmrta_opt.mission.instance import Instance, Robot, Victim
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.stages.clustering import clustering, clustering_data
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.situation import Situation

P_MEDIAN = StagedOptions(clustering_model="clustering_pmedian")


def mission(
    rows: Sequence[str],
    victims: Sequence[Cell],
    *,
    n_robots: int,
    start: Cell = (0, 0),
    **more: Any,
) -> Instance:
    return Instance(
        map=grid_from_rows(rows),
        capabilities=("A",),
        service_time={"A": 1.0},
        robots=tuple(
            Robot(id=r, start=start, speed=1.0, capabilities=("A",)) for r in range(n_robots)
        ),
        victims=tuple(
            Victim(id=v, cell=cell, requirements=("A",)) for v, cell in enumerate(victims)
        ),
        **more,
    )


# Victims 0 and 1 are 2 cells apart through the wall, but 10 on foot; 0 and 2 are 4 apart.
AROUND_A_WALL = mission([".....", "@@@@.", "....."], [(0, 0), (2, 0), (0, 4)], n_robots=2)


def test_k_means_groups_victims_through_a_wall_and_the_p_median_does_not() -> None:
    situation = Situation.of(AROUND_A_WALL)
    by_means = clustering(situation, StagedOptions()).labels
    assert by_means[0] == by_means[1] != by_means[2]
    by_medians = clustering(situation, P_MEDIAN)
    assert by_medians.labels[0] == by_medians.labels[2] != by_medians.labels[1]
    assert by_medians.solution is not None
    assert by_medians.solution.objective == pytest.approx(4)


def test_a_median_stands_for_its_cluster_and_the_mean_is_reported() -> None:
    # Least walks are from (0, 1): 1 + 3; the mean of the columns is 5/3.
    line = mission(["....."], [(0, 0), (0, 1), (0, 4)], n_robots=1)
    clusters = clustering(Situation.of(line), P_MEDIAN)
    assert clusters.cells == [(0, 1)]
    assert clusters.centres == pytest.approx(np.array([[0, 5 / 3]]))
    assert not clusters.pinned


def test_victims_on_one_cell_are_one_point_that_counts_as_many() -> None:
    data = clustering_data(
        Situation.of(mission(["....."], [(0, 4), (0, 0), (0, 4), (0, 4)], n_robots=3))
    )
    assert data.distance.tolist() == [[0, 4], [4, 0]]
    assert data.weight.tolist() == [1, 3]
    assert data.n_clusters == 2


def test_victims_on_one_cell_are_in_one_cluster() -> None:
    crowd = mission(["....."], [(0, 4), (0, 0), (0, 4)], n_robots=2)
    labels = clustering(Situation.of(crowd), P_MEDIAN).labels
    assert labels[0] == labels[2] != labels[1]


def test_parts_of_the_map_without_a_walk_between_them_have_a_cluster_each() -> None:
    rooms = mission([".@.@."], [(0, 0), (0, 2), (0, 4)], n_robots=1)
    data = clustering_data(Situation.of(rooms))
    assert data.n_clusters == 3
    assert data.can_reach.tolist() == np.eye(3, dtype=bool).tolist()
    clusters = clustering(Situation.of(rooms), P_MEDIAN)
    assert clusters.cells == [(0, 0), (0, 2), (0, 4)]
    assert plan(rooms, clustering_model="clustering_pmedian").metrics.n_served == 1


def test_pinned_clusters_win_unless_they_are_not_wanted() -> None:
    pinned = AROUND_A_WALL.replace(clusters=(0, 0, 1))
    kept = clustering(Situation.of(pinned), P_MEDIAN)
    assert kept.pinned
    assert kept.solution is None
    assert kept.labels.tolist() == [0, 0, 1]
    options = StagedOptions(clustering_model="clustering_pmedian", pinned_clusters=False)
    chosen = clustering(Situation.of(pinned), options)
    assert not chosen.pinned
    assert chosen.labels[0] == chosen.labels[2] != chosen.labels[1]


def test_a_plan_carries_the_certificate_of_its_clustering() -> None:
    made = plan(AROUND_A_WALL, clustering_model="clustering_pmedian")
    (certificate,) = [item for item in made.certificates if item.stage == "Clustering"]
    assert certificate.model == "clustering_pmedian"
    assert (certificate.status, certificate.check) == ("optimal", "passed")
    assert certificate.objective == certificate.bound == pytest.approx(4)
    assert made.metrics.n_served == 3


def test_a_plan_by_k_means_has_no_certificate_of_its_clustering() -> None:
    assert all(item.stage != "Clustering" for item in plan(AROUND_A_WALL).certificates)


def test_the_papers_mission_can_be_clustered_by_walks(paper: Instance) -> None:
    made = plan(paper, clustering_model="clustering_pmedian", pinned_clusters=False)
    assert made.metrics.served_share == 1
    assert len(made.clusters) == 4
    for cluster in made.clusters:
        members = {victim.cell for victim in paper.victims if victim.id in cluster.victims}
        assert cluster.cell in members


def test_a_model_of_another_stage_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="is a victim formulation, not a clustering one"):
        plan(AROUND_A_WALL, clustering_model="victim_printed")


def test_a_mission_without_victims_has_no_clusters() -> None:
    empty = mission(["..."], [], n_robots=1)
    assert clustering(Situation.of(empty), P_MEDIAN).n_clusters == 0
