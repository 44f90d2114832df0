"""What a planner is: a name, options of its own, and one function from an instance to a plan."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from ..._version import __version__
from ...mission.plan import Plan

RESULTS_DEPEND_ON = ("cvxpy", "highspy", "networkx", "numpy", "scikit-learn", "scipy")


@dataclass(frozen=True)
class Planner:
    """A way to plan: ``run(instance, **options)``."""

    name: str
    title: str
    run: Callable[..., Plan] = field(compare=False, repr=False)


class Stopwatch:
    """Wall time per named stage, in seconds."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        """Add the time of the ``with`` block to `stage`."""
        began = time.perf_counter()
        try:
            yield
        finally:
            passed = time.perf_counter() - began
            self.seconds[stage] = self.seconds.get(stage, 0.0) + passed


@cache
def _versions() -> dict[str, str]:
    found = {"msmrta_opt": __version__, "python": sys.version.split()[0]}
    for package in RESULTS_DEPEND_ON:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def versions() -> dict[str, str]:
    """Versions of what a plan's content depends on."""
    return dict(_versions())
