"""The joint problem by brute force: independent of everything that the package solves it with.

Total time and makespan by dynamic programming over sets of requirements (bit masks): what each robot
needs for each set (a shortest path over its victims, Held and Karp), then robot by robot the best
way to share all of them. Latency by trying every sharing and every order. For tests: up to about 14
requirements, for latency up to about 8.
"""

from __future__ import annotations

from itertools import permutations, product

import numpy as np

from msmrta_opt.routing.problem import RoutingData


def minimum(data: RoutingData, objective: str, stability: float = 0.0) -> float:
    """The best value of any routes; infinite if the limits allow none.

    Of the total time `stability` is added for each planned visit that its robot does not make.
    """
    if objective == "latency":
        return _least_latency(data)
    needs = [(int(v), int(k)) for v, k in np.argwhere(data.required)]
    full = (1 << len(needs)) - 1
    best = np.full(full + 1, np.inf)
    best[0] = 0.0
    for r in range(data.n_robots):
        own = _times_of_sets(data, r, needs)
        if stability:
            planned = set(np.flatnonzero(data.planned[r]).tolist())
            made = {s: {v for n, (v, _) in enumerate(needs) if s >> n & 1} for s in own}
            own = {s: time + stability * len(planned - made[s]) for s, time in own.items()}
        after = np.full(full + 1, np.inf)
        for done in range(full + 1):
            if not np.isfinite(best[done]):
                continue
            free = full & ~done
            more = np.array([s for s in own if s & ~free == 0])
            times = np.array([own[s] for s in more])
            value = (
                best[done] + times if objective == "total_time" else np.maximum(best[done], times)
            )
            np.minimum.at(after, done | more, value)
        best = after
    return float(best[full])


def _times_of_sets(data: RoutingData, r: int, needs: list[tuple[int, int]]) -> dict[int, float]:
    """Time of robot `r` for every set of requirements that it can serve within its limits."""
    able = [n for n, (v, k) in enumerate(needs) if data.able[r, v, k]]
    travel = _paths(data, r, sorted({needs[n][0] for n in able}))
    times: dict[int, float] = {0: 0.0}
    for chosen in range(1, 1 << len(able)):
        mine = [able[b] for b in range(len(able)) if chosen >> b & 1]
        walk = travel[frozenset(needs[n][0] for n in mine)]
        time = walk + sum(float(data.service[needs[n]]) for n in mine)
        if walk <= data.longest_walk[r] + 1e-9 and time <= data.endurance[r] + 1e-9:
            times[sum(1 << n for n in mine)] = time
    return times


def _paths(data: RoutingData, r: int, victims: list[int]) -> dict[frozenset[int], float]:
    """Least travel of robot `r` over each set of victims, its way back included."""
    reach = {(frozenset([v]), v): float(data.leave[r, v]) for v in victims}
    layer = dict(reach)
    while layer:
        onward: dict[tuple[frozenset[int], int], float] = {}
        for (done, at), walk in layer.items():
            for v in victims:
                if v not in done:
                    key = (done | {v}, v)
                    onward[key] = min(onward.get(key, np.inf), walk + float(data.between[r, at, v]))
        reach |= onward
        layer = onward
    best: dict[frozenset[int], float] = {}
    for (done, at), walk in reach.items():
        best[done] = min(best.get(done, np.inf), walk + float(data.back[r, at]))
    return best


def _least_latency(data: RoutingData) -> float:
    needs = [(int(v), int(k)) for v, k in np.argwhere(data.required)]
    choices = [np.flatnonzero(data.able[:, v, k]).tolist() for v, k in needs]
    best = np.inf
    for who in product(*choices):
        done = np.zeros((1, data.n_victims))
        for r in range(data.n_robots):
            load: dict[int, float] = {}
            for (v, k), robot in zip(needs, who, strict=True):
                if robot == r:
                    load[v] = load.get(v, 0.0) + float(data.service[v, k])
            own = _completions(data, r, load)
            done = np.maximum(done[:, None, :], own[None, :, :]).reshape(-1, data.n_victims)
        if len(done):
            best = min(best, float((done @ data.priority).min()))
    return best


def _completions(data: RoutingData, r: int, load: dict[int, float]) -> np.ndarray:
    """Completion times of the victims in every order within limits, ``(n_orders, n_victims)``."""
    rows = []
    for order in permutations(load):
        row, clock, walk = np.zeros(data.n_victims), 0.0, 0.0
        for before, v in zip((None, *order), order, strict=False):
            step = data.leave[r, v] if before is None else data.between[r, before, v]
            walk, clock = walk + step, clock + step + load[v]
            row[v] = clock
        home = data.back[r, order[-1]] if order else 0.0
        if walk + home <= data.longest_walk[r] + 1e-9 and clock + home <= data.endurance[r] + 1e-9:
            rows.append(row)
    return np.array(rows).reshape(-1, data.n_victims)
