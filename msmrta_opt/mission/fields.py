"""The types of the fields of missions: cells, ids, amounts, speeds; read strictly."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, NonNegativeInt


def _moving(speed: float) -> float:
    if speed < 1e-30:
        raise ValueError(f"{speed:g}; give 1e-30 or more")
    return speed


CellField = tuple[NonNegativeInt, NonNegativeInt]
Id = Annotated[int, Field(ge=0, lt=2**63)]  # as arrays and ledgers hold them
# Beyond these, sums and products of times would leave the range of floats.
Amount = Annotated[float, Field(ge=0, le=1e30, allow_inf_nan=False)]
Speed = Annotated[float, Field(gt=0, le=1e30, allow_inf_nan=False), AfterValidator(_moving)]
