"""What happened when a plan was executed: where robots were, what they served, what came in between.

A `Run` is a frozen record that carries the plan, the scenario and the world that its seed came to, so
that its JSON file (``"format": "msmrta-run/1"``) is enough to check it, draw it and make it again.
"""

from __future__ import annotations

import json
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, NonNegativeInt

from ..public import load
from . import display
from .files import write_text
from .grid import Cell
from .happened import Change as Change
from .happened import Decision as Decision
from .happened import DrawnService as DrawnService
from .happened import DrawnSpeed as DrawnSpeed
from .happened import Event as Event
from .happened import Hindsight as Hindsight
from .happened import Loss as Loss
from .happened import Queue as Queue
from .happened import Queued as Queued
from .happened import Service as Service
from .happened import Unknown as Unknown
from .happened import Walked as Walked
from .happened import World as World
from .instance import Victim
from .plan import Plan
from .proof import Finite
from .route import PlanRecord, Time
from .run_metrics import RUN_METRICS, RunMetrics
from .scenario import Scenario
from .validation import read_model

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMAT: Literal["msmrta-run/1"] = "msmrta-run/1"


class Run(PlanRecord):
    """A plan as it was executed."""

    format: Literal["msmrta-run/1"] = FORMAT
    plan: Plan
    scenario: Scenario
    seed: NonNegativeInt
    policy: str
    options: dict[str, Any] = Field(default_factory=dict)
    world: World
    tracks: tuple[Walked, ...]
    services: tuple[Service, ...] = ()
    events: tuple[Event, ...] = ()
    decisions: tuple[Decision, ...] = ()
    figures: dict[str, Finite] = Field(default_factory=dict)
    """The metrics, for those who read the file by other means."""
    hindsight: Hindsight | None = None
    """The run beside the best that could have been, where that was asked for; only claimed."""
    deciding_seconds: Time = 0.0
    """Wall time that the policy took; the one thing that differs from machine to machine."""

    @cached_property
    def metrics(self) -> RunMetrics:
        """What the run came to; see `RunMetrics`."""
        return RunMetrics(
            self.plan,
            self.victims,
            self.world,
            self.tracks,
            self.services,
            self.events,
            self.decisions,
        )

    @property
    def end(self) -> float:
        """When the run ended: at its scenario's ``until``, or with the last that happened."""
        if self.scenario.until is not None:
            return self.scenario.until
        times = [event.time for event in self.events]
        return max([*times, *(track.times[-1] for track in self.tracks)], default=0.0)

    @property
    def victims(self) -> tuple[Victim, ...]:
        """All that there were: those of the mission, and those of the scenario."""
        own = {victim.id for victim in self.plan.instance.victims}
        new = (item.victim for item in self.world.unknown if item.victim.id not in own)
        return (*self.plan.instance.victims, *new)

    def cell_of(self, robot: int, time: float) -> Cell:
        """Where a robot is at a time; between two cells, that from which it comes."""
        track = next(track for track in self.tracks if track.robot == robot)
        passed = (c for c, t in zip(track.cells, track.times, strict=True) if t <= time)
        *_, last = passed
        return last

    def plot(self, **options: Any) -> Figure:
        """Draw what was planned and what was walked; see `plots.plot_run`."""
        figure: Figure = load("plots").plot_run(self, **options)
        return figure

    def replay(self, beside: Run | Plan | None = None, **options: Any) -> Any:
        """A page that plays the run, or this one and another in step; see `plots.plot_replay`."""
        return load("plots").plot_replay(self, beside, **options)

    def document(self) -> dict[str, Any]:
        """The run as a JSON-ready document."""
        return self.model_dump(mode="json")

    def save(self, path: str | Path) -> None:
        """Write the run as JSON, whole or not at all."""
        write_text(path, json.dumps(self.document(), separators=(",", ":")) + "\n")

    @classmethod
    def read(cls, path: str | Path) -> Run:
        """Read a run file.

        Raises
        ------
        InputError
            Naming the file, the field, the offending value and what would be right.
        """
        return read_model(cls, path)

    def same_as(self, other: Run) -> bool:
        """Whether both runs are the same but for the wall time of planning and deciding."""
        mine, theirs = self.document(), other.document()
        for document in (mine, theirs):
            document.pop("deciding_seconds")
            document["plan"].pop("planning_seconds")
        return mine == theirs

    def __repr__(self) -> str:
        return f"Run({self._summary})"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        values = [
            {"metric": entry.words, "value": entry.text(self.metrics)}
            for entry in RUN_METRICS.values()
        ]
        told = [{"time": f"{event.time:.6g}", "event": str(event)} for event in self.events]
        return display.page(
            self._summary, display.table("Metrics", values), display.table("Events", told)
        )

    @property
    def _summary(self) -> str:
        of = self.metrics
        return (
            f"{self.policy} for {self.plan.instance.name or 'a mission'}, seed {self.seed}: "
            f"{of.n_served} of {of.n_available} available requirements served, total time "
            f"{of.total_time:g}, makespan {of.makespan:g}"
        )
