"""The compiled search: what it keeps from step to step, and which robots it asks."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from support.joint_random import first_come, limited, random_data

from msmrta_opt.routing.heuristics.compiled_search import CompiledSearch
from msmrta_opt.routing.objectives import OBJECTIVES
from msmrta_opt.routing.parameters import HeuristicsParameters
from msmrta_opt.routing.problem import RoutingData, faults, times
from msmrta_opt.routing.stop import MaximumIterations


def searched(
    data: RoutingData, objective: str, parameters: HeuristicsParameters, iterations: int, seed: int
) -> CompiledSearch:
    search = CompiledSearch(data, first_come(data), OBJECTIVES[objective], parameters, seed)
    search.run(MaximumIterations(iterations), lambda _: None)
    return search


@pytest.mark.parametrize("few", [False, True])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_cost_that_it_keeps_is_that_of_its_routes(objective: str, few: bool) -> None:
    aim = OBJECTIVES[objective]
    # Few neighbours and candidates: most robots are then not asked.
    some = {"neighbours": 5, "candidates": 3} if few else {}
    for seed in range(4):
        data = random_data(seed, 12, 30, 50, back=bool(seed % 2))
        if seed > 1:
            longest = times(data, first_come(data)).busy.max()
            data = limited(data, longest, longest)
        search = searched(data, objective, HeuristicsParameters(**some), 2000, seed)
        found = search.best_routes()
        assert faults(data, found) == []
        kept = aim.value(data, found)
        assert kept < aim.value(data, first_come(data))
        # Among equal makespans the smaller total is better.
        kept += 1e-4 * times(data, found).busy.sum() if aim.only_last else 0.0
        assert search.state.cost[1] == pytest.approx(kept)


def test_whatever_a_step_changed_is_put_back_where_it_is_not_kept() -> None:
    data = random_data(2, 5, 20, 35)
    search = searched(data, "total_time", HeuristicsParameters(), 500, 1)
    state, first = search.state, search.problem.first
    for r, n in enumerate(state.length.tolist()):
        route = state.route[r, :n].tolist()
        assert np.flatnonzero(state.at[r] >= 0).tolist() == sorted(route)
        assert [int(state.at[r, v]) for v in route] == list(range(n))
        served = {g for v in route for g in range(first[v], first[v + 1]) if state.who[g] == r}
        assert served == set(np.flatnonzero(state.who == r).tolist())
        travel = sum(data.between[r, v, w] for v, w in itertools.pairwise(route))
        travel += data.leave[r, route[0]] + data.back[r, route[-1]] if route else 0.0
        service = sum(float(search.problem.service[g]) for g in served)
        assert state.travel[r] == pytest.approx(travel)
        assert state.busy[r] == pytest.approx(travel + service)
