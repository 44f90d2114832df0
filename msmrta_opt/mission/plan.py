"""What a planner answers: who walks where, serves what and when, and what stays unserved and why.

A `Plan` is a frozen record that carries the instance it is for and the options it was made with, so
that its JSON file (``"format": "msmrta-plan/1"``) is enough to check it, draw it and make it again.
Robots and victims are named by their ids.
"""

from __future__ import annotations

import json
from enum import StrEnum
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, NonNegativeInt

from ..public import load
from .files import write_text
from .grid import Cell
from .instance import CellField, Instance
from .metrics import Metrics, metrics
from .proof import LatencyProof, RootProof
from .validation import read_model

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMAT: Literal["msmrta-plan/1"] = "msmrta-plan/1"


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


Time = Annotated[float, Field(ge=0, allow_inf_nan=False)]


LIMITS = ("endurance", "longest_walk", "return_to_start")
"""Most time units that a robot is busy; most cells that it walks; whether it ends where it began."""


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Visit(_Record):
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


class Route(_Record):
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


class Unserved(_Record):
    """A requirement that the plan leaves open, and why."""

    victim: NonNegativeInt
    kind: str
    reason: Reason


class Cluster(_Record):
    """One cluster of victims: its mean, the free cell that stands for it, and who took it.

    ``centre`` is ``(row, col)`` as numbers; ``cell`` is ``None`` if no member can be reached.
    """

    victims: tuple[NonNegativeInt, ...]
    centre: tuple[float, float]
    cell: CellField | None
    robots: tuple[NonNegativeInt, ...] = ()
    deferred: tuple[NonNegativeInt, ...] = ()


class Track(_Record):
    """One scout's walk, a cell per step (the start first), and how far it sees."""

    scout: NonNegativeInt
    visual_field_depth: NonNegativeInt
    cells: tuple[CellField, ...]


class Find(_Record):
    """A victim found: by which scout, at which step (0 is before the first move)."""

    victim: NonNegativeInt
    scout: NonNegativeInt
    step: NonNegativeInt


class ScoutingReport(_Record):
    """What the scouts did and found.

    ``coverage[t]`` is the share of the cells that can be seen from some reachable cell and had
    been seen after step ``t``.
    """

    walk: str
    shared_table: bool
    seed: int
    tracks: tuple[Track, ...]
    finds: tuple[Find, ...]
    not_found: tuple[NonNegativeInt, ...]
    coverage: tuple[float, ...]
    ended: Literal["covered", "all victims found", "step limit"]


class Certificate(_Record):
    """What is proven about the answer to one integer program.

    ``bound`` and ``objective`` are in the model's own sense, ``gap`` is relative; ``proof`` says
    how the bound was obtained, ``check`` is the verdict of the independent check. ``root`` holds
    what proves the bound before branching, where the planner keeps it; for latency ``pricing`` does.
    """

    stage: str
    model: str
    sense: Literal["min", "max"]
    solver: str
    version: str
    status: str
    objective: float | None
    bound: float | None
    gap: float | None
    proof: str
    check: str
    n_variables: NonNegativeInt
    n_rows: NonNegativeInt
    root: RootProof | None = None
    pricing: LatencyProof | None = None


class Plan(_Record):
    """The answer of a planner to an instance."""

    format: Literal["msmrta-plan/1"] = FORMAT
    instance: Instance
    planner: str
    options: dict[str, Any] = Field(default_factory=dict)
    versions: dict[str, str] = Field(default_factory=dict)
    routes: tuple[Route, ...]
    unserved: tuple[Unserved, ...] = ()
    scouting: ScoutingReport | None = None
    clusters: tuple[Cluster, ...] = ()
    certificates: tuple[Certificate, ...] = ()
    planning_seconds: dict[str, Time] = Field(default_factory=dict)

    @cached_property
    def metrics(self) -> Metrics:
        """How good the plan is; see `Metrics`."""
        return metrics(self)

    @cached_property
    def known(self) -> Instance:
        """The mission with the victims that the planner knew: those that were found."""
        if self.scouting is None or not self.scouting.not_found:
            return self.instance
        hidden = set(self.scouting.not_found)
        victims = enumerate(self.instance.victims)
        return self.instance.with_victims([v for v, x in victims if x.id not in hidden])

    def route(self, robot: int) -> Route:
        """The route of the robot with that id."""
        for route in self.routes:
            if route.robot == robot:
                return route
        raise KeyError(f"no robot {robot} in this plan")

    @property
    def limits(self) -> dict[str, Any]:
        """What is promised of every robot, by name; see `LIMITS`.

        The staged planner's ``endurance`` is no promise over whole routes: it limits what Eq. 2
        gives out, and the stages after it may add to that.
        """
        if self.planner == "msmrta":
            return {}
        return {name: self.options[name] for name in LIMITS if self.options.get(name) is not None}

    def is_for(self, mission: Instance) -> bool:
        """Whether `mission` is what this plan answers, whatever it is called."""
        parts = ("map", "capabilities", "service_time", "robots", "victims", "scouts")
        return all(getattr(self.instance, part) == getattr(mission, part) for part in parts)

    def plot(self, **options: Any) -> Figure:
        """Draw the plan: the three panels of the paper's Fig. 2; see `plots.plot_mission`."""
        figure: Figure = load("plots").plot_mission(self, **options)
        return figure

    def document(self) -> dict[str, Any]:
        """The plan as a JSON-ready document."""
        return self.model_dump(mode="json")

    def save(self, path: str | Path) -> None:
        """Write the plan as JSON, whole or not at all."""
        write_text(path, json.dumps(self.document(), separators=(",", ":")) + "\n")

    @classmethod
    def read(cls, path: str | Path) -> Plan:
        """Read a plan file.

        Raises
        ------
        InputError
            Naming the file, the field, the offending value and what would be right.
        """
        return read_model(cls, path)

    def same_as(self, other: Plan) -> bool:
        """Whether both plans are the same but for the time that planning took."""
        mine, theirs = self.document(), other.document()
        for document in (mine, theirs):
            document.pop("planning_seconds")
        return mine == theirs
