"""How good a plan is: what it serves, how far its robots walk, and when victims are done."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .plan import Plan


@dataclass(frozen=True)
class Metrics:
    """The figures of one plan.

    Distances are in cells, times in time units; a victim completes when its last served
    requirement does, and only victims with a served requirement count in completion times.
    """

    n_requirements: int
    """Requirements of all victims."""
    n_available: int
    """Requirements that a capable robot can reach (of victims that are known)."""
    n_served: int
    """Requirements served."""
    served_share: float
    """``n_served / n_available``; 1 if nothing is available."""
    victims_fully_served: int
    """Victims all of whose requirements are served."""
    distance: int
    """Cells walked by all robots."""
    distance_of: dict[int, int]
    """Cells walked, per robot id."""
    total_time: float
    """Travel and service time of all robots."""
    makespan: float
    """When the last robot is done."""
    latency: float
    """Sum over victims of priority times completion time."""
    mean_completion: float
    """Mean completion time of victims; 0 if none is served."""
    weighted_completion: float
    """Mean completion time of victims, weighted by priority; 0 if the weights sum to 0."""
    planning_seconds: float
    """Wall time of planning, all stages."""

    def as_dict(self) -> dict[str, object]:
        """All figures by name."""
        return asdict(self)


def metrics(plan: Plan) -> Metrics:
    """The figures of `plan`, from what it says its robots do."""
    instance = plan.instance
    speed = {robot.id: robot.speed for robot in instance.robots}
    served: dict[int, set[str]] = {victim.id: set() for victim in instance.victims}
    completion: dict[int, float] = {}
    finished = {robot.id: 0.0 for robot in instance.robots}
    for route in plan.routes:
        for visit in route.visits:
            served[visit.victim].update(visit.served)
            if visit.served:
                earlier = completion.get(visit.victim, 0.0)
                completion[visit.victim] = max(earlier, visit.departure)
        if route.visits:
            home = max(len(route.back) - 1, 0) / speed[route.robot]
            finished[route.robot] = route.visits[-1].departure + home
    n_requirements = sum(len(victim.requirements) for victim in instance.victims)
    n_served = sum(len(kinds) for kinds in served.values())
    out_of_reach = [item for item in plan.unserved if not item.reason.limits]
    n_available = n_requirements - len(out_of_reach)
    weight = {v.id: v.priority for v in instance.victims if v.id in completion}
    latency = float(sum(weight[v] * completion[v] for v in completion))
    total_weight = sum(weight.values())
    distance_of = {route.robot: route.distance for route in plan.routes}
    return Metrics(
        n_requirements=n_requirements,
        n_available=n_available,
        n_served=n_served,
        served_share=n_served / n_available if n_available else 1.0,
        victims_fully_served=sum(set(v.requirements) == served[v.id] for v in instance.victims),
        distance=sum(distance_of.values()),
        distance_of=distance_of,
        # Routes have no waiting, so a robot's finishing time is its travel and service time.
        total_time=sum(finished.values()),
        makespan=max(finished.values(), default=0.0),
        latency=latency,
        mean_completion=sum(completion.values()) / len(completion) if completion else 0.0,
        weighted_completion=latency / total_weight if total_weight else 0.0,
        planning_seconds=sum(plan.planning_seconds.values()),
    )
