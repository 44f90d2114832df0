"""Whether a proof of a plan's latency holds, to the last branch.

The rounds before branching are those of `pricing_bound`. The routes that they leave to a better plan
are listed (`route_lists`), each robot's apart, and a tree divides the plans that the lists allow: by
whether a robot serves a task, or by when a task is done. At each leaf dual values prove that nothing
better is left.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import Bools
from ..mission.errors import CheckError
from ..mission.exact import exact
from ..mission.plan import Plan
from ..mission.proof import LatencyLeaf, LatencyTree
from .certificates import worth
from .joint_problem import Joint
from .ng_routes import Task
from .pricing_bound import Priced, price, task_duals
from .route_lists import RouteList, route_list
from .scheduling_bound import scheduling_bound
from .verdict import Verdict

Allowed = tuple[Bools, ...]
"""By robot, which routes of its list."""


def check_latency_proof(proof: LatencyTree, plan: Plan) -> Verdict:
    """What `proof` proves of `plan`, which passes its own check.

    Raises
    ------
    CheckError
        If dual values are of what there is not, densities are too high, a branch is of what there is
        not, or there is more than can be counted.
    """
    joint = Joint.of(plan)
    value = worth(plan, "latency")
    size = "no leaves"
    at_once = max(joint.each_alone("latency"), scheduling_bound(joint))
    bound = joint.up(at_once, "latency", value)
    if proof.root is None or bound >= value:
        return Verdict("latency", value, bound, size)
    priced = price(joint, proof.root, value)
    if priced is None:
        return Verdict("latency", value, value, size)
    bound = max(bound, joint.up(priced.best, "latency", value))
    if not proof.leaves:
        return Verdict("latency", value, bound, size)
    lists = [route_list(robot, priced.spare) for robot in priced.robots]
    minimum = None
    for number, (allowed, leaf) in enumerate(_leaves(lists, priced, proof.leaves)):
        own = leaf_bound(joint, priced, lists, allowed, leaf, f"leaf {number}")
        if own is not None:
            minimum = own if minimum is None else min(minimum, own)
    n_routes = sum(len(routes.option) for routes in lists)
    size = f"{n_routes} routes listed, {len(proof.leaves)} leaves"
    if minimum is None or minimum > priced.better:
        bound = value
    else:
        bound = max(bound, joint.up(minimum * priced.unit, "latency", value))
    return Verdict("latency", value, bound, size)


def leaf_bound(
    joint: Joint,
    priced: Priced,
    lists: list[RouteList],
    allowed: Allowed,
    leaf: LatencyLeaf,
    name: str,
) -> int | None:
    """What the dual values of a leaf prove, in units; ``None`` if it holds no plan at all."""
    if not all(some.any() for some in allowed):
        return None
    duals = task_duals(joint, priced.tasks, leaf.duals, priced.unit, name)
    total = sum(dual.value for dual in duals.values())
    for routes, some in zip(lists, allowed, strict=True):
        total += int(routes.cost(routes.network.cost(duals))[some].min())
    return total


def _leaves(
    lists: list[RouteList], priced: Priced, leaves: tuple[LatencyLeaf, ...]
) -> Iterator[tuple[Allowed, LatencyLeaf]]:
    """The leaves in the order of the tree, with the routes that the branches to each allow.

    Each leaf holds the branches from the root to it; those of the tree must be complete: a leaf's low
    side comes first, then all of its high side.
    """
    path: list[tuple[object, bool]] = []
    for number, leaf in enumerate(leaves):
        own: list[tuple[object, bool]] = [(branch.what, branch.high) for branch in leaf.branches]
        if number == 0:
            expected: list[tuple[object, bool]] = [(what, False) for what, _ in own]
        else:
            while path and path[-1][1]:
                path.pop()
            if not path:
                raise CheckError(f"leaf {number} is one too many")
            turned = [*path[:-1], (path[-1][0], True)]
            expected = [*turned, *((what, False) for what, _ in own[len(turned) :])]
        if own != expected:
            raise CheckError(f"leaf {number} does not follow the one before it in the tree")
        path = own
        yield _allowed(lists, priced, leaf, f"leaf {number}"), leaf
    if any(not high for _, high in path):
        raise CheckError("the tree lacks the other side of its last branch")


def _allowed(lists: list[RouteList], priced: Priced, leaf: LatencyLeaf, name: str) -> Allowed:
    allowed = [np.ones(len(routes.option), dtype=bool) for routes in lists]
    known = {task for own in priced.tasks.values() for task in own}
    for branch in leaf.branches:
        task: Task = (branch.victim, tuple(sorted(branch.kinds)))
        if task not in known:
            raise CheckError(
                f"{name} branches on {', '.join(branch.kinds)} at victim {branch.victim}"
            )
        for routes, some in zip(lists, allowed, strict=True):
            some &= sides(routes, task, branch.robot, branch.until, branch.high)
    return tuple(allowed)


def sides(
    routes: RouteList, task: Task, robot: int | None, until: float | None, high: bool
) -> Bools:
    """The routes on one side of a branch.

    Of a robot: it serves the task on the high side, and not on the low one. Of a time: the task is done
    by then on the low side, and later on the high one.
    """
    when = routes.when(task)
    if until is not None:
        last = routes.until(exact(until))
        return np.asarray((when < 0) | ((when > last) if high else (when <= last)))
    if (routes.network.robot == robot) == high:
        return np.asarray(when >= 0) if high else np.ones(len(when), dtype=bool)
    return np.asarray(when < 0)
