"""Minimum cuts of small graphs: against all subsets, with and without merging."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator
from itertools import chain, combinations, pairwise

import numpy as np
import pytest
from numpy.random import Generator
from scipy.sparse.csgraph import connected_components
from support.amounts import sample

from msmrta_opt.routing.branch_and_cut import min_cut
from msmrta_opt.routing.branch_and_cut.min_cut import capacities, components, merged

Sides = Callable[[np.ndarray, int, int], tuple[np.ndarray, np.ndarray]]

N = 7
"""Vertices; the last two are the ends, which are never merged."""


def _graph(rng: Generator) -> np.ndarray:
    """Edges between few weights, so that many come to the same."""
    weight = rng.choice([0.0, 0.0, 0.0, 0.25, 0.5, 1.0], size=(N, N))
    weight = np.triu(weight, 1)
    return weight + weight.T


def _tours(rng: Generator) -> tuple[np.ndarray, np.ndarray]:
    """A mixture of paths between the two ends, each through some vertices; and their visits."""
    weight, visit = np.zeros((N, N)), np.zeros(N - 2)
    for share in rng.dirichlet(np.ones(int(rng.integers(1, 4)))):
        inner = rng.permutation(N - 2)[: int(rng.integers(1, N - 1))]
        path = [N - 2, *inner.tolist(), N - 1]
        for i, j in pairwise(path):
            weight[i, j] += share
            weight[j, i] += share
        visit[inner] += share
    return weight, visit


def _leaving(weight: np.ndarray, inside: tuple[int, ...]) -> float:
    outside = np.setdiff1d(np.arange(len(weight)), inside)
    return float(weight[np.ix_(list(inside), outside)].sum())


def _least_cut(weight: np.ndarray, source: int, sink: int) -> float:
    others = [v for v in range(len(weight)) if v not in (source, sink)]
    return min(_leaving(weight, (source, *some)) for some in _subsets(others))


def _subsets(vertices: list[int]) -> Iterator[tuple[int, ...]]:
    return chain.from_iterable(combinations(vertices, n) for n in range(len(vertices) + 1))


@pytest.fixture(params=["numba", "scipy"])
def sides(request: pytest.FixtureRequest) -> Sides:
    """`min_cut.sides`, with numba and without."""
    if request.param == "scipy":
        return min_cut.sides_by_scipy
    if importlib.util.find_spec("numba") is None:
        pytest.skip("numba is not installed")
    return min_cut.sides


@pytest.mark.parametrize("seed", sample(range(60), 12))
def test_both_sides_are_minimum_cuts_the_smallest_from_either_end(seed: int, sides: Sides) -> None:
    rng = np.random.default_rng(seed)
    weight = _graph(rng)
    source, sink = (int(v) for v in rng.choice(N, 2, replace=False))
    minimum = _least_cut(weight, source, sink)
    near, far = sides(capacities(weight), source, sink)
    assert near[source]
    assert far[sink]
    assert not (near & far).any()
    for side in (near, far):
        assert _leaving(weight, tuple(np.flatnonzero(side))) == pytest.approx(minimum)
    # Of all minimum cuts, these are within every other.
    for some in _subsets([v for v in range(N) if v not in (source, sink)]):
        if _leaving(weight, (source, *some)) == pytest.approx(minimum):
            assert set(np.flatnonzero(near)) <= {source, *some}
            assert not set(np.flatnonzero(far)) & {source, *some}


@pytest.mark.parametrize("seed", sample(range(60), 12))
def test_merging_keeps_the_least_cut_around_each_vertex_and_between_the_ends(seed: int) -> None:
    weight, visit = _tours(np.random.default_rng(seed))
    small, maximum, group = merged(weight, visit)
    n = len(maximum)
    assert len(small) == n + 2
    assert _least_cut(small, n, n + 1) == pytest.approx(_least_cut(weight, N - 2, N - 1))
    for v in range(N - 2):
        # The ends are one vertex here.
        before, after = _joined(weight), _joined(small)
        assert maximum[group[v]] >= visit[v]
        if maximum[group[v]] == visit[v]:
            minimum = _least_cut(after, int(group[v]), n)
            assert minimum == pytest.approx(_least_cut(before, v, N - 2))


def test_much_is_merged_where_little_is_undecided() -> None:
    sizes = [len(merged(*_tours(np.random.default_rng(seed)))[1]) for seed in range(60)]
    assert min(sizes) == 1
    assert sum(sizes) < 0.8 * 60 * (N - 2)


def _joined(weight: np.ndarray) -> np.ndarray:
    """The graph with its last two vertices as one."""
    n = len(weight) - 1
    into = np.eye(n + 1)[:n]
    into[-1, -1] = 1.0
    joined = into @ weight @ into.T
    np.fill_diagonal(joined, 0.0)
    return joined


def test_a_path_is_merged_into_one_group() -> None:
    weight = np.zeros((5, 5))
    for i, j in ((3, 0), (0, 1), (1, 2), (2, 4)):
        weight[i, j] = weight[j, i] = 1.0
    small, visit, group = merged(weight, np.ones(3))
    assert group.tolist() == [0, 0, 0]
    assert visit.tolist() == [1.0]
    assert small.tolist() == [[0, 1, 1], [1, 0, 0], [1, 0, 0]]


@pytest.mark.parametrize("seed", sample(range(30), 10))
def test_components_are_those_of_scipy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 12))
    adjacent = np.triu(rng.random((n, n)) < 0.15, 1)
    adjacent |= adjacent.T
    _, expected = connected_components(adjacent, directed=False)
    label = components(adjacent)
    assert ((label[:, None] == label) == (expected[:, None] == expected)).all()
    assert all(label[v] == min(np.flatnonzero(label == label[v])) for v in range(n))
