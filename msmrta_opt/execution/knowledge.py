"""What the world does and is during an execution, and what is known of it: cells, and victims.

All robots know the same: what one of them notices or finds, and what is announced, is known to all.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import replace

from ..arrays import Bools
from ..mission.grid import Cell, GridMap
from ..mission.instance import Instance, Victim
from ..mission.run import Change, Loss, Unknown, World
from ..mission.visibility import FieldOfView

_LOST, _CHANGED, _ANNOUNCED = range(3)


def happenings(world: World) -> deque[tuple[float, int, Loss | Change | Unknown]]:
    """What the world does, in its order."""
    found: list[tuple[float, int, Loss | Change | Unknown]] = [
        *((loss.time, _LOST, loss) for loss in world.lost),
        *((change.time, _CHANGED, change) for change in world.changes),
        *(
            (item.announced, _ANNOUNCED, item)
            for item in world.unknown
            if item.announced is not None
        ),
    ]
    return deque(sorted(found, key=lambda item: item[:2]))


class Knowledge:
    """The cells and victims that there are, and those that are known.

    Parameters
    ----------
    mission : Instance
        What is known at first, but for the victims that are unknown in `world`.
    world : World
        What the scenario came to.
    depth : int
        How far robots see victims, in cells.
    """

    def __init__(self, mission: Instance, world: World, depth: int) -> None:
        self.first = mission
        self.true = mission.map.free.copy()
        """Whether each cell is free, ``(n_rows, n_cols)``."""
        self.known = mission.map.free.copy()
        """Whether it is known to be."""
        self.version = 0
        """Of the known map."""
        self.hidden = {item.victim.id: item.victim for item in world.unknown}
        """The victims that nobody knows of, by id."""
        self.victims = {v.id: v for v in mission.victims if v.id not in self.hidden}
        self.unserved = {v.id: list(v.requirements) for v in self.victims.values()}
        """By known victim what is not served yet."""
        self._grid: tuple[int, GridMap] = (0, mission.map)
        self._mission: tuple[int, Instance] | None = None
        look = FieldOfView(mission.map, depth)  # sight is mutual
        self._seen_from: dict[int, Bools] = {v.id: look(v.cell) for v in self.hidden.values()}

    def change(self, cell: Cell, free: bool) -> bool:
        """Block or open a cell; returns whether that changes it."""
        changes = bool(self.true[cell]) != free
        self.true[cell] = free
        return changes

    def notice(self, cell: Cell) -> bool:
        """Learn how a cell is; returns whether that is news."""
        news = bool(self.known[cell] != self.true[cell])
        if news:
            self.known[cell] = self.true[cell]
            self.version += 1
        return news

    def beside(self, cell: Cell) -> Iterator[Cell]:
        """The cells of the map next to one, above, below, left and right."""
        row, col = cell
        n_rows, n_cols = self.true.shape
        for near in ((row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)):
            if 0 <= near[0] < n_rows and 0 <= near[1] < n_cols:
                yield near

    def in_sight(self, cell: Cell) -> list[Victim]:
        """The victims that nobody knows of, and that are seen from a cell."""
        seen = self._seen_from.items()
        return [self.hidden[v] for v, cells in seen if v in self.hidden and cells[cell]]

    def meet(self, victim: Victim) -> None:
        """Know a victim from now on."""
        del self.hidden[victim.id]
        self.victims[victim.id] = victim
        self.unserved[victim.id] = list(victim.requirements)

    @property
    def grid(self) -> GridMap:
        """The map as it is known."""
        if self._grid[0] != self.version:
            self._grid = (self.version, replace(self.first.map, free=self.known))
        return self._grid[1]

    @property
    def mission(self) -> Instance:
        """The mission with the victims that are known."""
        if self._mission is None or self._mission[0] != len(self.victims):
            known = tuple(self.victims.values())
            same = known == self.first.victims
            mission = self.first if same else self.first.replace(victims=known)
            self._mission = (len(known), mission)
        return self._mission[1]
