"""Oracles for further formulations: every feasible answer, named one by one, with its worth.

Written from the mathematics in ``models/``, by enumerating choices (who goes where) rather than
tables; no modelling language, no solver, no matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations, permutations, product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from msmrta_opt.optimise.data import ClusterData, ClusteringData, JointAssignmentData, VictimData

Answers = dict[bytes, float]
"""The worth of each feasible answer, by `key`."""


def key(*tables: ArrayLike) -> bytes:
    """The name of an answer: its 0/1 tables, one after the other."""
    return b"|".join(np.asarray(table).astype(np.int8).tobytes() for table in tables)


def clustering_pmedian(data: ClusteringData) -> Answers:
    answers: Answers = {}
    for medians in combinations(range(data.n_cells), data.n_clusters):
        for chosen in product(medians, repeat=data.n_cells):
            pairs = list(enumerate(chosen))
            if all(data.can_reach[pair] for pair in pairs):
                walked = sum(data.weight[i] * data.distance[i, j] for i, j in pairs)
                y = _table(pairs, (data.n_cells, data.n_cells))
                is_median = [j in medians for j in range(data.n_cells)]
                answers[key(y, is_median)] = float(walked)
    return answers


def cluster_fair(data: ClusterData, *, psi: float) -> Answers:
    score = (1 - psi) * data.w + psi * data.w_full
    return {
        key(_table(pairs, score.shape)): float(min(score[pair] for pair in pairs))
        for pairs in _full_matchings(*score.shape)
    }


def victim_bottleneck(data: VictimData, *, beta: float) -> Answers:
    cost, maximum = _cost(data, beta), 0
    answers: dict[int, Answers] = {0: {}}
    for pairs in _choices(data):
        robots = [r for r, _ in pairs]
        if len(set(robots)) == len(robots):
            maximum = max(maximum, len(pairs))
            slowest = max((cost[pair] for pair in pairs), default=0.0)
            answers.setdefault(len(pairs), {})[key(_table(pairs, cost.shape))] = float(slowest)
    return answers[maximum]


def victim_budgeted(data: VictimData, *, beta: float) -> Answers:
    cost, maximum = _cost(data, beta), 0
    answers: dict[int, Answers] = {0: {}}
    for pairs in _choices(data):
        if all(
            sum(r == s for s, _ in pairs) <= most_of_r for r, most_of_r in enumerate(data.budget)
        ):
            maximum = max(maximum, len(pairs))
            total = sum(cost[pair] for pair in pairs)
            answers.setdefault(len(pairs), {})[key(_table(pairs, cost.shape))] = float(total)
    return answers[maximum]


def victim_generalized(data: VictimData, *, beta: float) -> Answers:
    cost = _cost(data, beta)
    n_coverable = sum(any(column) for column in data.can_serve.T)
    answers: Answers = {}
    for pairs in _choices(data):
        if len(pairs) < n_coverable:
            continue
        busy = [
            sum(data.success[r, v] - data.busy[r] for s, v in pairs if s == r)
            for r in range(len(data.busy))
        ]
        left = [max(e - b, 0.0) for e, b in zip(data.endurance, data.busy, strict=True)]
        if all(time <= maximum for time, maximum in zip(busy, left, strict=True)):
            total = sum(cost[pair] for pair in pairs)
            answers[key(_table(pairs, cost.shape))] = float(total)
    return answers


def joint_assignment(data: JointAssignmentData, *, psi: float, beta: float, lam: float) -> Answers:
    (n_robots, n_clusters), n_victims = data.w.shape, len(data.cluster)
    score = (1 - psi) * data.w + psi * data.w_full
    nobody, no_post = n_robots, n_clusters
    answers: Answers = {}
    for posts in _full_matchings(n_robots, n_clusters):
        post_of = dict(posts)
        holder_of = {c: r for r, c in posts}
        holders = [holder_of.get(int(c), nobody) for c in data.cluster]
        able = [
            [r for r in range(n_robots) if data.can_serve[r, holders[v], v]] or [None]
            for v in range(n_victims)
        ]
        for robots in product(*able):
            time = 0.0
            pairs = [(r, v) for v, r in enumerate(robots) if r is not None]
            for r, v in pairs:
                c, h = post_of.get(r, no_post), holders[v]
                time += (1 - beta) * (data.arrival[r, c, v] + data.service[r, h, v])
                time += beta * (data.record[r, c] + data.redo[r, h, v])
            worth = lam * time - (1 - lam) * sum(score[post] for post in posts)
            x, y = _table(posts, score.shape), _table(pairs, (n_robots, n_victims))
            answers[key(x, y)] = float(worth)
    return answers


ORACLES: dict[str, Callable[..., Answers]] = {
    oracle.__name__: oracle
    for oracle in (
        clustering_pmedian,
        cluster_fair,
        victim_bottleneck,
        victim_budgeted,
        victim_generalized,
        joint_assignment,
    )
}
"""By the name of the formulation, each of data and parameters."""


def _cost(data: VictimData, beta: float) -> NDArray[np.float64]:
    return (1 - beta) * data.success + beta * data.failure


def _table(pairs: list[tuple[int, int]], shape: tuple[Any, ...]) -> NDArray[np.int8]:
    table = np.zeros(shape, dtype=np.int8)
    for pair in pairs:
        table[pair] = 1
    return table


def _choices(data: VictimData) -> Iterator[list[tuple[int, int]]]:
    """Every way to give each victim a robot that can serve it, or nobody."""
    able = [[None, *(int(r) for r in np.flatnonzero(column))] for column in data.can_serve.T]
    for robots in product(*able):
        yield [(r, v) for v, r in enumerate(robots) if r is not None]


def _full_matchings(n_robots: int, n_clusters: int) -> Iterator[list[tuple[int, int]]]:
    """Every one-to-one choice of as many (robot, cluster) pairs as can be."""
    if n_clusters <= n_robots:
        for robots in permutations(range(n_robots), n_clusters):
            yield [(r, c) for c, r in enumerate(robots)]
    else:
        for clusters in permutations(range(n_clusters), n_robots):
            yield list(enumerate(clusters))
