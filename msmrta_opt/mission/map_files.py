"""Any map file: a MovingAI ``.map``, a ``map.yaml`` of ROS, or an image of a floor."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .coarsening import Coarsening, Unknown, coarsen
from .errors import InputError
from .grid import GridMap
from .maps import read_map
from .occupancy import IMAGES, Occupancy, read_occupancy_image
from .ros_map import read_ros_map

ROS = (".yaml", ".yml")
OPTIONS = ("cell_size", "robot_radius", "unknown", "resolution")
"""How a floor becomes cells; see `read_floor_map`."""


def is_floor(path: str | Path) -> bool:
    """Whether the file's name says that it holds a floor in pixels, not a grid."""
    return Path(path).suffix.lower() in (*ROS, *IMAGES)


def read_floor(path: str | Path, *, resolution: float | None = None) -> Occupancy:
    """The occupancy in a ``map.yaml``, or in an image of `resolution` metres per pixel.

    Raises
    ------
    InputError
        If the file cannot be read, or the resolution is missing or given twice.
    """
    path = Path(path)
    if path.suffix.lower() in ROS:
        if resolution is not None:
            raise InputError("not for a map.yaml, which has its own", field="resolution")
        return read_ros_map(path)
    if resolution is None:
        raise InputError("missing; an image needs one, in metres per pixel", field="resolution")
    return read_occupancy_image(path, resolution)


def read_floor_map(
    path: str | Path,
    *,
    cell_size: float | None = None,
    robot_radius: float = 0.0,
    unknown: Unknown = "blocked",
    resolution: float | None = None,
) -> Coarsening:
    """The cells of a floor in a ``map.yaml`` or an image.

    Parameters
    ----------
    path : str or path
        The file.
    cell_size : float
        Side of a cell, in metres.
    robot_radius : float
        Of the robots, in metres.
    unknown : {"blocked", "free"}
        How unknown space counts.
    resolution : float, optional
        Metres per pixel of an image; a ``map.yaml`` has its own.

    Raises
    ------
    InputError
        If the file cannot be read, or an option is missing or out of range.
    """
    if cell_size is None:
        raise InputError("missing; a floor needs one, in metres, such as 0.5", field="cell_size")
    floor = read_floor(path, resolution=resolution)
    return coarsen(floor, cell_size, robot_radius=robot_radius, unknown=unknown)


def read_map_file(path: str | Path, **options: Any) -> GridMap:
    """The map in a file of any known format; options are those of `read_floor_map`.

    Raises
    ------
    InputError
        As `read_map` and `read_floor_map` do, or if an option is given for a grid.
    """
    if is_floor(path):
        return read_floor_map(path, **options).grid
    for option in options:
        raise InputError(
            f"not for {Path(path).name}; it is for a map.yaml or an image", field=option
        )
    return read_map(path)
