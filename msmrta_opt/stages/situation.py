"""What every stage looks at: the known victims, walking distances, and the robots' queues."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..mission.grid import Cell, DistanceTable
from ..mission.instance import Instance
from ..optimise.mission_data import Surroundings


@dataclass(frozen=True)
class Stop:
    """An entry of a robot's queue, by positions in the instance.

    ``victim`` is ``None`` for a stop that only passes a cell, such as a cluster's centre;
    ``kinds`` are the requirements to serve there.
    """

    robot: int
    cell: Cell
    stage: str
    victim: int | None = None
    kinds: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Situation:
    """An instance whose victims are all known, with its distances, each computed once."""

    instance: Instance
    distances: DistanceTable

    @classmethod
    def of(cls, instance: Instance) -> Situation:
        """The situation of `instance`; distances are asked for between starts and victims."""
        return cls(instance, DistanceTable(instance.map, [*instance.starts, *instance.cells]))

    @cached_property
    def cells(self) -> list[Cell]:
        """Cell of each victim."""
        return self.instance.cells

    @cached_property
    def reach(self) -> NDArray[np.bool_]:
        """Whether robot r can walk to victim v, shape ``(n_robots, n_victims)``."""
        component = self.instance.map.component
        starts, cells = (
            component[tuple(np.array(places, dtype=np.int64).reshape(-1, 2).T)]
            for places in (self.instance.starts, self.instance.cells)
        )
        return np.asarray(starts[:, None] == cells[None, :])

    @cached_property
    def able(self) -> NDArray[np.bool_]:
        """Whether r can serve kind k at v, shape ``(n_robots, n_victims, n_kinds)``."""
        instance = self.instance
        return instance.P[:, None, :] & instance.Q[None, :, :] & self.reach[:, :, None]

    @cached_property
    def available(self) -> NDArray[np.bool_]:
        """Requirements that some robot can serve, shape ``(n_victims, n_kinds)``."""
        return np.asarray(self.able.any(axis=0))

    def around(
        self,
        robots: Sequence[Cell] | None = None,
        centres: Sequence[Cell] = (),
        labels: NDArray[np.int64] | None = None,
        apart: NDArray[np.bool_] | None = None,
    ) -> Surroundings:
        """What a stage's data knows of the mission; robots are at their starts unless given."""
        starts = self.instance.starts if robots is None else robots
        return Surroundings(self.instance, self.distances, starts, centres, labels, apart)

    def after(self, stops: Iterable[Stop]) -> tuple[list[Cell], NDArray[np.float64]]:
        """Where each robot's queue ends, and when, in time units, shape ``(n_robots,)``."""
        cells = list(self.instance.starts)
        queued, before = list(stops), []
        for stop in queued:
            before.append(cells[stop.robot])
            cells[stop.robot] = stop.cell
        walked = self.distances.lengths(before, [stop.cell for stop in queued])
        speed, service = self.instance.speed.tolist(), self.instance.service.tolist()
        busy = [0.0] * self.instance.n_robots
        for stop, length in zip(queued, walked, strict=True):
            busy[stop.robot] += length / speed[stop.robot]
            if stop.victim is not None:
                serving = 0.0
                for k in stop.kinds:
                    serving += service[stop.victim][k]
                busy[stop.robot] += serving
        return cells, np.array(busy)


def without(remaining: NDArray[np.bool_], stops: Iterable[Stop]) -> NDArray[np.bool_]:
    """The requirements of `remaining`, shape ``(n_victims, n_kinds)``, that `stops` leave open."""
    left = remaining.copy()
    for stop in stops:
        if stop.victim is not None:
            left[stop.victim, list(stop.kinds)] = False
    return left


def each_once(stops: Iterable[Stop]) -> list[Stop]:
    """The stops without a requirement that an earlier one serves.

    A formulation may send several robots to a victim; each requirement is served by the first.
    Stops that only pass a cell stay.
    """
    done: set[tuple[int, int]] = set()
    kept = []
    for stop in stops:
        if stop.victim is None:
            kept.append(stop)
            continue
        left = tuple(k for k in stop.kinds if (stop.victim, k) not in done)
        done.update((stop.victim, k) for k in left)
        if left:
            kept.append(replace(stop, kinds=left))
    return kept


def nearest_first(distances: DistanceTable, start: Cell, cells: Sequence[Cell]) -> list[int]:
    """Positions in `cells`, always the nearest of the rest next; ties to the first."""
    if len(cells) <= 1:
        return list(range(len(cells)))
    far = distances.between([*cells, start], cells)
    order: list[int] = []
    left = np.arange(len(cells))
    here = len(cells)
    while left.size:
        i = int(far[here, left].argmin())
        here = int(left[i])
        order.append(here)
        left = np.delete(left, i)
    return order
