"""A plan for other programs: waypoints for Nav2, a table, and GeoJSON.

The waypoints are in the file that the Nav2 panel of RViz saves and loads, and sends to the waypoint
follower as the ``poses`` of a ``nav2_msgs/action/FollowWaypoints`` goal. What it does not know, it
leaves alone: the frame, the pause, the victim. Source: ``nav2_rviz_plugins/src/nav2_panel.cpp``
(``handleGoalSaver``, ``handleGoalLoader``, ``convert_to_msg``).
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any, Protocol

from .errors import InputError
from .files import write_text
from .instance import Instance
from .route import Route
from .waypoints import Waypoint, corners, frame_of, waypoints


class Driven(Protocol):
    """What is written: a `Plan`."""

    @property
    def instance(self) -> Instance:
        """What it is for."""

    @property
    def routes(self) -> tuple[Route, ...]:
        """One for each robot."""


COLUMNS = (
    *("robot", "waypoint", "row", "col", "x", "y", "yaw"),
    *("arrival", "departure", "victim", "serves"),
)


def plan_texts(plan: Driven, path: str | Path, *, frame_id: str = "map") -> dict[Path, str]:
    """The files that a plan is written to, and what is in each.

    Parameters
    ----------
    plan : Plan
        Whose walks are written.
    path : path
        ``.yaml`` (or ``.yml``): Nav2 waypoints, a file for each robot that has a visit, its id in the
        name. ``.csv``: a row for every cell that is walked. ``.geojson``: the routes and the visits.
    frame_id : str
        The frame of the poses, as ROS calls it.

    Raises
    ------
    InputError
        If the suffix is another.
    """
    path = Path(path)
    write = WRITERS.get(path.suffix.lower())
    if write is None:
        known = ", ".join(WRITERS)
        raise InputError(f"unknown format {path.suffix!r}; the suffix is one of {known}", file=path)
    points = {route.robot: waypoints(route, plan.instance) for route in plan.routes}
    return write(plan, path, {robot: found for robot, found in points.items() if found}, frame_id)


def export_plan(plan: Driven, path: str | Path, *, frame_id: str = "map") -> list[Path]:
    """Write a plan as `plan_texts` has it; returns the files."""
    texts = plan_texts(plan, path, frame_id=frame_id)
    for file, text in texts.items():
        write_text(file, text)
    return list(texts)


def _nav2(
    plan: Driven, path: Path, points: Mapping[int, list[Waypoint]], frame_id: str
) -> dict[Path, str]:
    import yaml

    texts = {}
    for robot, found in points.items():
        document = {
            "header": {"frame_id": frame_id},
            "robot": robot,
            "waypoints": {
                f"waypoint{number}": _nav2_waypoint(point)
                for number, point in enumerate(corners(found))
            },
        }
        file = path.with_name(f"{path.stem}-{robot}{path.suffix}")
        texts[file] = yaml.safe_dump(document, sort_keys=False, default_flow_style=None, width=120)
    return texts


def _nav2_waypoint(point: Waypoint) -> dict[str, Any]:
    made: dict[str, Any] = {
        "pose": [*_rounded(point.pose[:2]), 0.0],
        "orientation": _rounded(point.quaternion),
    }
    if point.visit is not None:
        made |= {
            "pause": point.pause,
            "victim": point.visit.victim,
            "serves": list(point.visit.served),
        }
    return made


def _csv(
    plan: Driven, path: Path, points: Mapping[int, list[Waypoint]], frame_id: str
) -> dict[Path, str]:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for robot, found in points.items():
        for number, point in enumerate(found):
            visit = point.visit
            served = ("", "") if visit is None else (visit.victim, "+".join(visit.served))
            times = point.arrival, point.departure
            writer.writerow((robot, number, *point.cell, *_rounded(point.pose), *times, *served))
    return {path: text.getvalue()}


def _geojson(
    plan: Driven, path: Path, points: Mapping[int, list[Waypoint]], frame_id: str
) -> dict[Path, str]:
    grid = plan.instance.map
    features = []
    for robot, found in points.items():
        line = [_rounded(point.pose[:2]) for point in corners(found)]
        line = [xy for i, xy in enumerate(line) if i == 0 or xy != line[i - 1]]
        if len(line) > 1:  # a line has two positions or more
            moves = sum(a.cell != b.cell for a, b in pairwise(found))
            features.append(_feature("LineString", line, robot=robot, cells=moves))
        visits = [(point, point.visit) for point in found if point.visit is not None]
        features += [
            _feature(
                "Point",
                _rounded(point.pose[:2]),
                robot=robot,
                stop=stop,
                victim=visit.victim,
                serves=list(visit.served),
                arrival=point.arrival,
                departure=point.departure,
            )
            for stop, (point, visit) in enumerate(visits, start=1)
        ]
    document = {
        "type": "FeatureCollection",
        "frame": {
            "frame_id": frame_id,
            "unit": "cell" if grid.frame is None else "metre",
            "cell_size": frame_of(grid).cell_size,
            "origin": list(frame_of(grid).origin),
        },
        "features": features,
    }
    return {path: json.dumps(document, ensure_ascii=False) + "\n"}


def _rounded(values: Iterable[float]) -> list[float]:
    """To nanometres: what is beyond is the rounding of a rotation."""
    return [round(value, 9) + 0.0 for value in values]


def _feature(kind: str, coordinates: list[Any], **properties: Any) -> dict[str, Any]:
    return {
        "type": "Feature",
        "geometry": {"type": kind, "coordinates": coordinates},
        "properties": properties,
    }


Writer = Callable[[Driven, Path, Mapping[int, list[Waypoint]], str], dict[Path, str]]
WRITERS: Mapping[str, Writer] = MappingProxyType(
    {".yaml": _nav2, ".yml": _nav2, ".csv": _csv, ".geojson": _geojson}
)
"""By the suffix of the file."""
