"""Fixtures that all tests share, and random tests that are the same on every run."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from support.by_hand import breadth_first as breadth_first
from support.by_hand import mission as mission
from support.by_hand import plan as plan

from msmrta_opt.mission.instance import Instance

# How fast a machine is must not decide whether a test passes.
settings.register_profile(
    "default", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("default")

INSTANCES = Path(__file__).parents[1] / "instances"


@pytest.fixture(scope="session")
def instances_dir() -> Path:
    """The folder of the missions that come with the package."""
    return INSTANCES


@pytest.fixture(scope="session")
def paper() -> Instance:
    """The mission of the paper's Tables 1 and 2."""
    return Instance.read(INSTANCES / "paper.json")
