"""Plans with one thing changed, for checkers to find."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

from msmrta_opt.mission.plan import Plan

Document = dict[str, Any]


def edited(plan: Plan, edit: Callable[[Document], None]) -> Plan:
    """The plan after `edit` changed its document."""
    document = copy.deepcopy(plan.document())
    edit(document)
    return Plan.model_validate(document)


def visit(document: Document, route: int, position: int = 0) -> Document:
    found: Document = document["routes"][route]["visits"][position]
    return found


def put(route: int, position: int = 0, **fields: object) -> Callable[[Document], None]:
    """Change fields of one visit."""
    return lambda document: visit(document, route, position).update(fields)
