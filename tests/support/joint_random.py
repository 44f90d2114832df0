"""Joint problems drawn on a plane, and routes without thought."""

from __future__ import annotations

import numpy as np

from msmrta_opt.routing.problem import Routes, RoutingData


def random_data(
    seed: int, n_robots: int, n_victims: int, n_needs: int, *, back: bool = False
) -> RoutingData:
    """Robots and victims on a plane, walking along its axes; `n_needs` requirements of 3 kinds."""
    random = np.random.RandomState(seed)
    start, place = random.randint(0, 12, (n_robots, 2)), random.randint(0, 12, (n_victims, 2))
    speed = random.choice([0.5, 1.0, 2.0], n_robots)
    leave = np.abs(start[:, None] - place).sum(axis=2) / speed[:, None]
    between = np.abs(place[:, None] - place).sum(axis=2) / speed[:, None, None]
    needed = np.zeros(n_victims * 3, dtype=bool)
    needed[random.choice(needed.size, n_needs, replace=False)] = True
    has = random.random_sample((n_robots, 3)) < 0.6
    has[random.randint(n_robots, size=3), range(3)] = True
    return RoutingData(
        leave=leave,
        length=between,
        back=leave if back else np.zeros_like(leave),
        service=random.randint(0, 9, (n_victims, 3)).astype(float),
        able=has[:, None, :] & needed.reshape(n_victims, 3)[None],
        priority=random.randint(0, 4, n_victims).astype(float),
        endurance=np.full(n_robots, np.inf),
        longest_walk=np.full(n_robots, np.inf),
    )


def limited(data: RoutingData, endurance: float, longest_walk: float) -> RoutingData:
    """The same with the limits given."""
    arrays = {name: getattr(data, name) for name in RoutingData.__dataclass_fields__}
    n = data.n_robots
    limits = {"endurance": np.full(n, endurance), "longest_walk": np.full(n, longest_walk)}
    return RoutingData(**{**arrays, **limits})


def first_come(data: RoutingData) -> Routes:
    """Routes without thought: each requirement by the first robot that can, victims in order."""
    routes = []
    for r in range(data.n_robots):
        mine = data.able[r] & ~data.able[:r].any(axis=0)
        visits = ((v, tuple(int(k) for k in np.flatnonzero(mine[v]))) for v in range(len(mine)))
        routes.append(tuple((v, kinds) for v, kinds in visits if kinds))
    return tuple(routes)
