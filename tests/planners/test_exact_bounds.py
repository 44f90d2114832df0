"""The exact planner's bounds on small random missions: never above any plan, at any time limit."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from support.amounts import sample

from msmrta_opt.routing.objectives import OBJECTIVES

LIMITS = (0.0, 0.05, 0.2)
CHUNKS = 8
MISSIONS_EACH = 8


@pytest.fixture(scope="module")
def fuzz() -> ModuleType:
    """The script as a module."""
    folder = str(Path(__file__).parents[2] / "benchmarks")
    sys.path.insert(0, folder)
    try:
        return importlib.import_module("fuzz")
    finally:
        sys.path.remove(folder)


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send on Windows")
@pytest.mark.parametrize("part", sample(range(CHUNKS), 4))
def test_no_bound_is_above_any_plan_and_a_stop_at_any_moment_leaves_one(
    fuzz: ModuleType, part: int
) -> None:
    numbers = range(part * MISSIONS_EACH, (part + 1) * MISSIONS_EACH)
    assert [line for n in numbers for line in fuzz.violations(n, LIMITS, list(OBJECTIVES))] == []


def test_the_missions_differ_in_what_matters(fuzz: ModuleType) -> None:
    made = [fuzz.mission(n) for n in range(CHUNKS * MISSIONS_EACH)]
    for option in ("return_to_start", "endurance", "longest_walk"):
        assert any(option in options for _, options in made)
    assert any(not options for _, options in made)
    assert {mission.n_robots for mission, _ in made} == {1, 2, 3, 4, 5}
    assert {mission.n_victims for mission, _ in made} == set(range(10))
    assert any(0.0 in mission.priority for mission, _ in made)


# That the search for violations finds them.


def known(fuzz: ModuleType, **said: Any) -> list[str]:
    lines: list[str] = fuzz.Known(**said).contradictions()
    return lines


def test_a_bound_above_the_plan_of_another_run_is_a_violation(fuzz: ModuleType) -> None:
    values = {"a": 12.0, "b": 10.0}
    (line,) = known(fuzz, values=values, bounds={"a": 11.0, "b": 10.0})
    assert "bound 11.0 of the run a is above 10.0 of b" in line


def test_a_plan_that_another_run_says_cannot_be_is_a_violation(fuzz: ModuleType) -> None:
    assert known(fuzz, impossible=["a"]) == []
    assert len(known(fuzz, values={"b": 10.0}, impossible=["a"])) == 1


@pytest.mark.parametrize("limit", [0.0, 0.2])
def test_a_planner_that_overstates_its_bound_is_found_out(
    fuzz: ModuleType, limit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = importlib.import_module("msmrta_opt.planners.exact")
    honest = exact._certificate

    def boastful(*given: Any) -> Any:
        certificate = honest(*given)
        return certificate.model_copy(update={"bound": certificate.objective + 1.0})

    monkeypatch.setattr(exact, "_certificate", boastful)
    number = next(n for n in range(10) if fuzz.mission(n)[0].n_victims > 3)
    assert any(
        "above" in line for line in fuzz.violations(number, [limit], ("total_time", "makespan"))
    )
