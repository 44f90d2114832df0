"""Small data for every stage: drawn by hypothesis, or dense and random, by a seed."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from msmrta_opt.mission.generate import generate_mission
from msmrta_opt.mission.grid import DistanceTable
from msmrta_opt.mission.maps import grid_from_rows
from msmrta_opt.optimise.data import (
    ClusterData,
    ClusteringData,
    JointAssignmentData,
    Surroundings,
    VictimData,
)

shares = st.sampled_from([0.0, 0.25, 0.5, 0.95, 1.0])
quarters = st.integers(0, 40).map(lambda n: n / 4)
sides = st.integers(1, 3)


@st.composite
def table(
    draw: st.DrawFn, shape: tuple[int, ...], values: st.SearchStrategy[Any]
) -> NDArray[np.generic]:
    size = int(np.prod(shape))
    return np.array(draw(st.lists(values, min_size=size, max_size=size))).reshape(shape)


@st.composite
def clustering_cases(draw: st.DrawFn) -> ClusteringData:
    """Up to four cells in up to three parts of a map, walks of whole cells."""
    n = draw(st.integers(1, 4))
    part = draw(table((n,), st.integers(0, 2)))
    can_reach = part[:, None] == part[None, :]
    distance = np.triu(draw(table((n, n), st.integers(1, 9))), 1).astype(float)
    return ClusteringData(
        distance=np.where(can_reach, distance + distance.T, 0.0),
        can_reach=can_reach,
        weight=draw(table((n,), st.integers(1, 3))).astype(float),
        n_clusters=draw(st.integers(1, n)),
    )


@st.composite
def cluster_cases(draw: st.DrawFn) -> ClusterData:
    shape = draw(sides), draw(st.integers(1, 4))
    w = draw(table(shape, st.integers(0, 6))).astype(float)
    w_full = np.minimum(w, draw(table(shape, st.integers(0, 6))))
    return ClusterData(w, w_full, np.ones(shape[0], dtype=np.int64))


@st.composite
def victim_cases(draw: st.DrawFn) -> VictimData:
    """Up to 3 robots and 4 victims; anybody may be out of reach, out of budget or out of time."""
    shape = n_robots, _ = draw(sides), draw(st.integers(1, 4))
    can_serve = draw(table(shape, st.booleans()))
    busy = draw(table((n_robots,), quarters))
    extra = draw(table(shape, quarters))
    return VictimData(
        success=np.where(can_serve, busy[:, None] + extra, 0.0),
        failure=np.where(can_serve, draw(table(shape, quarters)), 0.0),
        can_serve=can_serve,
        busy=busy,
        budget=draw(table((n_robots,), st.integers(0, 3))),
        endurance=draw(table((n_robots,), quarters | st.sampled_from([20.0, np.inf]))),
    )


@st.composite
def joint_cases(draw: st.DrawFn) -> JointAssignmentData:
    n_robots, n_clusters, n_victims = draw(sides), draw(sides), draw(st.integers(1, 3))
    at_post, at_holder = (n_robots, n_clusters + 1), (n_robots, n_robots + 1, n_victims)
    w = draw(table((n_robots, n_clusters), st.integers(0, 6))).astype(float)
    can_serve = draw(table(at_holder, st.booleans()))
    return JointAssignmentData(
        w=w,
        w_full=np.minimum(w, draw(table(w.shape, st.integers(0, 6)))),
        cluster=draw(table((n_victims,), st.integers(0, n_clusters - 1))),
        arrival=draw(table((*at_post, n_victims), quarters)),
        record=draw(table(at_post, quarters)),
        service=np.where(can_serve, draw(table(at_holder, quarters)), 0.0),
        redo=np.where(can_serve, draw(table(at_holder, quarters)), 0.0),
        can_serve=can_serve,
    )


def along_a_corridor() -> Surroundings:
    """Three robots, two of them to keep apart, and four clusters of a victim each, on a line."""
    grid = grid_from_rows(["......."])
    return Surroundings(
        mission=generate_mission(grid, 3, 4, seed=0, solvable=False),
        distances=DistanceTable(grid),
        robots=[(0, 0), (0, 1), (0, 2)],
        centres=[(0, 3), (0, 4), (0, 5), (0, 6)],
        labels=np.arange(4),
        apart=np.array([True, True, False]),
    )


def dense_case(stage: str, seed: int) -> Any:
    """Data at the largest size that is enumerated, where nearly everything is possible."""
    random = np.random.RandomState(seed)

    def times(*shape: int) -> NDArray[np.float64]:
        return random.randint(0, 80, size=shape) / 4

    if stage == "clustering":
        walks = np.triu(random.randint(1, 20, size=(4, 4)), 1).astype(float)
        return ClusteringData(
            walks + walks.T, np.ones((4, 4), bool), random.randint(1, 4, 4).astype(float), 2
        )
    w = random.randint(0, 9, size=(3, 4)).astype(float)
    if stage == "cluster":
        full = np.minimum(w, random.randint(0, 9, size=(3, 4)))
        return ClusterData(w, full, np.full(3, 2), around=along_a_corridor())
    if stage == "victim":
        can_serve, busy = random.random_sample((3, 4)) < 0.9, times(3)
        return VictimData(
            success=np.where(can_serve, busy[:, None] + times(3, 4), 0.0),
            failure=np.where(can_serve, times(3, 4), 0.0),
            can_serve=can_serve,
            busy=busy,
            budget=np.array([1, 2, 1]),
            endurance=busy + 20,
        )
    can_serve = random.random_sample((3, 4, 4)) < 0.8
    return JointAssignmentData(
        w=w[:, :3],
        w_full=w[:, :3] // 2,
        cluster=random.randint(0, 3, 4),
        arrival=times(3, 4, 4),
        record=times(3, 4),
        service=np.where(can_serve, times(3, 4, 4), 0.0),
        redo=np.where(can_serve, times(3, 4, 4), 0.0),
        can_serve=can_serve,
    )
