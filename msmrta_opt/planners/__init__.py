"""Planners: ways to plan a mission, each called alike, each plan checked before anyone sees it.

A file a planner: `msmrta`, the paper's staged method; `exact`, the joint problem with a proven bound;
the baselines `mrga`, `ssi`, `greedy` and `random`. What a planner is, and what it declares of itself, is
in `support`. A new file with a ``PLANNER`` is found here, and nothing else needs to know of it.
"""

from __future__ import annotations

import importlib
import math
import pkgutil
import sys
from collections.abc import Mapping
from functools import cache
from numbers import Integral, Real
from types import ModuleType
from typing import Any

from ..certify.plan import check_plan
from ..mission.errors import InputError
from ..mission.instance import Instance, require_mission
from ..mission.plan import Plan
from ..mission.suggestions import meant, none_of
from ..routing.objectives import DEFAULT, objective_of
from ..routing.parameters import Parameters
from .support.improvement import improve_plan
from .support.planner import Planner

OF_SEARCH = ("objective", "parameters")
"""Options of local search, which planners that search have, too."""


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
    objective: str | None = None,
    parameters: Parameters | Mapping[str, Any] | None = None,
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
    objective : str, optional
        What to improve, and what a planner with an objective minimises; one of
        `routing.objectives.OBJECTIVES`, total time by default.
    parameters : Parameters or mapping, optional
        Tuning parameters of the search, whether the planner's or the improvement's.
    **options
        The planner's own; for ``msmrta`` those of `options.StagedOptions`, ``preset``, and the
        parameters of its formulations.

    Raises
    ------
    InputError
        If the planner or an option is unknown or out of range, or nothing would heed `objective` or
        `parameters`.
    CheckError
        If the plan fails its independent check, which would be a defect of the planner.
    """
    require_mission(instance)
    of_search = dict(zip(OF_SEARCH, (objective, parameters), strict=True))
    check_options(planner, {"improve": improve, **of_search, **options})
    chosen = planners()[planner]
    options |= {k: x for k, x in of_search.items() if x is not None and k in chosen.options}
    chosen.load(options)
    made = check_plan(chosen.run(instance, **options))
    if improve is False:
        return made
    return check_plan(
        improve_plan(
            made,
            objective=objective or DEFAULT,
            seconds=None if improve is True else float(improve),
            seed=options.get("seed", 0),
            parameters=parameters,
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
        raise none_of(planner, known, "planner")
    chosen = known[planner]
    takes = chosen.options
    own = {k: x for k, x in options.items() if k not in ("improve", *OF_SEARCH, "callbacks")}
    if not own.keys() <= takes.keys():
        takes = {**takes, **dict.fromkeys(chosen.parameters_of(own))}
    for name in own:
        if name not in takes:
            raise InputError(
                f"planner {planner} has no such option{meant(name, takes)}; it has {', '.join(takes)}",
                field=name,
            )
    if chosen.check is not None:
        chosen.check(own)
    seed = own.get("seed", 0)
    if isinstance(seed, bool) or not (isinstance(seed, Integral) and 0 <= int(seed) < 2**32):
        raise InputError(f"{seed!r}; give a whole number, 0 to 2**32 - 1", field="seed")
    improve = options.get("improve", False)
    _check_improve(improve)
    if chosen.improves_itself and improve is not False:
        raise InputError(f"planner {planner} improves by itself; leave it out", field="improve")
    of_search = {name: options.get(name) for name in OF_SEARCH}
    if of_search["objective"] is not None:
        objective_of(of_search["objective"])
    Parameters.of(of_search["parameters"])
    for name, value in of_search.items():
        if value is not None and name not in takes and improve is False:
            raise InputError(
                f"planner {planner} has no {name} of its own; give improve with it", field=name
            )


def _check_improve(improve: object) -> None:
    if not (isinstance(improve, Real) and 0 <= float(improve) < math.inf):
        raise InputError(
            f"{improve!r}; give true, false, or a finite number of seconds, 0 or more",
            field="improve",
        )


class _Callable(ModuleType):
    """What ``msmrta_opt.planners()`` calls: there the module has the name of its function."""

    def __call__(self) -> dict[str, Planner]:
        return planners()


sys.modules[__name__].__class__ = _Callable
