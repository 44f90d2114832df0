"""Array types, and the shape and value checks that all data records share."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]


def own_arrays(data: object) -> None:
    """Give `data`, a frozen dataclass, its own read-only copies of its arrays."""
    for item in fields(data):  # type: ignore[arg-type]
        value = getattr(data, item.name)
        if isinstance(value, np.ndarray):
            copy = np.array(value)
            copy.setflags(write=False)
            object.__setattr__(data, item.name, copy)


def same_shape(name: str, array: Floats, **others: NDArray[np.generic]) -> None:
    """Refuse `array` unless it has two axes, and `others` unless they have its shape."""
    if array.ndim != 2:
        raise ValueError(f"{name} has shape {array.shape}; give two axes")
    for other, values in others.items():
        if values.shape != array.shape:
            raise ValueError(f"{other} has shape {values.shape} where {name} has {array.shape}")


def per_robot(array: Floats, **others: NDArray[np.generic]) -> None:
    """Refuse `others` unless they have one value for each row of `array`."""
    for other, values in others.items():
        if values.shape != array.shape[:1]:
            raise ValueError(f"{other} has shape {values.shape} for {array.shape[0]} robots")


def require_finite(**arrays: Floats) -> None:
    """Refuse arrays that hold anything but numbers."""
    for name, values in arrays.items():
        if not np.isfinite(values).all():
            raise ValueError(f"{name} holds values that are not finite")
