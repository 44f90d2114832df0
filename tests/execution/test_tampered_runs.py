"""A run that was tampered with is refused, whatever was changed."""

from __future__ import annotations

import contextlib
import copy
import random
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest
from pydantic import ValidationError
from support import executions
from support.amounts import sample

from msmrta_opt.certify.run import problems
from msmrta_opt.execution.execute import execute
from msmrta_opt.mission.run import Run

PARTS = ("world", "tracks", "services", "events", "decisions", "figures")


@cache
def document(number: int) -> dict[str, Any]:
    plan = executions.plan(number)
    return execute(plan, executions.scenario(number, plan), seed=number).document()


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(value, (dict, list)):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, item in items:
            yield from leaves(item, (*path, key))
    else:
        yield path


def tampered(chance: random.Random, given: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Another document, in which one value is changed, or one item is gone or there twice."""
    changed = copy.deepcopy(given)
    part = chance.choice([name for name in PARTS if changed[name]])
    if part not in ("world", "figures") and chance.random() < 0.3:
        items = changed[part]
        i = chance.randrange(len(items))
        what = chance.choice(["drop", "twice"])
        items[i : i + 1] = [] if what == "drop" else [items[i], items[i]]
        return f"{what} {part}[{i}]", changed
    path = chance.choice(list(leaves(changed[part])))
    inside = changed[part]
    for key in path[:-1]:
        inside = inside[key]
    old = inside[path[-1]]
    if isinstance(old, bool):
        new: Any = not old
    elif isinstance(old, (int, float)):
        new = old + chance.choice([1, 2, 1000]) if chance.random() < 0.7 else old * 1.5 + 1
    else:
        new = chance.choice(["Defuser", "lost", "served", None, 3])
    inside[path[-1]] = new
    return f"{part}{list(path)}: {old!r} is {new!r}", changed


@pytest.mark.parametrize("number", sample(range(60), quick=3))
def test_a_run_with_one_thing_changed_is_refused(number: int) -> None:
    chance, given = random.Random(number), document(number)
    assert problems(Run.model_validate(given)) == []
    for _ in range(25):
        what, changed = tampered(chance, given)
        if changed == given:
            continue
        with contextlib.suppress(ValidationError):  # no run at all
            assert problems(Run.model_validate(changed)) != [], what
