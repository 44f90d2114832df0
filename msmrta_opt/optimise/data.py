"""What each stage hands to its formulations, in arrays; the joint problem's is `routing.problem`.

Beside what is given stand, as properties, what formulations need of it: which victims can be covered,
the size of a largest matching, the time that a robot has left. All of that is data, so that a model
file holds nothing but its mathematics.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from ..arrays import Bools, Floats, Ints
from .axes import Axis, derived, over
from .mission_data import ClusterDistances, MissionData, VictimDistances
from .mission_data import Surroundings as Surroundings


@dataclass(frozen=True, eq=False)
class ClusteringData(MissionData):
    """Which of the victims' cells form a cluster, and which of them stands for it.

    The stage reads a binary variable ``y`` over (i, j): cell i is in the cluster that cell j stands
    for. Distances where ``can_reach`` is false mean nothing and are 0.
    """

    stage = "clustering"
    axes = MappingProxyType(
        {
            "i": Axis("cell"),
            "j": Axis("median", of="i"),
            "r": Axis("robot"),
            "v": Axis("victim"),
            "k": Axis("kind"),
        }
    )
    solution = MappingProxyType({"y": ("i", "j")})
    may_be_one = MappingProxyType({"y": "can_reach"})

    distance: Floats = field(metadata=over("i", "j", unit="cells"))
    """Walking distance from cell i to cell j."""
    can_reach: Bools = field(metadata=over("i", "j"))
    """Whether cell j can be reached from cell i."""
    weight: Floats = field(metadata=over("i", unit="victims"))
    """Number of victims on cell i."""
    n_clusters: int = field(metadata=over())
    """K, the number of clusters."""

    @derived("r", "i", unit="cells")
    def walk_to_cell(self) -> Floats:
        """Walk of robot r from its start to cell i; 0 if there is none."""
        around = self._around("walk_to_cell")
        cells = sorted(set(around.mission.cells))
        walks = around.distances.between(around.robots, cells)
        return np.where(np.isfinite(walks), walks, 0.0)

    @derived()
    def n_cells(self) -> int:
        """Number of cells with victims."""
        return len(self.distance)


@dataclass(frozen=True, eq=False)
class ClusterData(ClusterDistances):
    """Eq. 1: which robot takes which cluster; the stage reads a binary ``x`` over (r, c)."""

    stage = "cluster"
    axes = MappingProxyType(
        {
            "r": Axis("robot"),
            "c": Axis("cluster"),
            "d": Axis("other cluster", of="c"),
            "v": Axis("victim"),
            "k": Axis("kind"),
        }
    )
    solution = MappingProxyType({"x": ("r", "c")})

    w: Floats = field(metadata=over("r", "c", unit="requirements"))
    """Requirements that robot r can serve in cluster c."""
    w_full: Floats = field(metadata=over("r", "c", unit="requirements"))
    """Those of victims that robot r can satisfy fully."""
    budget: Ints = field(metadata=over("r", unit="clusters"))
    """Maximum number of clusters that robot r may take."""


@dataclass(frozen=True, eq=False)
class VictimData(VictimDistances):
    """Eq. 2: which robot takes which remaining victim; the stage reads a binary ``x`` over (r, v).

    Entries of the times where ``can_serve`` is false mean nothing and are 0.
    """

    stage = "victim"
    axes = MappingProxyType(
        {
            "r": Axis("robot"),
            "v": Axis("victim"),
            "u": Axis("other victim", of="v"),
            "k": Axis("kind"),
        }
    )
    solution = MappingProxyType({"x": ("r", "v")})
    may_be_one = MappingProxyType({"x": "can_serve"})

    success: Floats = field(metadata=over("r", "v", unit="time units"))
    """When robot r would be done with victim v."""
    failure: Floats = field(metadata=over("r", "v", unit="time units"))
    """Service time that others must redo, per capability of r."""
    can_serve: Bools = field(metadata=over("r", "v"))
    """Whether r can reach v and serve something there."""
    busy: Floats = field(metadata=over("r", unit="time units"))
    """When robot r is done with what it has already."""
    budget: Ints = field(metadata=over("r", unit="victims"))
    """Maximum number of victims that robot r may take."""
    endurance: Floats = field(metadata=over("r", infinite=True, unit="time units"))
    """Maximum time that robot r may be busy in all; ``inf`` for no limit."""

    @derived("v", "u", unit="cells")
    def walk_between_victims(self) -> Floats:
        """Walk from victim v to victim u; 0 if there is none."""
        around = self._around("walk_between_victims")
        walks = around.distances.between(around.mission.cells, around.mission.cells)
        return np.where(np.isfinite(walks), walks, 0.0)

    @derived("v")
    def coverable(self) -> Ints:
        """1 for each victim that some robot can serve, else 0."""
        return np.asarray(self.can_serve.any(axis=0), np.int64)

    @derived("r", "v", unit="time units")
    def extra(self) -> Floats:
        """Time that victim v adds to what robot r has already; 0 if it cannot."""
        return np.asarray(np.where(self.can_serve, self.success - self.busy[:, None], 0.0))

    @derived("r", unit="time units")
    def time_left(self) -> Floats:
        """Time that robot r has left for victims: a finite big-M.

        The rest of its endurance, but no more than all of its victims together would add.
        """
        left = np.maximum(self.endurance - self.busy, 0.0)
        return np.asarray(np.minimum(left, self.extra.sum(axis=1)))

    @derived(unit="victims")
    def matching_size(self) -> int:
        """ν: size of a maximum-cardinality matching of robots and victims by ``can_serve``."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import maximum_bipartite_matching

        if not self.can_serve.any():
            return 0
        matched = maximum_bipartite_matching(csr_array(self.can_serve), perm_type="column")
        return int(np.count_nonzero(matched >= 0))

    @derived(unit="victims")
    def budgeted_size(self) -> int:
        """Maximum number of victims that can be assigned within the budgets: a maximum flow."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import maximum_flow

        n_robots, n_victims = self.can_serve.shape
        capacity = np.zeros((n_robots + n_victims + 2,) * 2, dtype=np.int32)
        source, robots, victims, sink = 0, slice(1, n_robots + 1), slice(n_robots + 1, -1), -1
        capacity[source, robots] = np.minimum(self.budget, n_victims)
        capacity[robots, victims] = self.can_serve
        capacity[victims, sink] = 1
        return int(maximum_flow(csr_array(capacity), 0, len(capacity) - 1).flow_value)


@dataclass(frozen=True, eq=False)
class JointAssignmentData(ClusterDistances):
    """Eqs. 1 and 2 as one: who takes which post, and who then takes which victim.

    A robot's post is its cluster; the holder of a victim is the robot with the post at its cluster.
    The stage reads binary variables ``x`` over (r, c), the posts, and ``y`` over (r, v), who takes
    what holders leave. Posts p are the clusters and, last, none; holders h the robots and, last,
    nobody. Entries where ``can_serve`` is false, and times at a victim that cannot be reached, mean
    nothing and are 0.
    """

    stage = "joint"
    axes = MappingProxyType(
        {
            "r": Axis("robot"),
            "c": Axis("cluster"),
            "p": Axis("post", of="c", last="none"),
            "h": Axis("holder", of="r", last="nobody"),
            "v": Axis("victim"),
            "d": Axis("other cluster", of="c"),
            "k": Axis("kind"),
        }
    )
    solution = MappingProxyType({"x": ("r", "c"), "y": ("r", "v")})
    may_be_one = MappingProxyType({"y": "can_take"})

    w: Floats = field(metadata=over("r", "c", unit="requirements"))
    """Requirements that robot r can serve in cluster c."""
    w_full: Floats = field(metadata=over("r", "c", unit="requirements"))
    """Those of victims that robot r can satisfy fully."""
    cluster: Ints = field(metadata=over("v", unit="position along c"))
    """The cluster of victim v, as its position along c."""
    arrival: Floats = field(metadata=over("r", "p", "v", unit="time units"))
    """When robot r, done with post p, would be at victim v."""
    record: Floats = field(metadata=over("r", "p", unit="time units"))
    """Service time that others must redo of r's record at post p, per capability of r."""
    service: Floats = field(metadata=over("r", "h", "v", unit="time units"))
    """Service time of robot r for what holder h leaves of victim v."""
    redo: Floats = field(metadata=over("r", "h", "v", unit="time units"))
    """Service time that others must redo, where r does what it can of what holder h leaves of v, per
    capability of r."""
    can_serve: Bools = field(metadata=over("r", "h", "v"))
    """Whether r can reach v and serve something that holder h leaves there."""

    @derived("r", "v")
    def can_take(self) -> Bools:
        """Whether r can reach v and serve something that any holder leaves there."""
        return np.asarray(self.can_serve.any(axis=1))

    @derived("h", "v")
    def leaves(self) -> Ints:
        """1 if holder h leaves something of victim v that some robot can serve."""
        return np.asarray(self.can_serve.any(axis=0), np.int64)

    @derived("p", "v")
    def own_post(self) -> Bools:
        """Whether post p is that at the cluster of victim v."""
        return np.asarray(np.arange(self.record.shape[1])[:, None] == self.cluster)

    @derived("r", "h")
    def own_holder(self) -> Bools:
        """Whether holder h is robot r itself."""
        return np.eye(*self.can_serve.shape[:2], dtype=np.bool_)
