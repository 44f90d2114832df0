"""How many random cases a test tries: some in the quick set, all in the slow one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import settings

QUICK_EXAMPLES = 25
"""Hypothesis' examples where slow tests are left out; see `conftest`."""


def sample(cases: Sequence[Any], quick: int) -> list[Any]:
    """All `cases`, to be tried one by one; those after the first `quick` in the slow set only.

    Where slow tests are left out they are not even made: each process would make thousands of them.
    """
    if settings.default.max_examples == QUICK_EXAMPLES:
        return list(cases[:quick])
    return [
        case if i < quick else pytest.param(case, marks=pytest.mark.slow)
        for i, case in enumerate(cases)
    ]


def examples(number: int) -> int:
    """`number` of hypothesis' examples, or fewer where slow tests are left out."""
    return max(number * settings.default.max_examples // 100, 10)
