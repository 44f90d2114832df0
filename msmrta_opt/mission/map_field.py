"""The map of an instance file, in each way that it can be given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidationError,
    ValidationInfo,
    WithJsonSchema,
)

from .counting import rows_by_columns
from .errors import InputError, at, shown
from .frame import Frame
from .grid import GridMap
from .map_files import OPTIONS, read_map_file
from .maps import BLOCKED, FREE, grid_from_rows
from .ros_map import Coordinate, Origin
from .validation import first_problem, said_of

Length = Annotated[float, Field(strict=True, gt=0, le=1e9, allow_inf_nan=False)]
Radius = Annotated[float, Field(strict=True, ge=0, le=1e9, allow_inf_nan=False)]


class _Floor(BaseModel):
    """A floor in a ``map.yaml`` or an image; see `map_files.read_floor_map`."""

    model_config = ConfigDict(extra="forbid")

    file: str
    cell_size: Length
    robot_radius: Radius = 0.0
    unknown: Literal["blocked", "free"] = "blocked"
    resolution: Length | None = None


def _four(value: object) -> object:
    if not isinstance(value, (list, tuple)) or len(value) != 4:
        raise InputError(f"{shown(value)}; give [row, col, along, up], the last two in metres")
    return value


Place = Annotated[int, Field(strict=True, ge=0)]
OffCentre = Annotated[tuple[Place, Place, Coordinate, Coordinate], BeforeValidator(_four)]
"""A cell, and how far from its centre a robot stands: along and up the map, in metres."""


class _Frame(BaseModel):
    """Where the cells lie in the world, and which robots stand beside a centre; see `Frame`."""

    model_config = ConfigDict(extra="forbid")

    cell_size: Length
    origin: Origin
    off_centre: tuple[OffCentre, ...] = ()

    def check(self, grid: GridMap) -> None:
        """Refuse what is not in a cell of `grid`, and a cell given twice."""
        seen: set[tuple[int, int]] = set()
        for i, (row, col, along, up) in enumerate(self.off_centre):
            where = at("off_centre", i)
            if not grid.contains((row, col)):
                raise InputError(
                    f"[{row}, {col}] is outside the map of {rows_by_columns(grid.shape)}",
                    field=where,
                )
            if (row, col) in seen:
                raise InputError(f"[{row}, {col}] is given twice", field=where)
            if not max(abs(along), abs(up)) < self.cell_size / 2:
                raise InputError(
                    f"[{along:g}, {up:g}] is not in the cell; give less than half of "
                    f"cell_size, {self.cell_size:g}",
                    field=where,
                )
            seen.add((row, col))


def load_map(value: object, folder: Path) -> GridMap:
    """A map from what a document in `folder` holds: a path, its rows, or a floor.

    Raises
    ------
    InputError, ValueError
        If it is none of them, or what it names cannot be read.
    """
    if isinstance(value, GridMap):
        return value
    if isinstance(value, str) and value != "-":  # which would be standard input
        return read_map_file(folder / value)
    if isinstance(value, Mapping) and {"rows"} <= set(value) <= {"rows", "frame"}:
        rows = value["rows"]
        if isinstance(rows, (list, tuple)) and all(isinstance(row, str) for row in rows):
            grid = grid_from_rows(rows)
            if value.get("frame") is None:
                return grid
            frame = validated(_Frame, value["frame"], "frame")
            try:
                frame.check(grid)
            except InputError as error:
                raise said_of("frame", error) from None
            return replace(
                grid, frame=Frame(frame.cell_size, frame.origin, len(rows), frame.off_centre)
            )
    if isinstance(value, Mapping) and {"file"} <= set(value) <= {"file", *OPTIONS}:
        floor = validated(_Floor, value, "")
        return read_map_file(
            folder / floor.file, **floor.model_dump(exclude={"file"}, exclude_none=True)
        )
    raise ValueError(
        f'{shown(value)}; give a .map file\'s path or {{"rows": ["..@.", …]}}, or for a floor '
        '{"file": "map.yaml", "cell_size": 0.5}'
    )


def validated(model: type[Any], value: Any, field: str) -> Any:
    """`value`, a document's `field`, as `model` has it; its first mistake is an `InputError`."""
    try:
        return model.model_validate(value)
    except ValidationError as error:
        raise said_of(field, first_problem(error)) from None


def _load(value: object, info: ValidationInfo) -> GridMap:
    context = info.context or {}
    return context["map"] if "map" in context else load_map(value, Path(context.get("folder", ".")))


def _dump(grid: GridMap) -> dict[str, Any]:
    rows = {"rows": list(grid.rows)}
    if grid.frame is None:
        return rows
    frame: dict[str, Any] = {
        "cell_size": grid.frame.cell_size,
        "origin": list(grid.frame.origin),
    }
    if grid.frame.off_centre:
        frame["off_centre"] = [list(entry) for entry in grid.frame.off_centre]
    return rows | {"frame": frame}


MapField = Annotated[
    GridMap,
    BeforeValidator(_load),
    PlainSerializer(_dump),
    WithJsonSchema(
        {
            "description": "A MovingAI .map file, relative to this one; the rows themselves, with "
            "the map's place in the world if it has one; or a floor of a map.yaml or an image.",
            "anyOf": [
                {"type": "string"},
                {
                    "type": "object",
                    "properties": {
                        "rows": {
                            "type": "array",
                            "minItems": 1,
                            "items": {"type": "string", "pattern": f"^[{FREE}{BLOCKED}]+$"},
                        },
                        "frame": _Frame.model_json_schema(),
                    },
                    "required": ["rows"],
                    "additionalProperties": False,
                },
                _Floor.model_json_schema(),
            ],
        }
    ),
]
