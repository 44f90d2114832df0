"""How compare shows what each formulation does for the mission, and who gets what by it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..studies.analysis.score import Score
    from ..studies.record import Record

MEANING = (
    "own: the formulation's own objective, which only formulations of one objective share.",
    "Eq. 1: requirements served by who takes which cluster, weighed by ψ; more is better.",
    "Eq. 2: time of who takes which victim, weighed by β; less is better, of as many victims.",
    "B2, B3, B4: visits by cluster assignment, victim assignment and auction.",
)
"""What the columns mean that are not metrics of plans."""


def show_scores(rows: Sequence[Record], measured: Sequence[Score]) -> None:
    """Show scores of all formulations on all instances, and then who gets what."""
    from ..mission.metrics import metrics_of
    from ..studies.analysis.choices import MARK, side_by_side
    from .console import say, table

    if not measured:
        return
    metrics = metrics_of("plans")
    table(
        "What each formulation does for the mission (the staged plan that comes of it)",
        [
            *("instance", "model", "own", "Eq. 1", "Eq. 2", "B2", "B3", "B4"),
            *(metric.heading for metric in metrics),
            "message",
        ],
        [
            (
                item.instance,
                item.model,
                _own(rows, item),
                item.eq1,
                item.eq2,
                item.served_in_b2,
                item.served_in_b3,
                item.served_in_b4,
                *(item.metrics and metric.of(item.metrics) for metric in metrics),
                item.message,
            )
            for item in measured
        ],
    )
    for line in MEANING:
        say(line)
    columns, who = side_by_side([(item.instance, item.model, item.gets) for item in measured])
    if who:
        table(f"Who gets what ({MARK}: not as by {columns[2]})", columns, who)


def _own(rows: Sequence[Record], item: Score) -> float | None:
    """The optimal value that solvers agree on, or the best that one of them found."""
    solved = [
        row
        for row in rows
        if (row.instance, row.model) == (item.instance, item.model) and row.objective is not None
    ]
    solved.sort(key=lambda row: row.verdict != "optimal")
    return solved[0].objective if solved else None
