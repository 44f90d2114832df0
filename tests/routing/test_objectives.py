"""The table of objectives: one entry is all that a new objective needs."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import pytest
from support.joint_cases import any_routes, on_a_line, small_mission
from support.joint_oracle import minimum
from support.joint_random import first_come, random_data
from support.searches import closed_in

from msmrta_opt.mission.errors import InputError
from msmrta_opt.mission.metrics import METRICS
from msmrta_opt.optimise.registry import get
from msmrta_opt.routing import combinatorial_bounds
from msmrta_opt.routing.combinatorial_bounds import latency_bound
from msmrta_opt.routing.heuristics.ruin_and_recreate import ruin_and_recreate
from msmrta_opt.routing.methods import METHODS
from msmrta_opt.routing.objectives import OBJECTIVES, objective_of, value
from msmrta_opt.routing.stop import MaximumIterations


@pytest.mark.parametrize("name", OBJECTIVES)
def test_what_an_entry_names_exists(name: str) -> None:
    entry = OBJECTIVES[name]
    assert entry.name == name in METRICS
    assert entry.method in METHODS
    formulation, parameters = entry.model
    spec = get(formulation).spec
    assert spec.stage == "routing"
    assert set(parameters) <= set(spec.parameters)


@pytest.mark.parametrize("name", OBJECTIVES)
def test_its_bound_at_once_is_below_every_solution(name: str) -> None:
    for seed in range(20):
        data = random_data(seed, 2, 3, 5)
        assert 0 <= OBJECTIVES[name].bound(data) <= minimum(data, name) + 1e-9


def test_an_objective_that_is_none_is_refused_with_those_there_are() -> None:
    for wrong in ("duration", None, 3):
        with pytest.raises(InputError, match=r"objective: .*; give one of total_time, makespan"):
            objective_of(wrong)


def test_one_entry_is_enough_for_every_search() -> None:
    """The same as the makespan under another name, and half of it under a third."""
    makespan = OBJECTIVES["makespan"]
    data = small_mission(1, 3, 6)
    own = replace(makespan, name="own")
    routes, bound = closed_in(data, own, any_routes(data))
    assert bound.value == pytest.approx(minimum(data, "makespan"))
    assert value(data, routes, own) == pytest.approx(bound.value)
    found = ruin_and_recreate(data, any_routes(data), own, stop=MaximumIterations(200))
    same = ruin_and_recreate(data, any_routes(data), "makespan", stop=MaximumIterations(200))
    assert found == same


def test_an_objective_of_ones_own_steers_local_search() -> None:
    """The square of each robot's time: by hand, two robots at 0 and victims at 3 and 4 share them."""
    squares = replace(
        OBJECTIVES["total_time"],
        name="squares",
        of_times=lambda busy, completion, priority: sum(time**2 for time in busy),
    )
    data = on_a_line([0, 0], [3, 4], [[[True], [True]]] * 2, returns=True)
    together = (((0, (0,)), (1, (0,))), ())
    assert value(data, together, squares) == 64
    found = ruin_and_recreate(data, together, squares, stop=MaximumIterations(200))
    assert value(data, found, squares) == 64
    apart = (((0, (0,)),), ((1, (0,)),))
    assert value(data, apart, squares) == 36 + 64
    line = on_a_line([0, 10], [3, 7], [[[True], [True]]] * 2)
    one = (((0, (0,)), (1, (0,))), ())
    assert value(line, one, squares) == 49
    found = ruin_and_recreate(line, one, squares, stop=MaximumIterations(200))
    assert value(line, found, squares) == 9 + 9


def test_the_search_starts_from_any_routes() -> None:
    data = random_data(3, 3, 8, 12)
    for name in OBJECTIVES:
        found = ruin_and_recreate(data, first_come(data), name, stop=MaximumIterations(100))
        assert value(data, found, name) <= value(data, first_come(data), name)


def test_the_table_is_read_without_numpy() -> None:
    code = "import sys, msmrta_opt.routing.objectives; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_bound_of_a_mission_too_large_for_the_assignment_is_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    weaker = 0
    for seed in range(15):
        data = random_data(seed, 2, 3, 5)
        exact = latency_bound(data)
        monkeypatch.setattr(combinatorial_bounds, "_LARGEST", 0)
        assert 0 <= latency_bound(data) <= exact + 1e-9
        weaker += latency_bound(data) < exact - 1e-9
        monkeypatch.undo()
    assert 0 < weaker < 15


def test_jobs_of_one_length_on_two_machines_wait_by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Five services of 2 by two robots: done at 2, 2, 4, 4 and 6; each alone would come to 10."""
    monkeypatch.setattr(combinatorial_bounds, "_LARGEST", 0)
    data = on_a_line([0, 0], [0] * 5, [[[True]] * 5] * 2, service=2.0)
    assert latency_bound(data) == 18
