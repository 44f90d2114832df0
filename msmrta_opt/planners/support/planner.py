"""What a planner is: a name, one function from an instance to a plan, and what it declares of itself."""

from __future__ import annotations

import importlib
import inspect
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

import numpy as np

from ..._version import __version__
from ...mission.errors import MsmrtaError
from ...mission.grid import GridMap
from ...mission.plan import Limit, Plan
from ...optimise import registry
from ...optimise.solvers import solvers

RESULTS_DEPEND_ON = ("cvxpy", "highspy", "networkx", "numba", "numpy", "scikit-learn", "scipy")
CLUSTERING = ("msmrta_opt.stages.random_swap",) if find_spec("numba") else ("sklearn.cluster",)
SOLVING = (
    *("cvxpy", "cvxpy.cvxcore.python.cppbackend", "highspy", "scipy.optimize"),
    *(f"msmrta_opt.optimise.compile.{name}" for name in ("coefficients", "fingerprint")),
)
IMPROVING = ("msmrta_opt.routing.heuristics.compiled_search",)
"""What planners import on first use: to cluster, to solve programs, to improve routes."""


@dataclass(frozen=True, eq=False)
class Planner:
    """A way to plan, ``run(instance, **options)``, with all that others need to know about it.

    Parameters
    ----------
    name, title : str
        What it is called, and what it is.
    run : function
        From an instance, and options by keyword, to a plan.
    defaults : dict of str to value, optional
        Its options; by default the keywords of `run`.
    check : function of options, optional
        Raises `InputError` for values that are wrong, before anything is planned.
    limits : tuple of str
        Those of `mission.plan.LIMITS` that every robot of its plans keeps over its whole route.
    improves_itself : bool
        Whether local search is part of it already.
    formulations : function from options to names, optional
        The formulations that its plans depend on, given these options.
    libraries : tuple of str
        Modules that it imports on first use, to be loaded before its time is taken; what finds
        distances and walks is loaded for all.
    """

    name: str
    title: str
    run: Callable[..., Plan]
    defaults: Mapping[str, Any] | None = None
    check: Callable[[Mapping[str, Any]], object] | None = None
    limits: tuple[Limit, ...] = ()
    improves_itself: bool = False
    formulations: Callable[[Mapping[str, Any]], Iterable[str]] | None = None
    libraries: tuple[str, ...] = ()

    @property
    def options(self) -> dict[str, Any]:
        """Its options with their defaults; functions to call back are none of them."""
        if self.defaults is not None:
            return dict(self.defaults)
        given = inspect.signature(self.run).parameters.values()
        options = {p.name: p.default for p in given if p.kind is p.KEYWORD_ONLY}
        return {name: default for name, default in options.items() if name != "callbacks"}

    @property
    def heeds_objective(self) -> bool:
        """Whether it minimises an objective that it is given."""
        return "objective" in self.options

    def formulations_of(self, options: Mapping[str, Any]) -> tuple[str, ...]:
        """The names of the formulations that its plans with these `options` depend on."""
        if self.formulations is None:
            return ()
        takes = self.options
        return tuple(self.formulations({k: x for k, x in options.items() if k in takes}))

    def parameters_of(self, options: Mapping[str, Any]) -> tuple[str, ...]:
        """The parameters of these formulations, which it takes like options; none of broken files."""
        found: dict[str, None] = {}
        for name in self.formulations_of(options):
            with suppress(MsmrtaError):
                found |= dict.fromkeys(registry.get(name).spec.parameters)
        return tuple(found)

    def load(self, options: Mapping[str, Any]) -> None:
        """Import what a plan with these `options` needs, so that planning time is planning alone.

        What cannot be loaded is left to the planner, which says so where it misses it.
        """
        walk_a_step()
        load(self.libraries)
        with suppress(MsmrtaError):
            for name in self.formulations_of(options):
                solvers()
                registry.get(name)
        versions()


@cache
def walk_a_step() -> None:
    """Load whichever engine finds distances and walks here."""
    grid = GridMap(np.ones((1, 2), dtype=bool))
    here, there = (0, 0), (0, 1)
    grid.fields([here])
    grid.between([here], [there])
    grid.lengths([here], [there])
    grid.walks([here], [there])
    grid.nearest([here], [there])
    grid.search.components()


def load(modules: Iterable[str]) -> None:
    """Import those of `modules` that are there."""
    for module in modules:
        with suppress(ImportError):
            importlib.import_module(module)


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
