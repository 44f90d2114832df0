"""Minimum cuts of small undirected graphs, given as symmetric matrices of weights.

`merged` makes them smaller: where the edges between two groups of vertices come to at least the visits
of either, a set that holds one of them loses nothing by taking in the other. With δ(S) for the weight
that leaves S, and δ(W) ≤ 2 y(W) for groups W,

    δ(S ∪ W) = δ(S) + δ(W) − 2 e(S : W) ≤ δ(S) + 2 y(W) − 2 e(U : W) ≤ δ(S)    for U in S,

so some minimum cut between any two vertices divides neither group. Near a route's end hardly more is
left than what is undecided.

Source: Padberg and Rinaldi, Mathematical Programming 47 (1990); for tours that choose what they visit,
Kobeaga, Rojas-Delgado, Merino and Lozano, Annals of Operations Research (2021).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_flow

from ...arrays import Bools, Floats, Ints

_SCALE = 1e7
"""Flows are computed on integers; 32 bits hold all edges of a vertex at this scale."""
_EQUAL = 1e-7


def merged(weight: Floats, visit: Floats) -> tuple[Floats, Floats, Ints]:
    """The graph with its vertices merged.

    Parameters
    ----------
    weight : array, shape (n, n)
        Of edges; symmetric, its diagonal 0.
    visit : array, shape (m,)
        Of the first vertices, half of what leaves each; the others are never merged.

    Returns
    -------
    weight : array, shape (n_groups + n - m, n_groups + n - m)
    visit : array, shape (n_groups,)
        The maximum over the vertices of a group.
    group : int array, shape (m,)
        Of each vertex.
    """
    group = np.arange(len(visit))
    while True:
        m, others = len(visit), len(weight) - len(visit)
        tight = weight[:m, :m] >= np.maximum(visit[:, None], visit) - _EQUAL
        np.fill_diagonal(tight, False)
        if not tight.any():
            return weight, visit, group
        firsts, label = np.unique(components(tight), return_inverse=True)
        n_groups = len(firsts)
        belongs = np.zeros((n_groups + others, m + others))
        belongs[np.append(label, n_groups + np.arange(others)), np.arange(m + others)] = 1.0
        weight = belongs @ weight @ belongs.T
        np.fill_diagonal(weight, 0.0)
        visit = (belongs[:n_groups, :m] * visit).max(axis=1)
        group = label[group]


def components(adjacent: Bools) -> Ints:
    """The first vertex of each vertex's component, ``(n,)``; `adjacent` is symmetric.

    At this size SciPy takes longer to convert the graph than this does to find them.
    """
    label = np.arange(len(adjacent))
    while True:
        first = np.where(adjacent, label, len(label)).min(axis=1, initial=len(label))
        first = np.minimum(label, first)
        if (first == label).all():
            return label
        label = first[first]


def capacities(weight: Floats) -> Ints:
    """Weights as whole numbers, in which flows are computed."""
    return np.asarray(np.round(weight * _SCALE), dtype=np.int32)


def sides(capacity: Ints, source: int, sink: int) -> tuple[Bools, Bools]:
    """Vertices on the source's side of the first, and on the sink's of the last minimum cut."""
    near, far = _solver()(np.ascontiguousarray(capacity), source, sink)
    return near, far


@cache
def _solver() -> Callable[..., Iterable[Bools]]:
    """Compiled, where numba is there."""
    try:
        from .compiled_cut import sides as compiled
    except ImportError:
        return sides_by_scipy
    return compiled


def sides_by_scipy(capacity: Ints, source: int, sink: int) -> tuple[Bools, Bools]:
    """As `sides`, by SciPy."""
    tail, head = np.nonzero(capacity)
    begin = np.searchsorted(tail, np.arange(len(capacity) + 1)).astype(np.int32)
    graph = csr_array((capacity[tail, head], head.astype(np.int32), begin), shape=capacity.shape)
    flow = maximum_flow(graph, source, sink).flow.toarray()
    rest = capacity > flow
    return _reached(rest, source), _reached(rest.T, sink)


def _reached(arcs: Bools, start: int) -> Bools:
    """The vertices that arcs lead to from `start`, and it."""
    reached = np.zeros(len(arcs), dtype=bool)
    reached[start] = True
    while True:
        further = reached | arcs[reached].any(axis=0)
        if further.sum() == reached.sum():
            return reached
        reached = further
