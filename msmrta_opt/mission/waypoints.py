"""A plan as robots drive it: a pose for every cell of its walks, in metres where the map has a frame.

Without a frame a cell is a unit square: the map's lower left corner is the origin, and x counts columns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from .frame import Frame, Pose
from .grid import Cell, GridMap
from .instance import Instance
from .route import Route, Visit


@dataclass(frozen=True)
class Waypoint:
    """A robot in a cell of its walk.

    Parameters
    ----------
    cell : (row, col)
        Where the robot is.
    pose : (x, y, yaw)
        Where a robot in the cell stands, and the direction in which it came, in radians
        counterclockwise; for the first cell that in which it leaves.
    arrival, departure : float
        In time units.
    visit : Visit, optional
        What it does there, if it stays for a victim.
    """

    cell: Cell
    pose: Pose
    arrival: float
    departure: float
    visit: Visit | None = None

    @property
    def pause(self) -> float:
        """Time units that the robot stays."""
        return self.departure - self.arrival

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """The yaw as a rotation about the z axis: ``(w, x, y, z)``."""
        half = self.pose[2] / 2
        return math.cos(half), 0.0, 0.0, math.sin(half)


def frame_of(grid: GridMap) -> Frame:
    """The frame of a map; for one that has none, cells of side 1 from its lower left corner."""
    return grid.frame or Frame(cell_size=1.0, origin=(0.0, 0.0, 0.0), n_rows=grid.shape[0])


def waypoints(route: Route, mission: Instance) -> list[Waypoint]:
    """A waypoint for every cell that a robot walks, its start first; a visit is one of its own.

    Returns
    -------
    list of Waypoint
        Empty for a robot that has no visit. Two that follow each other are in the same cell where a
        robot comes to a victim without a move, or serves two victims of one cell.
    """
    if not route.visits:
        return []
    frame = frame_of(mission.map)
    speed = next(robot.speed for robot in mission.robots if robot.id == route.robot)
    start = route.visits[0].cells[0]
    stops: list[tuple[Cell, float, float, Visit | None]] = [(start, 0.0, 0.0, None)]
    for visit in route.visits:
        left = stops[-1][2]
        stops += [
            (cell, left + moves / speed, left + moves / speed, None)
            for moves, cell in enumerate(visit.cells[1:-1], start=1)
        ]
        stops.append((visit.cells[-1], visit.arrival, visit.departure, visit))
    left = stops[-1][2]
    stops += [
        (cell, left + moves / speed, left + moves / speed, None)
        for moves, cell in enumerate(route.back[1:], start=1)
    ]
    yaws = _yaws([stop[0] for stop in stops], frame)
    return [
        Waypoint(cell, (*frame.position(cell), yaw), arrival, departure, visit)
        for (cell, arrival, departure, visit), yaw in zip(stops, yaws, strict=True)
    ]


def corners(points: Sequence[Waypoint]) -> list[Waypoint]:
    """The waypoints between which a robot drives straight on: the ends, the turns and the visits.

    Where a robot stands beside a cell's centre, it turns.
    """
    kept = []
    for i, point in enumerate(points):
        is_end = i in (0, len(points) - 1)
        if is_end or point.visit is not None or _turns(*points[i - 1 : i + 2]):
            kept.append(point)
    return kept


def _turns(before: Waypoint, point: Waypoint, after: Waypoint) -> bool:
    """Whether a robot turns on its way, or moves to a cell on another side than it came from."""
    (row, col), (mid_row, mid_col), (next_row, next_col) = before.cell, point.cell, after.cell
    came, goes = (mid_row - row, mid_col - col), (next_row - mid_row, next_col - mid_col)
    return after.pose[2] != point.pose[2] or (came != goes and (0, 0) not in (came, goes))


def _yaws(cells: Sequence[Cell], frame: Frame) -> list[float]:
    """The direction of the move into each cell; a robot that did not move keeps its direction."""
    rotation = frame.origin[2]
    moves = [
        None if here == there else _direction(here, there, frame) + rotation
        for here, there in pairwise(cells)
    ]
    now = next((yaw for yaw in moves if yaw is not None), rotation)
    found = [now]
    for yaw in moves:
        now = now if yaw is None else yaw
        found.append(now)
    return [math.remainder(yaw, math.tau) for yaw in found]


def _direction(here: Cell, there: Cell, frame: Frame) -> float:
    """From where a robot stands in a cell to where it stands in another, in radians on the map."""
    (along, up), (to_along, to_up) = frame.offset(here), frame.offset(there)
    return math.atan2(
        here[0] - there[0] + (to_up - up) / frame.cell_size,
        there[1] - here[1] + (to_along - along) / frame.cell_size,
    )
