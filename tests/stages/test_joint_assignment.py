"""The data of Eqs. 1 and 2 as one program: it must say of the staged posts what the stages say."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.instance import Instance
from msmrta_opt.mission.maps import grid_from_rows, read_map
from msmrta_opt.optimise.data import JointAssignmentData, VictimData
from msmrta_opt.optimise.solve import solve
from msmrta_opt.stages.cluster_assignment import ClusterAssignment, cluster_assignment
from msmrta_opt.stages.clustering import clustering
from msmrta_opt.stages.joint_assignment import joint_assignment_data
from msmrta_opt.stages.options import StagedOptions
from msmrta_opt.stages.performance_analysis import performance_analysis
from msmrta_opt.stages.requirement_analysis import requirement_analysis
from msmrta_opt.stages.situation import Situation, without

SPLIT = ["......@...", ".@@@..@.@.", "......@...", "..@.......", "@@@@@@@@@@", "....@....."]
"""A wall with one way around it, and two rooms that are shut off."""


@dataclass(frozen=True)
class Staged:
    """The stages' own answer, and the data of both ways."""

    b2: ClusterAssignment
    times: VictimData
    joint: JointAssignmentData


def staged(instance: Instance, **changes: Any) -> Staged:
    options = StagedOptions(**changes)
    situation = Situation.of(instance)
    analysis = requirement_analysis(instance.P, instance.Q)
    clusters = clustering(situation, options)
    b2 = cluster_assignment(situation, analysis, clusters, options)
    remaining = without(situation.available, b2.stops)
    return Staged(
        b2,
        performance_analysis(situation, b2.stops, remaining, options),
        joint_assignment_data(situation, analysis, clusters, options),
    )


def at_staged_posts(case: Staged) -> VictimData:
    """The data of Eq. 2 that the joint data hold for the posts that the stages chose."""
    data, (n_robots, n_clusters) = case.joint, case.b2.chosen.shape
    posts = [
        next((c for c in range(n_clusters) if case.b2.chosen[r, c]), n_clusters)
        for r in range(n_robots)
    ]
    holders = [
        next((r for r in range(n_robots) if case.b2.chosen[r, c]), n_robots) for c in data.cluster
    ]
    shape = n_robots, len(data.cluster)
    success, failure, can_serve = np.zeros(shape), np.zeros(shape), np.zeros(shape, dtype=bool)
    for r, v in product(*map(range, shape)):
        c, h = posts[r], holders[v]
        can_serve[r, v] = data.can_serve[r, h, v]
        if can_serve[r, v]:
            success[r, v] = data.arrival[r, c, v] + data.service[r, h, v]
            failure[r, v] = data.record[r, c] + data.redo[r, h, v]
    return VictimData(
        success, failure, can_serve, case.times.busy, case.times.budget, case.times.endurance
    )


def missions(instances_dir: Path) -> list[tuple[Instance, dict[str, Any]]]:
    """Random missions with walls and shut-off rooms, by every reading that the joint data know."""
    grids = [read_map(instances_dir / "maps" / "map2.map"), grid_from_rows(SPLIT)]
    readings: list[dict[str, Any]] = [
        {},
        {"members": "partial"},
        {"weights": "authors", "through_centre": False},
        {"clustering_model": "clustering_pmedian"},  # may make more clusters than robots
    ]
    # With three robots and two victims, a robot has no post.
    cases = [((4, 16), reading) for reading in readings] + [((2, 12), {}), ((3, 2), {})]
    return [
        (generate_mission(grid, *size, seed=seed, per_victim=(2, 3), solvable=False), options)
        for seed, (grid, (size, options)) in enumerate(product(grids, cases))
    ]


def test_at_the_staged_posts_the_times_are_those_of_performance_analysis(
    instances_dir: Path,
) -> None:
    n_pairs = 0
    for instance, options in missions(instances_dir):
        case = staged(instance, **options)
        ours = at_staged_posts(case)
        assert ours.can_serve.tolist() == case.times.can_serve.tolist()
        assert ours.success == pytest.approx(case.times.success)
        assert ours.failure == pytest.approx(case.times.failure)
        n_pairs += int(ours.can_serve.sum())
    assert n_pairs > 50  # else there would be nothing to compare


@pytest.mark.parametrize(
    ("psi", "beta", "lam"), [(0.95, 0.5, 0.5), (0.5, 0.0, 0.02), (0.0, 1.0, 1.0)]
)
def test_deciding_together_is_never_worse_than_in_stages(
    psi: float, beta: float, lam: float, instances_dir: Path
) -> None:
    for instance, options in missions(instances_dir):
        case = staged(instance, psi=psi, beta=beta, **options)
        assert case.b2.solution is not None
        score = case.b2.solution.require().objective
        time = solve("victim_covering", case.times, beta=beta).require().objective
        joint = solve("joint_assignment", case.joint, psi=psi, beta=beta, lam=lam).require()
        assert score is not None
        assert time is not None
        assert joint.objective is not None
        assert joint.status == "optimal"
        assert joint.objective <= lam * time - (1 - lam) * score + 1e-6


def test_without_weight_on_times_the_posts_are_those_of_eq_1(instances_dir: Path) -> None:
    for instance, options in missions(instances_dir):
        case = staged(instance, psi=0.5, **options)
        assert case.b2.solution is not None
        joint = solve("joint_assignment", case.joint, psi=0.5, lam=0)
        assert joint.values["score"] == pytest.approx(case.b2.solution.objective)


def test_times_per_robot_alone_are_refused(instances_dir: Path) -> None:
    instance, _ = missions(instances_dir)[0]
    with pytest.raises(InputError, match="give 'pair'"):
        staged(instance, performance="robot")


def test_the_joint_data_of_a_mission_by_hand() -> None:
    """One robot at the left end of a line, and one cluster of two victims.

    The line is ``0 1 2 3 4``; the robot (speed 0.5, capability A) starts at 0. Victim 0 at 2 needs A
    (3) and B (5), victim 1 at 4 needs A (3). The mean is 3: both are 1 from it, victim 0 first. The
    robot walks 3 to the centre, 1 back to victim 0, serves 3, walks 2 to victim 1, serves 3: done at
    (3 + 1 + 2) / 0.5 + 6 = 18, on victim 1's cell. B is left to others of a record of 5, but nobody
    has it, so it is not available and no record.
    """
    instance = Instance.from_document(
        {
            "map": {"rows": ["....."]},
            "capabilities": ["A", "B"],
            "service_time": {"A": 3, "B": 5},
            "robots": [{"id": 0, "start": [0, 0], "speed": 0.5, "capabilities": ["A"]}],
            "victims": [
                {"id": 0, "cell": [0, 2], "requirements": ["A", "B"]},
                {"id": 1, "cell": [0, 4], "requirements": ["A"]},
            ],
        }
    )
    data = staged(instance).joint
    # From the post, then from the start.
    assert data.arrival.tolist() == [[[18 + 2 / 0.5, 18], [2 / 0.5, 4 / 0.5]]]
    assert data.record.tolist() == [[0, 0]]
    # Where the robot holds the cluster nothing is left; where nobody does, A is.
    assert data.can_serve.tolist() == [[[False, False], [True, True]]]
    assert data.service.tolist() == [[[0, 0], [3, 3]]]
    assert data.redo.tolist() == [[[0, 0], [0, 0]]]
