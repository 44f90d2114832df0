"""A short form of the fuzz of programs: nothing that is said about the first few hundred is wrong."""

from __future__ import annotations

import importlib
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="module")
def fuzz() -> ModuleType:
    """The script as a module."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
    try:
        return importlib.import_module("fuzz_programs")
    finally:
        sys.path.pop(0)


@pytest.mark.parametrize("first", range(0, 140, 35))
def test_random_programs_are_solved_and_explained_right(fuzz: ModuleType, first: int) -> None:
    counts: Counter[str] = Counter()
    for number in range(first, first + 35):
        assert fuzz.examine(number, ["auto", "highs", "scip", "glpk", "cpsat"], counts) == []
    assert counts["auto: optimal"] > 5
    assert counts["auto: infeasible"] > 0
