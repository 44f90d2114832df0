"""Policies: what to do when a plan meets the world.

A file a policy, found here by its ``POLICY``; nothing else needs to know of it. `keep` the
plan as it is; `repair` it where it costs least; `replan` all that is to come.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from functools import cache
from typing import Any

from ...mission.errors import InputError
from ...mission.suggestions import meant, none_of
from ..state import Policy

BLOCKED = ("wait", "skip", "detour")
COMMON: Mapping[str, Any] = {"blocked": "detour"}
"""Options that every policy has."""


@cache
def policies() -> dict[str, Policy]:
    """All policies by name: each file of this folder that has a ``POLICY``."""
    modules = (
        importlib.import_module(f"{__name__}.{info.name}")
        for info in pkgutil.iter_modules(__path__)
    )
    found = [module.POLICY for module in modules if hasattr(module, "POLICY")]
    return {policy.name: policy for policy in found}


def policy_of(name: str, options: Mapping[str, Any]) -> tuple[Policy, dict[str, Any]]:
    """The policy `name`, and all its options with those that are given.

    Raises
    ------
    InputError
        If there is no such policy or option, or a value is wrong.
    """
    known = policies()
    if name not in known:
        raise none_of(name, known, "policy")
    policy = known[name]
    takes = {**COMMON, **policy.defaults}
    for option in options:
        if option not in takes:
            raise InputError(
                f"policy {name} has no such option{meant(option, takes)}; it has {', '.join(takes)}",
                field=option,
            )
    chosen = {**takes, **options}
    if chosen["blocked"] not in BLOCKED:
        raise InputError(
            f"{chosen['blocked']!r}; give one of {', '.join(BLOCKED)}", field="blocked"
        )
    if policy.check is not None:
        policy.check(chosen)
    return policy, chosen
