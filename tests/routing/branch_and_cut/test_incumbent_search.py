"""The search for incumbents: which columns a region leaves free, and that pieces prove the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.joint_random import first_come, random_data

from msmrta_opt.routing.branch_and_cut.cutting_plane import Relaxation
from msmrta_opt.routing.branch_and_cut.edge_formulation import EdgeFormulation
from msmrta_opt.routing.branch_and_cut.incumbent_search import IncumbentSearch
from msmrta_opt.routing.branch_and_cut.root import Root
from msmrta_opt.routing.branch_and_cut.search import branch_and_cut
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.parameters import BranchAndCutParameters, Parameters
from msmrta_opt.routing.problem import RoutingData, faults
from msmrta_opt.routing.stop import MaximumRuntime

BOTH = ("total_time", "makespan")


def begun(data: RoutingData, objective: str) -> IncumbentSearch:
    """A search after the root relaxation of bad routes."""
    progress = Progress(data, objective, first_come(data))
    formulation = EdgeFormulation.of(data, objective, progress.value)
    relaxation = Relaxation(formulation, routes=progress.routes)
    relaxed = relaxation.solve(proved=lambda bound: progress.raise_bound(bound, "root LP"))
    assert not progress.done()
    return IncumbentSearch(Root(progress, formulation, relaxed, relaxation.seen, 1, Parameters()))


@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", range(3))
def test_each_column_is_about_the_victims_that_its_block_says(seed: int, objective: str) -> None:
    data = random_data(seed, 3, 10, 16)
    formulation = EdgeFormulation.of(data, objective, value(data, first_come(data), objective))
    pairs = formulation.pairs[:, 1].tolist()
    of: list[set[int]] = []
    for block in formulation.blocks:
        if block.name in "yfl":
            of += [{v} for v in pairs]
        elif block.name == "a":
            of += [{pairs[pair]} for pair in formulation.services[:, 0]]
        elif block.name == "e":
            of += [{i, j} for _, i, j in formulation.edges.tolist()]
        else:
            of += [{data.n_victims}] * (block.stop - block.start)
    assert [set(ends) for ends in formulation.ends.tolist()] == of


@pytest.mark.parametrize("objective", BOTH)
def test_region_by_region_routes_get_better_and_stay_feasible(objective: str) -> None:
    search = begun(random_data(1, 7, 14, 24), objective)
    before = search.progress.value
    search.by_victim_regions(MaximumRuntime(5))
    assert search.progress.value < before
    assert faults(search.data, search.progress.routes) == []


def test_a_point_a_hair_below_its_bounds_splits_victims_all_the_same() -> None:
    search = begun(random_data(8, 7, 12, 20), "total_time")
    search.relaxed = replace(search.relaxed, point=search.relaxed.point - 1e-9)
    before = search.progress.value
    search.by_robot_subsets(branch_and_cut, seconds=20)
    assert search.progress.value < before


def test_a_search_in_pieces_comes_to_the_same_as_one_tree() -> None:
    data = random_data(1, 7, 14, 24)
    phases = {}
    for name, many in {"pieces": 1, "one tree": 100}.items():
        # No program is easy, and nothing is left to local search.
        tuning = BranchAndCutParameters(many_robots=many, easy_share=0.0, polish_share=0.0)
        progress = Progress(data, "total_time", first_come(data), stop=MaximumRuntime(600))
        branch_and_cut(progress, seed=1, parameters=Parameters(branch_and_cut=tuning))
        assert faults(data, progress.routes) == []
        assert progress.open() <= 1e-6
        phases[name] = progress.value
    assert phases["pieces"] == pytest.approx(phases["one tree"])


def test_without_robots_to_split_victims_between_there_is_nothing_to_draw_by() -> None:
    search = begun(random_data(8, 7, 12, 20), "total_time")
    search.relaxed = replace(search.relaxed, point=np.zeros_like(search.relaxed.point))
    search.by_robot_subsets(branch_and_cut, seconds=20)
    assert faults(search.data, search.progress.routes) == []
