"""Where the cells of a map lie in the world: metres, x and y, and the map's rotation."""

from __future__ import annotations

import math
from dataclasses import dataclass

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
    """

    cell_size: float
    origin: Pose
    n_rows: int

    def position(self, cell: Cell) -> tuple[float, float]:
        """Where the centre of `cell` lies: x and y, in metres."""
        x0, y0, yaw = self.origin
        along = (cell[1] + 0.5) * self.cell_size
        up = (self.n_rows - 0.5 - cell[0]) * self.cell_size
        cos, sin = math.cos(yaw), math.sin(yaw)
        return x0 + cos * along - sin * up, y0 + sin * along + cos * up

    def cell(self, x: float, y: float) -> Cell:
        """The cell in which the point (`x`, `y`), in metres, lies; it may be beyond the map.

        Raises
        ------
        InputError
            If the point is not a finite one.
        """
        if not (math.isfinite(x) and math.isfinite(y)):
            raise InputError(f"x {x}, y {y}; give finite numbers, in metres")
        x0, y0, yaw = self.origin
        cos, sin = math.cos(yaw), math.sin(yaw)
        along = cos * (x - x0) + sin * (y - y0)
        up = cos * (y - y0) - sin * (x - x0)
        return (
            self.n_rows - 1 - math.floor(up / self.cell_size),
            math.floor(along / self.cell_size),
        )
