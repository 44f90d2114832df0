"""Array types, and what frozen records do with arrays."""

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
