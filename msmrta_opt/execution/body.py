"""A robot as it is at a time of an execution, and what it is to do."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from ..mission.grid import Cell
from ..mission.instance import Robot
from ..mission.plan import Plan
from ..mission.run import Queue, Queued, World
from .state import Task


@dataclass(eq=False)
class Body:
    """A robot as it is at a time."""

    number: int
    robot: Robot
    speed: float
    cell: Cell
    queue: deque[Task]
    task: Task | None = None
    """The visit that is under way, or walked to."""
    leg: list[Cell] | None = None
    """The cells of that walk, of which the robot is at number `step`."""
    step: int = 0
    base: float = 0.0
    """When it set out on it."""
    into: Cell | None = None
    """The cell that a move under way leads to."""
    kind: int | None = None
    """Which of the visit's kinds is being served."""
    began: float = 0.0
    """When serving that kind began."""
    served_for: float = 0.0
    """How long it has served until now."""
    ends: list[float] = field(default_factory=list)
    """When serving each of the visit's kinds ends."""
    until: float | None = None
    """When what is under way ends."""
    lost: bool = False
    stuck: int | None = None
    """The version of the known map on which there was no way on."""
    cells: list[Cell] = field(default_factory=list)
    times: list[float] = field(default_factory=list)

    @property
    def is_serving(self) -> bool:
        """Whether a service is under way."""
        return self.kind is not None

    @property
    def is_waiting(self) -> bool:
        """Whether it has a visit to make, or to walk back, and no way on which to begin."""
        return self.task is not None and self.until is None and not self.lost

    def ahead(self) -> tuple[Task, ...]:
        """The visits to come; one that is walked to is the first of them."""
        walking = self.task is not None and not self.is_serving
        return (self.task, *self.queue) if walking and self.task else tuple(self.queue)


def visits_of(body: Body) -> Queue:
    """The visits that a robot is to make."""
    ahead = [task for task in body.ahead() if task.victim is not None]
    visits = tuple(Queued(victim=task.victim, served=task.served) for task in ahead)
    return Queue(robot=body.robot.id, visits=visits)


def bodies_of(plan: Plan, world: World) -> list[Body]:
    """The robots of a mission at the beginning, with what the plan has them do."""
    speed = {drawn.robot: drawn.speed for drawn in world.speeds}
    routes = {route.robot: route for route in plan.routes}
    bodies = []
    for number, robot in enumerate(plan.instance.robots):
        queue: deque[Task] = deque()
        if robot.id in routes:
            route = routes[robot.id]
            queue += [Task(visit.victim, visit.served, visit.cells) for visit in route.visits]
            queue += [Task(None, (), route.back)] if route.back else []
        bodies.append(Body(number, robot, speed[robot.id], robot.start, queue))
    return bodies
