"""A short form of the fuzz of programs: nothing that is said about the first of every shape is wrong."""

from __future__ import annotations

import importlib
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from msmrta_opt.diagnosis.conflict import find_conflict
from msmrta_opt.optimise.solve import solve_program

FEW = range(57)
MANY = range(57, 2_000)


@pytest.fixture(scope="module")
def fuzz() -> Iterator[ModuleType]:
    """The script as a module."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
    yield importlib.import_module("fuzz_programs")
    sys.path.pop(0)


def assert_nothing_is_wrong(
    fuzz: ModuleType, numbers: range, folder: Path, *, scaled: bool = False
) -> None:
    counts: Counter[str] = Counter()
    make = fuzz.scaled_trial if scaled else fuzz.trial
    for number in numbers:
        assert fuzz.examine(make(number), number, fuzz.SOLVERS, folder, counts) == []
    kind = "badly scaled" if scaled else "well scaled"
    assert counts[f"auto, {kind}: optimal"] > 5
    assert counts[f"auto, {kind}: infeasible"] > 0
    assert counts[f"explain, {kind}: infeasible"] > 0
    assert counts["export: written and read"] > 0


def test_random_programs_are_solved_explained_and_written_right(
    fuzz: ModuleType, tmp_path: Path
) -> None:
    assert_nothing_is_wrong(fuzz, FEW, tmp_path)


def test_of_random_badly_scaled_programs_nothing_is_wrong(fuzz: ModuleType, tmp_path: Path) -> None:
    assert_nothing_is_wrong(fuzz, range(40), tmp_path, scaled=True)


@pytest.mark.slow
@pytest.mark.parametrize("scaled", [False, True])
def test_many_random_programs_are_solved_explained_and_written_right(
    fuzz: ModuleType, tmp_path: Path, scaled: bool
) -> None:
    assert_nothing_is_wrong(fuzz, MANY, tmp_path, scaled=scaled)


def test_the_oracle_finds_optima_that_are_known(fuzz: ModuleType) -> None:
    """max 2 x + z, x + 2 z ≤ 7, x ≤ 3 whole, 0 ≤ z ≤ 3: x = 3, z = 2."""
    asked = fuzz.trial(0)
    one = replace(
        asked.program,
        sense="max",
        cost=np.array([2.0, 1.0]),
        matrix=type(asked.program.matrix)(np.array([[1.0, 2.0]])),
        row_lower=np.array([-np.inf]),
        row_upper=np.array([7.0]),
        lower=np.zeros(2),
        upper=np.full(2, 3.0),
        integer=np.array([True, False]),
    )
    trial = replace(asked, program=one, low=one.lower, high=one.upper)
    assert fuzz.truth(trial).narrow == pytest.approx(8, abs=1e-9)
    whole = replace(one, integer=np.array([True, True]), row_lower=np.array([12.5]))
    assert fuzz.truth(replace(trial, program=whole)).wide is None


def test_the_fuzz_sees_what_is_wrong(fuzz: ModuleType) -> None:
    """Of two columns of 0 or 1 whose sum is 1, one has to be 1."""
    asked = fuzz.trial(0)
    program = replace(
        asked.program,
        sense="min",
        cost=np.array([3.0, 5.0]),
        offset=0.0,
        matrix=type(asked.program.matrix)(np.array([[1.0, 1.0], [1.0, 1.0], [1.0, -1.0]])),
        row_lower=np.array([1.0, -np.inf, -np.inf]),
        row_upper=np.array([1.0, 2.0, 5.0]),
        lower=np.zeros(2),
        upper=np.ones(2),
        integer=np.ones(2, dtype=bool),
        columns=(replace(asked.program.columns[0], shape=(2,)),),
        rows=(replace(asked.program.rows[0], shape=(3,)),),
    )
    trial = replace(asked, shape="whole", program=program, low=np.zeros(2), high=np.ones(2))
    best = fuzz.truth(trial)
    right = solve_program(program)
    assert fuzz.wrong_with(trial, best, right) == ""
    for other in (
        replace(right, status="infeasible", objective=None, bound=None),
        replace(right, objective=5.0, bound=5.0),
        replace(right, objective=2.0, bound=2.0),
        replace(right, bound=4.0),
        replace(right, status="unbounded"),
        replace(right, status="error"),
        replace(right, status="claimed"),
    ):
        assert fuzz.wrong_with(trial, best, other) != ""
    infeasible = replace(program, row_upper=np.array([1.0, 2.0, -2.0]))
    trial = replace(trial, program=infeasible)
    best, said = fuzz.truth(trial), find_conflict(infeasible)
    assert said.rows == ("row 2",)
    assert fuzz.wrong_with_explanation(trial, best, said) == ""
    for untrue in (
        replace(said, status="feasible"),
        replace(said, rows=("row 0", "row 1")),
        replace(said, rows=("row 0", "row 2")),
    ):
        assert fuzz.wrong_with_explanation(trial, best, untrue) != ""
