"""Where the cells of a map lie in the world: metres, x and y, and the map's rotation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from .errors import InputError
from .search import Cell

Pose = tuple[float, float, float]
"""x and y in metres and a yaw in radians, counterclockwise from the x axis."""


@dataclass(frozen=True)
class Frame:
    """The place of a map in the world, as ROS' map server has it.

    Parameters
    ----------
    cell_size : float
        Side of a cell, in metres.
    origin : (x, y, yaw)
        Pose of the map's lower left corner: metres, and radians counterclockwise. The map's rows run
        along its x axis, from the last row, at the bottom, upwards.
    n_rows : int
        Number of rows of the map.
    off_centre : tuple of (row, col, along, up)
        The cells whose robots stand elsewhere than at the centre, and how far from it: in metres
        along the map's x axis and up its y axis, less than half a cell each.
    """

    cell_size: float
    origin: Pose
    n_rows: int
    off_centre: tuple[tuple[int, int, float, float], ...] = ()

    def offset(self, cell: Cell) -> tuple[float, float]:
        """How far from the centre of `cell` a robot stands: along and up the map, in metres."""
        return self._offsets.get(cell, (0.0, 0.0))

    @cached_property
    def _offsets(self) -> dict[Cell, tuple[float, float]]:
        return {(row, col): (along, up) for row, col, along, up in self.off_centre}

    def position(self, cell: Cell) -> tuple[float, float]:
        """Where a robot in `cell` stands, at its centre or `off_centre`: x and y, in metres."""
        x0, y0, yaw = self.origin
        off_along, off_up = self.offset(cell)
        along = (cell[1] + 0.5) * self.cell_size + off_along
        up = (self.n_rows - 0.5 - cell[0]) * self.cell_size + off_up
        cos, sin = math.cos(yaw), math.sin(yaw)
        return x0 + cos * along - sin * up, y0 + sin * along + cos * up

    def cell(self, x: float, y: float) -> Cell:
        """The cell in which the point (`x`, `y`), in metres, lies; it may be beyond the map.

        Raises
        ------
        InputError
            If the point is not a finite one.
        """
        along, up = self._of_the_map(x, y)
        return (
            self.n_rows - 1 - math.floor(up / self.cell_size),
            math.floor(along / self.cell_size),
        )

    def spot(self, x: float, y: float) -> tuple[float, float]:
        """The row and column of the point (`x`, `y`), in metres, not rounded: whole ones are centres.

        Raises
        ------
        InputError
            If the point is not a finite one.
        """
        along, up = self._of_the_map(x, y)
        return self.n_rows - 0.5 - up / self.cell_size, along / self.cell_size - 0.5

    def _of_the_map(self, x: float, y: float) -> tuple[float, float]:
        """A point along and up the map, in metres from its lower left corner."""
        if not (math.isfinite(x) and math.isfinite(y)):
            raise InputError(f"x {x}, y {y}; give finite numbers, in metres")
        x0, y0, yaw = self.origin
        cos, sin = math.cos(yaw), math.sin(yaw)
        return cos * (x - x0) + sin * (y - y0), cos * (y - y0) - sin * (x - x0)
