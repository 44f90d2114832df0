"""Connectivity cuts: found exactly when there are any, and never against real routes."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from numpy.random import Generator

from msmrta_opt.routing.branch_and_cut.separation import Cut, Support, separate

N = 6


def _walk(rng: Generator, *, connected: bool) -> tuple[np.ndarray, ...]:
    """An integral point of the degree rows: a path, and perhaps closed tours beside it."""
    order = rng.permutation(N)
    length = int(rng.integers(1, N + 1))
    path, rest = order[:length], order[length:]
    visit, first, last, edges = np.zeros(N), np.zeros(N), np.zeros(N), np.zeros((N, N))
    visit[path], first[path[0]], last[path[-1]] = 1.0, 1.0, 1.0
    for i, j in pairwise(path):
        edges[min(i, j), max(i, j)] += 1.0
    if not connected and len(rest) > 2:
        visit[rest] = 1.0
        for i, j in zip(rest, np.roll(rest, 1), strict=True):
            edges[min(i, j), max(i, j)] += 1.0
    return visit, first, last, edges


def _support(visit: np.ndarray, first: np.ndarray, last: np.ndarray, edges: np.ndarray) -> Support:
    tail, head = np.nonzero(edges)
    return Support(0, visit, first, last, tail, head, edges[tail, head])


def _mixture(seed: int, *, twisted: bool) -> Support:
    """A point between several such; twisted: with the ends of one and the start of another."""
    rng = np.random.default_rng(seed)
    parts = [_walk(rng, connected=rng.random() < 0.6) for _ in range(int(rng.integers(1, 5)))]
    weights = rng.dirichlet(np.ones(len(parts)))
    point = [sum(w * part[n] for w, part in zip(weights, parts, strict=True)) for n in range(4)]
    if twisted:
        # Half starts at one victim, half ends at another, with nothing between: degrees hold.
        a, b = rng.choice(N, 2, replace=False)
        point = [p / 2 for p in point]
        point[0][[a, b]] += 0.25
        point[1][a] += 0.5
        point[2][b] += 0.5
    return _support(*point)


def _worst(support: Support) -> float:
    """The greatest violation of any subtour or path cut, over all sets of victims."""
    dense = np.zeros((N, N))
    dense[support.tail, support.head] = support.weight
    worst = -np.inf
    for size in range(1, N + 1):
        for members in combinations(range(N), size):
            inside = dense[np.ix_(members, members)].sum()
            y = support.visit[list(members)]
            worst = max(worst, inside - y.sum() + y.max())
            for ends in (support.first, support.last):
                worst = max(worst, inside + ends[list(members)].sum() - y.sum())
    return worst


@pytest.mark.parametrize("twisted", [False, True])
def test_cuts_are_found_exactly_when_some_set_of_victims_violates_one(twisted: bool) -> None:
    violated = 0
    for seed in range(100):
        support = _mixture(seed, twisted=twisted)
        worst = _worst(support)
        found = separate(support, tolerance=1e-4)
        assert bool(found) == (worst > 1e-4), (seed, worst, found)
        assert all(1e-4 < support.violation(cut) <= worst + 1e-9 for cut in found), seed
        violated += bool(found)
    assert violated > 20


def test_no_cut_excludes_any_route() -> None:
    rng = np.random.default_rng(0)
    routes = [_support(*_walk(rng, connected=True)) for _ in range(300)]
    cuts = {
        cut
        for seed in range(100)
        for t in (False, True)
        for cut in separate(_mixture(seed, twisted=t))
    }
    assert len(cuts) > 40
    assert {(cut.first, cut.last) for cut in cuts} == {
        (False, False),
        (True, False),
        (False, True),
        (True, True),
    }
    for cut in cuts:
        assert max(route.violation(cut) for route in routes) <= 1e-9, cut


def test_a_subtour_cut_and_its_form_on_the_victims_outside_are_violated_alike() -> None:
    for seed in range(50):
        support = _mixture(seed, twisted=seed % 2 == 0)
        for members in combinations(range(N), 3):
            outside = tuple(v for v in range(N) if v not in members)
            inner = Cut(0, members, vertex=members[0])
            outer = Cut(0, outside, first=True, last=True, vertex=members[0])
            assert support.violation(inner) == pytest.approx(support.violation(outer), abs=1e-9)


def test_a_triangle_beside_the_route_is_cut_off() -> None:
    visit, ends = np.array([1.0, 1.0, 1.0, 1.0]), np.array([0.0, 0.0, 0.0, 1.0])
    triangle = Support(0, visit, ends, ends, np.array([0, 0, 1]), np.array([1, 2, 2]), np.ones(3))
    # Three edges on three victims, where two are allowed.
    assert max(triangle.violation(cut) for cut in separate(triangle)) == pytest.approx(1.0)


def test_a_start_that_has_nothing_to_do_with_the_end_is_cut_off_by_a_path_cut_only() -> None:
    half = np.array([0.5, 0.5])
    point = Support(
        0,
        half,
        np.array([1.0, 0.0]),
        np.array([0.0, 1.0]),
        np.empty(0, np.int64),
        np.empty(0, np.int64),
        np.empty(0),
    )
    assert point.violation(Cut(0, (0,), vertex=0)) <= 0
    assert point.violation(Cut(0, (0, 1), vertex=0)) <= 0
    found = separate(point)
    assert found
    assert all(cut.first != cut.last for cut in found)


def test_a_single_route_has_no_cuts() -> None:
    one = np.array([1.0])
    none = np.empty(0, np.int64)
    assert separate(Support(0, one, one, one, none, none, np.empty(0))) == []
