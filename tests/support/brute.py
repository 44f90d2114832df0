"""Oracles for the formulations of Eq. 1 and Eq. 2: every 0/1 table, judged by the mathematics.

Written from the docstrings of ``models/``; no modelling language and no solver.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from msmrta_opt.optimise.data import ClusterData, VictimData


@cache
def tables(n_rows: int, n_columns: int) -> NDArray[np.float64]:
    """Every 0/1 table of a shape: float array, shape ``(2**(n_rows*n_columns), n_rows, n_columns)``."""
    size = n_rows * n_columns
    digits = np.arange(2**size)[:, None] >> np.arange(size) & 1
    return digits.reshape(-1, n_rows, n_columns).astype(float)


@dataclass(frozen=True)
class Judged:
    """Every 0/1 table with what it is worth, and the best worth of those that are feasible."""

    feasible: NDArray[np.bool_]
    worth: NDArray[np.float64]
    shape: tuple[int, int]
    best: float

    def worth_of(self, x: NDArray[np.float64]) -> float | None:
        """What one table is worth; ``None`` if it is not 0/1, not of the shape, or infeasible."""
        if x.shape != self.shape or not np.isin(x, (0, 1)).all():
            return None
        number = int(x.ravel() @ 2.0 ** np.arange(x.size))
        return float(self.worth[number]) if self.feasible[number] else None


def cluster_printed(data: ClusterData, psi: float) -> Judged:
    x = tables(*data.w.shape)
    return _most(data, psi, _at_most_one_robot(x))


def cluster_one_to_one(data: ClusterData, psi: float) -> Judged:
    x = tables(*data.w.shape)
    pairs = x.sum(axis=(1, 2)) == min(data.w.shape)
    return _most(data, psi, _at_most_one_robot(x) & _at_most_one_column(x) & pairs)


def cluster_budgeted(data: ClusterData, psi: float) -> Judged:
    x = tables(*data.w.shape)
    return _most(data, psi, _at_most_one_robot(x) & _each(x.sum(axis=2) <= data.budget))


def cluster_distance(data: ClusterData, psi: float, delta: float) -> Judged:
    x = tables(*data.w.shape)
    feasible = _at_most_one_robot(x) & _at_most_one_column(x)
    feasible &= ~((x > 0) & ~data.can_enter).any(axis=(1, 2))
    weight = (1 - psi) * data.w + psi * data.w_full - delta * data.walk_to_cluster
    return _judged(feasible, (weight * x).sum(axis=(1, 2)), data.w.shape, max)


def cluster_apart(data: ClusterData, psi: float) -> Judged:
    x = tables(*data.w.shape)
    named = np.flatnonzero(data.apart)
    close = [
        (x[:, r, c] > 0) & (x[:, s, d] > 0)
        for r, s in itertools.combinations(named, 2)
        for c, d in np.argwhere(data.neighbouring)
    ]
    apart = ~np.any(close, axis=0) if close else np.ones(len(x), dtype=bool)
    return _most(data, psi, _at_most_one_robot(x) & _at_most_one_column(x) & apart)


def victim_printed(data: VictimData, beta: float) -> Judged:
    x = tables(*data.success.shape)
    return _least(data, beta, _can(data, x) & _at_most_one_robot(x))


def victim_one_to_one(data: VictimData, beta: float) -> Judged:
    x = tables(*data.success.shape)
    one_to_one = _can(data, x) & _at_most_one_robot(x) & _at_most_one_column(x)
    pairs = x.sum(axis=(1, 2))
    return _least(data, beta, one_to_one & (pairs == pairs[one_to_one].max()))


def victim_covering(data: VictimData, beta: float) -> Judged:
    x = tables(*data.success.shape)
    return _least(data, beta, _covers(data, x))


def victim_balanced(data: VictimData, beta: float) -> Judged:
    x = tables(*data.success.shape)
    own = (1 - beta) * (data.success - data.busy[:, None]) + beta * data.failure
    load = (1 - beta) * data.busy + (own * x).sum(axis=2)
    return _judged(_covers(data, x), np.maximum(load.max(axis=1), 0), data.success.shape, min)


ORACLES: dict[str, Callable[[Any, float], Judged]] = {
    oracle.__name__: oracle
    for oracle in (
        cluster_budgeted,
        cluster_one_to_one,
        cluster_printed,
        victim_balanced,
        victim_covering,
        victim_one_to_one,
        victim_printed,
    )
}
"""By the name of the formulation, each of data and ψ or β."""
WALKED: dict[str, Callable[..., Judged]] = {
    oracle.__name__: oracle for oracle in (cluster_apart, cluster_distance)
}
"""The same of those that ask for distances, of data from a mission."""


def _judged(
    feasible: NDArray[np.bool_],
    worth: NDArray[np.float64],
    shape: tuple[int, ...],
    best: Callable[[Any], float],
) -> Judged:
    return Judged(feasible, worth, (shape[0], shape[1]), float(best(worth[feasible])))


def _most(data: ClusterData, psi: float, feasible: NDArray[np.bool_]) -> Judged:
    weight = (1 - psi) * data.w + psi * data.w_full
    return _judged(feasible, (weight * tables(*data.w.shape)).sum(axis=(1, 2)), data.w.shape, max)


def _least(data: VictimData, beta: float, feasible: NDArray[np.bool_]) -> Judged:
    shape = data.success.shape
    cost = (1 - beta) * data.success + beta * data.failure
    return _judged(feasible, (cost * tables(*shape)).sum(axis=(1, 2)), shape, min)


def _at_most_one_robot(x: NDArray[np.float64]) -> NDArray[np.bool_]:
    return _each(x.sum(axis=1) <= 1)


def _at_most_one_column(x: NDArray[np.float64]) -> NDArray[np.bool_]:
    return _each(x.sum(axis=2) <= 1)


def _can(data: VictimData, x: NDArray[np.float64]) -> NDArray[np.bool_]:
    return _each(x <= data.can_serve)


def _covers(data: VictimData, x: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Each victim that somebody can serve has exactly one robot that can."""
    robots = x.sum(axis=1)
    return _can(data, x) & _each(robots == data.can_serve.any(axis=0))


def _each(holds: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Per table, whether what is asked of it holds throughout."""
    return np.asarray(holds.reshape(len(holds), -1).all(axis=1), dtype=np.bool_)
