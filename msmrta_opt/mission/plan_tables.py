"""A plan as tables: its visits, its robots, its metrics; robots and victims by id."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Protocol

from .instance import Instance
from .metrics import METRICS, Metrics
from .route import Route

Row = dict[str, Any]


class Planned(Protocol):
    """What the tables are worked out from: a `Plan`."""

    @property
    def planner(self) -> str:
        """Who made it."""

    @property
    def instance(self) -> Instance:
        """What it is for."""

    @property
    def routes(self) -> tuple[Route, ...]:
        """One for each robot."""

    @property
    def metrics(self) -> Metrics:
        """How good it is."""

    def is_for(self, mission: Instance) -> bool:
        """Whether it is a plan for `mission`."""


VISIT_COLUMNS = ("robot", "stop", "victim", "serves", "stage", "cells", "arrival", "departure")


def visits(plan: Planned) -> list[Row]:
    """A row a visit, robot by robot in the order of its route; cells are those walked to it."""
    return [
        dict(
            zip(
                VISIT_COLUMNS,
                (
                    *(route.robot, stop, visit.victim, ", ".join(visit.served), visit.stage),
                    *(len(visit.cells) - 1, visit.arrival, visit.departure),
                ),
                strict=True,
            )
        )
        for route in plan.routes
        for stop, visit in enumerate(route.visits, start=1)
    ]


def robots(plan: Planned) -> list[Row]:
    """A row a robot: what it serves, the cells it walks, its time of service, of travel, and its end."""
    route_of = {route.robot: route for route in plan.routes}
    finished = plan.metrics.finished_of
    rows = []
    for robot in plan.instance.robots:
        route = route_of.get(robot.id, Route(robot=robot.id))
        service = sum(visit.departure - visit.arrival for visit in route.visits)
        rows.append(
            {
                "robot": robot.id,
                "visits": len(route.visits),
                "requirements": sum(len(visit.served) for visit in route.visits),
                "cells": route.distance,
                "service": service,
                "travel": finished[robot.id] - service,
                "finished": finished[robot.id],
            }
        )
    return rows


def metrics(plan: Planned) -> list[Row]:
    """A row a metric."""
    return [
        {
            "metric": name,
            "label": entry.label,
            "value": entry.scaled(entry.of(plan.metrics)),
            "unit": entry.unit,
        }
        for name, entry in METRICS.items()
    ]


TABLES: Mapping[str, Callable[[Planned], list[Row]]] = MappingProxyType(
    {"visits": visits, "robots": robots, "metrics": metrics}
)
"""By the name that `Plan.to_frame` takes."""
