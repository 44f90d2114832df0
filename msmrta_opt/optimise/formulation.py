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
from math import isfinite
from typing import Literal, get_args

from ..mission.errors import ModelError
from .data import ClusterData as ClusterData
from .data import ClusteringData as ClusteringData
from .data import JointAssignmentData as JointAssignmentData
from .data import VictimData as VictimData

Stage = Literal["clustering", "cluster", "victim", "joint", "routing"]


@dataclass(frozen=True)
class Parameter:
    """A number that users turn, in ``[low, high]``."""

    low: float
    high: float
    default: float
    meaning: str


PSI = Parameter(0.0, 1.0, 0.95, "importance of full over partial satisfaction")
BETA = Parameter(0.0, 1.0, 0.5, "importance of failure time over success time")
LAMBDA = Parameter(0.0, 1.0, 0.5, "importance of Eq. 2's time over Eq. 1's score")


@dataclass(frozen=True)
class Spec:
    """What a formulation is for.

    Parameters
    ----------
    stage : str
        Which data it takes: ``clustering`` takes `ClusteringData`, ``cluster`` `ClusterData`,
        ``victim`` `VictimData`, ``joint`` `JointAssignmentData`, ``routing``
        `routing.problem.RoutingData`.
    title : str
        One line for lists.
    parameters : dict of str to Parameter
        By the name of each ``cp.Parameter``; all are used.
    assumes : str
        What must hold of the data for a solution to exist, if anything.

    Raises
    ------
    ModelError
        If there is no such stage, or a parameter's range is none.
    """

    stage: Stage
    title: str
    parameters: dict[str, Parameter] = field(default_factory=dict)
    assumes: str = ""

    def __post_init__(self) -> None:
        if self.stage not in get_args(Stage):
            raise ModelError(f"stage {self.stage!r}; give one of {', '.join(get_args(Stage))}")
        for name, item in self.parameters.items():
            if not isinstance(item, Parameter):
                raise ModelError(f"{name}: {item!r}; give Parameter(low, high, default, meaning)")
            if not (isfinite(item.low) and isfinite(item.high)):
                raise ModelError(f"{name}: the range [{item.low:g}, {item.high:g}] is not finite")
            if not item.low <= item.default <= item.high:
                raise ModelError(
                    f"{name}: default {item.default:g} is not in [{item.low:g}, {item.high:g}]"
                )
