"""What a stage's data knows of its mission: distances, travel times, speeds, who can do and needs what.

All of it is worked out when a formulation first asks for it, so that planning pays for none of it. It
comes from the mission, so data made by hand has it only if it is given `Surroundings`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Bools, Floats, Ints
from ..mission.errors import InputError
from ..mission.grid import Cell, DistanceTable
from ..mission.instance import Instance
from .axes import Ids, StageData, derived


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The mission behind a stage's data, and the cells between which its distances are.

    Parameters
    ----------
    mission : Instance
        The mission with the victims that are known.
    distances : DistanceTable
        Of its map.
    robots : sequence of cell
        Where each robot is when the stage begins.
    centres : sequence of cell
        Of the clusters; empty before there are any.
    labels : int array, shape (n_victims,), optional
        The cluster of each victim.
    apart : bool array, shape (n_robots,), optional
        Whether a robot is named by the option ``apart``.
    """

    mission: Instance
    distances: DistanceTable
    robots: Sequence[Cell]
    centres: Sequence[Cell] = ()
    labels: Ints | None = None
    apart: Bools | None = None


@dataclass(frozen=True, eq=False)
class MissionData(StageData):
    """Data of a stage that knows its mission."""

    around: Surroundings | None = field(default=None, kw_only=True, repr=False)
    """Where the mission's own data come from; ``None`` for data made by hand."""

    def _more_ids(self) -> dict[str, Ids]:
        if self.around is None:
            return {}
        mission = self.around.mission
        ids: dict[str, Ids] = {
            "r": tuple(robot.id for robot in mission.robots),
            "v": tuple(victim.id for victim in mission.victims),
            "k": tuple(mission.capabilities),
        }
        return {letter: found for letter, found in ids.items() if letter in self.axes}

    def _around(self, name: str) -> Surroundings:
        """The surroundings, for the property `name`."""
        if self.around is None:
            raise InputError(
                "needs the mission, and this data was made by hand; take "
                f"mo.stage_data(mission, {self.stage!r})",
                field=name,
            )
        return self.around

    @derived()
    def mission(self) -> Instance:
        """The mission itself, with the victims that are known."""
        return self._around("mission").mission

    @derived("r", unit="cells per time unit")
    def speed(self) -> Floats:
        """Speed of robot r."""
        return self._around("speed").mission.speed

    @derived("r", "k")
    def capable(self) -> Bools:
        """Whether robot r has capability k: the paper's P."""
        return self._around("capable").mission.P

    @derived("v", "k")
    def requires(self) -> Bools:
        """Whether victim v needs k: the paper's Q."""
        return self._around("requires").mission.Q

    @derived("v", "k", unit="time units")
    def service_time(self) -> Floats:
        """Service time of kind k at victim v, 0 where it is not needed."""
        return self._around("service_time").mission.service


@dataclass(frozen=True, eq=False)
class VictimDistances(MissionData):
    """What follows from where victims are; entries where ``can_reach`` is false are 0."""

    @derived("v")
    def priority(self) -> Floats:
        """Weight of victim v's completion time."""
        return self._around("priority").mission.priority

    @derived("r", "v")
    def can_reach(self) -> Bools:
        """Whether robot r can walk to victim v."""
        return np.isfinite(self._walks_to_victims)

    @derived("r", "v", unit="cells")
    def walk_to_victim(self) -> Floats:
        """Walk of robot r, from where it is when the stage begins, to victim v."""
        return np.where(self.can_reach, self._walks_to_victims, 0.0)

    @derived("r", "v", unit="time units")
    def travel_to_victim(self) -> Floats:
        """Time of that walk at the speed of r."""
        return np.asarray(self.walk_to_victim / self.speed[:, None])

    @derived("r", "v")
    def _walks_to_victims(self) -> Floats:
        around = self._around("walk_to_victim")
        return around.distances.between(around.robots, around.mission.cells)


@dataclass(frozen=True, eq=False)
class ClusterDistances(VictimDistances):
    """What follows from where clusters are, too; walks that there are not are 0.

    A cluster stands at its centre: the cell from which its members are served.
    """

    @derived("v", "c")
    def member(self) -> Bools:
        """Whether victim v is in cluster c."""
        around = self._around("member")
        labels = np.zeros(0, np.int64) if around.labels is None else around.labels
        return np.asarray(labels[:, None] == np.arange(len(around.centres)))

    @derived("c", unit="victims")
    def size(self) -> Ints:
        """Number of victims in cluster c."""
        return np.asarray(self.member.sum(axis=0), np.int64)

    @derived("r", "c")
    def can_enter(self) -> Bools:
        """Whether robot r can walk to the centre of cluster c."""
        return np.isfinite(self._walks_to_clusters)

    @derived("r", "c", unit="cells")
    def walk_to_cluster(self) -> Floats:
        """Walk of robot r, from where it is when the stage begins, to the centre of cluster c."""
        return np.where(self.can_enter, self._walks_to_clusters, 0.0)

    @derived("r", "c", unit="time units")
    def travel_to_cluster(self) -> Floats:
        """Time of that walk at the speed of r."""
        return np.asarray(self.walk_to_cluster / self.speed[:, None])

    @derived("c", "d")
    def joined(self) -> Bools:
        """Whether a walk joins the centres of clusters c and d."""
        return np.isfinite(self._walks_between_clusters)

    @derived("c", "d", unit="cells")
    def walk_between_clusters(self) -> Floats:
        """Walk from the centre of cluster c to that of cluster d."""
        return np.where(self.joined, self._walks_between_clusters, 0.0)

    @derived("c", "d")
    def neighbouring(self) -> Bools:
        """Whether c and d are two clusters with no third one whose centre is nearer to both.

        The relative neighbourhood graph of the centres by walking distance (Toussaint 1980).
        """
        walks = self._walks_between_clusters
        between = np.maximum(walks[:, None, :], walks[None, :, :])
        is_between = between < walks[:, :, None]
        return np.asarray(self.joined & ~is_between.any(axis=2) & ~np.eye(len(walks), dtype=bool))

    @derived("r")
    def apart(self) -> Bools:
        """Whether the option ``apart`` names robot r."""
        around = self._around("apart")
        none = np.zeros(around.mission.n_robots, dtype=bool)
        return none if around.apart is None else around.apart

    @derived("r", "c")
    def _walks_to_clusters(self) -> Floats:
        around = self._around("walk_to_cluster")
        return around.distances.between(around.robots, around.centres)

    @derived("c", "d")
    def _walks_between_clusters(self) -> Floats:
        around = self._around("walk_between_clusters")
        return around.distances.between(around.centres, around.centres)
