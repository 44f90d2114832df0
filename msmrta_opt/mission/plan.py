"""What a planner returns: who walks where, serves what and when, and what stays unserved and why.

A `Plan` is a frozen record that carries the instance it is for and the options it was made with, so
that its JSON file (``"format": "msmrta-plan/1"``) is enough to check it, draw it and make it again.
Robots and victims are named by their ids.
"""

from __future__ import annotations

import json
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from pydantic import Field, NonNegativeInt

from ..public import load
from . import display
from .convergence import Convergence, SearchRecord
from .errors import InputError, shown
from .files import write_text
from .instance import CellField, Instance
from .metrics import Metrics, metrics_of
from .plan_difference import PlanDifference
from .plan_export import export_plan
from .plan_tables import TABLES, VISIT_COLUMNS
from .proof import Finite, LatencyProof, ProofFile, RootProof
from .route import PlanRecord, Time
from .route import Reason as Reason
from .route import Route as Route
from .route import Unserved as Unserved
from .route import Visit as Visit
from .suggestions import none_of
from .validation import read_model

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

FORMAT: Literal["msmrta-plan/1"] = "msmrta-plan/1"


Limit = Literal["endurance", "longest_walk", "return_to_start"]
LIMITS: tuple[Limit, ...] = get_args(Limit)
"""Maximum time units that a robot is busy, and cells that it walks; whether it ends where it began."""


class Cluster(PlanRecord):
    """One cluster of victims: its mean, the free cell that stands for it, and who took it.

    ``centre`` is ``(row, col)`` as numbers; ``cell`` is ``None`` if no member can be reached.
    """

    victims: tuple[NonNegativeInt, ...]
    centre: tuple[Finite, Finite]
    cell: CellField | None
    robots: tuple[NonNegativeInt, ...] = ()
    deferred: tuple[NonNegativeInt, ...] = ()


class Track(PlanRecord):
    """One scout's walk, a cell per step (the start first), and how far it sees."""

    scout: NonNegativeInt
    visual_field_depth: NonNegativeInt
    cells: tuple[CellField, ...]


class Find(PlanRecord):
    """A victim found: by which scout, at which step (0 is before the first move)."""

    victim: NonNegativeInt
    scout: NonNegativeInt
    step: NonNegativeInt


class ScoutingReport(PlanRecord):
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
    coverage: tuple[Finite, ...]
    ended: Literal["covered", "all victims found", "step limit"]


class Certificate(PlanRecord):
    """What is proven about the solution of one integer program.

    ``bound`` and ``objective`` are in the model's own sense, ``gap`` is relative; ``proof`` says
    how the bound was obtained, ``check`` is the verdict of the independent check. ``root`` holds
    what proves the bound before branching, where the planner keeps it; for latency ``pricing`` does.
    ``proved`` says what a file of its own proves to the last branch.
    """

    stage: str
    model: str
    sense: Literal["min", "max"]
    solver: str
    version: str
    status: str
    objective: Finite | None
    bound: Finite | None
    gap: Finite | None
    proof: str
    check: str
    n_variables: NonNegativeInt
    n_rows: NonNegativeInt
    parameters: dict[str, Finite] = Field(default_factory=dict)
    """The values of the formulation's parameters."""
    digest: str = ""
    """Of the formulation's file; empty in files of before, and for a method that has none."""
    root: RootProof | None = None
    pricing: LatencyProof | None = None
    proved: ProofFile | None = None

    @property
    def how(self) -> str:
        """How the bound is known, in words: by a proof that anybody can check, or by a solver's."""
        if self.proved is None:
            return self.proof
        if self.proved.status == "proved":
            return self.proved.summary
        return f"claimed by {self.proof}; {self.proved.summary}"


class Plan(PlanRecord):
    """What a planner makes of an instance."""

    format: Literal["msmrta-plan/1"] = FORMAT
    instance: Instance
    """The mission that it is for, whole."""
    planner: str
    """Who made it."""
    options: dict[str, Any] = Field(default_factory=dict)
    """With what it was made: the same options make the same plan."""
    promises: tuple[Limit, ...] | None = None
    """The options that limit every robot's whole route."""
    versions: dict[str, str] = Field(default_factory=dict)
    """Of all that its content depends on."""
    routes: tuple[Route, ...]
    """A route for each robot."""
    unserved: tuple[Unserved, ...] = ()
    """Requirements that nobody serves, each with the reason."""
    scouting: ScoutingReport | None = None
    """What scouts did, where there are any."""
    clusters: tuple[Cluster, ...] = ()
    """Of a staged plan."""
    certificates: tuple[Certificate, ...] = ()
    """What is proven about each integer program, or about the plan."""
    planning_seconds: dict[str, Time] = Field(default_factory=dict)
    """Wall time by stage."""
    search: SearchRecord | None = None
    """How incumbent and bound closed in, where the planner keeps it; see `convergence`."""

    @cached_property
    def metrics(self) -> Metrics:
        """How good the plan is; see `Metrics`."""
        seconds = sum(self.planning_seconds.values())
        return Metrics(self.instance, self.routes, self.unserved, seconds)

    @cached_property
    def known(self) -> Instance:
        """The mission with the victims that the planner knew: those that were found."""
        if self.scouting is None or not self.scouting.not_found:
            return self.instance
        hidden = set(self.scouting.not_found)
        victims = enumerate(self.instance.victims)
        return self.instance.with_victims([v for v, x in victims if x.id not in hidden])

    def route(self, robot: int) -> Route:
        """The route of the robot with that id.

        Raises
        ------
        InputError
            If there is no such robot.
        """
        for route in self.routes:
            if route.robot == robot:
                return route
        known = ", ".join(str(route.robot) for route in self.routes)
        raise InputError(f"no robot {robot!r} in this plan; there are {known}", field="robot")

    @property
    def limits(self) -> dict[str, Any]:
        """What every robot keeps over its whole route, by name; see `LIMITS`."""
        promises = self.promises
        if promises is None:
            # The files of before do not say. Those of staged plans name a preset, and an endurance
            # that limits what Eq. 2 gives out, to which later stages may add.
            promises = () if "preset" in self.options else LIMITS
        return {name: self.options[name] for name in promises if self.options.get(name) is not None}

    def is_for(self, mission: Instance) -> bool:
        """Whether `mission` is what this plan is for, whatever it is called."""
        parts = ("map", "capabilities", "service_time", "robots", "victims", "scouts")
        return all(getattr(self.instance, part) == getattr(mission, part) for part in parts)

    def to_frame(self, what: str = "visits") -> pd.DataFrame:
        """The plan as a table.

        Parameters
        ----------
        what : {"visits", "robots", "metrics"}
            A row a visit, a robot or a metric; distances in cells, times in time units.

        Raises
        ------
        InputError
            If there is no such table.
        """
        import pandas as pd

        if what not in TABLES:
            raise none_of(what, TABLES, "what")
        columns = VISIT_COLUMNS if what == "visits" else None  # there may be no visit
        return pd.DataFrame(TABLES[what](self), columns=columns)

    def diff(self, other: Plan) -> PlanDifference:
        """What `other` does otherwise: visits moved, metrics beside each other, a picture of both.

        Raises
        ------
        InputError
            If it is no plan.
        """
        if not isinstance(other, Plan):
            raise InputError(
                f"{shown(other)}; give a plan, as msmrta_opt.plan returns it", field="other"
            )
        return PlanDifference(self, other)

    def convergence(self, **others: Plan) -> Convergence:
        """Incumbent and bound of the search over time: a table, and a picture.

        Parameters
        ----------
        **others : Plan
            Further plans by name, to be laid over this one.

        Raises
        ------
        InputError
            If a plan keeps no record of a search, as only the exact planner does.
        """
        return Convergence({self.planner: self, **others})

    def plot(self, **options: Any) -> Figure:
        """Draw the plan: the three panels of the paper's Fig. 2; see `plots.plot_mission`."""
        figure: Figure = load("plots").plot_mission(self, **options)
        return figure

    def replay(self, beside: Plan | None = None, **options: Any) -> Any:
        """A page that plays the plan, or this one and another in step; see `plots.plot_replay`."""
        return load("plots").plot_replay(self, beside, **options)

    def document(self) -> dict[str, Any]:
        """The plan as a JSON-ready document."""
        return self.model_dump(mode="json")

    def save(self, path: str | Path) -> None:
        """Write the plan as JSON, whole or not at all."""
        write_text(path, json.dumps(self.document(), separators=(",", ":")) + "\n")

    def export(self, path: str | Path, *, frame_id: str = "map") -> list[Path]:
        """Write what robots drive, for Nav2, as a table or as GeoJSON; see `plan_export`.

        Parameters
        ----------
        path : path
            ``.yaml``, of which each robot gets one, ``.csv`` or ``.geojson``.
        frame_id : str
            The frame of the poses, as ROS calls it.

        Returns
        -------
        list of Path
            The files.
        """
        return export_plan(self, path, frame_id=frame_id)

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
        """Whether both plans are the same but for the time that planning and proving took."""
        mine, theirs = self.document(), other.document()
        for document in (mine, theirs):
            del document["planning_seconds"], document["search"]
            for certificate in document["certificates"]:
                del certificate["proved"]
        return mine == theirs

    def __repr__(self) -> str:
        return f"Plan({self._summary})"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        missing = [
            {"victim": item.victim, "requirement": item.kind, "why": item.reason.value}
            for item in self.unserved
        ]
        values = [
            {"metric": entry.words, "value": entry.text(self.metrics)}
            for entry in metrics_of("plan")
        ]
        return display.page(
            self._summary,
            display.table("Metrics", values),
            display.table("Visits", TABLES["visits"](self)),
            display.table("Unserved", missing),
        )

    @property
    def _summary(self) -> str:
        of = self.metrics
        return (
            f"{self.planner} for {self.instance.name or 'a mission'}: {of.n_served} of "
            f"{of.n_available} available requirements served, total time {of.total_time:g}, "
            f"makespan {of.makespan:g}"
        )
