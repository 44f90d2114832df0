"""The check of the clusters that a plan reports."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from math import isqrt

import numpy as np

from ..arrays import Ints
from ..mission.grid import Cell
from ..mission.plan import Cluster, Plan
from .walking import StraightWalks

CLOSE = 1e-9
"""Cells by which a centre may differ from the mean."""


def problems(plan: Plan, component: Ints) -> list[str]:
    """Everything that is wrong with the clusters of `plan`, one line each.

    They part the known victims, as the mission pins them if the plan says so; their centres are the
    means of their members; the cells that stand for these are free, and a member can be reached from
    them; those members are deferred whose walk from there is longer than without walls; and the robots
    exist. The staged method's cells are the nearest such, the first by row and column, unless a
    formulation chose them.

    Parameters
    ----------
    plan : Plan
        Any planner's.
    component : int array, shape (n_rows, n_cols)
        The connected component of each cell, 0 in walls.
    """
    if not plan.clusters:
        return []
    known = {victim.id: victim.cell for victim in plan.known.victims}
    robots = {robot.id for robot in plan.instance.robots}
    wrong = _partition(plan, set(known))
    straight = StraightWalks(plan.instance.map)
    for number, cluster in enumerate(plan.clusters):
        name = f"cluster {number}"
        wrong += [
            f"{name} names robot {r}, which is not there" for r in set(cluster.robots) - robots
        ]
        if len(set(cluster.robots)) < len(cluster.robots):
            wrong.append(f"{name} names a robot twice")
        if not cluster.victims:
            wrong.append(f"{name} has no victim")
        elif set(cluster.victims) <= set(known):
            cells = {v: known[v] for v in cluster.victims}
            wrong += (
                f"{name} {problem}" for problem in _place(plan, cluster, cells, component, straight)
            )
    return wrong


def _partition(plan: Plan, known: set[int]) -> list[str]:
    count = Counter(v for cluster in plan.clusters for v in cluster.victims)
    wrong = [f"victim {v} is in a cluster, and is not known" for v in count if v not in known]
    wrong += [f"victim {v} is in {count[v]} clusters" for v in sorted(known) if count[v] != 1]
    labels = plan.instance.clusters
    if not wrong and labels is not None and plan.options.get("pinned_clusters") is True:
        pinned: dict[int, set[int]] = {}
        for victim, label in zip(plan.instance.victims, labels, strict=True):
            if victim.id in known:
                pinned.setdefault(label, set()).add(victim.id)
        wrong += [
            f"cluster {number} is none of those that the mission pins"
            for number, cluster in enumerate(plan.clusters)
            if set(cluster.victims) not in pinned.values()
        ]
    return wrong


def _place(
    plan: Plan,
    cluster: Cluster,
    cells: Mapping[int, Cell],
    component: Ints,
    straight: StraightWalks,
) -> Iterator[str]:
    """What is wrong with where a cluster is said to be, and with whom it defers."""
    mean = [sum(axis) / len(cells) for axis in zip(*cells.values(), strict=True)]
    if not all(abs(a - b) <= CLOSE for a, b in zip(cluster.centre, mean, strict=True)):
        yield f"has its centre at {list(cluster.centre)}, which should be {mean}"
    own = {int(component[cell]) for cell in cells.values()}
    stands = cluster.cell
    if stands is None or not (plan.instance.map.is_free(stands) and component[stands] in own):
        yield f"is stood for by {stands}, from which no member can be reached"
        return
    if plan.planner == "msmrta" and plan.options.get("clustering_model") is None:
        nearest = _nearest(list(cells.values()), own, component, stands)
        if stands != nearest:
            yield f"is stood for by {stands}, which should be {nearest}"
    deferred = set(cluster.deferred)
    if strange := sorted(deferred - set(cells)):
        yield f"defers victim {strange[0]}, which is no member"
    near = straight.from_cell(stands, cells.values())
    for v, cell in cells.items():
        if (v in deferred) != (cell not in near):
            said = "defers" if v in deferred else "does not defer"
            walk = "as short as without walls" if v in deferred else "longer than without walls"
            yield f"{said} victim {v}, whose walk is {walk}"


def _nearest(members: list[Cell], own: set[int], component: Ints, one: Cell) -> Cell:
    """The nearest cell to the mean of `members` from which one of them can be reached.

    It is no farther than `one` from which they can, so within a square around the mean.
    """
    n, (row, col) = len(members), map(sum, zip(*members, strict=True))
    far = isqrt((n * one[0] - row) ** 2 + (n * one[1] - col) ** 2) + 1
    first = max((row - far) // n, 0), max((col - far) // n, 0)
    square = component[first[0] : (row + far) // n + 2, first[1] : (col + far) // n + 2]
    rows, cols = np.nonzero(np.logical_or.reduce([square == number for number in own]))
    rows, cols = rows + first[0], cols + first[1]
    minimum = int(
        ((n * rows - row) ** 2 + (n * cols - col) ** 2).argmin()
    )  # row-major, so ties too
    return int(rows[minimum]), int(cols[minimum])
