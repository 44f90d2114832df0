r"""Connectivity cuts: what keeps a robot's edges from closing on themselves, and how to find them.

With ``y`` for visits, ``e`` for edges, ``f`` and ``l`` for first and last victims of one robot, and
``e(S)`` the edges with both ends in S, for every set S of victims:

- *subtour*: ``e(S) ≤ y(S) - y[v]`` for v in S. Equivalent, by the degree rows, to: at least
  ``2 y[v]`` edges and ends of the route leave S;
- the same, written on the victims S *outside* such a set, for v not in S:
  ``e(S) + f(S) + l(S) ≤ y(S) - y[v] + sum f``, sparser where the set is large;
- *path*: ``e(S) + f(S) ≤ y(S)``, and ``e(S) + l(S) ≤ y(S)``: the subtour cut of S with the start
  (or the end) of the route, which is visited whenever the route has a first (last) victim. Open
  routes need these, since a fractional start may otherwise have nothing to do with the end.

The most violated subtour cut for v is a minimum cut between v and both ends of the route; the most
violated path cut one between the two ends. Victims are taken by falling y: once v's minimum cut is
known, v may be contracted into the ends, for every set with v in it has been looked at and no later
vertex asks for more. So few and ever smaller flows suffice for an exact separation.

Source: generalised subtour elimination, Fischetti, Salazar González and Toth, Operations Research 45
(1997), section 3; the contraction as in Padberg and Rinaldi, Mathematical Programming 47 (1990).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, maximum_flow

from ..formulation import Bools, Floats, Ints

_SCALE = 1e7
"""Flows are computed on integers; 32 bits hold all edges of a vertex at this scale."""


@dataclass(frozen=True)
class Cut:
    """``e(S) + [first] f(S) + [last] l(S) - y(S) + y[vertex] - [first and last] sum f ≤ 0``."""

    robot: int
    members: tuple[int, ...]
    """The victims S, in order."""
    first: bool = False
    last: bool = False
    vertex: int | None = None


@dataclass(frozen=True, eq=False)
class Support:
    """A point of one robot's variables, by victims; zero where the robot cannot go."""

    robot: int
    visit: Floats
    """y, ``(n_victims,)``."""
    first: Floats
    """f, ``(n_victims,)``."""
    last: Floats
    """l, ``(n_victims,)``."""
    tail: Ints
    """One end of each edge in use, ``(n_edges,)``."""
    head: Ints
    """The other end."""
    weight: Floats
    """e of each edge in use."""

    def violation(self, cut: Cut) -> float:
        """By how much the point violates `cut`; at most 0 if it does not."""
        inside = np.zeros(len(self.visit), dtype=bool)
        inside[list(cut.members)] = True
        left = float(self.weight[inside[self.tail] & inside[self.head]].sum())
        left -= float(self.visit[inside].sum())
        left += float(self.first[inside].sum()) if cut.first else 0.0
        left += float(self.last[inside].sum()) if cut.last else 0.0
        left += 0.0 if cut.vertex is None else float(self.visit[cut.vertex])
        return left - (float(self.first.sum()) if cut.first and cut.last else 0.0)


def separate(support: Support, *, tolerance: float = 1e-6) -> list[Cut]:
    """Cuts that the point violates by more than `tolerance`; one at least if there is one.

    The point must satisfy the degree rows. Cheap cuts first (single victims and components of the
    support graph); flows only where those find nothing.
    """
    found = {
        cut: violation
        for cut in [*_singles(support, tolerance), *_components(support)]
        if (violation := support.violation(cut)) > tolerance
    }
    if not found:
        cuts = [*_path_cuts(support), *_subtours(support, tolerance)]
        found = {cut: v for cut in cuts if (v := support.violation(cut)) > tolerance}
    return sorted(found, key=lambda cut: -found[cut])


def _singles(support: Support, tolerance: float) -> list[Cut]:
    """``f[v] ≤ y[v]``, ``l[v] ≤ y[v]``, ``e ≤ y`` at either end, and ``y[v] ≤ sum f``."""
    y, robot = support.visit, support.robot
    cuts = [
        Cut(robot, (int(v),), first=True) for v in np.flatnonzero(support.first > y + tolerance)
    ]
    cuts += [Cut(robot, (int(v),), last=True) for v in np.flatnonzero(support.last > y + tolerance)]
    started = float(support.first.sum())
    cuts += [
        Cut(robot, (), first=True, last=True, vertex=int(v))
        for v in np.flatnonzero(y > started + tolerance)
    ]
    over = support.weight - np.minimum(y[support.tail], y[support.head])
    for n in np.flatnonzero(over > tolerance):
        i, j = sorted((int(support.tail[n]), int(support.head[n])))
        cuts.append(Cut(robot, (i, j), vertex=i if y[i] >= y[j] else j))
    return cuts


def _components(support: Support) -> list[Cut]:
    """Cuts from components of the support graph, at a few thresholds of edge weight."""
    n = len(support.visit)
    cuts: list[Cut] = []
    for threshold in (1e-9, 0.3, 0.6):
        strong = support.weight > threshold
        graph = coo_array(
            (np.ones(int(strong.sum())), (support.tail[strong], support.head[strong])), shape=(n, n)
        )
        _, label = connected_components(graph, directed=False)
        for component in np.flatnonzero(np.bincount(label) > 1):
            cuts.extend(_around(support, label == component))
    return cuts


def _around(support: Support, inside: Bools) -> list[Cut]:
    """The subtour cut of a set, in its sparser form, and the two path cuts."""
    seen = support.visit > 1e-9
    inside = inside & seen
    members = tuple(np.flatnonzero(inside).tolist())
    if not members:
        return []
    robot = support.robot
    vertex = int(np.argmax(np.where(inside, support.visit, -1.0)))
    outside = tuple(np.flatnonzero(seen & ~inside).tolist())
    if len(members) <= len(outside) + 2:
        subtour = Cut(robot, members, vertex=vertex)
    else:
        subtour = Cut(robot, outside, first=True, last=True, vertex=vertex)
    return [subtour, Cut(robot, members, first=True), Cut(robot, members, last=True)]


def _path_cuts(support: Support) -> list[Cut]:
    """The most violated path cut, on the smaller of its two sides."""
    n = len(support.visit)
    own = np.arange(n)
    start, end = np.full(n, n), np.full(n, n + 1)
    tail = np.concatenate([support.tail, start, own])
    head = np.concatenate([support.head, own, end])
    weight = np.concatenate([support.weight, support.first, support.last])
    near, far = _sides(tail, head, weight, n + 2, n, n + 1)
    seen = support.visit > 1e-9
    return [
        Cut(support.robot, tuple(np.flatnonzero(side[:n] & seen).tolist()), **ends)
        for side, ends in (
            (near, {"first": True}),
            (far, {"last": True}),
        )
    ]


def _subtours(support: Support, tolerance: float) -> list[Cut]:
    """The most violated subtour cut of each vertex, by falling y, contracting as it goes."""
    n = len(support.visit)
    ends = n
    place = np.arange(n + 1)
    tail = np.concatenate([support.tail, np.arange(n)])
    head = np.concatenate([support.head, np.full(n, ends)])
    weight = np.concatenate([support.weight, support.first + support.last])
    cuts: list[Cut] = []
    for v in np.argsort(-support.visit, kind="stable"):
        if support.visit[v] <= tolerance:
            break
        a, b = place[tail], place[head]
        left = (a != b) & (weight > 1e-12)
        a, b, w = a[left], b[left], weight[left]
        at_v = (a == v) | (b == v)
        beside = np.where(a[at_v] == v, b[at_v], a[at_v])
        if not (beside == ends).all():
            near, _ = _sides(a, b, w, n + 1, int(v), ends)
            cuts.append(_around(support, near[:n])[0])
        place[v] = ends
    return cuts


def _sides(
    tail: Ints, head: Ints, weight: Floats, n: int, source: int, sink: int
) -> tuple[Bools, Bools]:
    """Vertices on the source's side of the first, and on the sink's of the last minimum cut."""
    scaled = np.round(weight * _SCALE).astype(np.int32)
    both = (
        np.concatenate([scaled, scaled]),
        (np.concatenate([tail, head]), np.concatenate([head, tail])),
    )
    capacity = csr_array(coo_array(both, shape=(n, n)))
    flow = maximum_flow(capacity, source, sink).flow
    rest = csr_array(capacity - flow)
    rest.data[rest.data < 0] = 0
    rest.eliminate_zeros()
    near, far = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    near[breadth_first_order(rest, source, return_predecessors=False)] = True
    far[breadth_first_order(csr_array(rest.T), sink, return_predecessors=False)] = True
    return near, far
