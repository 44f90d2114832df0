"""K-means: as good as many starts, and the same for the same seed, with numba or without."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from sklearn.cluster import KMeans
from threadpoolctl import threadpool_limits

from msmrta_opt.arrays import Floats, Ints
from msmrta_opt.stages.k_means import k_means


def inertia(locations: Floats, labels: Ints) -> float:
    return sum(
        float(((own - own.mean(axis=0)) ** 2).sum())
        for own in (locations[labels == c] for c in np.unique(labels))
    )


def cells(n: int, seed: int, side: int = 20) -> Floats:
    return np.random.RandomState(seed).randint(0, side, (n, 2)).astype(float)


@pytest.fixture(params=[True, False], ids=["numba", "without numba"])
def numba(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    if not request.param:
        monkeypatch.setitem(sys.modules, "msmrta_opt.stages.random_swap", None)
    return bool(request.param)


@pytest.mark.parametrize("n", [50, 100])
def test_no_fewer_of_the_best_partitions_of_200_starts_are_found_than_by_50_starts(n: int) -> None:
    now = by_50 = 0
    with threadpool_limits(1):
        for seed in range(6):
            locations = cells(n, seed)
            best = KMeans(10, init="random", n_init=200, random_state=1000 + seed).fit(locations)
            fifty = KMeans(10, init="random", n_init=50, random_state=seed).fit(locations)
            good = best.inertia_ * (1 + 1e-9)
            by_50 += fifty.inertia_ <= good
            now += inertia(locations, k_means(locations, 10, seed)) <= good
    assert now >= max(by_50, 3)


@pytest.mark.usefixtures("numba")
def test_the_same_seed_gives_the_same_labels() -> None:
    locations = cells(60, 1)
    np.testing.assert_array_equal(k_means(locations, 8, 5), k_means(locations, 8, 5))


@pytest.mark.usefixtures("numba")
@pytest.mark.parametrize("seed", range(5))
def test_four_groups_far_apart_are_found(seed: int) -> None:
    group = np.repeat(np.arange(4), 12)
    locations = cells(48, seed, 10) + 1000 * np.stack([group // 2, group % 2], axis=1)
    labels = k_means(locations, 4, seed)
    pairs = set(zip(group.tolist(), labels.tolist(), strict=True))
    assert (len(pairs), len({a for a, _ in pairs}), len({b for _, b in pairs})) == (4, 4, 4)


@pytest.mark.usefixtures("numba")
def test_victims_on_one_cell_are_together_where_each_cell_can_have_a_cluster() -> None:
    different = np.array([[0, 0], [0, 9], [5, 5], [9, 0]], dtype=float)
    locations = different[[0, 0, 0, 1, 2, 2, 3, 3, 3, 3]]
    labels = k_means(locations, 4, 0)
    assert inertia(locations, labels) == 0
    assert sorted(set(labels.tolist())) == [0, 1, 2, 3]


@pytest.mark.usefixtures("numba")
@pytest.mark.parametrize(("n", "k"), [(1, 1), (3, 1), (3, 3)])
def test_few_victims_make_few_clusters(n: int, k: int) -> None:
    labels = k_means(np.arange(2.0 * n).reshape(n, 2), k, 0)
    assert len(set(labels.tolist())) == k


@pytest.mark.parametrize("k", [1, 12, 33, 80])
@pytest.mark.parametrize("seed", range(3))
def test_points_are_with_the_nearest_centre_and_centres_are_the_means_of_their_points(
    k: int, seed: int
) -> None:
    centres = pytest.importorskip("msmrta_opt.stages.random_swap").centres
    points = np.random.RandomState(seed).random_sample((300, 2)) * 100
    found = centres(points, k, 40, seed)
    labels = ((points[:, None] - found) ** 2).sum(axis=2).argmin(axis=1)
    means = [points[labels == c].mean(axis=0) for c in range(k)]
    np.testing.assert_allclose(found, means, atol=1e-9)
