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
vertex asks for more. Victims that need not be parted are merged first (`min_cut`). So few and ever
smaller flows suffice for an exact separation.

Source: generalised subtour elimination, Fischetti, Salazar González and Toth, Operations Research 45
(1997), section 3; the contraction as in Padberg and Rinaldi, Mathematical Programming 47 (1990).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Bools, Floats, Ints
from .min_cut import capacities, components, merged, sides

_TINY = 1e-9


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
    graph = _Graph.of(support)
    found = {
        cut: violation
        for cut in dict.fromkeys([*_singles(support, tolerance), *_components(graph)])
        if (violation := support.violation(cut)) > tolerance
    }
    if not found:
        cuts = [*_path_cuts(graph), *_subtours(graph, tolerance)]
        found = {cut: v for cut in cuts if (v := support.violation(cut)) > tolerance}
    return sorted(found, key=lambda cut: -found[cut])


@dataclass(frozen=True, eq=False)
class _Graph:
    """The support graph: groups of victims that no cut needs to divide, then the route's two ends."""

    support: Support
    weight: Floats
    """Of edges, ``(n_groups + 2, n_groups + 2)``, symmetric."""
    visit: Floats
    """The maximum over the victims of a group, ``(n_groups,)``."""
    group: Ints
    """Of each victim, ``(n_victims,)``; -1 where nobody goes."""

    @classmethod
    def of(cls, support: Support) -> _Graph:
        seen = np.flatnonzero(support.visit > _TINY)
        n = len(seen)
        place = np.full(len(support.visit), -1)
        place[seen] = np.arange(n)
        tail, head = place[support.tail], place[support.head]
        both = (tail >= 0) & (head >= 0)
        weight = np.zeros((n + 2, n + 2))
        weight[tail[both], head[both]] = support.weight[both]
        weight[:n, n], weight[:n, n + 1] = support.first[seen], support.last[seen]
        weight, visit, group = merged(weight + weight.T, support.visit[seen])
        place[seen] = group
        return cls(support, weight, visit, place)

    @property
    def n_groups(self) -> int:
        """Number of groups."""
        return len(self.visit)

    def victims(self, inside: Bools) -> tuple[int, ...]:
        """The victims of the groups `inside`, ``(n_groups,)``, in order."""
        # Nobody's group is -1: the last one, which is outside.
        return tuple(np.flatnonzero(np.append(inside, False)[self.group]).tolist())

    def around(self, inside: Bools) -> list[Cut]:
        """The subtour cut of some groups, in its sparser form, and the two path cuts.

        None of a single victim: `_singles` knows all of these that may be violated.
        """
        members = self.victims(inside)
        if len(members) < 2:
            return []
        robot, visit = self.support.robot, self.support.visit
        vertex = max(members, key=lambda v: (visit[v], -v))
        outside = self.victims(~inside)
        if len(members) <= len(outside) + 2:
            subtour = Cut(robot, members, vertex=vertex)
        else:
            subtour = Cut(robot, outside, first=True, last=True, vertex=vertex)
        return [subtour, Cut(robot, members, first=True), Cut(robot, members, last=True)]


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


def _components(graph: _Graph) -> list[Cut]:
    """Cuts from components of the support graph, at a few thresholds of edge weight."""
    n = graph.n_groups
    inner = graph.weight[:n, :n]
    cuts: list[Cut] = []
    for threshold in (_TINY, 0.3, 0.6):
        label = components(inner > threshold)
        for component in np.unique(label):
            cuts.extend(graph.around(label == component))
    return cuts


def _path_cuts(graph: _Graph) -> list[Cut]:
    """The most violated path cuts: on the start's smallest side, and on the end's."""
    n = graph.n_groups
    near, far = sides(capacities(graph.weight), n, n + 1)
    robot = graph.support.robot
    return [
        Cut(robot, graph.victims(near[:n]), first=True),
        Cut(robot, graph.victims(far[:n]), last=True),
    ]


def _subtours(graph: _Graph, tolerance: float) -> list[Cut]:
    """The most violated subtour cut of each group, by falling y, contracting as it goes."""
    n = graph.n_groups
    capacity = capacities(graph.weight)
    # Both ends of the route are one vertex.
    ends = n
    _contract(capacity, n + 1, ends)
    cuts: list[Cut] = []
    for v in np.argsort(-graph.visit, kind="stable"):
        if graph.visit[v] <= tolerance:
            break
        if capacity[v, :n].any():
            near, _ = sides(capacity, int(v), ends)
            cuts.extend(graph.around(near[:n])[:1])
        _contract(capacity, int(v), ends)
    return cuts


def _contract(capacity: Ints, vertex: int, into: int) -> None:
    """Make `vertex` part of another, in place."""
    capacity[into] += capacity[vertex]
    capacity[:, into] += capacity[:, vertex]
    capacity[into, into] = 0
    capacity[vertex], capacity[:, vertex] = 0, 0
