"""The contract between a formulation and everything that uses it.

A formulation is one file of a models folder. Its docstring states the program in mathematics; `SPEC`
says what it is for; ``build(data)`` returns it as a `cvxpy.Problem`, written so that a reader can lay
it beside the mathematics line by line. The file's stem is the formulation's name.

- Parameters of the mathematics that users turn (``psi``, ``beta``) are ``cp.Parameter``s whose names
  stand in ``SPEC.parameters``, used in DPP form, so that a new value needs no new canonicalisation.
- Constraints carry labels (``.set_label("cluster {c} has at most one robot")``): the words in which
  an infeasibility is explained and rows are exported, with one ``{…}`` per axis of the constraint.
- Variables carry names; the stage that uses the formulation reads the one its data class documents.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Stage = Literal["clustering", "cluster", "victim", "joint"]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Parameter:
    """A number that users turn, in ``[low, high]``."""

    low: float
    high: float
    default: float
    meaning: str


PSI = Parameter(0.0, 1.0, 0.95, "importance of full over partial satisfaction")
BETA = Parameter(0.0, 1.0, 0.5, "importance of failure time over success time")


@dataclass(frozen=True)
class Spec:
    """What a formulation is for.

    Parameters
    ----------
    stage : str
        Which data it takes: ``cluster`` takes `ClusterData`, ``victim`` `VictimData`.
    title : str
        One line for lists.
    parameters : dict of str to Parameter
        By the names of the ``cp.Parameter``s.
    assumes : str
        What must hold of the data for a solution to exist, if anything.
    """

    stage: Stage
    title: str
    parameters: dict[str, Parameter] = field(default_factory=dict)
    assumes: str = ""


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
        _same_shape("w", self.w, w_full=self.w_full)
        _per_robot(self.w, budget=self.budget)
        _finite(w=self.w, w_full=self.w_full)


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
        _same_shape("success", self.success, failure=self.failure, can_serve=self.can_serve)
        _per_robot(self.success, busy=self.busy, budget=self.budget, endurance=self.endurance)
        _finite(success=self.success, failure=self.failure, busy=self.busy)

    @property
    def matching_size(self) -> int:
        """Most victims that can be assigned one to one: the largest matching of ``can_serve``."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import maximum_bipartite_matching

        if not self.can_serve.any():
            return 0
        matched = maximum_bipartite_matching(csr_array(self.can_serve), perm_type="column")
        return int(np.count_nonzero(matched >= 0))


def _same_shape(name: str, array: Floats, **others: NDArray[np.generic]) -> None:
    if array.ndim != 2:
        raise ValueError(f"{name} has shape {array.shape}; give two axes")
    for other, values in others.items():
        if values.shape != array.shape:
            raise ValueError(f"{other} has shape {values.shape} where {name} has {array.shape}")


def _per_robot(array: Floats, **others: NDArray[np.generic]) -> None:
    for other, values in others.items():
        if values.shape != array.shape[:1]:
            raise ValueError(f"{other} has shape {values.shape} for {array.shape[0]} robots")


def _finite(**arrays: Floats) -> None:
    for name, values in arrays.items():
        if not np.isfinite(values).all():
            raise ValueError(f"{name} holds values that are not finite")
