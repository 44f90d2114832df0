"""What robots do, and what stays undone: all that metrics are worked out from."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, NonNegativeInt

from .grid import Cell
from .instance import CellField

Time = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class PlanRecord(BaseModel):
    """Frozen, and with no other fields than its own."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Visit(PlanRecord):
    """A robot at a victim.

    ``cells`` are those walked from the robot's previous stop to the victim, both included;
    ``arrival`` and ``departure`` are in time units; ``stage`` names what decided the visit.
    """

    victim: NonNegativeInt
    served: tuple[str, ...]
    stage: str
    cells: Annotated[tuple[CellField, ...], Field(min_length=1)]
    arrival: Time
    departure: Time


class Route(PlanRecord):
    """All that one robot does, in order. A robot without visits stays at its start.

    ``back`` holds the cells walked after the last visit, if the robot returns to its start.
    """

    robot: NonNegativeInt
    visits: tuple[Visit, ...] = ()
    back: tuple[CellField, ...] = ()

    @property
    def cells(self) -> list[Cell]:
        """All cells walked, in order, each stop once; empty for a robot that stays."""
        walked: list[Cell] = []
        for leg in (*(visit.cells for visit in self.visits), self.back):
            walked.extend(leg[1:] if walked else leg)
        return walked

    @property
    def distance(self) -> int:
        """Cells walked, that is, moves made."""
        legs = (*(visit.cells for visit in self.visits), self.back)
        return sum(max(len(leg) - 1, 0) for leg in legs)


class Reason(StrEnum):
    """Why a requirement stays unserved: nobody can serve it, or nobody within the robots' limits."""

    NO_ROBOT_HAS_IT = "no robot has it"
    NO_CAPABLE_ROBOT_REACHES_IT = "no capable robot can reach it"
    NOT_FOUND = "not found by the scouts"
    BEYOND_ENDURANCE = "beyond the robots' endurance"
    BEYOND_LONGEST_WALK = "beyond the robots' longest walk"
    BEYOND_BOTH = "beyond the robots' endurance and longest walk"

    @property
    def limits(self) -> tuple[str, ...]:
        """The options that would have to be raised for a robot to serve it; none if nobody could."""
        return {
            Reason.BEYOND_ENDURANCE: ("endurance",),
            Reason.BEYOND_LONGEST_WALK: ("longest_walk",),
            Reason.BEYOND_BOTH: ("endurance", "longest_walk"),
        }.get(self, ())


class Unserved(PlanRecord):
    """A requirement that the plan leaves open, and why."""

    victim: NonNegativeInt
    kind: str
    reason: Reason
