"""The registry of solvers: each file of this folder that has a ``SOLVER``, found by name.

To add one, add a file. Nothing of a solver is imported until it is asked to solve.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from ...mission.errors import InputError
from ...mission.suggestions import meant
from .base import Ability, Options, Outcome, Solver

__all__ = ["Ability", "Options", "Outcome", "Solver", "get", "solvers"]


@cache
def solvers() -> dict[str, Solver]:
    """All solvers by name, whether installed or not."""
    modules = (
        importlib.import_module(f"{__name__}.{info.name}")
        for info in pkgutil.iter_modules(__path__)
    )
    found = [module.SOLVER for module in modules if hasattr(module, "SOLVER")]
    return {solver.name: solver for solver in sorted(found, key=lambda solver: solver.rank)}


def get(name: str) -> Solver:
    """The solver called `name`.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    known = solvers()
    if name not in known:
        near = meant(name, ("auto", *known))
        raise InputError(
            f"no solver {name!r}{near}; there are auto, {', '.join(known)}", field="solver"
        )
    return known[name]
