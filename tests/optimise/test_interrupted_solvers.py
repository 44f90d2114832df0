"""Every solver ends once the user asks, with its incumbent: on a program that none of them finishes.

The process asks itself, so that nothing depends on the clock.
"""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from support.misbehaviour import cpsat_until_its_first_incumbent
from support.programs import program

from msmrta_opt import interruption
from msmrta_opt.diagnosis.conflict import find_conflict
from msmrta_opt.isolation import Worker
from msmrta_opt.mission.instance import Instance
from msmrta_opt.optimise.check import violations
from msmrta_opt.optimise.compile import compile_for
from msmrta_opt.optimise.program import Program
from msmrta_opt.optimise.solve import solve_program
from msmrta_opt.optimise.solvers import Options, glpk, highs
from msmrta_opt.stages.data import stage_data


@pytest.fixture(scope="module")
def endless() -> Program:
    """A hundred things of ten weights each, of which half may be carried: years of branch and bound."""
    random = np.random.default_rng(1)
    weights = random.integers(1, 1000, (10, 100))
    worth = random.integers(1, 1000, 100) + weights.mean(axis=0).round()
    return program(weights, weights.sum(axis=1) // 2, worth, sense="max")


@pytest.mark.parametrize("solver", ["auto", "highs", "scip", "glpk", "cpsat"])
def test_a_solver_that_is_asked_to_end_ends(
    solver: str, endless: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interruption._now, "of_parent", lambda: True)
    solution = solve_program(endless, solver=solver)
    assert solution.status in ("feasible", "no_solution")
    assert solution.found == (solution.status == "feasible")


@pytest.mark.parametrize("name", ["loops", "rooms", "halls"])
def test_highs_asked_to_end_ends_in_a_model_of_all_routes(
    name: str, instances_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mission = Instance.read(instances_dir / "suite" / f"{name}.json")
    asked = compile_for("joint_routing_mtz", stage_data(mission, "routing")).program()
    monkeypatch.setattr(interruption._now, "of_parent", lambda: True)
    solution = solve_program(asked, solver="highs")
    assert solution.status in ("feasible", "no_solution")
    assert solution.found == (solution.status == "feasible")


def test_an_explanation_that_is_asked_to_end_ends(
    endless: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interruption._now, "of_parent", lambda: True)
    assert find_conflict(endless).status == "unknown"


@pytest.mark.parametrize("sense", ["min", "max"])
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_highs_that_does_not_end_leaves_its_incumbent_and_bound_behind(
    sense: str, offset: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if it were left the moment before it says that it is done."""
    random = np.random.default_rng(2)
    weights = random.integers(1, 1000, (5, 80))
    worth = random.integers(1, 1000, 80) * (1 if sense == "max" else -1)
    trial = program(weights, weights.sum(axis=1) // 2, worth, sense=sense, offset=offset)
    right = highs.run(trial, Options(gap=0.02))
    monkeypatch.setattr(highs, "until_interrupted", lambda work, end, **_: bool(work()) and False)
    found = highs.run(trial, Options(gap=0.02))
    assert (right.status, found.status, found.message) == ("optimal", "feasible", highs.LEFT)
    assert found.x is not None
    assert right.x is not None
    assert violations(trial, found.x) == []
    assert trial.value(found.x) == pytest.approx(trial.value(right.x))
    assert found.bound is not None
    assert trial.sign * (trial.value(found.x) - found.bound) >= 0


def test_cpsat_ends_with_its_incumbent(endless: Program) -> None:
    with Worker() as worker:
        outcome = worker.call(cpsat_until_its_first_incumbent, endless)
    assert outcome.status == "feasible"
    assert violations(endless, outcome.x) == []
    assert outcome.bound >= endless.value(outcome.x)


def test_glpk_leaves_its_incumbent_behind(
    endless: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = tmp_path / "incumbent"
    monkeypatch.setattr(glpk, "TemporaryDirectory", lambda: nullcontext(str(tmp_path)))
    monkeypatch.setattr(
        interruption._now,
        "of_parent",
        lambda: written.exists() and written.read_text().rstrip().endswith("e o f"),
    )
    solution = solve_program(endless, solver="glpk")
    assert solution.status == "feasible"
    assert solution.found
    assert solution.bound is None


def test_half_of_what_glpk_writes_is_no_incumbent() -> None:
    whole = "c Problem:\ns mip 1 2 f 3\ni 1 4\nj 1 0\nj 2 1\ne o f\n"
    assert list(glpk._written(whole, 2)) == [0, 1]
    assert glpk._written(whole[:-4], 2) is None
    assert glpk._written(whole, 3) is None
