"""What each stage hands to its formulations, in arrays; the joint problem's is `routing.problem`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Bools, Floats, Ints, own_arrays, per_robot, require_finite, same_shape


@dataclass(frozen=True, eq=False)
class ClusteringData:
    """Which of the victims' cells form a cluster, and which of them stands for it.

    A formulation answers with a binary variable ``y``, shape ``(n_cells, n_cells)``: cell i is in
    the cluster that cell j stands for. Distances where ``can_reach`` is false mean nothing and are 0.
    """

    distance: Floats
    """Walking distance from cell i to cell j, in cells, ``(n_cells, n_cells)``."""
    can_reach: Bools
    """Whether cell j can be reached from cell i, ``(n_cells, n_cells)``."""
    weight: Floats
    """Number of victims on cell i, ``(n_cells,)``."""
    n_clusters: int
    """K, the number of clusters."""

    def __post_init__(self) -> None:
        own_arrays(self)
        same_shape("distance", self.distance, can_reach=self.can_reach)
        if self.distance.shape != (self.n_cells, self.n_cells):
            raise ValueError(f"distance has shape {self.distance.shape}; give a square")
        if self.weight.shape != (self.n_cells,):
            raise ValueError(f"weight has shape {self.weight.shape} for {self.n_cells} cells")
        require_finite(distance=self.distance, weight=self.weight)

    @property
    def n_cells(self) -> int:
        """Number of cells with victims."""
        return len(self.distance)


@dataclass(frozen=True, eq=False)
class ClusterData:
    """Eq. 1: which robot takes which cluster.

    A formulation answers with a binary variable ``x``, shape ``(n_robots, n_clusters)``.
    """

    w: Floats
    """Requirements that robot r can serve in cluster c, ``(n_robots, n_clusters)``."""
    w_full: Floats
    """Those of victims that robot r can satisfy fully, ``(n_robots, n_clusters)``."""
    budget: Ints
    """Most clusters that robot r may take, ``(n_robots,)``."""

    def __post_init__(self) -> None:
        own_arrays(self)
        same_shape("w", self.w, w_full=self.w_full)
        per_robot(self.w, budget=self.budget)
        require_finite(w=self.w, w_full=self.w_full)


@dataclass(frozen=True, eq=False)
class VictimData:
    """Eq. 2: which robot takes which remaining victim.

    A formulation answers with a binary variable ``x``, shape ``(n_robots, n_victims)``. Entries of
    the times where ``can_serve`` is false mean nothing and are 0.
    """

    success: Floats
    """When robot r would be done with victim v, in time units, ``(n_robots, n_victims)``."""
    failure: Floats
    """Service time that others must redo, per capability of r, ``(n_robots, n_victims)``."""
    can_serve: Bools
    """Whether r can reach v and serve something there, ``(n_robots, n_victims)``."""
    busy: Floats
    """When robot r is done with what it has already, in time units, ``(n_robots,)``."""
    budget: Ints
    """Most victims that robot r may take, ``(n_robots,)``."""
    endurance: Floats
    """Most time units that robot r may be busy in all, ``inf`` for no limit, ``(n_robots,)``."""

    def __post_init__(self) -> None:
        own_arrays(self)
        same_shape("success", self.success, failure=self.failure, can_serve=self.can_serve)
        per_robot(self.success, busy=self.busy, budget=self.budget, endurance=self.endurance)
        require_finite(success=self.success, failure=self.failure, busy=self.busy)

    @property
    def matching_size(self) -> int:
        """Most victims that can be assigned one to one: the largest matching of ``can_serve``."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import maximum_bipartite_matching

        if not self.can_serve.any():
            return 0
        matched = maximum_bipartite_matching(csr_array(self.can_serve), perm_type="column")
        return int(np.count_nonzero(matched >= 0))

    @property
    def budgeted_size(self) -> int:
        """Most victims that can be assigned within the budgets: the largest flow through them."""
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
class JointAssignmentData:
    """Eqs. 1 and 2 as one: who takes which post, and who then takes which victim.

    A robot's post is its cluster; the holder of a victim is the robot with the post at its cluster.
    A formulation answers with binary variables ``x``, shape ``(n_robots, n_clusters)``, the posts, and
    ``y``, shape ``(n_robots, n_victims)``, who takes what holders leave. Posts have one more place,
    the last, for no post; holders likewise for nobody. Entries where ``can_serve`` is false, and
    times at a victim that cannot be reached, mean nothing and are 0.
    """

    w: Floats
    """Requirements that robot r can serve in cluster c, ``(n_robots, n_clusters)``."""
    w_full: Floats
    """Those of victims that robot r can satisfy fully, ``(n_robots, n_clusters)``."""
    cluster: Ints
    """The cluster of victim v, ``(n_victims,)``."""
    arrival: Floats
    """When robot r, done with post c, would be at victim v, in time units,
    ``(n_robots, n_clusters + 1, n_victims)``."""
    record: Floats
    """Service time that others must redo of r's record at post c, per capability of r,
    ``(n_robots, n_clusters + 1)``."""
    service: Floats
    """Service time of robot r for what holder h leaves of victim v, in time units,
    ``(n_robots, n_robots + 1, n_victims)``."""
    redo: Floats
    """Service time that others must redo, where r does what it can of what holder h leaves of v, per
    capability of r, ``(n_robots, n_robots + 1, n_victims)``."""
    can_serve: Bools
    """Whether r can reach v and serve something that holder h leaves there,
    ``(n_robots, n_robots + 1, n_victims)``."""

    def __post_init__(self) -> None:
        own_arrays(self)
        same_shape("w", self.w, w_full=self.w_full)
        (n_robots, n_clusters), n_victims = self.w.shape, len(self.cluster)
        at_post, at_holder = (n_robots, n_clusters + 1), (n_robots, n_robots + 1)
        for name, shape in {
            "arrival": (*at_post, n_victims),
            "record": at_post,
            "service": (*at_holder, n_victims),
            "redo": (*at_holder, n_victims),
            "can_serve": (*at_holder, n_victims),
        }.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} has shape {getattr(self, name).shape}; give {shape}")
        require_finite(w=self.w, w_full=self.w_full, arrival=self.arrival, record=self.record)
        require_finite(service=self.service, redo=self.redo)
