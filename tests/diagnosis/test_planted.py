"""Of programs with one row gone wrong, `explain` and `diff` name the right one."""

from __future__ import annotations

import pytest
from support.planted import Planted, planted

from msmrta_opt.diagnosis.difference import diff
from msmrta_opt.diagnosis.explain import explain


def missed(item: Planted) -> str:
    """What names another row than the one that is wrong; empty if all names that one."""
    if item.is_infeasible:
        found = explain(item.wrong)
        if found.conflict is None or found.conflict.status != "infeasible":
            return f"explain says {found.status}"
        if item.row not in found.conflict.rows:
            return f"explain names {', '.join(found.conflict.rows)}"
    difference = diff(item.right, item.wrong)
    if [row.name for row in difference.rows] != [item.row]:
        return f"diff names {', '.join(row.name for row in difference.rows)}"
    if (difference.rows_a, difference.rows_b, difference.costs) != ((), (), ()):
        return "diff names more than rows"
    return ""


def report(items: list[Planted]) -> list[str]:
    return [
        f"{item.name}, {item.edit} of '{item.row}': {said}"
        for item in items
        if (said := missed(item))
    ]


def test_the_row_that_is_wrong_is_named_in_a_sample() -> None:
    assert report(list(planted(12))) == []


@pytest.mark.slow
def test_the_row_that_is_wrong_is_named_in_at_least_45_of_50() -> None:
    items = list(planted(50, seed=1))
    assert any(item.is_infeasible for item in items)
    assert not all(item.is_infeasible for item in items)
    wrong = report(items)
    assert len(wrong) <= 5, wrong
