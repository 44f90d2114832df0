"""Cuts at the root: rounds of separation, until they no longer pay."""

from __future__ import annotations

from fractions import Fraction

from .derivation import Box, Lemmas
from .exact import ExactProgram, Row
from .relaxation import Relaxation, Relaxed
from .rounding import derive
from .separation import Separator
from .tree import Limits

MAX_ROUNDS = 60
CUTS_A_ROUND = 150
STALLED = 4
"""Rounds without `PROGRESS` that end the search for cuts."""
PROGRESS = 0.03
"""Share of what is missing to the target."""
SLACK = 1e-4
"""Relative slack from which a cut is dropped."""


def strengthen(
    program: ExactProgram,
    relaxation: Relaxation,
    rows: list[Row],
    box: Box,
    lemmas: Lemmas,
    target: Fraction | None,
    limits: Limits,
) -> int:
    """Add cuts to `rows` and the relaxation, which has the same; returns how many there are.

    They are looked for until the relaxation's value is the target, or, without one, it is infeasible.
    """
    n_given = len(rows)
    separator = Separator(program, box)
    relaxed = relaxation.solve()
    history: list[float] = []
    for _ in range(MAX_ROUNDS):
        if relaxed.x is None or limits.reached(0):
            break
        if target is not None and relaxed.value >= target:
            break
        history.append(relaxed.value)
        if len(history) > STALLED:
            gained = history[-1] - history[-1 - STALLED]
            if target is None or gained < PROGRESS * (float(target) - relaxed.value):
                break
        found = separator.cuts(relaxed.x, relaxation, CUTS_A_ROUND)
        cuts = [derive(program, rows, box, lemmas, item) for item in found]
        added = [cut for cut in cuts if cut is not None and _violation(cut, relaxed) > SLACK]
        if not added:
            break
        rows.extend(added)
        relaxation.add_rows(added)
        separator.add_rows(added)
        relaxed = relaxation.solve()
        if relaxed.x is None:
            break
        idle = [i for i in range(n_given, len(rows)) if _violation(rows[i], relaxed) < -SLACK]
        if idle:
            relaxation.remove_rows(idle)
            separator.remove_rows(idle)
            for i in reversed(idle):
                del rows[i]
            relaxed = relaxation.solve()
    return len(rows) - n_given


def _violation(row: Row, relaxed: Relaxed) -> float:
    """By how much a ≤ row is violated, over its largest coefficient."""
    assert relaxed.x is not None
    assert row.upper is not None
    size = float(max(map(abs, row.coefficients)))
    activity = sum(
        float(a) * relaxed.x[j] for j, a in zip(row.columns, row.coefficients, strict=True)
    )
    return float(activity - float(row.upper)) / size
