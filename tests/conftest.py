"""Fixtures that all tests share, and random tests that are the same on every run."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from support.amounts import QUICK_EXAMPLES
from support.by_hand import breadth_first as breadth_first
from support.by_hand import mission as mission
from support.by_hand import plan as plan

from msmrta_opt.mission.instance import Instance

# How fast a machine is must not decide whether a test passes.
settings.register_profile(
    "whole", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("quick", settings.get_profile("whole"), max_examples=QUICK_EXAMPLES)
QUICK = "not slow"
"""The tests that are chosen by default, with a fourth of the random examples."""

ROOT = Path(__file__).parents[1]
COMPILED = (
    "msmrta_opt.mission.a_star",
    "msmrta_opt.mission.breadth_first",
    "msmrta_opt.routing.branch_and_cut.compiled_cut",
    "msmrta_opt.routing.heuristics.compiled_steps",
    "msmrta_opt.stages.random_swap",
)
INSTANCES = ROOT / "instances"
LONG = (
    "test_notebooks.py", "test_readme.py", "test_killed.py",
    "cli/test_screen.py", "test_packaging.py", "test_cluster.py",
    "report/test_page.py", "plots/test_names.py", "cli/test_compare.py",
)  # fmt: skip
"""Files whose tests are long, or wait, or share what takes long to make; the longest first."""


def pytest_configure(config: pytest.Config) -> None:
    """Choose how many examples; in a fresh checkout compile the inner loops once for all processes."""
    settings.load_profile("quick" if config.option.markexpr == QUICK else "whole")
    if getattr(config.option, "numprocesses", None) and not any(
        (ROOT / "msmrta_opt").rglob("*.nbi")
    ):
        compiling = [
            subprocess.Popen([sys.executable, "-c", f"import {name}"], stderr=subprocess.DEVNULL)
            for name in COMPILED
        ]
        for process in compiling:  # where there is no numba, each fails at once
            process.wait()


def pytest_xdist_auto_num_workers() -> int:
    """One process more than there are cores: some tests wait for what they have started."""
    return (os.cpu_count() or 1) + 1


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Begin each process' share with whole files of long tests: none is left over for the end."""
    n_shares = getattr(config, "workerinput", {}).get("workercount", 1)
    files: dict[str, list[pytest.Item]] = {name: [] for name in LONG}
    others: list[pytest.Item] = []
    for item in items:
        path = item.path.as_posix()
        name = next((name for name in LONG if path.endswith(f"/{name}")), None)
        (others if name is None else files[name]).append(item)
    ends = [len(items) * (i + 1) // n_shares for i in range(n_shares)]
    items.clear()
    for i, end in enumerate(ends):  # shares follow each other, all of a size
        own = [item for name in LONG[i::n_shares] for item in files[name]]
        n_others = max(end - len(items) - len(own), 0) if end < ends[-1] else len(others)
        items += [*own, *others[:n_others]]
        del others[:n_others]


@pytest.fixture(scope="session")
def instances_dir() -> Path:
    """The folder of the missions that come with the package."""
    return INSTANCES


@pytest.fixture(scope="session")
def paper() -> Instance:
    """The mission of the paper's Tables 1 and 2."""
    return Instance.read(INSTANCES / "paper.json")
