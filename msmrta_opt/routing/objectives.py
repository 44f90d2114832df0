"""The table of objectives: all that a method, a command or a page needs to know of each.

A new objective is an entry here, with its bound in `combinatorial_bounds`, a metric of its name in
`mission.metrics`, and what the method that solves it adds. Nothing else lists objectives or asks for
one by its name; the checkers of `certify` state them anew: they share nothing with what they check.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from ..mission.errors import InputError
from ..mission.suggestions import none_of

if TYPE_CHECKING:  # the command line reads this table, and is to start without numpy
    from ..mission.metrics import Metrics
    from .problem import Routes, RoutingData

Method = Literal["branch and cut", "branch and price"]


@dataclass(frozen=True)
class Objective:
    """What is to be minimised."""

    name: str
    """Also the name of the metric of plans that it is."""
    title: str
    unit: str
    definition: str
    of_times: Callable[[Sequence[float], Sequence[float], Sequence[float]], float]
    """Its value, from when each robot is done and each victim is complete, and the priorities."""
    bound: Callable[[RoutingData], float]
    """A bound at once, before any search."""
    method: Method
    """What solves it."""
    model: tuple[str, Mapping[str, Any]]
    """A formulation of stage ``routing`` that states it, with the values of its parameters."""
    insertion: Literal["travel", "finish", "completion"]
    """By what ruin and recreate judges a place for a requirement: the travel that it adds, when its
    robot is then done, or by how much victims are then complete later."""
    service_is_constant: bool = False
    """Whether it holds the service of all requirements, whoever serves them."""
    only_last: bool = False
    """Whether it is the time of one robot, the one that is done last, not of all together."""
    of_victims: bool = False
    """Whether it is made of the victims' completion times, not of the robots' times."""
    weighted: bool = False
    """Whether it weighs times by priority."""
    is_compiled: bool = False
    """Whether the compiled search knows it: the sum of all robots' times, or with `only_last` the last,
    or with `of_victims` the victims' weighted sum."""
    sense: Literal["min"] = "min"

    def value(self, data: RoutingData, routes: Routes) -> float:
        """What `routes` are worth, in `unit`."""
        from .problem import times

        at = times(data, routes)
        return float(
            self.of_times(at.busy.tolist(), at.completion.tolist(), data.priority.tolist())
        )

    def unit_of(self, data: RoutingData) -> float:
        """What 1 of its values is in the mission's own units, for `data` in others."""
        return data.time_unit * (data.priority_unit if self.weighted else 1.0)

    def require(self, method: Method) -> None:
        """Refuse to be solved by another method than its own.

        Raises
        ------
        InputError
            If `method` is not what solves it.
        """
        if self.method != method:
            raise InputError(f"{self.name!r} is solved by {self.method}", field="objective")

    def of_plan(self, metrics: Metrics) -> float:
        """What a plan with these metrics is worth, in `unit`."""
        return float(getattr(metrics, self.name))


def objective_of(name: object) -> Objective:
    """The objective `name`; one that is an `Objective` already as it is.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    if isinstance(name, Objective):
        return name
    if not isinstance(name, str) or name not in OBJECTIVES:
        raise none_of(name, OBJECTIVES, "objective")
    return OBJECTIVES[name]


def value(data: RoutingData, routes: Routes, objective: str | Objective) -> float:
    """What `routes` are worth by `objective`: to be minimised."""
    return objective_of(objective).value(data, routes)


def _bound(name: str) -> Callable[[RoutingData], float]:
    def bound(data: RoutingData) -> float:
        from . import combinatorial_bounds

        return float(getattr(combinatorial_bounds, name)(data))

    return bound


_TABLE = (
    Objective(
        name="total_time",
        title="total time",
        unit="time units",
        definition="travel and service of all robots",
        of_times=lambda busy, completion, priority: sum(busy),
        bound=_bound("total_time_bound"),
        method="branch and cut",
        model=("joint_routing_flow", {"w": 0.0}),
        insertion="travel",
        is_compiled=True,
        service_is_constant=True,
    ),
    Objective(
        name="makespan",
        title="makespan",
        unit="time units",
        definition="when the last robot is done",
        of_times=lambda busy, completion, priority: max(busy, default=0.0),
        bound=_bound("makespan_bound"),
        method="branch and cut",
        model=("joint_routing_flow", {"w": 1.0}),
        insertion="finish",
        is_compiled=True,
        only_last=True,
    ),
    Objective(
        name="latency",
        title="latency",
        unit="time units",
        definition="completion times of all victims, weighted by priority",
        of_times=lambda busy, completion, priority: sum(
            weight * time for weight, time in zip(priority, completion, strict=True)
        ),
        bound=_bound("latency_bound"),
        method="branch and price",
        model=("joint_routing_mtz", {"w_total": 0.0, "w_makespan": 0.0, "w_latency": 1.0}),
        insertion="completion",
        is_compiled=True,
        of_victims=True,
        weighted=True,
    ),
)

OBJECTIVES: Mapping[str, Objective] = MappingProxyType({one.name: one for one in _TABLE})
"""By name."""
DEFAULT = "total_time"
NAMES = ", ".join(OBJECTIVES)
"""For help and messages."""
