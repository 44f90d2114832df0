"""Occupancy of a floor, pixel by pixel: what is free, what is occupied, and what nobody knows.

The values of an image are read as ROS' map server reads them (its modes trinary, scale and raw); what
lies between the thresholds, which the server's mode scale hands on as a cost, counts as unknown here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .counting import rows_by_columns
from .errors import InputError, shown
from .files import check_regular
from .frame import Pose

if TYPE_CHECKING:
    from PIL.Image import Image

FREE, OCCUPIED, UNKNOWN = 0, 1, 2
LARGEST_PIXELS = 10**8
"""Of an image; a larger one would not fit into memory beside what is made of it."""
IMAGES = (".bmp", ".gif", ".jpg", ".jpeg", ".pbm", ".pgm", ".png", ".ppm", ".tif", ".tiff")
OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196
"""The map server's customary thresholds."""


def is_finite(value: object) -> bool:
    """Whether `value` is a finite number."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


Mode = Literal["trinary", "scale", "raw"]
States = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Occupancy:
    """A floor in pixels.

    Parameters
    ----------
    state : uint8 array, shape (n_rows, n_cols)
        `FREE`, `OCCUPIED` or `UNKNOWN`, the upper row first.
    resolution : float
        Side of a pixel, in metres.
    origin : (x, y, yaw)
        Pose of the lower left corner, metres and radians.
    name : str
        What to call the map.
    source : Path, optional
        The file that it was read from.
    """

    state: States
    resolution: float
    origin: Pose = (0.0, 0.0, 0.0)
    name: str = ""
    source: Path | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        state = np.asarray(self.state)
        if state.ndim != 2 or 0 in state.shape:
            raise InputError(
                f"shape {state.shape}; give a rectangle of rows and columns", field="state"
            )
        if not np.isin(state, (FREE, OCCUPIED, UNKNOWN)).all():
            raise InputError(
                f"give {FREE} for free, {OCCUPIED} for occupied, {UNKNOWN} for unknown",
                field="state",
            )
        if not (is_finite(self.resolution) and self.resolution > 0):
            raise InputError(
                f"{shown(self.resolution)}; give metres per pixel, above 0", field="resolution"
            )
        if not (
            isinstance(self.origin, (tuple, list))
            and len(self.origin) == 3
            and all(map(is_finite, self.origin))
        ):
            raise InputError(
                f"{shown(self.origin)}; give three finite numbers, (x, y, yaw)", field="origin"
            )
        state = state.astype(np.uint8)
        state.setflags(write=False)
        object.__setattr__(self, "state", state)
        x, y, yaw = map(float, self.origin)
        object.__setattr__(self, "origin", (x, y, yaw))
        object.__setattr__(self, "resolution", float(self.resolution))

    @classmethod
    def from_percent(
        cls,
        values: ArrayLike,
        resolution: float,
        origin: Pose = (0.0, 0.0, 0.0),
        *,
        occupied_thresh: float = OCCUPIED_THRESH,
        free_thresh: float = FREE_THRESH,
        name: str = "",
    ) -> Self:
        """The floor in an array as a message of ROS, ``nav_msgs/OccupancyGrid``, has it.

        Parameters
        ----------
        values : int array, shape (n_rows, n_cols)
            Occupancies in percent, 0 to 100, and -1 for unknown; the lower row first:
            ``numpy.reshape(message.data, (message.info.height, message.info.width))``.
        resolution : float
            Side of a pixel, in metres.
        origin : (x, y, yaw)
            Pose of the lower left corner, metres and radians.
        occupied_thresh, free_thresh : float
            Occupancies, 0 to 1, above which a pixel is occupied and below which it is free; what lies
            between is unknown.
        name : str
            What to call the map.

        Raises
        ------
        InputError
            If the values are others.
        """
        percent = np.asarray(values)
        if percent.ndim != 2 or percent.dtype.kind not in "iu":
            raise InputError(
                f"shape {percent.shape} of {percent.dtype}; give a rectangle of whole numbers",
                field="values",
            )
        if (wrong := percent[(percent < -1) | (percent > 100)]).size:
            raise InputError(f"{wrong[0]}; give 0 to 100, or -1 for unknown", field="values")
        state = np.full(percent.shape, UNKNOWN, np.uint8)
        state[percent > 100 * occupied_thresh] = OCCUPIED
        state[(percent >= 0) & (percent < 100 * free_thresh)] = FREE
        return cls(state[::-1], resolution, origin, name)

    @property
    def share(self) -> dict[str, float]:
        """Shares of the pixels that are ``free``, ``occupied`` and ``unknown``; they sum to 1."""
        counts = np.bincount(self.state.ravel(), minlength=3) / self.state.size
        return dict(zip(("free", "occupied", "unknown"), counts.tolist(), strict=True))


def read_occupancy_image(
    path: Path,
    resolution: float,
    origin: Pose = (0.0, 0.0, 0.0),
    *,
    occupied_thresh: float = OCCUPIED_THRESH,
    free_thresh: float = FREE_THRESH,
    negate: bool = False,
    mode: Mode = "trinary",
) -> Occupancy:
    """The occupancy that an image shows: white is free and black is occupied, unless negated.

    Parameters
    ----------
    path : Path
        An image of 8 bits a channel.
    resolution : float
        Side of a pixel, in metres.
    origin : (x, y, yaw)
        Pose of the lower left corner, metres and radians.
    occupied_thresh, free_thresh : float
        Occupancies, 0 to 1, above which a pixel is occupied and below which it is free.
    negate : bool
        Whether white is occupied and black is free.
    mode : {"trinary", "scale", "raw"}
        ``scale``: what is not opaque is unknown. ``raw``: the values 0 to 100 are occupancies in
        percent, the others unknown.

    Raises
    ------
    InputError
        If the file is no image that can be read, or too large.
    """
    bands = _bands(path)
    opaque = bands[..., -1] == 255 if bands.shape[-1] in (2, 4) else None
    if mode != "trinary" and opaque is not None:
        bands = bands[..., :-1]
    # The mean over the channels, in trinary with the alpha channel, which is 255 where opaque.
    total = bands[..., 0] if bands.shape[-1] == 1 else bands.sum(axis=-1, dtype=np.uint16)
    shade = np.arange(255 * bands.shape[-1] + 1) / (255 * bands.shape[-1])
    if mode == "raw":
        percent = np.round(shade * 255)
        occupancy = np.where(percent <= 100, percent / 100, np.nan)
    else:
        occupancy = shade if negate else 1 - shade
    states = np.full(len(shade), UNKNOWN, np.uint8)
    states[occupancy > occupied_thresh] = OCCUPIED
    states[occupancy < free_thresh] = FREE
    state = states[total]
    if mode == "scale" and opaque is not None:
        state[~opaque] = UNKNOWN
    return Occupancy(state, resolution, origin, name=path.stem, source=path)


def _bands(path: Path) -> NDArray[np.uint8]:
    """The channels of an image, shape ``(n_rows, n_cols, n_channels)``."""
    from PIL import Image, UnidentifiedImageError

    check_regular(path)
    try:
        # Too large an image is refused here, before Pillow warns of it.
        limit, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
        try:
            image = Image.open(path)
        finally:
            Image.MAX_IMAGE_PIXELS = limit
        with image:
            n_cols, n_rows = image.size
            if n_cols * n_rows > LARGEST_PIXELS:
                raise InputError(
                    f"{rows_by_columns((n_rows, n_cols))}; give at most {LARGEST_PIXELS:,} pixels",
                    file=path,
                )
            array = np.asarray(_eight_bits(image, path))
    except InputError:
        raise
    except UnidentifiedImageError:
        raise InputError(f"not an image; give one of {', '.join(IMAGES)}", file=path) from None
    except Exception as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"the image cannot be read ({said})", file=path) from None
    return array.reshape(n_rows, n_cols, -1)


def _eight_bits(image: Image, path: Path) -> Any:
    """`image` with channels of 8 bits: grey or colour, with alpha or without."""
    if image.mode in ("L", "LA", "RGB", "RGBA"):
        return image
    if image.mode == "1":
        return image.convert("L")
    if image.mode in ("P", "PA"):
        has_alpha = image.mode == "PA" or "transparency" in image.info
        return image.convert("RGBA" if has_alpha else "RGB")
    raise InputError(
        f"pixels of kind {image.mode}; give an image of 8 bits a channel, grey or RGB", file=path
    )
