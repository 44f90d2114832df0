"""Planners: ways to plan a mission, each called alike, each plan checked before anyone sees it."""

from __future__ import annotations

import importlib
import inspect
import math
import pkgutil
from collections.abc import Mapping
from functools import cache
from numbers import Real
from typing import Any

from ..certify.plan import check_plan
from ..mission.errors import InputError
from ..mission.instance import Instance
from ..mission.plan import Plan
from ..routing.problem import Objective
from ..stages.options import StagedOptions
from .support.improvement import check_objective, improve_plan
from .support.planner import Planner


@cache
def planners() -> dict[str, Planner]:
    """All planners by name: each file of this folder that has a ``PLANNER``."""
    modules = (
        importlib.import_module(f"{__name__}.{info.name}")
        for info in pkgutil.iter_modules(__path__)
    )
    found = [module.PLANNER for module in modules if hasattr(module, "PLANNER")]
    return {planner.name: planner for planner in found}


def plan(
    instance: Instance,
    *,
    planner: str = "msmrta",
    improve: bool | float = False,
    objective: Objective | None = None,
    **options: Any,
) -> Plan:
    """Plan `instance`, and check the plan.

    Parameters
    ----------
    instance : Instance
        The mission.
    planner : str
        One of `planners`; the default is the paper's staged method.
    improve : bool or float
        Improve the plan by local search: ``True`` for a fixed number of steps, which the same seed
        repeats; a number for that many seconds.
    objective : {"total_time", "makespan", "latency"}, optional
        What to improve, and what a planner with an objective minimises; total time by default.
    **options
        The planner's own; for ``msmrta`` those of `options.StagedOptions`, and ``preset``.

    Raises
    ------
    InputError
        If the planner or an option is unknown or out of range, or nothing would heed `objective`.
    CheckError
        If the plan fails its independent check, which would be a defect of the planner.
    """
    check_options(planner, {"improve": improve, "objective": objective, **options})
    run = planners()[planner].run
    if objective is not None and "objective" in inspect.signature(run).parameters:
        options["objective"] = objective
    made = check_plan(run(instance, **options))
    if improve is False:
        return made
    return check_plan(
        improve_plan(
            made,
            objective=objective or "total_time",
            seconds=None if improve is True else float(improve),
            seed=options.get("seed", 0),
        )
    )


def check_options(planner: str, options: Mapping[str, Any]) -> None:
    """Check what `plan` is to be given, without planning.

    Raises
    ------
    InputError
        If the planner or an option is unknown, or nothing would heed it.
    """
    known = planners()
    if planner not in known:
        raise InputError(f"{planner!r}; give one of {', '.join(known)}", field="planner")
    takes = inspect.signature(known[planner].run).parameters
    own = {name: value for name, value in options.items() if name not in ("improve", "objective")}
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in takes.values()):
        StagedOptions.of(**own)
    else:
        for name in own:
            if name not in takes:
                there = ", ".join(list(takes)[1:])
                raise InputError(
                    f"planner {planner} has no such option; it has {there}", field=name
                )
    improve, objective = options.get("improve", False), options.get("objective")
    _check_improve(improve)
    if "objective" in takes and improve is not False:
        raise InputError(f"planner {planner} improves by itself; leave it out", field="improve")
    if objective is not None:
        check_objective(objective)
        if "objective" not in takes and improve is False:
            raise InputError(
                f"planner {planner} has no objective of its own; give improve with it",
                field="objective",
            )


def _check_improve(improve: object) -> None:
    if not (isinstance(improve, Real) and 0 <= float(improve) < math.inf):
        raise InputError(
            f"{improve!r}; give true, false, or a finite number of seconds, 0 or more",
            field="improve",
        )
