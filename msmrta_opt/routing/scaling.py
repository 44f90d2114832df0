"""The joint problem in units in which its solutions are worth neither much nor little.

Solvers have absolute tolerances, 1e-6 and thereabouts: what they take for 0 is not to depend on whether
a mission is written in hours or in days. Times and priorities are multiplied by powers of two, which is
exact, so that what is to be minimised of the incumbent is of a size at which such tolerances are small.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from .objectives import Objective
from .problem import Routes, RoutingData, times

_SMALL, _LARGE = 2.0**5, 2.0**24
"""What lies between is left as it is."""
_TARGET = 11
"""What does not comes to between half of 2 to this, and all of it."""
_LONGEST = 2.0**20
"""In lengths of the incumbent: no better solution has so long a leg, unless priorities are as far apart,
and shorter legs only make solutions better, so that bounds still hold."""


def in_convenient_units(data: RoutingData, objective: Objective, incumbent: Routes) -> RoutingData:
    """The same problem in other units; as it is where its own will do.

    Parameters
    ----------
    data : RoutingData
        The joint problem.
    objective : Objective
        What is to be minimised.
    incumbent : Routes
        Feasible routes.
    """
    at = times(data, incumbent)
    if objective.service_is_constant:
        length = float(at.travel.sum())
    elif objective.of_victims:
        length = float(at.completion.max(initial=0.0))
    else:
        length = float(at.busy.max(initial=0.0))
    unit = _unit(length)
    longest = _LONGEST * length if length > 0.0 else math.inf
    legs = {name: getattr(data, name) for name in ("leave", "back")}
    # Of a table for all robots no leg is cut that may be within the longest for some.
    lengths = data.length if len(data.length) > 1 else data.length / data.speed.max()
    cut = longest * (data.speed[:, None, None] if len(data.length) > 1 else data.speed.max())
    if unit != 1.0 or max(x.max(initial=0.0) for x in (*legs.values(), lengths)) > longest:
        others = {
            name: getattr(data, name) for name in ("service", "endurance", "longest_walk", "ready")
        }
        data = replace(
            data,
            **{name: np.minimum(x, longest) / unit for name, x in legs.items()},
            length=np.minimum(data.length, cut) / unit,
            **{name: x / unit for name, x in others.items()},
            time_unit=data.time_unit * unit,
        )
    if objective.weighted:
        unit = _unit(objective.value(data, incumbent))
        if unit != 1.0:
            data = replace(
                data, priority=data.priority / unit, priority_unit=data.priority_unit * unit
            )
    return data


def _unit(value: float) -> float:
    """The power of two in which `value` is of a size that will do."""
    if value == 0.0 or _SMALL <= value < _LARGE:
        return 1.0
    return math.ldexp(1.0, math.frexp(value)[1] - _TARGET)
