r"""Symmetry-breaking rows for search trees: they leave out solutions no better than others.

`own_visits`: a visit serves something. Walking makes that true by itself, since no detour is shorter
than the direct way; lengths that break the triangle inequality do not.

`in_order`: of solutions that differ by the names of equal robots only, or by the direction of a robot
that returns, one is enough. In an order of the victims, farthest from the start first, equal robots
go by the first victim in that order that each visits, and the first victim of a walk that returns
comes before its last. These rows hold for some optimum, not for each: a tree that is kept to some
of the columns should do without them. The root does without any.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...arrays import Ints
from ..problem import SUMS, RoutingData
from .edge_formulation import EdgeFormulation, Row


def own_visits(formulation: EdgeFormulation) -> list[Row]:
    """No more visitors than there is to be served, where a detour can be shorter."""
    data = formulation.data
    if not _detours(data):
        return []
    if not len(formulation.services):
        needed = data.required.sum(axis=1)
        return [
            (pairs, np.ones(len(pairs)), float(needed[v]))
            for v, pairs in enumerate(_present(column) for column in formulation.pair_of.T)
        ]
    a = formulation.start("a")
    rows = []
    for pair in range(formulation.n_pairs):
        served = a + np.flatnonzero(formulation.services[:, 0] == pair)
        rows.append(_at_most([pair], served))
    return rows


def in_order(formulation: EdgeFormulation) -> list[Row]:
    """One of the solutions that differ by equal robots' names or by a walk's direction only."""
    data = formulation.data
    rows = []
    for group in _equal_robots(data):
        order = np.argsort(-data.leave[group[0]], kind="stable")
        order = order[data.can_visit[group[0], order]]
        alone = data.required.sum(axis=1) == 1
        for before, after in pairwise(group):
            for place, v in enumerate(order):
                # Two robots never share a victim that needs one kind of help.
                earlier = order[:place] if alone[v] else order[: place + 1]
                rows.append(
                    _at_most([formulation.pair_of[after, v]], formulation.pair_of[before, earlier])
                )
    f, last = formulation.start("f"), formulation.start("l")
    for r in range(data.n_robots):
        own = data.can_visit[r]
        if not own.any() or not np.array_equal(data.leave[r, own], data.back[r, own]):
            continue
        order = np.argsort(-data.leave[r], kind="stable")
        pairs = formulation.pair_of[r, order[own[order]]]
        rows += [_at_most([last + p], f + pairs[: i + 1]) for i, p in enumerate(pairs)]
    return rows


def _at_most(less: list[int], more: Ints) -> Row:
    """The columns `less` come to no more than `more`."""
    weight = np.concatenate([np.ones(len(less)), -np.ones(len(more))])
    return np.concatenate([np.array(less, dtype=np.int64), more]), weight, 0.0


def _present(pairs: Ints) -> Ints:
    return np.asarray(pairs[pairs >= 0])


def _detours(data: RoutingData) -> bool:
    """Whether some robot gets somewhere sooner by way of a victim than directly."""
    for r in range(data.n_robots):
        own = np.flatnonzero(data.can_visit[r])
        between = data.ways(r, own)
        leave, back = data.leave[r, own], data.back[r, own]
        longest = max((float(x.max(initial=0.0)) for x in (between, leave, back)), default=0.0)
        # A way home from a robot's start is none: those that do not return have no way back.
        for via in range(len(own)):
            onward = np.delete(between[via], via) + SUMS * longest
            others = np.delete(np.arange(len(own)), via)
            if (
                (between[np.ix_(others, others)] > between[others, via][:, None] + onward).any()
                or (leave[others] > leave[via] + onward).any()
                or (back[others] > onward + back[via]).any()
            ):
                return True
    return False


def _equal_robots(data: RoutingData) -> list[list[int]]:
    """Robots that differ by name only, in groups of two and more."""
    groups: list[list[int]] = []
    arrays = (
        data.leave,
        data.speed,
        *([data.length] if len(data.length) > 1 else []),
        data.back,
        data.able,
        data.endurance,
        data.longest_walk,
    )
    for r in range(data.n_robots):
        for group in groups:
            if all(np.array_equal(array[group[0]], array[r]) for array in arrays):
                group.append(r)
                break
        else:
            groups.append([r])
    return [group for group in groups if len(group) > 1]
