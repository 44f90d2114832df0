"""Points of the edge formulation and routes, each from the other; and each robot's share of a point."""

from __future__ import annotations

import numpy as np

from ...arrays import Floats
from ..problem import Routes, RoutingData, Visit
from .edge_variables import EdgeVariables
from .separation import Support

_TINY = 1e-9


def point_of(variables: EdgeVariables, routes: Routes) -> Floats:
    """The variables' values on `routes`, ``(n_columns,)``."""
    x = np.zeros(variables.n_columns)
    y, f, last, a, e = (variables.start(name) for name in "yflae")
    service, edge = variables.service_place, variables.edge_place
    for r, route in enumerate(routes):
        for (v, kinds), onward in zip(route, [*route[1:], None], strict=False):
            pair = int(variables.pair_of[r, v])
            x[y + pair] = 1.0
            for k in kinds:
                if service:
                    x[a + service[pair, k]] = 1.0
            if onward is not None:
                x[e + edge[r, min(v, onward[0]), max(v, onward[0])]] = 1.0
        if route:
            x[f + variables.pair_of[r, route[0][0]]] = 1.0
            x[last + variables.pair_of[r, route[-1][0]]] = 1.0
    if variables.objective.only_last:
        x[variables.start("T")] = variables.objective.value(variables.data, routes)
    return x


def point_supports(variables: EdgeVariables, x: Floats) -> list[Support]:
    """The point `x`, ``(n_columns,)``, of each robot that moves in it."""
    shape = variables.data.can_visit.shape
    robot, victim = variables.pairs.T
    planes = []
    for name in "yfl":
        plane = np.zeros(shape)
        plane[robot, victim] = x[variables.start(name) :][: variables.n_pairs]
        planes.append(plane)
    weight = x[variables.start("e") :]
    supports = []
    for r, slice_ in enumerate(variables.edge_of_robot):
        if not planes[0][r].any():
            continue
        used = np.flatnonzero(weight[slice_] > _TINY) + slice_.start
        ends = variables.edges[used]
        y, first, last = (plane[r] for plane in planes)
        supports.append(Support(r, y, first, last, ends[:, 1], ends[:, 2], weight[used]))
    return supports


def routes_of(variables: EdgeVariables, x: Floats) -> Routes | None:
    """The routes of an integral point, ``(n_columns,)``; none if its edges are not paths.

    Visits that serve nothing are left out. Where the program does not say who serves what, the
    first able visitor does.
    """
    data = variables.data
    order: list[list[int]] = [[] for _ in range(data.n_robots)]
    for support in point_supports(variables, x):
        path = _path(support)
        if path is None:
            return None
        order[support.robot] = path
    visits: list[dict[int, list[int]]] = [{} for _ in range(data.n_robots)]
    if len(variables.services):
        chosen = variables.services[x[variables.start("a") :][: len(variables.services)] > 0.5]
        for pair, k in chosen:
            r, v = variables.pairs[pair]
            visits[r].setdefault(int(v), []).append(int(k))
    else:
        visits = _share(data, order)
    routes: list[tuple[Visit, ...]] = []
    for r, path in enumerate(order):
        if not set(visits[r]) <= set(path):
            return None
        routes.append(tuple((v, tuple(sorted(visits[r][v]))) for v in path if v in visits[r]))
    return tuple(routes)


def _path(support: Support) -> list[int] | None:
    """The victims from first to last, if the edges are one path through all that are visited."""
    first, last = np.flatnonzero(support.first > 0.5), np.flatnonzero(support.last > 0.5)
    if len(first) != 1 or len(last) != 1:
        return None
    beside: dict[int, list[int]] = {}
    for i, j, w in zip(support.tail, support.head, support.weight, strict=True):
        if w > 0.5:
            beside.setdefault(int(i), []).append(int(j))
            beside.setdefault(int(j), []).append(int(i))
    path, before, here = [], -1, int(first[0])
    while True:
        path.append(here)
        onward = [v for v in beside.get(here, []) if v != before]
        if len(onward) != (0 if here == last[0] else 1) or len(path) > len(support.visit):
            break
        if not onward:
            break
        before, here = here, onward[0]
    whole = len(path) == int((support.visit > 0.5).sum()) and path[-1] == last[0]
    return path if whole else None


def _share(data: RoutingData, order: list[list[int]]) -> list[dict[int, list[int]]]:
    """Every requirement to the able visitor that can serve the largest number at that victim."""
    visits: list[dict[int, list[int]]] = [{} for _ in order]
    for v in range(data.n_victims):
        there = [r for r, path in enumerate(order) if v in path]
        there.sort(key=lambda r: -int(data.able[r, v].sum()))
        for k in np.flatnonzero(data.required[v]):
            for r in there:
                if data.able[r, v, k]:
                    visits[r].setdefault(v, []).append(int(k))
                    break
    return visits
