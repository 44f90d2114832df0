"""Maps of ROS' map server: a ``map.yaml`` that names an image and says how to read it.

Source: the map format of ``map_server`` and ``nav2_map_server``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from .errors import InputError, all_of, each_of, shown
from .files import read_yaml
from .occupancy import Occupancy, read_occupancy_image
from .validation import problems_of


def _three(value: object) -> object:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        raise InputError(f"{shown(value)}; give three numbers, [x, y, yaw]")
    return value


Coordinate = Annotated[float, Field(strict=True, ge=-1e9, le=1e9, allow_inf_nan=False)]
Origin = Annotated[tuple[Coordinate, Coordinate, Coordinate], BeforeValidator(_three)]
"""Pose of a map's lower left corner: x and y in metres, yaw in radians."""
Share = Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)]


class _Description(BaseModel):
    """The fields of a ``map.yaml``; others are left alone, as the map server does."""

    model_config = ConfigDict(extra="ignore")

    image: str
    resolution: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)]
    origin: Origin
    occupied_thresh: Share
    free_thresh: Share
    negate: bool
    mode: Literal["trinary", "scale", "raw"] = "trinary"

    @model_validator(mode="after")
    def _thresholds_are_in_order(self) -> Self:
        if self.free_thresh > self.occupied_thresh:
            raise InputError(
                f"{self.free_thresh:g} is above occupied_thresh {self.occupied_thresh:g}; "
                "give one that is not, for free is below it and occupied above the other",
                field="free_thresh",
            )
        return self


def read_ros_map(path: str | Path) -> Occupancy:
    """The occupancy of a ``map.yaml`` and its image.

    Raises
    ------
    InputError
        If a file is missing or broken, or a field is missing or out of range; `MistakesError` of
        several mistakes.
    """
    path = Path(path)
    document = read_yaml(path)
    if not isinstance(document, dict):
        raise InputError("not a map's description; give image, resolution, origin, …", file=path)
    try:
        said = _Description.model_validate(document)
    except ValidationError as error:
        wrong = list(each_of(problems_of(error)))
        image = document.get("image")
        if isinstance(image, str) and not (path.parent / image).exists():
            wrong.insert(0, InputError(f"{path.parent / image}: no such file", field="image"))
        raise all_of(wrong).within(path) from None
    try:
        return read_occupancy_image(
            path.parent / said.image,
            said.resolution,
            said.origin,
            occupied_thresh=said.occupied_thresh,
            free_thresh=said.free_thresh,
            negate=said.negate,
            mode=said.mode,
        )
    except InputError as error:
        raise InputError(str(error), field="image", file=path) from None
