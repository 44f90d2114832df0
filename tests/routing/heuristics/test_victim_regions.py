"""Regions: which columns lie in them, where they are drawn, and that taking turns proves the same."""

from __future__ import annotations

import numpy as np
import pytest

from msmrta_opt.routing.branch_and_cut import search as strong
from msmrta_opt.routing.branch_and_cut.cutting_plane import Relaxed
from msmrta_opt.routing.branch_and_cut.edge_formulation import Columns
from msmrta_opt.routing.branch_and_cut.search import _Run
from msmrta_opt.routing.heuristics.victim_regions import GROWTH, Regions
from msmrta_opt.routing.incumbent import Progress
from msmrta_opt.routing.objectives import value
from msmrta_opt.routing.parameters import Parameters
from msmrta_opt.routing.problem import RoutingData, faults
from msmrta_opt.routing.stop import MaximumRuntime

from .test_ruin_and_recreate import first_come, random_data

BOTH: tuple[str, ...] = ("total_time", "makespan")


def begun(
    kind: type[_Run], data: RoutingData, objective: str, seconds: float, seed: int
) -> tuple[_Run, Progress]:
    progress = Progress(data, objective, first_come(data), stop=MaximumRuntime(seconds))
    return kind(progress, seed, Parameters()), progress


def columns_of(seed: int, objective: str) -> Columns:
    data = random_data(seed, 3, 10, 16)
    return Columns.of(data, objective, value(data, first_come(data), objective))


def victims(columns: Columns, chosen: np.ndarray) -> set[int]:
    """Those that the chosen columns have to do with, told by the columns' blocks."""
    pairs = columns.pairs[:, 1].tolist()
    of: list[tuple[int, ...]] = []
    for block in columns.blocks:
        size = block.stop - block.start
        if block.name in "yfl":
            of += [(v,) for v in pairs]
        elif block.name == "a":
            of += [(pairs[pair],) for pair in columns.services[:, 0]]
        elif block.name == "e":
            of += [(i, j) for _, i, j in columns.edges.tolist()]
        else:
            of += [()] * size
    assert len(of) == columns.n_columns
    return {v for ends, here in zip(of, chosen, strict=True) if here for v in ends}


@pytest.mark.parametrize("objective", BOTH)
@pytest.mark.parametrize("seed", range(3))
def test_a_region_holds_all_columns_between_its_victims_and_no_others(
    seed: int, objective: str
) -> None:
    columns = columns_of(seed, objective)
    regions = Regions(columns, np.zeros(columns.n_columns), seed)
    for _ in range(5):
        chosen = regions.draw()
        inside = victims(columns, chosen)
        assert 0 < len(inside) <= round(regions.size) < columns.data.n_victims
        robot, i, j = columns.edges.T
        edges = chosen[columns.start("e") :]
        here = list(inside)
        assert (edges == (np.isin(i, here) & np.isin(j, here))).all()
        first = columns.start("f")
        visits = chosen[first : first + columns.n_pairs]
        assert (visits == np.isin(columns.pairs[:, 1], here)).all()
        if objective == "makespan":
            assert chosen[columns.start("T")]
        assert set(robot[edges]) <= set(columns.pairs[:, 0])


def test_regions_lie_where_the_relaxation_is_undecided() -> None:
    columns = columns_of(0, "total_time")
    edge = len(columns.edges) // 2
    point = np.zeros(columns.n_columns)
    point[columns.start("e") + edge] = 0.5
    regions = Regions(columns, point)
    regions.size = 1.0
    ends = set(columns.edges[edge, 1:].tolist())
    for _ in range(10):
        assert victims(columns, regions.draw()) <= ends


def test_regions_grow_until_they_hold_all_and_shrink_to_the_smallest() -> None:
    columns = columns_of(1, "total_time")
    regions = Regions(columns, np.zeros(columns.n_columns))
    first = regions.size
    regions.shrink()
    assert regions.size == first
    regions.grow()
    assert regions.size == pytest.approx(first * GROWTH)
    regions.shrink()
    assert regions.size == pytest.approx(first)
    while not regions.exhausted:
        assert not regions.draw().all()
        regions.grow()
    assert regions.draw().all()


@pytest.mark.parametrize("objective", BOTH)
def test_region_by_region_routes_get_better_and_stay_feasible(objective: str) -> None:
    data = random_data(1, 7, 14, 24)
    run, progress = begun(_Run, data, objective, 30.0, 1)
    before = progress.value
    relaxed = run.relax()
    assert not progress.done()
    run.by_regions(relaxed, progress.began + 5.0)
    assert progress.value < before
    assert faults(data, progress.routes) == []


def test_a_search_in_pieces_comes_to_the_same_as_one_tree(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(strong, "EASY", 0.0)
    data = random_data(1, 7, 14, 24)
    took: list[str] = []

    class Noted(_Run):
        def by_robots(self, relaxed: Relaxed, seconds: float) -> None:
            took.append("robots")
            super().by_robots(relaxed, seconds)

        def by_regions(self, relaxed: Relaxed, until: float) -> None:
            took.append("regions")
            super().by_regions(
                relaxed, min(until, self.progress.began + self.progress.spent() + 5.0)
            )

        def polish(self, relaxed: Relaxed) -> None:
            """Nothing, so that something is left to find."""

    worth = []
    for whole in (True, False):
        run, progress = begun(Noted, data, "total_time", 60.0, 1)
        run.close_in(whole=whole)
        assert faults(data, progress.routes) == []
        assert progress.open() <= 1e-6
        worth.append(progress.value)
    assert worth[0] == pytest.approx(worth[1])
    assert took == ["robots", "regions"]


def test_seeking_ends_with_its_share_of_the_time() -> None:
    data = random_data(9, 8, 30, 55)
    run, progress = begun(_Run, data, "makespan", 4.0, 0)
    relaxed = run.relax()
    run.seek(relaxed)
    assert progress.spent() < 4.0 + 5.0
    assert faults(data, progress.routes) == []
