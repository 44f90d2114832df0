"""How many random cases a test tries: some in the quick set, all in the slow one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import settings


def sample(cases: Sequence[Any], quick: int) -> list[Any]:
    """All `cases`, to be tried one by one; those after the first `quick` in the slow set only."""
    return [
        case if i < quick else pytest.param(case, marks=pytest.mark.slow)
        for i, case in enumerate(cases)
    ]


def examples(number: int) -> int:
    """`number` of hypothesis' examples, or fewer where slow tests are left out; see `conftest`."""
    return max(number * settings.default.max_examples // 100, 10)
